"""Models in the making: bodies anywhere, and liaisons that are closed in the initial pose wherever they are."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from maggi.linalg.rotations import rotation_matrix
from maggi.model import (
    GROUND,
    Attachment,
    BoxMesh,
    Damping,
    ElasticBody,
    End,
    GivenMotion,
    Joint,
    LineQuadrature,
    Material,
    Model,
    NamedSet,
    PointMass,
    Pose,
    RigidBody,
    RitzBody,
    RitzIntegrals,
    expression,
)
from maggi.model.shapes import BoxQuadrature


def vector(values):
    """Numbers as the tuple that descriptions keep."""
    return tuple(float(x) for x in values)


def matrix(rows):
    """A matrix as the tuple of tuples that descriptions keep."""
    return tuple(vector(row) for row in rows)


def direction(rng):
    """A random unit vector."""
    x = rng.normal(size=3)
    return x / np.linalg.norm(x)


def across(rng, axis):
    """A random unit vector normal to an axis."""
    x = np.cross(axis, direction(rng))
    return x / np.linalg.norm(x)


@dataclass
class Workshop:
    """A model in the making. Elastic bodies get an attachment wherever something is fixed to them."""

    rng: np.random.Generator
    bodies: dict = field(default_factory=dict)
    joints: dict = field(default_factory=dict)
    forces: dict = field(default_factory=dict)

    def name(self, what):
        """A new name."""
        return f"{what}{len(self.bodies) + len(self.joints) + len(self.forces)}"

    def pose(self):
        """A random pose within about a metre."""
        rng = self.rng
        return Pose(vector(0.5 * rng.normal(size=3)), matrix(rotation_matrix(rng.normal(size=3))))

    def rigid(self):
        """A rigid body of a random kind: solid, thin (no inertia about one axis), or with inertia about one axis only."""
        rng = self.rng
        second = rng.uniform(0.01, 0.1, 3)
        kind = rng.integers(0, 6)
        if kind == 0:
            second[1:] = 0.0
        moments = second.sum() - second if kind != 1 else np.array([0.0, 0.0, second[0]])
        turn = rotation_matrix(rng.normal(size=3)) if kind != 1 else np.eye(3)
        body = RigidBody(
            float(rng.uniform(0.5, 2.0)),
            vector(0.2 * rng.normal(size=3)),
            matrix(turn @ np.diag(moments) @ turn.T),
            self.pose(),
            attachments={},
        )
        return self._keep("b", body)

    def ritz(self):
        """A Ritz body with two or three quadratic shape functions over a box or a line."""
        rng = self.rng
        count = int(rng.integers(2, 4))
        constant, linear = 0.2 * rng.normal(size=(3, count)), 0.4 * rng.normal(size=(3, 3, count))
        square = 0.4 * rng.normal(size=(3, 3, count))
        turn = rng.normal(size=(3, count)) if rng.random() < 0.7 else np.zeros((3, count))

        def shapes(x):
            return constant + np.einsum("pj,jia->pia", x, linear) + np.einsum("pj,jia->pia", x**2, square)

        def rotations(x):
            return turn + np.einsum("pj,jia->pia", x, linear)

        factor = rng.normal(size=(count, count))
        stiffness = 20.0 * (factor @ factor.T + np.eye(count))
        damping = 0.05 * stiffness if rng.random() < 0.7 else None
        if rng.random() < 0.5:
            low, high = rng.uniform(-0.5, -0.1, 3), rng.uniform(0.1, 0.5, 3)
            integrals = RitzIntegrals(8.0, BoxQuadrature(vector(low), vector(high), 3), stiffness, damping)
        else:
            inertia = np.diag([0.02, 0.3, 0.3])
            integrals = RitzIntegrals(1000.0, LineQuadrature(0.8, 1e-3, 5), stiffness, damping, matrix(inertia))
        return self._keep("e", RitzBody(integrals, shapes, rotations, pose=self.pose(), attachments={}))

    def box(self):
        """A soft box of two hexahedra, held at its ends; one rigid attachment, one averaged."""
        size, rng = (0.6, 0.3, 0.2), self.rng
        damping = Damping(float(rng.uniform(0.0, 2.0)), float(rng.uniform(0.0, 1e-2)))
        material = Material(float(rng.uniform(10.0, 50.0)), 1e4, 0.3, damping)
        attachments = {
            "start": Attachment(nodes=NamedSet("x_min"), coupling="rigid"),
            "end": Attachment(nodes=NamedSet("x_max"), coupling="average"),
        }
        return self._keep("m", ElasticBody(BoxMesh(size, (2, 1, 1)), material, self.pose(), attachments=attachments))

    def given(self):
        """A rigid body that moves as functions of time say."""
        rng = self.rng
        pose = self.pose()
        a = vector(0.3 * rng.normal(size=3))
        origin = tuple(
            expression("x + a*sin(2*t) + b*t**2", x=x, a=s, b=0.5 * s) for x, s in zip(pose.origin, a, strict=True)
        )
        motion = GivenMotion(origin, vector(direction(rng)), expression("1.5*t + 0.4*sin(3*t)"))
        return self._keep("g", RigidBody(1.0, pose=pose, attachments={}, motion=motion))

    def to_body(self, name, point):
        """A global point in the axes of a body, in the initial pose."""
        if name == GROUND:
            return np.asarray(point)
        pose = self.bodies[name].pose
        return np.array(pose.rotation).T @ (np.asarray(point) - np.array(pose.origin))

    def to_global(self, name, point):
        """A body's point, global, in the initial pose."""
        if name == GROUND:
            return np.asarray(point)
        pose = self.bodies[name].pose
        return np.array(pose.origin) + np.array(pose.rotation) @ np.asarray(point)

    def is_elastic(self, name):
        """Whether a body must be held at attachments."""
        return name != GROUND and not isinstance(self.bodies[name], RigidBody)

    def is_meshed(self, name):
        """Whether a body has only the attachments that its mesh was given."""
        return name != GROUND and isinstance(self.bodies[name], ElasticBody)

    def mesh_attachments(self, name):
        """Global places of a box's attachments by name."""
        x, y, z = self.bodies[name].mesh.size
        return {"start": self.to_global(name, [0.0, y / 2, z / 2]), "end": self.to_global(name, [x, y / 2, z / 2])}

    def end(self, name, place):
        """The end of a liaison at a global place: of an elastic body a new attachment there."""
        return self.attachment(name, place) if self.is_elastic(name) else End(name)

    def attachment(self, name, place):
        """A new attachment at a global place; of ground a fixed point, of a box the attachment next to it."""
        if name == GROUND:
            return End(GROUND, point=vector(place))
        if self.is_meshed(name):
            places = self.mesh_attachments(name)
            return End(name, min(places, key=lambda key: np.linalg.norm(places[key] - place)))
        attachments = self.bodies[name].attachments
        key = f"a{len(attachments)}"
        attachments[key] = Attachment(at=vector(self.to_body(name, place)))
        return End(name, key)

    def point_mass(self, name):
        """A point mass on a body."""
        end = self.attachment(name, self.place(name))
        attachments = self.bodies[name].attachments
        mass = PointMass(float(self.rng.uniform(0.1, 0.5)), vector(0.1 * self.rng.normal(size=3)))
        attachments[end.attachment] = replace(attachments[end.attachment], point_masses=(mass,))

    def place(self, *names):
        """A random global point near bodies; where one of them is a box, one of its attachments."""
        for name in names:
            if self.is_meshed(name):
                places = self.mesh_attachments(name)
                return places[str(self.rng.choice(list(places)))]
        origins = [self.to_global(name, np.zeros(3)) for name in names]
        return np.mean(origins, axis=0) + 0.3 * self.rng.normal(size=3)

    def join(self, kind, first, second, place=None, **keys):
        """A joint at a global place."""
        place = self.place(first, second) if place is None else place
        ends = self.end(first, place), self.end(second, place)
        at = None if self.is_elastic(first) or self.is_elastic(second) else vector(place)
        return self.add(kind, Joint(kind, *ends, at=at, **keys))

    def at(self, second, place):
        """The key `at` of contacts, which elastic bodies do without: their attachment is there."""
        return None if self.is_elastic(second) else vector(place)

    def add(self, what, liaison):
        """A liaison; returns its name."""
        name = self.name(what)
        self.joints[name] = liaison
        return name

    def model(self):
        """The finished model."""
        gravity = vector(9.81 * direction(self.rng))
        return Model(dict(self.bodies), dict(self.joints), dict(self.forces), gravity=gravity)

    def _keep(self, letter, body):
        name = self.name(letter)
        self.bodies[name] = body
        return name

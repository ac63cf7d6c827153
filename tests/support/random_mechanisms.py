"""Random mechanisms: bodies anywhere, any liaison of the library between any two, and states in motion.

`Workshop` builds a model body by body and liaison by liaison, every liaison closed in the initial pose. `LIAISONS` has a
function for every kind, which places it at random. `random_model` puts a whole mechanism together, and
`state_in_motion` moves any system to other positions and velocities that its liaisons admit.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from maggi.bodies.motions import prescribe
from maggi.linalg.rotations import rotation_matrix
from maggi.model import (
    GROUND,
    Attachment,
    BoxMesh,
    Cam,
    Coupler,
    Damping,
    Distance,
    Driver,
    ElasticBody,
    End,
    ExpressionCurve,
    ExpressionSurface,
    GivenMotion,
    Joint,
    JointCoordinate,
    KnifeEdge,
    LineQuadrature,
    Material,
    Model,
    NamedSet,
    Pfaffian,
    PfaffianFunction,
    PfaffianRow,
    Plane,
    PointLoad,
    PointMass,
    PointOnCurve,
    PointOnSurface,
    Pose,
    RigidBody,
    RitzBody,
    RitzIntegrals,
    RollingDisc,
    RollingSphere,
    SplineCurve,
    SplineSurface,
    SpringDamper,
    TorsionSpring,
    expression,
    formula,
)
from maggi.model.joints import POSE
from maggi.model.shapes import BoxQuadrature
from maggi.projection.maggi import closest_velocities, project, restore
from maggi.stepping.allocate import copy_motion
from maggi.stepping.kernels import move
from maggi.system.dense import dense_mass, dense_rows, floating_velocities, velocity_scale


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


# joints


def _axial(kind, **keys):
    def add(shop, first, second):
        return shop.join(kind, first, second, axis=vector(direction(shop.rng)), **keys)

    return add


def _plain(kind):
    return lambda shop, first, second: shop.join(kind, first, second)


def universal(shop, first, second):
    x = direction(shop.rng)
    return shop.join("universal", first, second, axes=(vector(x), vector(across(shop.rng, x))))


def bent_shafts(shop, first, second):
    z = direction(shop.rng)
    other = z + 0.4 * across(shop.rng, z)
    return shop.join("constant-velocity", first, second, axes=(vector(z), vector(other)))


def screw(shop, first, second):
    pitch = float(shop.rng.choice([-1.0, 1.0]) * shop.rng.uniform(0.1, 0.5))
    return shop.join("screw", first, second, axis=vector(direction(shop.rng)), pitch=pitch)


# liaisons of two points


def rod(shop, first, second):
    ends = [shop.attachment(name, shop.place(name)) for name in (first, second)]
    return shop.add("rod", Distance(*ends))


def driven_rod(shop, first, second):
    p = shop.place(first)
    q = p + 0.7 * direction(shop.rng)
    ends = shop.attachment(first, p), shop.attachment(second, q)
    return shop.add("rod", Distance(*ends, expression("0.7 + 0.3*t + 0.5*t**2")))


def _curve(shop):
    a, b, c = shop.rng.uniform(0.2, 0.6, 3)
    x, y, z = (
        formula(text, ("s",), a=float(a), b=float(b), c=float(c))
        for text in ("a*cos(s)", "b*sin(s) + 0.1*s**2", "c*s + 0.2*sin(2*s)")
    )
    s = 0.4
    point = np.array([a * np.cos(s), b * np.sin(s) + 0.1 * s**2, c * s + 0.2 * np.sin(2 * s)])
    return ExpressionCurve(x, y, z, (-2.0, 3.0)), point


def _carrier(shop, first):
    """The end that carries a curve or a surface, whose frame is that of its body."""
    return shop.end(first, shop.to_global(first, np.zeros(3)))


def curve(shop, first, second):
    track, point = _curve(shop)
    place = shop.to_global(first, point)
    return shop.add(
        "curve", PointOnCurve(_carrier(shop, first), shop.end(second, place), track, shop.at(second, place))
    )


def spline(shop, first, second):
    angles = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    points = np.column_stack([0.6 * np.cos(angles), 0.4 * np.sin(angles), 0.1 * np.cos(2.0 * angles)])
    place = shop.to_global(first, points[2])
    track = SplineCurve(tuple(map(vector, points)), closed=True)
    return shop.add(
        "spline", PointOnCurve(_carrier(shop, first), shop.end(second, place), track, shop.at(second, place))
    )


def surface(shop, first, second):
    point = 0.5 * direction(shop.rng) + [0.3, 0.2, 0.1]
    x, y, z = (float(v) for v in point)
    level = x**2 + 2.0 * y**2 + 0.5 * z**2 + 0.3 * np.sin(2.0 * x) * z
    F = formula("x**2 + 2*y**2 + 0.5*z**2 + 0.3*sin(2*x)*z - level", ("x", "y", "z"), level=float(level))
    place = shop.to_global(first, point)
    return shop.add(
        "surface",
        PointOnSurface(_carrier(shop, first), shop.end(second, place), ExpressionSurface(F), shop.at(second, place)),
    )


def height_field(shop, first, second):
    x, y = np.linspace(-1.0, 1.0, 6), np.linspace(-1.2, 1.2, 5)
    z = 0.2 * np.sin(2.0 * x)[:, None] + 0.15 * np.cos(2.0 * y)
    place = shop.to_global(first, [x[3], y[2], z[3, 2]])
    field_of = SplineSurface(vector(x), vector(y), matrix(z))
    return shop.add(
        "field", PointOnSurface(_carrier(shop, first), shop.end(second, place), field_of, shop.at(second, place))
    )


def _cam(shop, first, second, **keys):
    """An elliptic cam in the plane normal to z of its body; the follower's point on it or `keys["radius"]` away."""
    profile = ExpressionCurve(
        formula("0.4*cos(s)", ("s",)),
        formula("0.25*sin(s)", ("s",)),
        formula("0*s", ("s",)),
        (0.0, 6.283185307179586),
        True,
    )
    s = 0.7
    point, tangent = (
        np.array([0.4 * np.cos(s), 0.25 * np.sin(s), 0.0]),
        np.array([-0.4 * np.sin(s), 0.25 * np.cos(s), 0.0]),
    )
    normal = np.cross(tangent, [0.0, 0.0, 1.0]) / np.linalg.norm(tangent)
    R = np.eye(3) if first == GROUND else np.array(shop.bodies[first].pose.rotation)
    if "face" in keys:
        keys["face"] = vector(R @ normal)
        place = point + 0.05 * tangent
    else:
        place = point + keys["radius"] * normal
    place = shop.to_global(first, place)
    return shop.add(
        "cam",
        Cam(
            _carrier(shop, first),
            shop.end(second, place),
            profile,
            vector(R[:, 2]),
            at=shop.at(second, place),
            **keys,
        ),
    )


def roller(shop, first, second):
    return _cam(shop, first, second, radius=0.1)


def edge_follower(shop, first, second):
    return _cam(shop, first, second, radius=0.0)


def face_follower(shop, first, second):
    return _cam(shop, first, second, face=None)


# contacts without slip


def disc(shop, first, second):
    rng = shop.rng
    n, radius = direction(rng), float(rng.uniform(0.1, 0.4))
    u = across(rng, n) + float(rng.uniform(-0.8, 0.8)) * n
    u /= np.linalg.norm(u)
    centre = shop.place(second)
    down = -(n - (n @ u) * u)
    foot = centre + radius * down / np.linalg.norm(down)
    return shop.add(
        "disc",
        RollingDisc(
            shop.end(first, foot),
            shop.end(second, centre),
            radius,
            vector(u),
            Plane(vector(foot), vector(n)),
            shop.at(second, centre),
        ),
    )


def sphere(shop, first, second):
    rng = shop.rng
    n, radius = direction(rng), float(rng.uniform(0.1, 0.4))
    centre = shop.place(second)
    foot = centre - radius * n
    place = foot if shop.is_elastic(first) else foot + 0.3 * across(rng, n)
    return shop.add(
        "sphere",
        RollingSphere(
            shop.end(first, place),
            shop.end(second, centre),
            radius,
            Plane(vector(place), vector(n)),
            shop.at(second, centre),
        ),
    )


def blade(shop, first, second):
    n = direction(shop.rng)
    along = across(shop.rng, n)
    place = shop.place(second)
    return shop.add(
        "blade",
        KnifeEdge(shop.end(first, place), shop.end(second, place), vector(along), vector(n), shop.at(second, place)),
    )


# relations of coordinates


def _driver(kind, quantity, text):
    def add(shop, first, second):
        joint = _axial(kind)(shop, first, second)
        return shop.add("motor", Driver(joint, quantity, expression(text)))

    return add


def _pair(kinds, quantities, text, rates=False, kind="coupler"):
    """A relation between the coordinates of two joints that lead from the first body over a third to the second."""

    def add(shop, first, second):
        middle = shop.rigid()
        names = [_axial(kinds[0])(shop, first, middle), _axial(kinds[1])(shop, middle, second)]
        coordinates = {
            letter: JointCoordinate(joint, q) for letter, joint, q in zip("ab", names, quantities, strict=True)
        }
        return shop.add("relation", Coupler(kind, coordinates, formula(text, ("t", "a", "b")), rates))

    return add


# rows of the user's own


def pfaffian(shop, first, second):
    ends = {"p": shop.attachment(first, shop.place(first)), "q": shop.attachment(second, shop.place(second))}
    names = ("t", *(f"{end}.{part}" for end in ends for part in POSE))
    rows = (
        PfaffianRow(
            {
                ("q", "v.x"): formula("q.r11 + 0.3*p.y*t", names),
                ("q", "v.y"): formula("q.r21*p.r11", names),
                ("p", "v.z"): formula("1 + 0.5*q.x**2", names),
                ("q", "w.z"): formula("0.2*q.r33", names),
            },
            formula("0.1*t + 0.05*p.x", names),
        ),
        PfaffianRow({("p", "w.x"): formula("1", names), ("q", "w.y"): formula("cos(q.z)", names)}),
    )
    return shop.add("pfaffian", Pfaffian(ends, rows))


def _own_rows(t, position, rotation):
    A = np.zeros((1, 2, 6))
    A[0, 0, :3] = rotation[1, :, 0]
    A[0, 1, :3] = np.cross(position[0] - position[1], [0.0, 0.0, 1.0]) + [1.0, 0.0, t]
    A[0, 1, 3:] = 0.1 * rotation[0, 2]
    return A, np.array([0.2 * np.sin(t) + 0.1 * position[1, 0]])


def own_function(shop, first, second):
    ends = {"p": shop.attachment(first, shop.place(first)), "q": shop.attachment(second, shop.place(second))}
    return shop.add("function", PfaffianFunction(ends, 1, _own_rows))


HOLONOMIC = {
    "revolute": _axial("revolute"),
    "prismatic": _axial("prismatic"),
    "cylindrical": _axial("cylindrical"),
    "planar": _axial("planar"),
    "spherical": _plain("spherical"),
    "weld": _plain("weld"),
    "free": _plain("free"),
    "universal": universal,
    "constant-velocity": _axial("constant-velocity"),
    "bent-shafts": bent_shafts,
    "screw": screw,
    "rod": rod,
    "driven-rod": driven_rod,
    "curve": curve,
    "spline-curve": spline,
    "surface": surface,
    "height-field": height_field,
    "cam-roller": roller,
    "cam-edge": edge_follower,
    "cam-face": face_follower,
    "angle-driver": _driver("revolute", "angle", "2*t + 0.5*sin(3*t)"),
    "angle-driver-cylindrical": _driver("cylindrical", "angle", "t**2 + t"),
    "angle-driver-planar": _driver("planar", "angle", "1.5*t"),
    "displacement-driver": _driver("prismatic", "displacement", "0.2*t + 0.3*t**2"),
    "gear": _pair(("revolute", "revolute"), ("angle", "angle"), "b - (-2.5)*a", kind="gear"),
    "rack": _pair(("revolute", "prismatic"), ("angle", "displacement"), "b - 0.2*a", kind="rack"),
    "coupler": _pair(("cylindrical", "prismatic"), ("angle", None), "b - 0.3*sin(a) + 0.1*a*b - 0.2*t"),
}
NONHOLONOMIC = {
    "disc": disc,
    "sphere": sphere,
    "knife-edge": blade,
    "speed-driver": _driver("revolute", "speed", "1 + 2*t"),
    "speed-driver-prismatic": _driver("prismatic", "speed", "0.5*cos(t)"),
    "coupler-of-rates": _pair(("revolute", "prismatic"), (None, None), "b - 0.4*cos(t)*a + 0.2*t", rates=True),
    "pfaffian": pfaffian,
    "function": own_function,
}
LIAISONS = {**HOLONOMIC, **NONHOLONOMIC}
"""Every kind of liaison: ``add(shop, first, second)`` places it at random between two bodies and returns its name."""

TREE = (
    "revolute",
    "prismatic",
    "cylindrical",
    "planar",
    "spherical",
    "universal",
    "constant-velocity",
    "screw",
    "free",
)
LOOP = ("spherical", "rod", "planar", "surface", "height-field", "curve", "cam-roller", "cylindrical", "universal")
NO_SLIP = ("disc", "sphere", "knife-edge", "pfaffian", "function")


@dataclass(frozen=True)
class Features:
    """What a random mechanism has, beyond rigid bodies in a tree of joints."""

    closed: bool = False
    nonholonomic: bool = False
    redundant: bool = False
    elastic: bool = False
    driven: bool = False


def random_model(rng, features):
    """A mechanism of three to five bodies with at least the given features, with springs and loads."""
    shop = Workshop(rng)
    names = []
    for i in range(int(rng.integers(3, 6))):
        if features.elastic and i == 0:
            name = shop.box() if rng.random() < 0.3 else shop.ritz()
        else:
            name = shop.ritz() if features.elastic and rng.random() < 0.3 else shop.rigid()
        parent = str(rng.choice([GROUND, *names]))
        LIAISONS[str(rng.choice(TREE))](shop, parent, name)
        names.append(name)
    boxes = [name for name in names if shop.is_meshed(name)]
    # a box is held and loaded at its own attachments only
    names = [name for name in names if name not in boxes]
    if features.closed:
        for _ in range(int(rng.integers(1, 3))):
            first, second = _two(rng, [GROUND, *names])
            LIAISONS[str(rng.choice(LOOP))](shop, first, second)
    if features.nonholonomic:
        free = shop.rigid()
        LIAISONS[str(rng.choice(("spherical", "free", "planar")))](shop, str(rng.choice([GROUND, *names])), free)
        LIAISONS[str(rng.choice(NO_SLIP))](shop, str(rng.choice([GROUND, *names])), free)
        names.append(free)
    if features.redundant:
        _hinge_pair(shop, str(rng.choice([GROUND, *names])), shop.rigid())
    if features.driven:
        kind = str(rng.choice(("angle-driver", "displacement-driver", "speed-driver", "gear", "coupler-of-rates")))
        LIAISONS[kind](shop, str(rng.choice([GROUND, *(n for n in names if not shop.is_elastic(n))])), shop.rigid())
    if rng.random() < 0.3:
        shop.point_mass(names[0])
    _forces(shop, [*names, *boxes])
    return shop.model()


def _two(rng, names):
    first, second = rng.choice(len(names), 2, replace=False)
    return names[first], names[second]


def _hinge_pair(shop, first, second):
    """Two joints of one kind on one axis: a door on two hinges, all rows of the second repeat those of the first."""
    axis, place = direction(shop.rng), shop.place(second)
    kind = str(shop.rng.choice(("revolute", "prismatic", "cylindrical")))
    for shift in (0.0, 0.4):
        shop.join(kind, first, second, place + shift * axis, axis=vector(axis))


def _forces(shop, names):
    rng = shop.rng
    first, second = _two(rng, [GROUND, *names])
    ends = [shop.attachment(name, shop.place(name)) for name in (first, second)]
    length = None if rng.random() < 0.5 else 0.3
    shop.forces[shop.name("spring")] = SpringDamper(*ends, 50.0, 2.0, length)
    on = shop.attachment(names[-1], shop.place(names[-1]))
    value = tuple(expression("a*cos(5*t)", a=float(a)) for a in 3.0 * rng.normal(size=3))
    kind, frame = str(rng.choice(("force", "torque"))), str(rng.choice(("global", "body")))
    shop.forces[shop.name("load")] = PointLoad(on, kind, value, frame)
    hinges = [name for name, joint in shop.joints.items() if isinstance(joint, Joint) and joint.kind == "revolute"]
    if hinges:
        shop.forces[shop.name("torsion")] = TorsionSpring(hinges[0], 5.0, 0.3, 0.2)


def state_in_motion(system, rng, t=0.1, steps=3, length=0.1):
    """Positions away from the initial pose and velocities, at time t (s), that all liaisons admit; None if there are none.

    steps : how many times everything moves by about `length` (m, rad) and is put back on Φ = 0.
    """
    moving = _moving(system)
    motion = copy_motion(system.start)
    scale = velocity_scale(system)
    for step in range(1, steps + 1):
        now = t * step / steps
        prescribe(system.motions, system.bodies, now, motion)
        wanted = admitted_velocities(system, motion, now, rng.normal(size=len(moving)), moving)
        if wanted is None:
            return None
        size = np.abs(wanted * scale[moving]).max(initial=0.0)
        base, shift = copy_motion(motion), np.zeros(system.coordinates)
        shift[moving] = wanted * (length / size if size > 0.0 else 0.0)
        move(system.bodies, base, shift, motion)
        if not _close(system, motion, now, moving):
            return None
    velocities = admitted_velocities(system, motion, t, rng.normal(size=len(moving)), moving)
    if velocities is None:
        return None
    motion.v[moving] = velocities
    return motion


def _moving(system):
    """Velocities that are unknown: of floating frames, and rates of elastic coordinates."""
    offset, bodies = system.bodies.offset, range(1, system.bodies.kind.size)
    elastic = [np.arange(offset[b] + 6, offset[b + 1]) for b in bodies]
    return np.sort(np.concatenate([floating_velocities(system), *elastic]))


def admitted_velocities(system, motion, t, wanted, moving):
    """The admitted velocities (k,) nearest to wanted ones; None where the liaisons contradict each other."""
    motion.v[moving] = 0.0
    rows = dense_rows(system, motion, t)
    M = dense_mass(system, motion)[np.ix_(moving, moving)]
    projection = project(rows.A[:, moving], velocity_scale(system)[moving])
    if np.abs(projection.inconsistency(rows.velocity)).max(initial=0.0) > 1e-9:
        return None
    return closest_velocities(projection, M, wanted, rows.velocity)


def _close(system, motion, t, moving):
    holonomic = np.flatnonzero(system.holonomic)
    M = dense_mass(system, motion)[np.ix_(moving, moving)]

    def rows_at(step):
        shift = np.zeros(system.coordinates)
        shift[moving] = step
        move(system.bodies, motion, shift, motion)
        rows = dense_rows(system, motion, t)
        return rows.A[np.ix_(holonomic, moving)], rows.position[holonomic]

    left = restore(rows_at, M, velocity_scale(system)[moving], 1e-12)
    return left < 1e-11

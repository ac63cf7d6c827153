"""Bodies and attachments of a model, collected into the body table."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import FIXED, MESH, RIGID, RITZ, BodyTable, MotionState
from maggi.linalg.rotations import rotation_matrix
from maggi.model.bodies import GivenMotion, RigidBody, RitzBody, RitzTerms
from maggi.model.errors import ModelError
from maggi.model.expression import value_at
from maggi.model.geometry import Pose
from maggi.model.shapes import RitzIntegrals

from .packing import flat, integers, numbers

if TYPE_CHECKING:
    from maggi.bodies.mesh_body import MeshBody
    from maggi.bodies.reduced import ReducedBody

Array = NDArray[np.float64]
NULL_INERTIA = 1e-9  # a moment of inertia below this part of m·size² counts as none
FLOOR = 1e-6  # what is then added to the iteration matrix, in the same unit


@dataclass(frozen=True, eq=False)
class _Body:
    kind: int
    floating: bool
    elastic: int
    mass: float
    S0: Array
    J0: Array
    ritz: RitzTerms | None
    origin: Array
    rotation: Array


class BodyList:
    """Bodies in the order of their rows; row 0 is ground."""

    def __init__(self) -> None:
        zero = np.zeros(3)
        self._bodies = [_Body(FIXED, False, 0, 0.0, zero, np.zeros((3, 3)), None, zero, np.eye(3))]
        self._attachment_body: list[int] = []
        self._points: list[Array] = []
        self._psi: list[Array] = []
        self._psi_offset: list[int] = []

    def add_rigid(self, body: RigidBody) -> int:
        """A rigid body; its inertia moved to the frame's origin."""
        c = np.array(body.center_of_mass)
        J0 = np.array(body.inertia) + body.mass * (c @ c * np.eye(3) - np.outer(c, c))
        return self._add(RIGID, body.motion is None, 0, body.mass, body.mass * c, J0, None, pose_of(body))

    def add_ritz(self, name: str, body: RitzBody) -> int:
        """A Ritz body; integrated here where its description asks for it."""
        terms = body.terms if isinstance(body.terms, RitzTerms) else _integrate(body, body.terms, f"bodies.{name}")
        return self._add(RITZ, body.motion is None, len(terms.m), terms.mass, terms.S0, terms.J0, terms, pose_of(body))

    def add_mesh(self, body: MeshBody, pose: tuple[Array, Array]) -> int:
        """A meshed body, with six elastic coordinates for every attachment."""
        inertia = body.inertia
        return self._add(MESH, body.floating, 6 * len(body.couplings), inertia.mass, inertia.S0, inertia.J0, None, pose)

    def add_reduced(self, body: ReducedBody, pose: tuple[Array, Array]) -> int:
        """A meshed body on a few shapes, which is a Ritz body."""
        terms = body.terms
        return self._add(RITZ, body.body.floating, len(terms.m), terms.mass, terms.S0, terms.J0, terms, pose)

    def add_rigidified(self, body: MeshBody, pose: tuple[Array, Array]) -> int:
        """A meshed body as a rigid one."""
        inertia = body.inertia
        return self._add(RIGID, True, 0, inertia.mass, inertia.S0, inertia.J0, None, pose)

    def add_attachment(self, body: int, point: Array, psi: Array | None = None) -> int:
        """An attachment at `point` (body axes) whose (d, θ) are Ψ e, `psi` (6, n_e); None: it does not deform."""
        elastic = self._bodies[body].elastic
        if psi is None:
            psi = np.zeros((6, elastic))
        self._attachment_body.append(body)
        self._points.append(np.asarray(point, dtype=np.float64))
        self._psi_offset.append(sum(part.size for part in self._psi))
        self._psi.append(psi)
        return len(self._points) - 1

    def place(self, body: int, origin: Array, rotation: Array) -> None:
        """Give a body its initial pose."""
        self._bodies[body] = replace(self._bodies[body], origin=origin, rotation=rotation)

    def is_elastic(self, body: int) -> bool:
        """Whether a body has elastic coordinates."""
        return self._bodies[body].elastic > 0

    def is_mesh(self, body: int) -> bool:
        return self._bodies[body].kind == MESH

    def moves(self, body: int) -> bool:
        """Whether a body has any unknown velocity."""
        entry = self._bodies[body]
        return entry.kind != FIXED and (entry.floating or entry.elastic > 0)

    def to_body(self, body: int, point: Array) -> Array:
        """A global point in a body's axes, in the initial pose."""
        entry = self._bodies[body]
        return np.asarray(entry.rotation.T @ (point - entry.origin))

    def to_global(self, body: int, point: Array) -> Array:
        """A point of a body, global, in the initial pose."""
        entry = self._bodies[body]
        return np.asarray(entry.origin + entry.rotation @ point)

    def rotation(self, body: int) -> Array:
        """A body's initial rotation."""
        return self._bodies[body].rotation

    def attachment_body(self, attachment: int) -> int:
        return self._attachment_body[attachment]

    def attachment_position(self, attachment: int) -> Array:
        """An attachment's global position in the initial pose."""
        return self.to_global(self._attachment_body[attachment], self._points[attachment])

    def attachment_point(self, attachment: int) -> Array:
        """An attachment's point in its body's axes, undeformed."""
        return self._points[attachment]

    def centers(self) -> list[Array]:
        """Centres of mass of all bodies that have mass, global."""
        return [self.to_global(b, e.S0 / e.mass) for b, e in enumerate(self._bodies) if e.mass > 0.0]

    def inertia_floor(self, size: float) -> Array:
        """What the iteration matrix adds to bodies without inertia about some axis, such as point masses (b,)."""
        result = np.zeros(len(self._bodies))
        for b, e in enumerate(self._bodies):
            if e.mass <= 0.0:
                continue
            c = e.S0 / e.mass
            J = e.J0 - e.mass * (c @ c * np.eye(3) - np.outer(c, c))
            if np.linalg.eigvalsh(J)[0] < NULL_INERTIA * e.mass * size**2:
                result[b] = FLOOR * e.mass * size**2
        return result

    def table(self) -> BodyTable:
        """The finished table."""
        bodies = self._bodies
        width = np.array([0 if e.kind == FIXED else 6 + e.elastic for e in bodies])
        count = np.array([0 if e.ritz is None else e.elastic for e in bodies])
        ritz = [e.ritz for e in bodies if e.ritz is not None]
        return BodyTable(
            kind=integers([e.kind for e in bodies]),
            floating=integers([e.floating for e in bodies]),
            offset=integers(np.concatenate([[0], np.cumsum(width)]).tolist()),
            block=integers(np.concatenate([[0], np.cumsum(width**2)]).tolist()),
            mass=numbers([e.mass for e in bodies]),
            S0=numbers([e.S0 for e in bodies], (-1, 3)),
            J0=numbers([e.J0 for e in bodies], (-1, 3, 3)),
            ritz=integers((np.cumsum(count) - count).tolist()),
            ritz_square=integers((np.cumsum(count**2) - count**2).tolist()),
            m=flat([r.m for r in ritz]),
            k=flat([r.k for r in ritz]),
            D=flat([r.D for r in ritz]),
            m_O=flat([r.m_O for r in ritz]),
            G=flat([r.G for r in ritz]),
            H=flat([r.H for r in ritz]),
            s=flat([r.s for r in ritz]),
            s2=flat([r.s2 for r in ritz]),
            attachment_body=integers(self._attachment_body),
            attachment_point=numbers(self._points, (-1, 3)),
            attachment_axes=numbers([np.eye(3)] * len(self._points), (-1, 3, 3)),
            attachment_turned=np.zeros(len(self._points), dtype=np.int64),
            psi_offset=integers(self._psi_offset),
            psi=flat(self._psi),
        )

    def start(self) -> MotionState:
        """All bodies at rest in their initial poses."""
        n = sum(0 if e.kind == FIXED else 6 + e.elastic for e in self._bodies)
        return MotionState(
            np.array([e.origin for e in self._bodies]),
            np.array([e.rotation for e in self._bodies]),
            np.zeros(n),
            np.zeros(n),
            np.zeros(n),
        )

    def _add(
        self,
        kind: int,
        floating: bool,
        elastic: int,
        mass: float,
        S0: Array,
        J0: Array,
        ritz: RitzTerms | None,
        pose: tuple[Array, Array],
    ) -> int:
        self._bodies.append(_Body(kind, floating, elastic, mass, S0, J0, ritz, *pose))
        return len(self._bodies) - 1


def pose_of(body: RigidBody | RitzBody) -> tuple[Array, Array]:
    """Origin and rotation of a body's frame at t = 0."""
    motion = body.motion if isinstance(body.motion, GivenMotion) else None
    return initial_pose(body.pose, motion)


def initial_pose(pose: Pose, motion: GivenMotion | None) -> tuple[Array, Array]:
    """The pose given, or where a given motion starts."""
    origin, rotation = np.array(pose.origin), np.array(pose.rotation)
    if motion is not None:
        if motion.origin is not None:
            origin = np.array([value_at(f, [0.0])[0] for f in motion.origin])
        if motion.angle is not None and motion.axis is not None:
            axis = np.array(motion.axis) / np.linalg.norm(motion.axis)
            rotation = rotation @ rotation_matrix(axis * value_at(motion.angle, [0.0])[0])
    return origin, rotation


def _integrate(body: RitzBody, integrals: RitzIntegrals, path: str) -> RitzTerms:
    from maggi.elements.ritz import ritz_terms  # the only kind of body that asks for it

    try:
        return ritz_terms(body.shapes, integrals)
    except ModelError as error:
        raise ModelError(error.message, path=f"{path}.{error.path}".rstrip("."), remedy=error.remedy) from None

"""Bodies as mass points: what a body's mass is, without any matrix (rigid bodies, Ritz bodies)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from maggi.elements.quadrature import gauss_legendre
from maggi.model.bodies import GivenMotion, RigidBody, RitzBody, RitzTerms
from maggi.model.errors import ModelError
from maggi.model.expression import value_at
from maggi.model.geometry import Pose
from maggi.model.shapes import BoxQuadrature, LineQuadrature, RitzIntegrals

from .elasticity import Elasticity, GivenMatrices, Rigid
from .taylor import SKEW

Array = NDArray[np.float64]

ROUND_OFF = 1e-13  # of the largest second moment: less is none


@dataclass(frozen=True, eq=False)
class Marker:
    """A point and axes fixed in a body's material.

    body : its name. point (3,): body frame, m. translation, rotation (3, n): displacement and rotation vector of the
    material there for unit elastic coordinates, body axes. axes (3, 3): as columns, body axes.
    """

    body: str
    point: Array
    translation: Array
    rotation: Array
    axes: Array = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True, eq=False)
class PointBody:
    """A body as p mass points, displaced by n shape functions.

    masses (p,) kg; a few may be negative, see `equivalent_points`. points (p, 3): undeformed, body frame, m; shapes
    (p, 3, n). origin (3,), rotation (3, 3): initial pose, global. attachments : by name. motion: of a prescribed frame.
    """

    name: str
    masses: Array
    points: Array
    shapes: Array
    origin: Array
    rotation: Array
    elasticity: Elasticity = field(default_factory=Rigid)
    attachments: Mapping[str, Marker] = field(default_factory=lambda: MappingProxyType({}))
    motion: GivenMotion | None = None

    @property
    def elastic(self) -> int:
        """Number n of elastic coordinates."""
        return int(self.shapes.shape[2])

    def fixed(self, point: Array, axes: Array | None = None) -> Marker:
        """A marker at a global point with global axes (3, 3), both in the initial pose, that no deformation moves."""
        still = np.zeros((3, self.elastic))
        turned = self.rotation.T @ (np.eye(3) if axes is None else axes)
        return Marker(self.name, self.rotation.T @ (point - self.origin), still, still, turned)


def equivalent_points(mass: float, center: Array, inertia: Array) -> tuple[Array, Array]:
    """Seven mass points (masses (7,), positions (7, 3)) with a given mass, centre and inertia tensor about it, exactly.

    They stand in pairs on the principal axes of the second moments ``Σ = ½ tr(J) 1 − J``. A moment larger than the sum
    of the other two, as where only the one about the axis of a plane mechanism is given, needs a pair of negative
    masses: no body has it, but the sums over the points are still its kinetic quantities.
    """
    second, axes = np.linalg.eigh(0.5 * np.trace(inertia) * np.eye(3) - inertia)
    largest = float(np.abs(second).max(initial=0.0))
    second[np.abs(second) < ROUND_OFF * largest] = 0.0
    share = (mass if mass > 0.0 else largest) / 6.0
    if share == 0.0:
        return np.full(1, mass), center[None].copy()
    arms = np.sqrt(np.abs(second) / (2.0 * share)) * axes
    pair = share * np.sign(second)
    masses = np.concatenate([[mass - 2.0 * pair.sum()], pair, pair])
    return masses, np.concatenate([center[None], center + arms.T, center - arms.T])


def with_inertia(body: PointBody, moment: float) -> PointBody:
    """The body with a further moment of inertia (kg m²), the same about every axis of its frame, and no further mass."""
    masses, points = equivalent_points(0.0, np.zeros(3), moment * np.eye(3))
    return replace(
        body,
        masses=np.concatenate([body.masses, masses]),
        points=np.concatenate([body.points, points]),
        shapes=np.concatenate([body.shapes, np.zeros((len(masses), 3, body.elastic))]),
    )


def rigid_body(name: str, body: RigidBody) -> PointBody:
    """A rigid body by its description."""
    masses, points = equivalent_points(body.mass, np.array(body.center_of_mass), np.array(body.inertia))
    origin, rotation = initial_pose(body.pose, body.motion)
    still = np.zeros((3, 0))
    attachments = {
        key: Marker(name, np.array(attachment.at), still, still) for key, attachment in body.attachments.items()
    }
    return PointBody(
        name,
        masses,
        points,
        np.zeros((len(masses), 3, 0)),
        origin,
        rotation,
        attachments=attachments,
        motion=body.motion,
    )


def ritz_body(name: str, body: RitzBody) -> PointBody:
    """A Ritz body by its shape functions at the points of the quadrature that its description asks for.

    Raises ModelError where its constants are given as matrices, which have no points.
    """
    if isinstance(body.terms, RitzTerms):
        raise ModelError(
            "the body's constants are given as matrices, so that there are no mass points to sum over",
            path=f"bodies.{name}",
            remedy="describe it by its shape functions and a quadrature (`RitzIntegrals`)",
        )
    integrals = body.terms
    points, volumes = _quadrature(integrals)
    masses = integrals.density * volumes
    shapes = np.asarray(body.shapes(points), dtype=np.float64)
    count = shapes.shape[2]
    if integrals.J0 is not None:
        # what the points do not see of the inertia turns with the frame and does not deform
        seen = np.einsum("p,pi,pj->ij", masses, points, points)
        rest = np.array(integrals.J0) - (np.trace(seen) * np.eye(3) - seen)
        more, places = equivalent_points(0.0, np.zeros(3), rest)
        masses, points = np.concatenate([masses, more]), np.concatenate([points, places])
        shapes = np.concatenate([shapes, np.zeros((len(more), 3, count))])
    damping = np.zeros((count, count)) if integrals.damping is None else np.asarray(integrals.damping)
    attachments = {}
    for key, attachment in body.attachments.items():
        at = np.array(attachment.at)
        translation = np.asarray(body.shapes(at[None]))[0]
        turn = np.zeros((3, count)) if body.rotations is None else np.asarray(body.rotations(at[None]))[0]
        attachments[key] = Marker(name, at, translation, turn)
    origin, rotation = initial_pose(body.pose, body.motion)
    law = GivenMatrices(np.asarray(integrals.stiffness), damping)
    return PointBody(name, masses, points, shapes, origin, rotation, law, attachments, body.motion)


def initial_pose(pose: Pose, motion: object) -> tuple[Array, Array]:
    """Origin and rotation of a body's frame at t = 0."""
    origin, rotation = np.array(pose.origin), np.array(pose.rotation)
    if isinstance(motion, GivenMotion):
        if motion.origin is not None:
            origin = np.array([value_at(f, [0.0])[0] for f in motion.origin])
        if motion.angle is not None and motion.axis is not None:
            rotation = rotation @ _turn(np.array(motion.axis), value_at(motion.angle, [0.0])[0])
    return origin, rotation


def _turn(axis: Array, angle: float) -> Array:
    matrix = np.einsum("k,kij->ij", axis / np.linalg.norm(axis), SKEW)
    return np.asarray(np.eye(3) + np.sin(angle) * matrix + (1.0 - np.cos(angle)) * matrix @ matrix)


def _quadrature(integrals: RitzIntegrals) -> tuple[Array, Array]:
    """Points (p, 3) and the volume that each stands for (p,)."""
    match integrals.quadrature:
        case LineQuadrature(length, area, order):
            x, w = gauss_legendre(order)
            points = np.zeros((order, 3))
            points[:, 0] = 0.5 * length * (x + 1.0)
            return points, 0.5 * length * area * w
        case BoxQuadrature(low, high, order):
            x, w = gauss_legendre(order)
            sides = [0.5 * (b - a) * (x + 1.0) + a for a, b in zip(low, high, strict=True)]
            points = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 3)
            volumes = np.einsum("i,j,k->ijk", w, w, w).ravel() * np.prod(np.subtract(high, low)) / 8.0
            return points, volumes

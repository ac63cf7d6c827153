"""Descriptions of bodies: rigid, elastic from a mesh, elastic from shape functions (Ritz)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from .attachments import Attachment
from .functions import TimeFunction
from .geometry import Matrix, Pose, Vector, Velocity
from .materials import Material
from .meshes import MeshSource
from .shapes import RitzIntegrals

Array = NDArray[np.float64]
NO_ATTACHMENTS: Mapping[str, Attachment] = MappingProxyType({})


@dataclass(frozen=True)
class GivenMotion:
    """A prescribed frame: origin (3 functions of time, global, m), then a turn about a fixed axis by an angle (rad).

    The pose is ``origin(t)`` and ``rotation · exp(angle(t) axis~)`` with the body's initial `pose.rotation`;
    `axis` is in body axes. `held` names the attachments clamped to the frame.
    """

    origin: tuple[TimeFunction, TimeFunction, TimeFunction] | None = None
    axis: Vector | None = None
    angle: TimeFunction | None = None
    held: tuple[str, ...] = ()


@dataclass(frozen=True)
class RigidRunMotion:
    """A prescribed frame that moves as the same body does in a run of the mechanism with it rigid."""

    held: tuple[str, ...] = ()


FrameMotion = GivenMotion | RigidRunMotion


@dataclass(frozen=True)
class CraigBampton:
    """A reduction to the lowest `modes` with the attachments held, and the static shapes of the attachments' motions.

    With no modes it is static condensation. Craig, Bampton: Coupling of substructures for dynamic analyses, AIAA
    Journal 6 (1968) 1313–1319.
    """

    modes: int


@dataclass(frozen=True)
class RigidBody:
    """A rigid body: mass (kg), centre of mass (body frame, m), inertia tensor about it (body axes, kg m²).

    With `motion` given the body moves as prescribed and mass and inertia only count for reactions and energy.
    """

    mass: float
    center_of_mass: Vector = (0.0, 0.0, 0.0)
    inertia: Matrix = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    pose: Pose = field(default_factory=Pose)
    velocity: Velocity = field(default_factory=Velocity)
    attachments: Mapping[str, Attachment] = field(default_factory=lambda: NO_ATTACHMENTS)
    motion: GivenMotion | None = None


@dataclass(frozen=True)
class ElasticBody:
    """An elastic body from a mesh, on a floating frame (`motion` None) or a prescribed one.

    `reduction` None: the full mesh moves.
    """

    mesh: MeshSource
    material: Material | None
    pose: Pose = field(default_factory=Pose)
    velocity: Velocity = field(default_factory=Velocity)
    attachments: Mapping[str, Attachment] = field(default_factory=lambda: NO_ATTACHMENTS)
    motion: FrameMotion | None = None
    reduction: CraigBampton | None = None


@dataclass(frozen=True, eq=False)
class RitzTerms:
    """The constants of T3 and T5a for a body with n shape functions (SI units, body axes).

    mass (kg); S0 (3,) first moment; J0 (3, 3) inertia tensor about the frame's origin; m (n, n);
    k (n, n); D (n, n) damping; m_O (n, 3) = ∫ρNᵀ dV; G (3, n, n); H (3, 3, n, n); s (3, n);
    s2 (3, 3, n) = ∫ρNᵀẽ_kẽ_l r dV. Sources: Eq. T2, T3, T5a; paper (A1)–(A6).
    """

    mass: float
    S0: Array
    J0: Array
    m: Array
    k: Array
    D: Array
    m_O: Array
    G: Array
    H: Array
    s: Array
    s2: Array


@dataclass(frozen=True, eq=False)
class RitzBody:
    """The paper's general element as a body: any shape functions N(x), which carry their reference conditions.

    terms : the constants, given directly, or what `elements.ritz` needs to integrate them.
    shapes : N(x) as a function of points (p, 3) to (p, 3, n), used for the attachments' displacement.
    rotations : rotation of the material at points, (p, 3) to (p, 3, n); None means none (no section rotation).
    initial : coordinates (n) and their rates (n, 1/s) at t = 0; None means all zero.
    """

    terms: RitzTerms | RitzIntegrals
    shapes: Callable[[Array], Array]
    rotations: Callable[[Array], Array] | None = None
    initial: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    pose: Pose = field(default_factory=Pose)
    velocity: Velocity = field(default_factory=Velocity)
    attachments: Mapping[str, Attachment] = field(default_factory=lambda: NO_ATTACHMENTS)
    motion: GivenMotion | None = None


Body = RigidBody | ElasticBody | RitzBody

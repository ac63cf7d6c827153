"""Descriptions of joints between two bodies, and of drivers of their coordinates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .curves import Curve, Surface
from .functions import Formula, TimeFunction
from .geometry import Vector
from .joint_kinds import Quantity

Array = NDArray[np.float64]
GROUND = "ground"


@dataclass(frozen=True)
class End:
    """One end of a joint or a spring: a body, one of its attachments, or a fixed point of ground (global, m)."""

    body: str
    attachment: str | None = None
    point: Vector | None = None

    def __str__(self) -> str:
        if self.point is not None:
            return str(list(self.point))
        return self.body if self.attachment is None else f"{self.body}.{self.attachment}"


@dataclass(frozen=True)
class Joint:
    """A joint of a registered `kind` between two ends.

    at, axis : global, in the initial pose; fixed in both bodies from then on. `axes` is the pair (on first, on
        second): of a universal joint its pins, of a constant-velocity joint its shafts where they are not in line.
    pitch : of a screw, m per turn.
    """

    kind: str
    first: End
    second: End
    at: Vector | None = None
    axis: Vector | None = None
    axes: tuple[Vector, Vector] | None = None
    pitch: float | None = None


@dataclass(frozen=True)
class Driver:
    """Prescribes one coordinate of a joint: `quantity` is ``angle``, ``displacement`` or ``speed``."""

    joint: str
    quantity: str
    function: TimeFunction


@dataclass(frozen=True)
class JointCoordinate:
    """A coordinate of a joint: its ``angle`` or ``displacement``; None where the joint has only one of the two."""

    joint: str
    quantity: Quantity | None = None


@dataclass(frozen=True)
class Coupler:
    """A relation between joint coordinates: ``relation = 0``, or with `rates` between their speeds.

    kind : ``gear``, ``rack``, ``belt`` or ``coupler``: what the model file called it.
    coordinates : by the names that stand for them in `relation`.
    relation : a formula in ``t`` and those names (m, rad; with `rates` m/s, rad/s, and then linear in them). Coordinates
        begin at zero, where the relation must hold (not with `rates`).
    """

    kind: str
    coordinates: Mapping[str, JointCoordinate]
    relation: Formula
    rates: bool = False


@dataclass(frozen=True)
class Distance:
    """A massless rod between two points: their distance is `length` (m), a function of time; None: the initial one."""

    first: End
    second: End
    length: TimeFunction | None = None


@dataclass(frozen=True)
class PointOnCurve:
    """A point of the second body stays on a curve that the first carries.

    at : the point, global, in the initial pose (needed where `second` names no attachment). `curve` is in the frame of
    the first body (global for ground). The joint's coordinate is the curve's parameter, from its initial value on.
    """

    first: End
    second: End
    curve: Curve
    at: Vector | None = None


@dataclass(frozen=True)
class PointOnSurface:
    """A point of the second body stays on a surface that the first carries; `at` and frame as in `PointOnCurve`."""

    first: End
    second: End
    surface: Surface
    at: Vector | None = None


@dataclass(frozen=True)
class Cam:
    """A follower on a cam's profile, two-sided: it neither lifts off nor slips out of the cam's plane by itself.

    first carries the plane `profile` (in its body's frame, normal to `axis`); `axis` is global, in the initial pose.
    The follower is a roller of `radius` (m; 0: a knife edge) about the second's point `at`, or, where `face` (global
    normal in the initial pose, towards the cam or away from it) is given, a flat face through `at`.
    """

    first: End
    second: End
    profile: Curve
    axis: Vector
    radius: float = 0.0
    face: Vector | None = None
    at: Vector | None = None


@dataclass(frozen=True)
class Plane:
    """A plane by a point and its normal (global, in the initial pose)."""

    point: Vector = (0.0, 0.0, 0.0)
    normal: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class RollingDisc:
    """A thin disc of `radius` (m) that rolls without slip on a plane of the first body; two-sided.

    second carries the disc: its centre is `at` (default: the named attachment, or the body's origin), `axis` its axis
    of revolution (global, in the initial pose).
    """

    first: End
    second: End
    radius: float
    axis: Vector
    plane: Plane
    at: Vector | None = None


@dataclass(frozen=True)
class RollingSphere:
    """A sphere of `radius` (m) that rolls without slip on a plane of the first body, such as a turntable."""

    first: End
    second: End
    radius: float
    plane: Plane
    at: Vector | None = None


@dataclass(frozen=True)
class KnifeEdge:
    """A blade on the second body: its point `at` moves over the first only along `direction`, not sideways.

    direction, normal : global, in the initial pose; the permitted motion, and the normal of the surface that it slides
    on. Sideways is ``normal × direction``, fixed in the second body. The blade holds no height.
    """

    first: End
    second: End
    direction: Vector
    normal: Vector
    at: Vector | None = None


VELOCITIES = ("v.x", "v.y", "v.z", "w.x", "w.y", "w.z")
POSE = ("x", "y", "z", "r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33")


@dataclass(frozen=True)
class PfaffianRow:
    """One row Σ coefficient · velocity + constant = 0 (Eq. T7).

    coefficients : by (name of the end, velocity component); all components are global. Formulas in ``t`` and
    ``name.x name.y name.z name.r11 … name.r33``: position (m) and rotation (body to global) of the ends.
    """

    coefficients: Mapping[tuple[str, str], Formula]
    constant: Formula | None = None


@dataclass(frozen=True)
class Pfaffian:
    """Rows A(q, t) v + b(q, t) = 0 on the velocities of named points, not integrated: they hold no position."""

    ends: Mapping[str, End]
    rows: tuple[PfaffianRow, ...]


@dataclass(frozen=True, eq=False)
class PfaffianFunction:
    """Rows from a Python function (not in model files).

    function : ``function(t, position, rotation) -> (A, b)`` with position (k, 3) global and rotation (k, 3, 3) of the k
        `ends`; A (rows, k, 6) on their velocities and angular velocities (global), b (rows,). It must be smooth: its
        rate along the motion is taken by central differences.
    """

    ends: Mapping[str, End]
    rows: int
    function: Callable[[float, Array, Array], tuple[Array, Array]]


Contact = RollingDisc | RollingSphere | KnifeEdge
Liaison = (
    Joint
    | Driver
    | Coupler
    | Distance
    | PointOnCurve
    | PointOnSurface
    | Cam
    | RollingDisc
    | RollingSphere
    | KnifeEdge
    | Pfaffian
    | PfaffianFunction
)

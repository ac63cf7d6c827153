"""Vectors, poses and velocities of the descriptions: plain tuples, so that they are frozen and hashable."""

from __future__ import annotations

import math
from dataclasses import dataclass

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Pose:
    """Position of a frame's origin (global, m) and its rotation matrix (frame components to global)."""

    origin: Vector = (0.0, 0.0, 0.0)
    rotation: Matrix = IDENTITY


@dataclass(frozen=True)
class Velocity:
    """Given initial velocity of a body's frame origin, global components; None leaves that part free."""

    linear: Vector | None = None
    angular: Vector | None = None


def axis_rotation(axis: Vector, angle: float) -> Matrix:
    """The rotation matrix about a unit axis by an angle (rad), right-handed, by Rodrigues' formula."""
    x, y, z = axis
    s, c = math.sin(angle), math.cos(angle)
    v = 1.0 - c
    return (
        (c + v * x * x, v * x * y - s * z, v * x * z + s * y),
        (v * y * x + s * z, c + v * y * y, v * y * z - s * x),
        (v * z * x - s * y, v * z * y + s * x, c + v * z * z),
    )

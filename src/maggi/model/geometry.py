"""Vectors, poses and velocities of the descriptions: plain tuples, so that they are frozen and hashable."""

from __future__ import annotations

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

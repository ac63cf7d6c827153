"""Descriptions of curves and surfaces that points of other bodies are kept on."""

from __future__ import annotations

from dataclasses import dataclass

from .functions import Formula
from .geometry import Vector


@dataclass(frozen=True)
class SplineCurve:
    """The twice continuously differentiable cubic spline through `points` (m, in the frame of the body that carries it).

    Its parameter s is the length of the chords from the first point (m). An open spline has no curvature at its
    ends; a closed one is periodic, its last point being the one before the first again.
    """

    points: tuple[Vector, ...]
    closed: bool = False


@dataclass(frozen=True)
class ExpressionCurve:
    """A curve (x, y, z) as formulas in the parameter ``s`` (m, in the frame of the body that carries it).

    interval : where s runs. closed: the curve at its end continues at its start.
    """

    x: Formula
    y: Formula
    z: Formula
    interval: tuple[float, float]
    closed: bool = False


@dataclass(frozen=True)
class ExpressionSurface:
    """The points with F(x, y, z) = 0 (m, in the frame of the body that carries it); ∇F must not vanish there."""

    F: Formula


@dataclass(frozen=True)
class SplineSurface:
    """The height z over a grid in x and y (m, in the frame of the body that carries it), by bicubic splines.

    x (p,) and y (q,) increasing; z is p rows of q heights.
    """

    x: tuple[float, ...]
    y: tuple[float, ...]
    z: tuple[tuple[float, ...], ...]


Curve = SplineCurve | ExpressionCurve
Surface = ExpressionSurface | SplineSurface

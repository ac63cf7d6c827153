"""Curves and surfaces made from formulas: polar profiles of cams, surfaces by their height."""

from __future__ import annotations

import math

from .curves import ExpressionCurve, ExpressionSurface
from .expression import named_formula
from .functions import Formula
from .geometry import Vector
from .operations import Operation

AXIS_NEAR_X = 1e-3
"""Sine of the angle between a cam's axis and the body's x axis below which y takes the place of x."""


def polar_profile(radius: Formula, axis: Vector) -> ExpressionCurve:
    """The closed curve at distance `radius` (m), a formula in the angle ``s`` (rad), from the body's origin.

    axis : unit normal of its plane, in the body's axes, about which s counts right-handed. s = 0 is the direction of
        the body's x axis projected on the plane, or of y where x is the axis.
    """
    e1, e2 = polar_directions(axis)
    x, y, z = (
        _joined(Operation.MULTIPLY, radius, named_formula(_direction(a, b), ("s",), {}))
        for a, b in zip(e1, e2, strict=True)
    )
    return ExpressionCurve(x, y, z, (0.0, 2.0 * math.pi), closed=True)


def polar_directions(axis: Vector) -> tuple[Vector, Vector]:
    """The directions of s = 0 and s = π/2 of a polar profile, in the body's axes."""
    x, y, z = axis
    along = (1.0, 0.0, 0.0) if math.hypot(y, z) > AXIS_NEAR_X else (0.0, 1.0, 0.0)
    share = sum(a * n for a, n in zip(along, axis, strict=True))
    a, b, c = (a - share * n for a, n in zip(along, axis, strict=True))
    size = math.sqrt(a * a + b * b + c * c)
    a, b, c = a / size, b / size, c / size
    return (a, b, c), (y * c - z * b, z * a - x * c, x * b - y * a)


def _direction(a: float, b: float) -> str:
    """a cos s + b sin s, without terms that are zero but for round-off."""
    terms = [f"({factor!r})*{wave}" for factor, wave in ((a, "cos(s)"), (b, "sin(s)")) if abs(factor) > 1e-15]
    return " + ".join(terms) or "0"


def height_surface(height: Formula) -> ExpressionSurface:
    """The surface z = height, a formula in x and y (m)."""
    z = named_formula("z", ("x", "y", "z"), {})
    return ExpressionSurface(_joined(Operation.SUBTRACT, height, z))


def _joined(operation: Operation, first: Formula, second: Formula) -> Formula:
    """The operation on two formulas; the first one's variables are the second's, or the beginning of them."""
    assert second.variables[: len(first.variables)] == first.variables
    symbol = {Operation.MULTIPLY: "*", Operation.SUBTRACT: "-"}[operation]
    return Formula(
        f"({first.text}) {symbol} ({second.text})",
        second.variables,
        (*first.codes, *second.codes, int(operation)),
        (*first.values, *second.values, 0.0),
    )

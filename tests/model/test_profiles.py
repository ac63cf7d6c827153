"""Polar profiles against their definition, surfaces by their height."""

from __future__ import annotations

import math

import numpy as np
import pytest

from maggi.model import ExpressionCurve, Formula, formula
from maggi.model.operations import evaluate
from maggi.model.profiles import height_surface, polar_directions, polar_profile


def at(f: Formula, *values: float) -> float:
    return float(evaluate(f.codes, f.values, [np.array([value]) for value in values])[0])


def point(curve: ExpressionCurve, s: float) -> np.ndarray:
    return np.array([at(f, s) for f in (curve.x, curve.y, curve.z)])


@pytest.mark.parametrize(
    "axis", [(0, 0, 1), (0, 0, -1), (0, 1, 0), (1, 0, 0), (-1, 0, 0), (0.6, 0, 0.8), (0.6, 0.64, 0.48)]
)
def test_polar_profile(axis: tuple[float, float, float]) -> None:
    curve = polar_profile(formula("0.02 + 0.005*cos(s)", ("s",)), axis)
    n = np.array(axis)
    along = np.array([0.0, 1.0, 0.0]) if abs(axis[0]) == 1 else np.array([1.0, 0.0, 0.0])
    first = along - (along @ n) * n
    first /= np.linalg.norm(first)
    for s in (0.0, 0.4, 2.0, 5.0):
        radius = 0.02 + 0.005 * math.cos(s)
        wanted = radius * (math.cos(s) * first + math.sin(s) * np.cross(n, first))
        np.testing.assert_allclose(point(curve, s), wanted, atol=1e-17)
    assert curve.closed
    assert curve.interval == (0.0, 2 * math.pi)


def test_directions_are_right_handed_about_the_axis() -> None:
    for axis in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.6, 0.0, 0.8)):
        e1, e2 = polar_directions(axis)
        np.testing.assert_allclose(np.cross(e1, e2), axis, atol=1e-15)


def test_height_surface() -> None:
    surface = height_surface(formula("0.1*x - y**2", ("x", "y")))
    assert surface.F.variables == ("x", "y", "z")
    assert at(surface.F, 2.0, 0.5, 0.2 - 0.25) == pytest.approx(0.0, abs=1e-16)
    assert abs(at(surface.F, 2.0, 0.5, 1.0)) == pytest.approx(1.05)

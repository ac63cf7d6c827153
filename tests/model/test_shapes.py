"""Shape functions by expressions against the same written in numpy."""

from __future__ import annotations

import numpy as np

from maggi.model.expression import compile_program
from maggi.model.shapes import ExpressionShapes


def row(*texts: str) -> tuple:
    return tuple(compile_program(text, {"l": 0.3}, ("x", "y", "z")) for text in texts)


def test_shapes_against_numpy() -> None:
    shapes = ExpressionShapes((row("0", "x**2/l"), row("sin(pi*x/l)", "0"), row("max(y, z)", "atan2(y, 1 + z)")))
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (7, 3))
    x, y, z = points.T
    zero = np.zeros(7)
    wanted = [[zero, x**2 / 0.3], [np.sin(np.pi * x / 0.3), zero], [np.maximum(y, z), np.arctan2(y, 1 + z)]]
    assert shapes.count == 2
    np.testing.assert_allclose(shapes(points), np.moveaxis(np.array(wanted), 2, 0), rtol=1e-14)


def test_outside_a_domain_nothing_is_raised_and_nothing_finite_returned() -> None:
    shapes = ExpressionShapes((row("sqrt(x)"), row("1/y"), row("log(z)")))
    assert not np.isfinite(shapes(np.array([[-1.0, 0.0, -1.0]]))).any()

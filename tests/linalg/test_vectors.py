"""Cross products of small vectors."""

from __future__ import annotations

import numpy as np

from maggi.linalg.vectors import cross, cross_rows


def test_cross_is_numpys() -> None:
    a, b = np.random.default_rng(0).standard_normal((2, 50, 3))
    for x, y in zip(a, b, strict=True):
        assert np.array_equal(cross(x, y), np.cross(x, y))


def test_cross_of_rows_is_numpys() -> None:
    a, b = np.random.default_rng(1).standard_normal((2, 50, 3))
    assert np.array_equal(cross_rows(a, b), np.cross(a, b))
    assert cross_rows(a[:0], b[:0]).shape == (0, 3)

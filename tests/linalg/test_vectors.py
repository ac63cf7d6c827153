"""Cross products of small vectors."""

from __future__ import annotations

import numpy as np

from maggi.linalg.vectors import cross


def test_cross_is_numpys() -> None:
    a, b = np.random.default_rng(0).standard_normal((2, 50, 3))
    for x, y in zip(a, b, strict=True):
        assert np.array_equal(cross(x, y), np.cross(x, y))

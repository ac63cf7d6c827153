"""Least squares for systems whose unknowns and equations are of very different units."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RANK = (
    1e-12  # singular values below this part of the largest count as none, once equations and unknowns are of one size
)


def least_squares(matrix: Array, right: Array) -> Array:
    """The solution x (n,) of least norm, after equations and unknowns are scaled to like size. matrix (m, n).

    Two steps of refinement take away what round-off the scaling leaves.
    """
    rows, columns = np.ones(matrix.shape[0]), np.ones(matrix.shape[1])
    for _ in range(8):
        scaled = np.abs(rows[:, None] * matrix * columns)
        rows /= _root(scaled.max(axis=1, initial=0.0))
        columns /= _root(scaled.max(axis=0, initial=0.0))
    U, values, Vt = np.linalg.svd(rows[:, None] * matrix * columns, full_matrices=False)
    kept = values > RANK * values.max(initial=0.0)
    U, values, Vt = U[:, kept], values[kept], Vt[kept]
    x = np.zeros(matrix.shape[1])
    for _ in range(3):
        x += columns * (Vt.T @ ((U.T @ (rows * (right - matrix @ x))) / values))
    return x


def _root(size: Array) -> Array:
    return np.sqrt(np.where(size > 0.0, size, 1.0))

"""Compiled operations on small dense vectors and matrices."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from maggi.linalg.compiling import kernel

Array = NDArray[np.float64]

# Sums may be taken in any order, so that several entries are multiplied at once.
REORDERED = {"reassoc", "contract"}


@njit(cache=True, fastmath=REORDERED)
def multiply(matrix: Array, x: Array, out: Array) -> None:
    """out (n,) = matrix (n, n) x."""
    for i in range(x.shape[0]):
        value = 0.0
        for j in range(x.shape[0]):
            value += matrix[i, j] * x[j]
        out[i] = value


@njit(cache=True, fastmath=REORDERED)
def inner(x: Array, y: Array) -> float:
    """x · y."""
    value = 0.0
    for i in range(x.shape[0]):
        value += x[i] * y[i]
    return value


@njit(cache=True)
def add_multiple(factor: float, x: Array, out: Array) -> None:
    """out += factor · x."""
    for i in range(x.shape[0]):
        out[i] += factor * x[i]


@kernel
def invert(matrix: Array, out: Array) -> None:
    """The inverse of a small positive definite matrix, by L D Lᵀ; `matrix` is overwritten."""
    n = matrix.shape[0]
    for i in range(n):
        for j in range(i):
            value = matrix[i, j]
            for k in range(j):
                value -= matrix[i, k] * matrix[j, k] * matrix[k, k]
            matrix[i, j] = value / matrix[j, j]
        value = matrix[i, i]
        for k in range(i):
            value -= matrix[i, k] * matrix[i, k] * matrix[k, k]
        matrix[i, i] = value
    for column in range(n):
        for i in range(n):
            value = 1.0 if i == column else 0.0
            for k in range(column, i):
                value -= matrix[i, k] * out[k, column]
            out[i, column] = value
        for i in range(n - 1, -1, -1):
            value = out[i, column] / matrix[i, i]
            for k in range(i + 1, n):
                value -= matrix[k, i] * out[k, column]
            out[i, column] = value

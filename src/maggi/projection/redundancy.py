"""Liaison forces where rows repeat each other: the ones of least norm, and which of them are unique (Eq. T11)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import BodyTable
from maggi.liaisons.tables import ROW_ANGULAR, LiaisonTable

from .range_space import assemble_compliance, factorise, solve

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_SHARE = 1e-6  # of a row in what is not unique, from which on its force counts as such


def left_null_space(
    liaisons: LiaisonTable, bodies: BodyTable, A: Array, metric: Array, active: IntArray, size: float
) -> Array:
    """An orthonormal basis Z (r, k) of the weighted multipliers w λ that exert nothing, Aᵀ λ = 0.

    w is 1 for forces and 1/size for moments.

    A (flat): rows at one state. metric (flat blocks): of velocities, on which nothing depends but what is round-off.
    active (r,): rows that a singular position has made dependent. size (m): what makes forces of moments.
    """
    r = len(liaisons.row)
    first, start = liaisons.skyline_first, liaisons.skyline_start
    L, pivot, scale = np.zeros(int(start[-1])), np.zeros(r), np.zeros(r)
    assemble_compliance(liaisons, bodies, A, metric, L)
    matrix = L.copy()
    factorise(first, start, L, pivot, scale, active)
    dependent = np.flatnonzero(pivot == 0.0)
    if dependent.size == 0:
        return np.zeros((r, 0))
    # each dependent row less what the independent ones make of it: Λ_II x = Λ_Id
    columns = np.zeros((r, dependent.size))
    for k, d in enumerate(dependent):
        right = _column(matrix, first, start, int(d))
        right[pivot == 0.0] = 0.0
        solve(first, start, L, pivot, right)
        columns[:, k] = -right
        columns[d, k] = 1.0
    weight = np.where(liaisons.row[:, ROW_ANGULAR] == 1, 1.0 / size, 1.0)
    return np.asarray(np.linalg.qr(columns * weight[:, None])[0])


def least_norm(liaisons: LiaisonTable, Z: Array, multipliers: Array, size: float) -> tuple[Array, NDArray[np.bool_]]:
    """The multipliers (r,) of least norm that exert the same forces, and which rows' are unique (r,).

    Z : from `left_null_space`. The norm counts forces (N), and moments by size (m) as forces.
    """
    weight = np.where(liaisons.row[:, ROW_ANGULAR] == 1, 1.0 / size, 1.0)
    scaled = weight * multipliers
    return (scaled - Z @ (Z.T @ scaled)) / weight, np.asarray(np.linalg.norm(Z, axis=1) < _SHARE)


def _column(matrix: Array, first: IntArray, start: IntArray, d: int) -> Array:
    """Column d of a symmetric skyline matrix."""
    r = len(first)
    column = np.zeros(r)
    column[first[d] : d + 1] = matrix[start[d] : start[d + 1]]
    below = np.arange(d + 1, r)
    below = below[first[d + 1 :] <= d]
    column[below] = matrix[start[below] + d - first[below]]
    return column

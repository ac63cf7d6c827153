"""Liaison forces where rows repeat each other: the ones of least norm, and which of them are unique (Eq. T11)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import BodyTable
from maggi.liaisons.tables import ROW_ANGULAR, LiaisonTable
from maggi.linalg.compiling import inner_kernel, kernel

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
    L, pivot, scale, Z = np.zeros(int(liaisons.skyline_start[-1])), np.zeros(r), np.zeros(r), np.zeros((r, r))
    weight = _weights(liaisons, size)
    return Z[:, : _null_space(liaisons, bodies, A, metric, active, weight, L, pivot, scale, Z)]


@kernel
def _null_space(
    liaisons: LiaisonTable,
    bodies: BodyTable,
    A: Array,
    metric: Array,
    active: IntArray,
    weight: Array,
    L: Array,
    pivot: Array,
    scale: Array,
    Z: Array,
) -> int:
    """`left_null_space` into the first columns of Z (r, r); how many they are."""
    first, start = liaisons.skyline_first, liaisons.skyline_start
    r = pivot.shape[0]
    assemble_compliance(liaisons, bodies, A, metric, L)
    matrix = L.copy()
    factorise(first, start, L, pivot, scale, active)
    column = np.empty(r)
    count = 0
    for d in range(r):
        if pivot[d] != 0.0:
            continue
        # a dependent row less what the independent ones make of it: Λ_II x = Λ_Id
        for i in range(r):
            low, high = min(i, d), max(i, d)
            inside = pivot[i] != 0.0 and low >= first[high]
            column[i] = matrix[start[high] + low - first[high]] if inside else 0.0
        solve(first, start, L, pivot, column)
        for i in range(r):
            Z[i, count] = -column[i] * weight[i]
        Z[d, count] = weight[d]
        orthonormalise(Z, count)
        count += 1
    return count


@inner_kernel
def orthonormalise(Z: Array, last: int) -> None:
    """Make column `last` of Z (r, n) orthogonal to those before it, twice, since once leaves round-off, and of length one."""
    r = Z.shape[0]
    for _ in range(2):
        for k in range(last):
            product = 0.0
            for i in range(r):
                product += Z[i, k] * Z[i, last]
            for i in range(r):
                Z[i, last] -= product * Z[i, k]
    length = 0.0
    for i in range(r):
        length += Z[i, last] * Z[i, last]
    for i in range(r):
        Z[i, last] /= math.sqrt(length)


def least_norm(liaisons: LiaisonTable, Z: Array, multipliers: Array, size: float) -> tuple[Array, NDArray[np.bool_]]:
    """The multipliers (r,) of least norm that exert the same forces, and which rows' are unique (r,).

    Z : from `left_null_space`. The norm counts forces (N), and moments by size (m) as forces.
    """
    weight = _weights(liaisons, size)
    scaled = weight * multipliers
    return (scaled - Z @ (Z.T @ scaled)) / weight, np.asarray(np.linalg.norm(Z, axis=1) < _SHARE)


def _weights(liaisons: LiaisonTable, size: float) -> Array:
    """1 for rows of forces, 1/size for those of moments (r,)."""
    return np.where(liaisons.row[:, ROW_ANGULAR] == 1, 1.0 / size, 1.0)

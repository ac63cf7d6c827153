"""Liaison forces where rows repeat each other: the ones of least norm, and which of them are unique (Eq. T11)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import BodyTable
from maggi.liaisons.tables import ROW_ANGULAR, LiaisonTable
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.small import add_multiple, inner

from .range_space import assemble_compliance, factorise, solve

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_SHARE = 1e-6  # of a row in what is not unique, from which on its force counts as such


def least_norm(
    liaisons: LiaisonTable,
    bodies: BodyTable,
    A: Array,
    metric: Array,
    active: IntArray,
    multipliers: Array,
    size: float,
) -> tuple[Array, NDArray[np.bool_]]:
    """The multipliers (m, r) of least norm that exert what the given ones do at m states, and which are unique (m, r).

    The norm counts forces (N), and moments by size (m) as forces.

    A (m, flat): rows at each state. metric (flat blocks): of velocities, on which nothing depends but what is round-off.
    active (m, r): rows that a singular position has made dependent. multipliers (m, r).
    """
    r = len(liaisons.row)
    L, pivot, scale, Zt = np.zeros(int(liaisons.skyline_start[-1])), np.zeros(r), np.zeros(r), np.empty((r, r))
    weight = np.where(liaisons.row[:, ROW_ANGULAR] == 1, 1.0 / size, 1.0)
    found, share = np.array(multipliers, order="C"), np.empty(multipliers.shape)
    of_states = np.ascontiguousarray(A), np.ascontiguousarray(active), found, share
    _least_norm(liaisons, bodies, metric, weight, *of_states, L, pivot, scale, Zt)
    return found, np.asarray(share < _SHARE)


@kernel
def _least_norm(
    liaisons: LiaisonTable,
    bodies: BodyTable,
    metric: Array,
    weight: Array,
    A: Array,
    active: IntArray,
    multipliers: Array,
    share: Array,
    L: Array,
    pivot: Array,
    scale: Array,
    Zt: Array,
) -> None:
    """`least_norm` in place; share (m, r): of each row in what is not unique, the norm of its row of Z."""
    r = pivot.shape[0]
    for k in range(multipliers.shape[0]):
        forces, of_row = multipliers[k], share[k]
        count = null_space(liaisons, bodies, A[k], metric, active[k], weight, L, pivot, scale, Zt)
        for i in range(r):
            of_row[i] = 0.0
            forces[i] *= weight[i]
        for c in range(count):
            z = Zt[c]
            add_multiple(-inner(z, forces), z, forces)
            for i in range(r):
                of_row[i] += z[i] * z[i]
        for i in range(r):
            of_row[i] = math.sqrt(of_row[i])
            forces[i] /= weight[i]


@inner_kernel
def null_space(
    liaisons: LiaisonTable,
    bodies: BodyTable,
    A: Array,
    metric: Array,
    active: IntArray,
    weight: Array,
    L: Array,
    pivot: Array,
    scale: Array,
    Zt: Array,
) -> int:
    """An orthonormal basis of the weighted multipliers w λ that exert nothing, Aᵀ λ = 0, into the first rows of Zt (r, r); how many.

    w is 1 for forces and 1/size for moments.
    """
    first, start = liaisons.skyline_first, liaisons.skyline_start
    r = pivot.shape[0]
    assemble_compliance(liaisons, bodies, A, metric, L)
    matrix = L.copy()
    factorise(first, start, L, pivot, scale, active)
    count = 0
    for d in range(r):
        if pivot[d] != 0.0:
            continue
        # a dependent row less what the independent ones before it make of it: Λ_II x = Λ_Id
        row = Zt[count]
        for i in range(r):
            inside = i < d and pivot[i] != 0.0 and i >= first[d]
            row[i] = -matrix[start[d] + i - first[d]] if inside else 0.0
        solve(first, start, L, pivot, row[:d])
        row[d] = 1.0
        for i in range(r):
            row[i] *= weight[i]
        _orthonormalise(Zt, count)
        count += 1
    return count


@inner_kernel
def _orthonormalise(Zt: Array, last: int) -> None:
    """Make row `last` orthogonal to those before it, and of length one.

    Once more where that takes away more than half of it, and so leaves round-off (twice is enough: Parlett, Kahan).
    """
    row = Zt[last]
    length = math.sqrt(inner(row, row))
    for _ in range(2):
        before = length
        for k in range(last):
            add_multiple(-inner(Zt[k], row), Zt[k], row)
        length = math.sqrt(inner(row, row))
        if length > 0.5 * before:
            break
    for i in range(row.shape[0]):
        row[i] /= length

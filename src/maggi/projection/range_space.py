"""Maggi's projection in its range-space form, compiled: a skyline factor of Λ = A W Aᵀ that switches off dependent rows.

The null-space form ``Sᵀ W⁻¹ S`` (`projection.maggi`) and this one are duals: both give the increment that the
liaisons admit, in the metric W⁻¹; a test shows them equal. This form costs only the rows and keeps their sparsity.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.bodies.tables import FIXED, MESH, Array, BodyTable, IntArray
from maggi.liaisons.tables import LiaisonTable
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.small import REORDERED, inner, multiply

RANK_TOLERANCE = 1e-11
"""A row is dependent where its pivot falls below this part of its own size (see `docs/decisions.md`)."""

SINGULAR, REGULAR = 1e-7, 4e-7
"""sin² of a row's angle to the rows before it, in the geometric metric: below the first it becomes dependent, above the
second independent again. Near a singular position round-off ε is magnified by 1/sin at position level, 1/sin² in
velocities, 1/sin³ in accelerations."""

SUSPECT = 1e-5
"""Smallest pivot in the metric of the step from which on the geometric one is looked at."""


@kernel
def assemble_compliance(rows: LiaisonTable, bodies: BodyTable, A: Array, W: Array, out: Array) -> None:
    """Λ = Σ_b A_b W_b A_bᵀ into skyline storage: row i holds columns skyline_first[i] … i."""
    out[:] = 0.0
    for b in range(bodies.kind.shape[0]):
        start, end = rows.incidence_start[b], rows.incidence_start[b + 1]
        n = bodies.offset[b + 1] - bodies.offset[b]
        if start == end or (bodies.floating[b] == 0 and n <= 6):
            continue  # nothing of it moves but as prescribed: no compliance
        block = W[bodies.block[b] : bodies.block[b + 1]].reshape(n, n)
        product = np.empty(n)
        for x in range(start, end):
            i = rows.incidence[x, 0]
            o = rows.incidence[x, 1]
            multiply(block, A[o : o + n], product)
            for y in range(start, end):
                j = rows.incidence[y, 0]
                if j > i:
                    continue
                p = rows.incidence[y, 1]
                out[rows.skyline_start[i] + j - rows.skyline_first[i]] += inner(product, A[p : p + n])


@njit(cache=True, error_model="numpy", fastmath=REORDERED)
def _eliminate(i: int, first: IntArray, start: IntArray, L: Array, pivot: Array) -> float:
    """Row i of L D Lᵀ, in place; returns its pivot D. Dependent rows before it have pivot 0 and take no part."""
    o = start[i] - first[i]
    diagonal = L[o + i]
    for j in range(first[i], i):
        if pivot[j] == 0.0:
            continue
        p = start[j] - first[j]
        value = L[o + j]
        for k in range(max(first[i], first[j]), j):
            value -= L[o + k] * L[p + k]
        L[o + j] = value
    for j in range(first[i], i):
        value = L[o + j]
        L[o + j] = value * pivot[j]
        diagonal -= value * value * pivot[j]
    L[o + i] = 1.0
    return float(diagonal)


@kernel
def factorise(first: IntArray, start: IntArray, L: Array, pivot: Array, scale: Array, active: IntArray) -> float:
    """L D Lᵀ of a positive semidefinite skyline matrix, in place; returns the smallest pivot kept, relative to scale.

    pivot: 1/D, zero for rows that depend on earlier ones, and where active (≥ r,) is 0. scale (r,):
    the largest diagonal each row has had; a row at a singular position vanishes itself, so its present diagonal says
    nothing about dependence. Rows of the matrix beyond the first r, springs, are always kept and do not count.
    """
    smallest = 1.0
    for i in range(first.shape[0]):
        present = L[start[i] - first[i] + i]
        diagonal = _eliminate(i, first, start, L, pivot)
        if i >= scale.shape[0]:
            pivot[i] = 1.0 / diagonal
            continue
        scale[i] = max(scale[i], present)
        if active[i] == 1 and diagonal > RANK_TOLERANCE * scale[i]:
            pivot[i] = 1.0 / diagonal
            smallest = min(smallest, diagonal / scale[i])
        else:
            pivot[i] = 0.0
    return smallest


@inner_kernel
def factorise_kept(first: IntArray, start: IntArray, L: Array, pivot: Array, scale: Array, kept: IntArray) -> float:
    """`factorise` of the rows that are kept alone; 0 where one of them turns out to depend on others."""
    smallest = 1.0
    for i in range(first.shape[0]):
        if kept[i] == 0:
            pivot[i] = 0.0
            continue
        diagonal = _eliminate(i, first, start, L, pivot)
        pivot[i] = 1.0 / diagonal
        if i < scale.shape[0]:
            if not diagonal > RANK_TOLERANCE * scale[i]:
                return 0.0
            smallest = min(smallest, diagonal / scale[i])
    return smallest


@kernel
def find_singular(first: IntArray, start: IntArray, L: Array, pivot: Array, scale: Array, active: IntArray) -> float:
    """Which rows are dependent by their geometry alone, with hysteresis; returns sin² of the smallest angle kept.

    L: A Aᵀ in the geometric metric, overwritten. active (r,): 1 where a row is in use, renewed. Redundant rows become
    inactive too: they are dependent in any metric.
    """
    smallest = 1.0
    for i in range(active.shape[0]):
        scale[i] = max(scale[i], L[start[i] - first[i] + i])
        diagonal = _eliminate(i, first, start, L, pivot)
        if diagonal > (SINGULAR if active[i] == 1 else REGULAR) * scale[i]:
            pivot[i] = 1.0 / diagonal
            active[i] = 1
            smallest = min(smallest, diagonal / scale[i])
        else:
            pivot[i] = 0.0
            active[i] = 0
    return smallest


@kernel
def solve(first: IntArray, start: IntArray, L: Array, pivot: Array, x: Array) -> None:
    """Solve Λ x = b in place, with the leading part of Λ where x is shorter; dependent rows get zero."""
    r = x.shape[0]
    for i in range(r):
        if pivot[i] == 0.0:
            x[i] = 0.0
            continue
        o = start[i] - first[i]
        value = x[i]
        for j in range(first[i], i):
            value -= L[o + j] * x[j]
        x[i] = value
    for i in range(r):
        x[i] *= pivot[i]
    for i in range(r - 1, -1, -1):
        o = start[i] - first[i]
        if pivot[i] > 0.0:
            for j in range(first[i], i):
                x[j] -= L[o + j] * x[i]
        else:
            x[i] = 0.0


@kernel
def transpose_product(rows: LiaisonTable, bodies: BodyTable, A: Array, x: Array, out: Array) -> None:
    """out (n,) = Aᵀ x over all bodies' small coordinates."""
    out[:] = 0.0
    for b in range(bodies.kind.shape[0]):
        o = bodies.offset[b]
        n = bodies.offset[b + 1] - o
        if bodies.kind[b] == FIXED:
            continue
        for y in range(rows.incidence_start[b], rows.incidence_start[b + 1]):
            p = rows.incidence[y, 1]
            value = x[rows.incidence[y, 0]]
            if value != 0.0:
                for k in range(n):
                    out[o + k] += A[p + k] * value


@kernel
def product(rows: LiaisonTable, bodies: BodyTable, A: Array, v: Array, out: Array) -> None:
    """out (r,) = A v."""
    out[:] = 0.0
    for b in range(bodies.kind.shape[0]):
        o = bodies.offset[b]
        n = bodies.offset[b + 1] - o
        if bodies.kind[b] == FIXED:
            continue
        for y in range(rows.incidence_start[b], rows.incidence_start[b + 1]):
            p = rows.incidence[y, 1]
            value = 0.0
            for k in range(n):
                value += A[p + k] * v[o + k]
            out[rows.incidence[y, 0]] += value


@kernel
def block_product(bodies: BodyTable, W: Array, f: Array, out: Array, of_meshes: bool = False) -> None:
    """out (n,) = W f, block by block. of_meshes: only those of meshed bodies, since the others are zero."""
    if of_meshes:
        out[:] = 0.0
    for b in range(bodies.kind.shape[0]):
        if of_meshes and bodies.kind[b] != MESH:
            continue
        o = bodies.offset[b]
        n = bodies.offset[b + 1] - o
        block = W[bodies.block[b] : bodies.block[b + 1]].reshape(n, n)
        multiply(block, f[o : o + n], out[o : o + n])

"""Maggi's projection in its range-space form, compiled: a skyline factor of Λ = A W Aᵀ that switches off dependent rows.

The null-space form ``Sᵀ W⁻¹ S`` (`projection.maggi`) and this one are duals: both give the increment that the
liaisons admit, in the metric W⁻¹; a test shows them equal. This form costs only the rows and keeps their sparsity.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.bodies.tables import FIXED, Array, BodyTable, IntArray
from maggi.liaisons.tables import LiaisonTable

RANK_TOLERANCE = 1e-11
"""A row is dependent where its pivot falls below this part of its own size (see `docs/decisions.md`)."""


@njit(cache=True)
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
            for k in range(n):
                value = 0.0
                for l in range(n):
                    value += block[k, l] * A[o + l]
                product[k] = value
            for y in range(start, end):
                j = rows.incidence[y, 0]
                if j > i:
                    continue
                p = rows.incidence[y, 1]
                value = 0.0
                for k in range(n):
                    value += product[k] * A[p + k]
                out[rows.skyline_start[i] + j - rows.skyline_first[i]] += value


@njit(cache=True)
def factorise(first: IntArray, start: IntArray, L: Array, pivot: Array, scale: Array) -> int:
    """L D Lᵀ of a positive semidefinite skyline matrix, in place; returns the number of independent rows.

    pivot (r,): 1/D, zero for rows that depend on earlier ones. scale (r,): the largest diagonal each row has
    had; a row at a singular position vanishes itself, so its present diagonal says nothing about dependence.
    """
    rank = 0
    for i in range(first.shape[0]):
        o = start[i] - first[i]
        diagonal = L[o + i]
        if diagonal > scale[i]:
            scale[i] = diagonal
        for j in range(first[i], i):
            p = start[j] - first[j]
            value = L[o + j]
            for k in range(max(first[i], first[j]), j):
                value -= L[o + k] * L[p + k]
            L[o + j] = value
        for j in range(first[i], i):
            value = L[o + j]
            L[o + j] = value * pivot[j]
            diagonal -= value * value * pivot[j]
        if diagonal > RANK_TOLERANCE * scale[i]:
            pivot[i] = 1.0 / diagonal
            rank += 1
        else:
            pivot[i] = 0.0
        L[o + i] = 1.0
    return rank


@njit(cache=True)
def solve(first: IntArray, start: IntArray, L: Array, pivot: Array, x: Array) -> None:
    """Solve Λ x = b in place; dependent rows get zero."""
    r = first.shape[0]
    for i in range(r):
        o = start[i] - first[i]
        value = x[i]
        for j in range(first[i], i):
            value -= L[o + j] * x[j]
        x[i] = value if pivot[i] > 0.0 else 0.0
    for i in range(r):
        x[i] *= pivot[i]
    for i in range(r - 1, -1, -1):
        o = start[i] - first[i]
        if pivot[i] > 0.0:
            for j in range(first[i], i):
                x[j] -= L[o + j] * x[i]
        else:
            x[i] = 0.0


@njit(cache=True)
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


@njit(cache=True)
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


@njit(cache=True)
def block_product(bodies: BodyTable, W: Array, f: Array, out: Array) -> None:
    """out (n,) = W f, block by block."""
    for b in range(bodies.kind.shape[0]):
        o = bodies.offset[b]
        n = bodies.offset[b + 1] - o
        block = W[bodies.block[b] : bodies.block[b + 1]].reshape(n, n)
        for k in range(n):
            value = 0.0
            for l in range(n):
                value += block[k, l] * f[o + l]
            out[o + k] = value

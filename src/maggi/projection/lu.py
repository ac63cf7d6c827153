"""Dense linear algebra of the projected equations, compiled: LU factors that tell their smallest pivot, products, Cholesky.

For matrices of the size of a mechanism (some tens), where a call to LAPACK costs as much as the work, and where a pivot
near zero is an answer and not an error.
"""

from __future__ import annotations

import math

import numpy as np

from maggi.bodies.tables import Array, IntArray
from maggi.linalg.compiling import kernel

MASSLESS = 1e-12


@kernel
def factorise_lu(a: Array, order: IntArray) -> float:
    """LU factors of the square matrix a (n, n), in place, with partial pivoting; order (n,): row exchanges.

    Returns the smallest |pivot| (inf where n = 0). A pivot of zero is left as it is: the caller judges.
    """
    n = a.shape[0]
    smallest = math.inf
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[p, k]):
                p = i
        order[k] = p
        if p != k:
            for j in range(n):
                x = a[k, j]
                a[k, j] = a[p, j]
                a[p, j] = x
        pivot = a[k, k]
        if abs(pivot) < smallest or math.isnan(pivot):  # a NaN stays
            smallest = abs(pivot)
        if pivot == 0.0:
            continue
        for i in range(k + 1, n):
            if a[i, k] != 0.0:
                x = a[i, k] / pivot
                a[i, k] = x
                for j in range(k + 1, n):
                    a[i, j] -= x * a[k, j]
    return smallest


@kernel
def solve_lu(a: Array, order: IntArray, x: Array) -> None:
    """x ← A⁻¹ x, x (n, k), with the factors of `factorise_lu`."""
    n, count = x.shape
    for k in range(n):
        p = order[k]
        if p != k:
            for j in range(count):
                y = x[k, j]
                x[k, j] = x[p, j]
                x[p, j] = y
    for k in range(n):
        for i in range(k + 1, n):
            y = a[i, k]
            if y != 0.0:
                for j in range(count):
                    x[i, j] -= y * x[k, j]
    for k in range(n - 1, -1, -1):
        y = 1.0 / a[k, k]
        for j in range(count):
            x[k, j] *= y
        for i in range(k):
            y = a[i, k]
            if y != 0.0:
                for j in range(count):
                    x[i, j] -= y * x[k, j]


@kernel
def solve_lu_transposed(a: Array, order: IntArray, x: Array) -> None:
    """x ← A⁻ᵀ x, x (n,), with the factors of `factorise_lu`."""
    n = x.shape[0]
    for k in range(n):
        for i in range(k):
            x[k] -= a[i, k] * x[i]
        x[k] /= a[k, k]
    for k in range(n - 1, -1, -1):
        for i in range(k + 1, n):
            x[k] -= a[i, k] * x[i]
    for k in range(n - 1, -1, -1):
        p = order[k]
        if p != k:
            y = x[k]
            x[k] = x[p]
            x[p] = y


@kernel
def multiply(a: Array, b: Array, out: Array) -> None:
    """out (m, k) = a (m, n) b (n, k), zeros of a skipped: liaison rows touch two bodies of many."""
    m, n = a.shape
    for i in range(m):
        for j in range(out.shape[1]):
            out[i, j] = 0.0
        for l in range(n):
            x = a[i, l]
            if x != 0.0:
                for j in range(out.shape[1]):
                    out[i, j] += x * b[l, j]


@kernel
def multiply_transposed(a: Array, b: Array, out: Array) -> None:
    """out (n, k) = aᵀ b with a (m, n), b (m, k)."""
    m, n = a.shape
    for i in range(n):
        for j in range(out.shape[1]):
            out[i, j] = 0.0
    for l in range(m):
        for i in range(n):
            x = a[l, i]
            if x != 0.0:
                for j in range(out.shape[1]):
                    out[i, j] += x * b[l, j]


@kernel
def solve_inertia(M: Array, usual: Array, x: Array) -> tuple[int, float]:
    """x ← M⁻¹ x for a positive semidefinite M (n, n), destroyed, by Cholesky's factors with diagonal pivoting.

    usual (n,): the inertia that would be usual of every unknown. A pivot below `MASSLESS` of it is of a freedom without
    inertia, such as the rotation of a point mass: nothing tells its acceleration, which is set to zero. Returns how
    many there are, and the largest force on one, over the largest force: more than round-off if something drives it.
    """
    n = M.shape[0]
    order = np.arange(n)
    size = np.sqrt(usual)
    largest = 0.0
    for i in range(n):
        x[i] /= size[i]
        largest = max(largest, abs(x[i]))
        for j in range(n):
            M[i, j] /= size[i] * size[j]
    rank = n
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if M[i, i] > M[p, p]:
                p = i
        if not (M[p, p] > MASSLESS):
            rank = k
            break
        if p != k:
            for j in range(n):
                M[k, j], M[p, j] = M[p, j], M[k, j]
            for i in range(n):
                M[i, k], M[i, p] = M[i, p], M[i, k]
            order[k], order[p] = order[p], order[k]
            x[k], x[p] = x[p], x[k]
        pivot = math.sqrt(M[k, k])
        M[k, k] = pivot
        for i in range(k + 1, n):
            M[i, k] /= pivot
        for i in range(k + 1, n):
            for j in range(k + 1, i + 1):
                M[i, j] -= M[i, k] * M[j, k]
                M[j, i] = M[i, j]
        x[k] /= pivot
        for i in range(k + 1, n):
            x[i] -= M[i, k] * x[k]
    left = 0.0
    for k in range(rank, n):
        left = max(left, abs(x[k]))
        x[k] = 0.0
    for k in range(rank - 1, -1, -1):
        for i in range(k + 1, rank):
            x[k] -= M[i, k] * x[i]
        x[k] /= M[k, k]
    y = x.copy()
    for k in range(n):
        x[order[k]] = y[k] / size[order[k]]
    return n - rank, left / largest if largest > 0.0 else 0.0

"""Matrix products of the hot loop: y = K x and Y = μ a, in place, on all threads.

Both are bound by memory: a 3×3 block of K costs 76 bytes, an entry of μ 12 bytes. Rows are shared among threads by
stored entries, each row is summed in the order of its columns, so that results do not depend on the number of
threads. Nothing is allocated. Steps use `SymmetricBlocks`, which reads half of K.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numba
import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int32]

PARTS = 4  # of a triangle's rows; each costs a field to add up
SMALL = 1000  # nodes below which one part does


def stiffness_product(K: sp.bsr_matrix, x: Array, out: Array) -> Array:
    """``out = K x`` for 3×3 blocks; x and out are C-contiguous, (3n,) or (n, 3); returns `out`."""
    _check(K.shape[0], x, out)
    _block_product(K.indptr, K.indices, K.data, x.reshape(-1, 3), out.reshape(-1, 3), numba.get_num_threads())
    return out


def mass_product(mu: sp.csr_matrix, a: Array, out: Array) -> Array:
    """``out = (μ ⊗ I₃) a`` (T4) for a nodal field a; a and out are C-contiguous, (3n,) or (n, 3); returns `out`."""
    _check(3 * mu.shape[0], a, out)
    _scalar_product(mu.indptr, mu.indices, mu.data, a.reshape(-1, 3), out.reshape(-1, 3), numba.get_num_threads())
    return out


def elastic_and_inertia(K: sp.bsr_matrix, mu: sp.csr_matrix, x: Array, a: Array, out: Array) -> Array:
    """``out = K x + (μ ⊗ I₃) a`` in one pass over the node graph that K and μ share; returns `out`.

    Raises ValueError if the two do not stand on one graph.
    """
    _check(K.shape[0], x, out)
    _check(3 * mu.shape[0], a, out)
    if K.indices.size != mu.indices.size:
        raise ValueError("K and mu stand on different node graphs")
    _fused_product(
        K.indptr,
        K.indices,
        K.data,
        mu.data,
        x.reshape(-1, 3),
        a.reshape(-1, 3),
        out.reshape(-1, 3),
        numba.get_num_threads(),
    )
    return out


@dataclass(frozen=True, eq=False)
class SymmetricBlocks:
    """The upper triangle of a symmetric matrix of n rows of 3×3 blocks, for products that read every block once.

    indptr (n+1,), indices, blocks (nnz, 3, 3): rows of the triangle, the diagonal block first. starts (p+1,), ends
    (p,): part k has the rows from starts[k] to starts[k+1] and adds to none from ends[k] on. sums (p, n, 3): what the
    parts add up. The number of parts depends on n only, so that products do not depend on the number of threads.
    """

    indptr: IntArray
    indices: IntArray
    blocks: Array
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]
    sums: Array

    @staticmethod
    def of(matrix: sp.bsr_matrix) -> SymmetricBlocks:
        """The triangle of a matrix of 3×3 blocks whose diagonal blocks are all stored, its rows sorted."""
        n = matrix.shape[0] // 3
        parts = 1 if n < SMALL else PARTS
        indptr, indices, blocks = _upper_triangle(matrix.indptr, matrix.indices, matrix.data)
        if indptr[-1] < 0:
            raise ValueError("the matrix lacks diagonal blocks")
        starts = np.searchsorted(indptr, np.linspace(0, indptr[-1], parts + 1)).astype(np.int64)
        starts[0], starts[-1] = 0, n
        ends = np.array([indices[indptr[a] : indptr[b]].max(initial=a - 1) + 1 for a, b in pairwise(starts)])
        return SymmetricBlocks(indptr, indices, blocks, starts, ends.astype(np.int64), np.empty((parts, n, 3)))

    def add_product(self, x: Array, out: Array) -> None:
        """``out += K x``; x and out are C-contiguous, (3n,)."""
        _check(3 * (self.indptr.size - 1), x, out)
        _symmetric_product(
            self.indptr,
            self.indices,
            self.blocks,
            self.starts,
            self.ends,
            x.reshape(-1, 3),
            self.sums,
            out.reshape(-1, 3),
        )


def _check(size: int, x: Array, out: Array) -> None:
    # The kernels do not look at bounds.
    if x.size != size or out.size != size:
        raise ValueError(f"a product of {size} rows got {x.size} and {out.size} values")
    if not (x.flags.c_contiguous and out.flags.c_contiguous):
        raise ValueError("the arrays must be C-contiguous")


@numba.njit(cache=True)
def _row_range(indptr: IntArray, part: int, parts: int) -> tuple[int, int]:
    """Rows of one part, such that all parts have about the same number of stored entries."""
    total = np.int64(indptr[-1])
    low = 0 if part == 0 else int(np.searchsorted(indptr, total * part // parts))
    high = indptr.size - 1 if part == parts - 1 else int(np.searchsorted(indptr, total * (part + 1) // parts))
    return low, high


@numba.njit(cache=True, parallel=True)
def _block_product(indptr: IntArray, indices: IntArray, blocks: Array, x: Array, out: Array, parts: int) -> None:
    for part in numba.prange(parts):
        low, high = _row_range(indptr, part, parts)
        for n in range(low, high):
            y0, y1, y2 = 0.0, 0.0, 0.0
            for p in range(indptr[n], indptr[n + 1]):
                m = indices[p]
                x0, x1, x2 = x[m, 0], x[m, 1], x[m, 2]
                y0 += blocks[p, 0, 0] * x0 + blocks[p, 0, 1] * x1 + blocks[p, 0, 2] * x2
                y1 += blocks[p, 1, 0] * x0 + blocks[p, 1, 1] * x1 + blocks[p, 1, 2] * x2
                y2 += blocks[p, 2, 0] * x0 + blocks[p, 2, 1] * x1 + blocks[p, 2, 2] * x2
            out[n, 0], out[n, 1], out[n, 2] = y0, y1, y2


@numba.njit(cache=True, parallel=True)
def _scalar_product(indptr: IntArray, indices: IntArray, values: Array, a: Array, out: Array, parts: int) -> None:
    for part in numba.prange(parts):
        low, high = _row_range(indptr, part, parts)
        for n in range(low, high):
            y0, y1, y2 = 0.0, 0.0, 0.0
            for p in range(indptr[n], indptr[n + 1]):
                m, value = indices[p], values[p]
                y0 += value * a[m, 0]
                y1 += value * a[m, 1]
                y2 += value * a[m, 2]
            out[n, 0], out[n, 1], out[n, 2] = y0, y1, y2


@numba.njit(cache=True, parallel=True)
def _fused_product(
    indptr: IntArray, indices: IntArray, blocks: Array, values: Array, x: Array, a: Array, out: Array, parts: int
) -> None:
    for part in numba.prange(parts):
        low, high = _row_range(indptr, part, parts)
        for n in range(low, high):
            y0, y1, y2 = 0.0, 0.0, 0.0
            for p in range(indptr[n], indptr[n + 1]):
                m, value = indices[p], values[p]
                x0, x1, x2 = x[m, 0], x[m, 1], x[m, 2]
                y0 += blocks[p, 0, 0] * x0 + blocks[p, 0, 1] * x1 + blocks[p, 0, 2] * x2 + value * a[m, 0]
                y1 += blocks[p, 1, 0] * x0 + blocks[p, 1, 1] * x1 + blocks[p, 1, 2] * x2 + value * a[m, 1]
                y2 += blocks[p, 2, 0] * x0 + blocks[p, 2, 1] * x1 + blocks[p, 2, 2] * x2 + value * a[m, 2]
            out[n, 0], out[n, 1], out[n, 2] = y0, y1, y2


@numba.njit(cache=True)
def _upper_triangle(indptr: IntArray, indices: IntArray, blocks: Array) -> tuple[IntArray, IntArray, Array]:
    n = indptr.size - 1
    first = np.empty(n + 1, np.int32)
    first[0] = 0
    for i in range(n):
        low = indptr[i]
        while low < indptr[i + 1] and indices[low] < i:
            low += 1
        if low == indptr[i + 1] or indices[low] != i:
            first[n] = -1
            return first, np.empty(0, np.int32), np.empty((0, 3, 3))
        first[i + 1] = first[i] + indptr[i + 1] - low
    chosen = np.empty(first[n], np.int32)
    values = np.empty((first[n], 3, 3))
    for i in range(n):
        shift = indptr[i + 1] - first[i + 1]
        for p in range(first[i], first[i + 1]):
            chosen[p] = indices[p + shift]
            for j in range(3):
                for k in range(3):
                    values[p, j, k] = blocks[p + shift, j, k]
    return first, chosen, values


@numba.njit(cache=True, parallel=True, fastmath={"contract"})
def _symmetric_product(indptr, indices, blocks, starts, ends, x, sums, out):  # type: ignore[no-untyped-def]
    parts = starts.size - 1
    for part in numba.prange(parts):
        y = sums[part]
        for n in range(starts[part], ends[part]):
            y[n, 0] = y[n, 1] = y[n, 2] = 0.0
        for n in range(starts[part], starts[part + 1]):
            p = indptr[n]
            u0, u1, u2 = x[n, 0], x[n, 1], x[n, 2]
            y0 = y[n, 0] + blocks[p, 0, 0] * u0 + blocks[p, 0, 1] * u1 + blocks[p, 0, 2] * u2
            y1 = y[n, 1] + blocks[p, 1, 0] * u0 + blocks[p, 1, 1] * u1 + blocks[p, 1, 2] * u2
            y2 = y[n, 2] + blocks[p, 2, 0] * u0 + blocks[p, 2, 1] * u1 + blocks[p, 2, 2] * u2
            for q in range(p + 1, indptr[n + 1]):
                m = indices[q]
                b00, b01, b02 = blocks[q, 0, 0], blocks[q, 0, 1], blocks[q, 0, 2]
                b10, b11, b12 = blocks[q, 1, 0], blocks[q, 1, 1], blocks[q, 1, 2]
                b20, b21, b22 = blocks[q, 2, 0], blocks[q, 2, 1], blocks[q, 2, 2]
                x0, x1, x2 = x[m, 0], x[m, 1], x[m, 2]
                y0 += b00 * x0 + b01 * x1 + b02 * x2
                y1 += b10 * x0 + b11 * x1 + b12 * x2
                y2 += b20 * x0 + b21 * x1 + b22 * x2
                y[m, 0] += b00 * u0 + b10 * u1 + b20 * u2
                y[m, 1] += b01 * u0 + b11 * u1 + b21 * u2
                y[m, 2] += b02 * u0 + b12 * u1 + b22 * u2
            y[n, 0], y[n, 1], y[n, 2] = y0, y1, y2
    for n in numba.prange(out.shape[0]):
        for part in range(parts):
            if starts[part] <= n < ends[part]:
                for i in range(3):
                    out[n, i] += sums[part, n, i]

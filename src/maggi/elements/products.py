"""Matrix products of the hot loop: y = K x and Y = μ a, in place, on all threads.

Both are bound by memory: a 3×3 block of K costs 76 bytes, an entry of μ 12 bytes. Rows are shared among threads by
stored entries, each row is summed in the order of its columns, so that results do not depend on the number of
threads. Nothing is allocated.
"""

from __future__ import annotations

import numba
import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int32]


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

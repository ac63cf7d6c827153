"""k₁ M + k₂ K as the factorisation reads it: one triangle, entry by entry, nothing else held beside the two."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numba import njit
from numpy.typing import NDArray

from .factor import Factor, Pattern

Array = NDArray[np.float64]


class ShiftedFactors:
    """Factors of ``k₁ M + k₂ K`` for any k₁, k₂: K (n, n) in 3×3 blocks, whose diagonal blocks are all stored."""

    def __init__(self, K: sp.bsr_matrix) -> None:
        self._K = K
        self._pattern: Pattern | None = None

    def sum(self, k1: float, M: sp.csr_matrix, k2: float) -> Array:
        """The entries of k₁ M + k₂ K that `factorise` takes. M (n, n): its entries stand in blocks that K has; both sorted."""
        K = self._K
        indptr, indices, values = _upper_sum(K.indptr, K.indices, K.data, k2, M.indptr, M.indices, M.data, k1)
        if indptr[-1] < 0:
            raise ValueError("M has entries where K has none, or K no diagonal")
        if self._pattern is None:
            self._pattern = Pattern(indptr, indices)
        return np.asarray(values)

    def factorise(self, values: Array) -> Factor:
        """The factor of a sum; M need not be held meanwhile. See `linalg.factor.factorise`."""
        assert self._pattern is not None
        return self._pattern.factorise(values)


@njit(cache=True)
def _upper_sum(indptr, indices, blocks, k2, m_indptr, m_indices, m_data, k1):  # type: ignore[no-untyped-def]
    """CSR arrays of the upper triangle, the diagonal first; the last of indptr is −1 if M does not fit."""
    n = indptr.size - 1
    first = np.zeros(3 * n + 1, np.int32)
    for row in range(n):
        low = indptr[row]
        while low < indptr[row + 1] and indices[low] < row:
            low += 1
        if low == indptr[row + 1] or indices[low] != row:
            first[-1] = -1
            return first, np.empty(0, np.int32), np.empty(0)
        width = 3 * (indptr[row + 1] - low)
        for i in range(3):
            first[3 * row + i + 1] = first[3 * row + i] + width - i
    columns, values = np.empty(first[-1], np.int32), np.empty(first[-1])
    for row in range(n):
        low = indptr[row]
        while indices[low] < row:
            low += 1
        for i in range(3):
            at = first[3 * row + i]
            q = m_indptr[3 * row + i]
            last = m_indptr[3 * row + i + 1]
            while q < last and m_indices[q] < 3 * row + i:
                q += 1
            for p in range(low, indptr[row + 1]):
                for j in range(i if p == low else 0, 3):
                    column = 3 * indices[p] + j
                    value = k2 * blocks[p, i, j]
                    if q < last and m_indices[q] == column:
                        value += k1 * m_data[q]
                        q += 1
                    columns[at] = column
                    values[at] = value
                    at += 1
            if q < last:
                first[-1] = -1
                return first, columns, values
    return first, columns, values

"""k₁ M + k₂ K as the factorisation reads it: one triangle, entry by entry, let go before the factor is made."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from . import paged
from .allocators import give_back
from .compiling import kernel
from .factor import Factor, Pattern

Array = NDArray[np.float64]
IntArray = NDArray[np.int32]


class ShiftedFactors:
    """Factors of ``k₁ M + k₂ K`` for any k₁, k₂.

    indptr (n+1,), indices (nnz,), blocks (nnz, 3, 3): the upper triangle of K by rows of 3×3 blocks, the diagonal block
    first, the others sorted. set_aside: called when they have been read and the factor is yet to be made.
    """

    def __init__(
        self, indptr: IntArray, indices: IntArray, blocks: Array, set_aside: Callable[[], None] = lambda: None
    ) -> None:
        self._triangle = indptr, indices, blocks
        self._set_aside = set_aside
        self._pattern = Pattern()

    def factorise_held(self, held: NDArray[np.int64]) -> Factor:
        """The factor of K with some unknowns held, which are zero where their right sides are; raises as `factorise` does."""
        return self._factor(self._held(held))

    def factorise(self, k1: float, mass: Callable[[], sp.csr_matrix], k2: float) -> Factor:
        """A factor; raises as `linalg.factor.factorise` does.

        mass : makes M (3n, 3n), whose entries stand in blocks that K has, its rows sorted. It is not held while the factor
        is made, which is when most memory is needed.
        """
        return self._factor(self._sum(k1, mass(), k2))

    def _held(self, held: NDArray[np.int64]) -> sp.csc_array:
        n = 3 * (self._triangle[0].size - 1)
        triangle = self._sum(0.0, sp.csr_matrix((n, n)), 1.0)
        hold(triangle, held)
        return triangle

    def _factor(self, triangle: sp.csc_array) -> Factor:
        prepared = self._pattern.prepare(triangle)
        del triangle
        self._set_aside()
        factor = prepared.factorise()
        del prepared
        give_back()
        return factor

    def _sum(self, k1: float, M: sp.csr_matrix, k2: float) -> sp.csc_array:
        """The lower triangle by columns, which is the upper one by rows."""
        indptr, indices, blocks = self._triangle
        first = _upper_rows(indptr)
        columns, values = np.empty(first[-1], np.int32), paged.empty((first[-1],))
        fits = _upper_sum(indptr, indices, blocks, k2, M.indptr, M.indices, M.data, k1, first, columns, values)
        if not fits:
            raise ValueError("M has entries where K has none")
        triangle = sp.csc_array((values, columns, first), shape=M.shape)
        triangle.has_canonical_format = True
        return triangle


def hold(triangle: sp.csc_array, unknowns: NDArray[np.int64]) -> None:
    """Cut some unknowns off from all others, in place; their diagonal entries stay.

    triangle (n, n): the lower one by columns, the diagonal entry the first of each.
    """
    diagonals = triangle.indptr[unknowns]
    kept = triangle.data[diagonals]
    for unknown, first in zip(unknowns, diagonals, strict=True):
        triangle.data[first : triangle.indptr[unknown + 1]] = 0.0
        triangle.data[triangle.indices == unknown] = 0.0
    triangle.data[diagonals] = kept


@kernel
def _upper_rows(indptr: IntArray) -> IntArray:
    """Where the rows of the upper triangle start, entry by entry, (3n+1,)."""
    n = indptr.size - 1
    first = np.zeros(3 * n + 1, np.int32)
    for row in range(n):
        width = 3 * (indptr[row + 1] - indptr[row])
        for i in range(3):
            first[3 * row + i + 1] = first[3 * row + i] + width - i
    return first


@kernel
def _upper_sum(  # type: ignore[no-untyped-def]
    indptr, indices, blocks, k2, m_indptr, m_indices, m_data, k1, first, columns, values
):
    """Columns and values of the upper triangle, the diagonal first; returns whether M fits."""
    n = indptr.size - 1
    for row in range(n):
        low = indptr[row]
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
                return False
    return True

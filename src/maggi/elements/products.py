"""Products with K in place, ``y += K x``, and squares xᵀK x, on all threads, half of K read.

A 3×3 block costs 76 bytes and 18 multiplications: large meshes are bound by memory, small ones by arithmetic. Rows are
shared among a fixed number of parts by stored entries, so that results do not depend on the number of threads. Nothing is
allocated.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.linalg.compiling import kernel
from maggi.linalg.lanes import WIDTH, four, put_four, three_fours
from maggi.linalg.paged import empty, release
from maggi.linalg.shared import SharedPass, inner_pass
from maggi.linalg.table import Table

Array = NDArray[np.float64]
IntArray = NDArray[np.int32]

PARTS = 4  # of a triangle's rows; each costs a field to add up
SMALL = 1000  # nodes below which one part does
ALONE = 20_000  # nodes up to which adding up the parts' fields is not worth waking anyone


@dataclass(frozen=True, eq=False)
class SymmetricBlocks(Table):
    """The upper triangle of a symmetric matrix of n rows of 3×3 blocks, for products that read every block once.

    indptr (n+1,), indices, blocks (nnz, 3, 3): rows of the triangle, the diagonal block first. starts (p+1,), ends
    (p,): part k has the rows from starts[k] to starts[k+1] and adds to none from ends[k] on. sums (p, n, 3): what the parts
    add up. The number of parts depends on n only, so that products do not depend on the number of threads.
    """

    indptr: IntArray
    indices: IntArray
    blocks: Array
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]
    sums: Array

    @property
    def order(self) -> int:
        """The number 3n of rows."""
        return 3 * (self.indptr.size - 1)

    @staticmethod
    def of(matrix: sp.bsr_matrix) -> SymmetricBlocks:
        """The triangle of a matrix of 3×3 blocks whose diagonal blocks are all stored, its rows sorted."""
        n = matrix.shape[0] // 3
        parts = 1 if n < SMALL else PARTS
        indptr = _upper_rows(matrix.indptr, matrix.indices)
        if indptr[-1] < 0:
            raise ValueError("the matrix lacks diagonal blocks")
        indices, blocks = empty((indptr[-1],), np.int32), empty((indptr[-1], 3, 3))
        _copy_upper(matrix.indptr, matrix.indices, matrix.data, indptr, indices, blocks)
        starts = np.searchsorted(indptr, np.linspace(0, indptr[-1], parts + 1)).astype(np.int64)
        starts[0], starts[-1] = 0, n
        ends = np.array([indices[indptr[a] : indptr[b]].max(initial=a - 1) + 1 for a, b in pairwise(starts)])
        return SymmetricBlocks(indptr, indices, blocks, starts, ends.astype(np.int64), np.empty((parts, n, 3)))

    def product(self, x: Array, out: Array) -> Product:
        """``out += K x`` of these arrays, (3n,) and C-contiguous.

        Raises ValueError for arrays of other sizes.
        """
        if x.size != self.order or out.size != self.order:
            raise ValueError(f"a product of {self.order} rows got {x.size} and {out.size} values")
        return Product(self, x, out)

    def squares(self, fields: Array) -> Squares:
        """xᵀK x of the four columns of this array, (n, 3, 4) and C-contiguous.

        Raises ValueError for an array of another shape.
        """
        shape = self.order // 3, 3, WIDTH
        if fields.shape != shape:
            raise ValueError(f"squares of fields {shape} got an array of shape {fields.shape}")
        return Squares(self, fields, np.empty((self.starts.size - 1, WIDTH)))

    def add_product(self, x: Array, out: Array) -> None:
        """``out += K x``, once."""
        self.product(x, out).add()

    def set_aside(self) -> None:
        """Lets the system take back the memory of the matrix until it is next read."""
        release(self.indices, self.blocks)

    def diagonal(self) -> Array:
        """The diagonal (3n,)."""
        return np.ascontiguousarray(np.einsum("nii->ni", self.blocks[self.indptr[:-1]])).ravel()

    def matrix(self) -> sp.bsr_matrix:
        """Both triangles, (3n, 3n): made anew with every call, and twice as large."""
        upper = sp.bsr_matrix((self.blocks, self.indices, self.indptr), shape=(self.order, self.order))
        strict = upper.copy()
        strict.data[self.indptr[:-1]] = 0.0
        return upper + strict.T


@dataclass(frozen=True, eq=False)
class Product(Table):
    """A product ``out += K x`` of certain arrays (3n,), to be done again and again."""

    K: SymmetricBlocks
    x: Array
    out: Array

    def add(self) -> None:
        """``out += K x``."""
        parts = self.K.sums.shape[0]
        _multiply(self, parts)
        _add_up(self, parts if self.K.sums.shape[1] > ALONE else 1)


@dataclass(frozen=True, eq=False)
class Squares(Table):
    """Squares xᵀK x of four fields at once, which costs little more than one; fields (n, 3, 4), sums (p, 4) by part."""

    K: SymmetricBlocks
    fields: Array
    sums: Array

    def find(self) -> Array:
        """The squares of the fields as they are now (4,)."""
        _square(self, self.sums.shape[0])
        return np.asarray(self.sums.sum(axis=0))


@kernel
def _upper_rows(indptr: IntArray, indices: IntArray) -> IntArray:
    """Where the triangle's rows start, (n+1,), the last −1 if a diagonal block is missing."""
    n = indptr.size - 1
    first = np.zeros(n + 1, np.int32)
    for i in range(n):
        low = indptr[i]
        while low < indptr[i + 1] and indices[low] < i:
            low += 1
        if low == indptr[i + 1] or indices[low] != i:
            first[n] = -1
            return first
        first[i + 1] = first[i] + indptr[i + 1] - low
    return first


@kernel
def _copy_upper(indptr, indices, blocks, first, chosen, values):  # type: ignore[no-untyped-def]
    for i in range(first.size - 1):
        shift = indptr[i + 1] - first[i + 1]
        for p in range(first[i], first[i + 1]):
            chosen[p] = indices[p + shift]
            for j in range(3):
                for k in range(3):
                    values[p, j, k] = blocks[p + shift, j, k]


@inner_pass
def _times(b, x0, x1, x2):  # type: ignore[no-untyped-def]
    """A block's product (3,) with x."""
    return (
        b[0, 0] * x0 + b[0, 1] * x1 + b[0, 2] * x2,
        b[1, 0] * x0 + b[1, 1] * x1 + b[1, 2] * x2,
        b[2, 0] * x0 + b[2, 1] * x1 + b[2, 2] * x2,
    )


@inner_pass
def _add_transposed(b, x0, x1, x2, y):  # type: ignore[no-untyped-def]
    """``y += bᵀ x`` of a block."""
    y[0] += b[0, 0] * x0 + b[1, 0] * x1 + b[2, 0] * x2
    y[1] += b[0, 1] * x0 + b[1, 1] * x1 + b[2, 1] * x2
    y[2] += b[0, 2] * x0 + b[1, 2] * x1 + b[2, 2] * x2


@SharedPass
def _multiply(of: Product, part: int, parts: int) -> None:
    """What the rows of a part add to K x, into its `sums`."""
    K = of.K
    indptr, indices, blocks = K.indptr, K.indices, K.blocks
    x = of.x.reshape(-1, 3)
    first, last = K.starts[part], K.starts[part + 1]
    y = K.sums[part]
    y[first : K.ends[part]] = 0.0
    for n in range(first, last):
        p = indptr[n]
        u0, u1, u2 = x[n, 0], x[n, 1], x[n, 2]
        y0, y1, y2 = _times(blocks[p], u0, u1, u2)
        for q in range(np.uint32(p + 1), np.uint32(indptr[n + 1])):
            m = np.uint32(indices[q])  # unsigned: no look for places from the end
            z0, z1, z2 = _times(blocks[q], x[m, 0], x[m, 1], x[m, 2])
            y0 += z0
            y1 += z1
            y2 += z2
            _add_transposed(blocks[q], u0, u1, u2, y[m])
        y[n, 0] += y0
        y[n, 1] += y1
        y[n, 2] += y2


@SharedPass
def _add_up(of: Product, part: int, parts: int) -> None:
    """``out += `` the sums of all parts, for a part of the nodes."""
    K, out = of.K, of.out.reshape(-1, 3)
    first, last = out.shape[0] * part // parts, out.shape[0] * (part + 1) // parts
    for k in range(K.sums.shape[0]):
        low, high = max(first, K.starts[k]), min(last, K.ends[k])
        if low < high:
            _add_field(K.sums[k, low:high], out[low:high])


@inner_pass
def _add_field(x, out):  # type: ignore[no-untyped-def]
    for n in range(out.shape[0]):
        for i in range(3):
            out[n, i] += x[n, i]


@SharedPass
def _square(of: Squares, part: int, parts: int) -> None:
    """What the rows of a part add to xᵀK x: of the diagonal block once, of the others twice."""
    K, fields = of.K, of.fields
    indptr, indices, blocks = K.indptr, K.indices, K.blocks
    total = four(0.0)
    for n in range(K.starts[part], K.starts[part + 1]):
        p = indptr[n]
        y0 = y1 = y2 = four(0.0)
        for q in range(np.uint32(p + 1), np.uint32(indptr[n + 1])):
            y0, y1, y2 = _add_four(blocks[q], fields, np.uint32(indices[q]), y0, y1, y2)
        twice = four(2.0)
        y0, y1, y2 = _add_four(blocks[p], fields, np.uint32(n), twice * y0, twice * y1, twice * y2)
        x0, x1, x2 = three_fours(fields, np.uint32(n))
        total = x0 * y0 + (x1 * y1 + (x2 * y2 + total))
    put_four(of.sums[part], 0, total)


@inner_pass
def _add_four(b, fields, n, y0, y1, y2):  # type: ignore[no-untyped-def]
    """y and a block's product with the fields at a node."""
    x0, x1, x2 = three_fours(fields, n)
    return (
        b[0, 2] * x2 + (b[0, 1] * x1 + (b[0, 0] * x0 + y0)),
        b[1, 2] * x2 + (b[1, 1] * x1 + (b[1, 0] * x0 + y1)),
        b[2, 2] * x2 + (b[2, 1] * x1 + (b[2, 0] * x0 + y2)),
    )

"""Factorisation of sparse symmetric matrices, once for many right-hand sides, behind one small protocol.

Two backends: rslab's supernodal L D Lᵀ, which factorises a solid's matrix about ten times faster and solves about three
times faster (`docs/decisions.md`), and scipy's SuperLU, which is always there. Definite matrices and their shifts
(K - s M) are for either. Saddle points, with zeros on the diagonal, need pivots that rslab may not find inside a front;
there SuperLU exchanges rows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import splu

from .allocators import give_back  # before rslab is loaded
from .paged import read_at_first

try:
    import rslab
except ImportError:  # no wheel for this platform
    rslab = None  # type: ignore[assignment]

Array = NDArray[np.float64]
Backend = Literal["auto", "rslab", "superlu"]

# From this order on nested dissection, whose tree lets two cores share a solve. Orderings with less fill for slender
# bodies have a tree that is a chain, along which one core works.
DISSECTION_ORDER = 8_000
LEAF = 50  # unknowns that the dissection leaves together
# Right sides that are solved at once: with more, the memory that a solve takes grows faster than its time falls.
WIDTH = 24
# Right sides after which little memory stays taken: for each of those solved at once a factor keeps some six fields.
FEW = 3
# A known solution is found again to about 1e-16 times the condition number; with less than three digits left, the
# factor is of no use.
PROBE_TOLERANCE = 1e-3


class SingularMatrixError(np.linalg.LinAlgError):
    """The matrix cannot be factorised: it is singular to working precision, or not symmetric."""


class Factor(Protocol):
    """A factorised symmetric matrix of order n. Non-finite right-hand sides give non-finite solutions."""

    @property
    def order(self) -> int:
        """The number n of unknowns."""

    @property
    def nbytes(self) -> int:
        """Memory that the factor holds."""

    def solve(self, b: Array) -> Array:
        """The solution x (n,) of A x = b, for b (n,); b is left as it is."""

    def solve_many(self, B: Array) -> Array:
        """The solutions X (n, k) of A X = B, for B (n, k); cheaper than k single solves."""


class RslabFactor:
    """P A Pᵀ = L D Lᵀ by rslab, on as many cores as pay."""

    def __init__(self, order: int, factorise: Callable[[], Any]) -> None:
        """What a function of rslab's returns."""
        self.order = order
        try:
            self._handle = factorise()
        except RuntimeError as error:  # a pivot that is zero to working precision
            raise SingularMatrixError(_message(order)) from error
        self.nbytes = int(self._handle.heap_bytes)

    def solve(self, b: Array) -> Array:
        """See `Factor.solve`."""
        return np.asarray(self._handle.solve(b), dtype=np.float64)

    def solve_many(self, B: Array) -> Array:
        """See `Factor.solve_many`."""
        n, k = B.shape
        if k <= WIDTH:
            return np.asarray(self._handle.solve_many(np.asfortranarray(B)), dtype=np.float64)
        X = np.empty((n, k))
        for first in range(0, k, WIDTH):
            X[:, first : first + WIDTH] = self._handle.solve_many(np.asfortranarray(B[:, first : first + WIDTH]))
        return X


class SuperLUFactor:
    """L U = P (D A D) Pᵀ by SuperLU, with D = |diag A|^(-1/2), so that pivots from the diagonal are good ones.

    pivoting : exchange rows where the diagonal is small. A definite matrix does not need it, and has several times
    less fill without.
    """

    def __init__(self, matrix: csc_array, *, pivoting: bool = False) -> None:
        self.order = matrix.shape[0]
        self._scale = _scale(matrix.diagonal())
        scaling = diags_array(self._scale)
        scaled = csc_array(scaling @ matrix @ scaling)
        try:
            if pivoting:
                self._handle = splu(scaled)
            else:
                self._handle = splu(
                    scaled, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
                )
        except RuntimeError as error:  # "Factor is exactly singular"
            raise SingularMatrixError(_message(self.order)) from error
        self.nbytes = 12 * int(self._handle.nnz)

    def solve(self, b: Array) -> Array:
        """See `Factor.solve`."""
        return np.asarray(self._scale * self._handle.solve(self._scale * b), dtype=np.float64)

    def solve_many(self, B: Array) -> Array:
        """See `Factor.solve_many`."""
        scale = self._scale[:, None]
        return np.asarray(scale * self._handle.solve(np.asfortranarray(scale * B)), dtype=np.float64)


def factorise(matrix: Any, backend: Backend = "auto") -> Factor:
    """Factorises a symmetric sparse matrix.

    Parameters
    ----------
    matrix : scipy sparse matrix or array (n, n), n ≥ 1, both triangles stored.
    backend : ``rslab``, ``superlu``, or ``auto``: rslab where it is installed, SuperLU where that does not do.

    Raises
    ------
    SingularMatrixError : singular to working precision, or not symmetric.
    ValueError : not square, empty, or with an entry that is not finite.
    ModuleNotFoundError : rslab was asked for and is not installed.
    """
    csc = csc_array(matrix, dtype=np.float64)
    csc.sum_duplicates()
    rows, columns = csc.shape
    if rows != columns or rows == 0:
        raise ValueError(f"a square matrix is needed, not one of shape {csc.shape}")
    _refuse_infinite(csc)
    if backend == "rslab" and rslab is None:
        raise ModuleNotFoundError("rslab is not installed")
    diagonal = csc.diagonal()
    probe = Probe(diagonal, csc.__matmul__)
    try:
        if backend == "superlu" or rslab is None:
            return probe.passed(SuperLUFactor(csc))
        return probe.passed(RslabFactor(rows, lambda: rslab.ldlt(csc, **settings(rows))))
    except SingularMatrixError:
        # Of a definite matrix this is the last word. Others may only have needed pivots from off the diagonal.
        if backend == "rslab" or diagonal.min() > 0.0:
            raise
    return probe.passed(SuperLUFactor(csc, pivoting=True))


def solve_rows(factor: Factor, forces: Array) -> Array:
    """The solutions (m, n) of m right sides, a row each: few at once, after which the factor keeps little to work on."""
    if len(forces) == 1:
        return factor.solve(forces[0])[None]
    rows = np.empty_like(forces)
    for first in range(0, len(forces), FEW):
        some = slice(first, first + FEW)
        rows[some] = factor.solve_many(forces[some].T).T
    return rows


class Pattern:
    """The pattern of symmetric matrices, whose analysis serves any number of factorisations."""

    def __init__(self) -> None:
        self._analysis: Any = None

    def prepare(self, triangle: csc_array) -> Prepared:
        """A matrix ready to be factorised, for which the triangle itself need not be held.

        triangle (n, n): the lower one by columns, the diagonal entry the first of each, the others sorted behind it; of the
        same pattern in every call.

        Raises ValueError for an entry that is not finite.
        """
        _refuse_infinite(triangle)
        diagonal = triangle.data[triangle.indptr[:-1]]
        probe = Probe(diagonal, lambda x: np.asarray(triangle @ x + triangle.T @ x - diagonal * x))
        if self._analysis is None and rslab is not None:
            self._analysis = rslab.analyze(triangle, path="ldlt", **settings(triangle.shape[0]))
        may_fail = self._analysis is None or diagonal.min() <= 0.0
        return Prepared(self._analysis, triangle.data, probe, triangle if may_fail else None)


@dataclass(frozen=True, eq=False)
class Prepared:
    """A matrix that is about to be factorised. triangle: where SuperLU may be needed."""

    analysis: Any
    values: Array
    probe: Probe
    triangle: csc_array | None

    def factorise(self) -> Factor:
        """Raises SingularMatrixError as the function `factorise` does."""
        if self.analysis is not None:
            give_back()
            try:
                with read_at_first(self.values):
                    factor = RslabFactor(self.probe.order, lambda: self.analysis.factor(self.values))
                return self.probe.passed(factor)
            except SingularMatrixError:
                if self.triangle is None:
                    raise
        assert self.triangle is not None
        return factorise(self.triangle + self.triangle.T - diags_array(self.triangle.diagonal()), "superlu")


class Probe:
    """A random solution, which the factor of a matrix has to find again.

    Neither backend notices a pivot that is only nearly zero, such as those of a body that nothing holds; here the
    free motion turns up in the solution with an error of order one. In the scaled unknowns, so that units do not matter.
    """

    def __init__(self, diagonal: Array, product: Callable[[Array], Array]) -> None:
        """For the matrix with this diagonal and these products."""
        self.order = diagonal.size
        self._scale = _scale(diagonal)
        self._expected = np.random.default_rng(0).standard_normal(self.order)
        with np.errstate(all="ignore"):
            self._right = product(self._scale * self._expected)

    def passed(self, factor: Factor) -> Factor:
        """The factor itself. Raises SingularMatrixError."""
        with np.errstate(all="ignore"):
            found = factor.solve(self._right) / self._scale
            error = float(np.linalg.norm(found - self._expected) / np.linalg.norm(self._expected))
        if not error < PROBE_TOLERANCE:  # also if it is not finite
            raise SingularMatrixError(_message(self.order))
        return factor


def settings(order: int) -> dict[str, Any]:
    """rslab's settings for a matrix of this order."""
    if order < DISSECTION_ORDER:
        return {}
    # the library's own choice is four threads, on whatever cores there are: each holds what it works on
    return {"ordering": "metis", "nd_leaf_size": LEAF, "threads": min(4, int(numba.get_num_threads()))}


def _refuse_infinite(matrix: csc_array) -> None:
    if not np.isfinite(matrix.data).all():
        at = int(np.flatnonzero(~np.isfinite(matrix.data))[0])
        column = int(np.searchsorted(matrix.indptr, at, side="right")) - 1
        raise ValueError(f"entry ({matrix.indices[at]}, {column}) of the matrix is {matrix.data[at]}")


def _scale(diagonal: Array) -> Array:
    """|a_ii|^(-1/2), or 1 where the diagonal is zero (n,)."""
    size = np.abs(diagonal)
    size[size == 0.0] = 1.0
    return np.asarray(1.0 / np.sqrt(size), dtype=np.float64)


def _message(order: int) -> str:
    return f"the matrix of order {order} is singular to working precision, or not symmetric"

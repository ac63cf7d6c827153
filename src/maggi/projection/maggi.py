"""Maggi's projection: the thesis of the program on one page (Theory §4; paper §3, Appendix B).

Liaisons are rows ``A v + b = 0`` (T7). A basis S of the velocities that they admit turns the unconstrained
equations into ordinary differential equations in exactly the true freedoms, without multipliers:

    T8   v = S ν + v_p        T9   v̇ = S ν̇ + a_p        T10  (SᵀMS) ν̇ = Sᵀ(f − M a_p)

Everything here is dense and for the small system: it defines, audits and starts a computation. The compiled
step applies the same projection in range-space form (`range_space`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq, qr, solve_triangular

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

RANK_TOLERANCE = 1e-10
"""A direction counts as dependent where it is this much smaller than the largest, rows and velocities scaled."""


class Admitted(Protocol):
    """Rows A (m, n), the velocities S (n, f) that they admit, and `particular` ones: of a `Projection` or a `Splitting`."""

    @property
    def A(self) -> Array: ...
    @property
    def S(self) -> Array: ...
    def particular(self, b: Array) -> Array: ...


@dataclass(frozen=True, eq=False)
class Projection:
    """Velocities that m rows on n velocities admit.

    S (n, n − rank). independent (n − rank,): which velocities are ν, so that S is the identity on them.
    rows (rank,): a maximal independent set of rows; redundant: the others. gap: smallest kept over largest
    dropped pivot, a measure of how clear the decision on the rank was (inf where nothing was dropped).
    """

    A: Array
    S: Array
    independent: IntArray
    dependent: IntArray
    rows: IntArray
    redundant: IntArray
    gap: float

    @property
    def rank(self) -> int:
        """Number of independent rows."""
        return len(self.dependent)

    def particular(self, b: Array) -> Array:
        """v_p (n,) with A v_p = −b on the dependent velocities alone (T8); with γ for b it is a_p (T9)."""
        x = np.zeros(self.A.shape[1])
        if self.rank:
            x[self.dependent] = lstsq(self.A[:, self.dependent], -b)[0]
        return x

    def inconsistency(self, b: Array) -> Array:
        """What no velocity can make of A v + b = 0: the residual (m,) of the best."""
        return np.asarray(self.A @ self.particular(b) + b)


def project(A: Array, scale: Array | None = None) -> Projection:
    """Rank decision, independent velocities and S, by QR with column pivoting (coordinate partitioning).

    A (m, n). scale (n,): the size of one unit of each velocity, such as the mechanism's size for angular
    velocities, so that pivots compare. Raises ValueError where A is not finite.
    """
    m, n = A.shape
    if not np.isfinite(A).all():
        raise ValueError("the liaison rows are not finite")
    scale = np.ones(n) if scale is None else scale
    scaled = A / scale
    size = np.linalg.norm(scaled, axis=1)
    scaled = scaled / np.where(size > 0.0, size, 1.0)[:, None]
    if m == 0 or n == 0:
        empty = np.empty(0, dtype=np.int64)
        return Projection(A, np.eye(n), np.arange(n), empty, empty, np.arange(m), np.inf)
    _, R, order = qr(scaled, mode="economic", pivoting=True)
    pivots = np.abs(np.diag(R))
    rank = int(np.sum(pivots > RANK_TOLERANCE * max(pivots[0], 1e-300)))
    dropped = pivots[rank] if rank < len(pivots) else 0.0
    gap = float(pivots[rank - 1] / dropped) if rank and dropped > 0.0 else np.inf
    dependent, independent = order[:rank], order[rank:]
    S = np.zeros((n, n - rank))
    S[independent, np.arange(n - rank)] = 1.0
    # R is that of scaled velocities: v = scaled / scale
    S[dependent] = -solve_triangular(R[:rank, :rank], R[:rank, rank:]) / scale[dependent, None] * scale[independent]
    row_order = qr(scaled.T, mode="r", pivoting=True)[1]
    rows, redundant = np.sort(row_order[:rank]), np.sort(row_order[rank:])
    return Projection(A, S, independent, dependent, rows, redundant, gap)


def accelerations(projection: Admitted, M: Array, f: Array, gamma: Array) -> Array:
    """v̇ (n,) of ``M v̇ = f + liaison forces`` with A v̇ + γ = 0: Maggi's equations T9, T10."""
    S = projection.S
    a_p = projection.particular(gamma)
    if S.shape[1] == 0:
        return a_p
    nud = np.linalg.solve(S.T @ M @ S, S.T @ (f - M @ a_p))
    return np.asarray(S @ nud + a_p)


def liaison_forces(projection: Admitted, residual: Array) -> Array:
    """λ (m,) with Aᵀλ = f − M v̇ (T11), of least norm where rows are redundant."""
    return np.asarray(lstsq(projection.A.T, residual)[0])


def closest_velocities(projection: Admitted, M: Array, v: Array, b: Array) -> Array:
    """The velocities that the liaisons admit nearest to v in the kinetic metric M: v itself where it is admitted.

    ``v + S(SᵀMS)⁻¹SᵀM(v_p' )`` with any particular correction: the part of the defect along S is free.
    """
    S = projection.S
    correction = projection.particular(projection.A @ v + b)
    if S.shape[1]:
        correction = correction - S @ np.linalg.lstsq(S.T @ M @ S, S.T @ (M @ correction), rcond=None)[0]
    return np.asarray(v + correction)


def restore(
    rows: Callable[[Array], tuple[Array, Array]], M: Array, scale: Array, tolerance: float, attempts: int = 20
) -> float:
    """Tangent-space position update: Newton's method back to Φ = 0, least in the metric M; the largest |Φ| that is left.

    rows : step (n,) → (A, Φ) after positions have moved by that step from where they are, the first being zero. Steps
    are composed, not summed: increments of frames do not add up, and A is that of the moved bodies.
    """
    step = np.zeros(len(scale))
    left = np.inf
    for _ in range(attempts):
        A, Phi = rows(step)
        left = float(np.abs(Phi).max(initial=0.0))
        if left <= tolerance or not np.isfinite(left):
            break
        step = closest_velocities(project(A, scale), M, np.zeros(len(scale)), Phi)
    return left

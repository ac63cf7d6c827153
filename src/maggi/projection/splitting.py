"""A choice of independent velocities: what is chosen once and kept while the mechanism moves, and what follows from it.

All velocities are split as ``v = E ν + N z``: ν are the independent ones, read off v by ``ν = P v``, and N spans the
directions that do not change ν, along which the liaisons answer. E, N and P are constant; S and v_p follow from the
rows wherever the mechanism is (T8):

    S = E − N (A N)⁻¹ A E,   v_p = −N (A N)⁻¹ b,   P S = 1,   P v_p = 0
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq, qr

from .maggi import RANK_TOLERANCE

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

HYSTERESIS = 100.0
"""A row that was dependent becomes independent where its pivot exceeds this many times the rank tolerance, and an
independent one dependent where it falls below the tolerance divided by as much."""


@dataclass(frozen=True, eq=False)
class Splitting:
    """Independent and dependent directions of n velocities under m rows of rank r; f = n − r.

    strategy: the name of what chose it. E (n, f), N (n, r), P (f, n) as above; N has columns of unit length in scaled
    velocities. velocities (f,): which velocities ν are, where they are some of v; empty where they are combinations.
    rows (r,): a maximal independent set of rows; redundant (m − r,): the others. gap: smallest kept over largest
    dropped pivot (inf where nothing was dropped). scale (n,): the size of one unit of each velocity. condition: of S
    where it was chosen.
    """

    strategy: str
    E: Array
    N: Array
    P: Array
    velocities: IntArray
    rows: IntArray
    redundant: IntArray
    gap: float
    scale: Array
    condition: float = np.nan

    @property
    def rank(self) -> int:
        """Number of independent rows."""
        return len(self.rows)

    @property
    def freedoms(self) -> int:
        """Number of independent velocities."""
        return len(self.P)

    def at(self, A: Array) -> AdmittedVelocities:
        """S and the particular solutions for the rows A (m, n) of the present state."""
        return AdmittedVelocities(self, A)


class AdmittedVelocities:
    """The velocities that rows A admit, in a splitting's independent ones (T8, T9).

    S (n, f). Has what `maggi.accelerations`, `maggi.liaison_forces` and `maggi.closest_velocities` ask of a projection.
    """

    def __init__(self, splitting: Splitting, A: Array) -> None:
        self.A = A
        self.splitting = splitting
        self._AN = A @ splitting.N
        self.S = splitting.E - splitting.N @ self._dependent(A @ splitting.E)

    @property
    def rank(self) -> int:
        """Number of independent rows."""
        return self.splitting.rank

    @property
    def gap(self) -> float:
        """How clear the decision on the rank was; see `Splitting`."""
        return self.splitting.gap

    def particular(self, b: Array) -> Array:
        """v_p (n,) with A v_p = −b and P v_p = 0 (T8); with γ for b it is a_p (T9)."""
        return np.asarray(-self.splitting.N @ self._dependent(b))

    def inconsistency(self, b: Array) -> Array:
        """What no velocity can make of A v + b = 0: the residual (m,) of the best."""
        return np.asarray(self.A @ self.particular(b) + b)

    @property
    def condition(self) -> float:
        """Condition number of S in scaled velocities, its columns made equally long: 1 is best."""
        if self.S.shape[1] == 0:
            return 1.0
        scaled = self.S * self.splitting.scale[:, None]
        values = np.linalg.svd(scaled / np.linalg.norm(scaled, axis=0), compute_uv=False)
        return float(values[0] / values[-1])

    def _dependent(self, right: Array) -> Array:
        if self.rank == 0 or right.size == 0:
            return np.zeros((self.rank, *right.shape[1:]))
        return np.asarray(lstsq(self._AN, right)[0])


def decided_rank(pivots: Array, n: int, previous: int | None) -> int:
    """How many of the pivots, in falling order, count; what counted before is kept within the `HYSTERESIS`.

    They are compared with the first, and with the least that the first is where a row of length 1 on n velocities is
    more than round-off.
    """
    if len(pivots) == 0:
        return 0
    relative = pivots / max(pivots[0], n**-0.5)
    if previous is None:
        return int(np.sum(relative > RANK_TOLERANCE))
    surely = int(np.sum(relative > RANK_TOLERANCE * HYSTERESIS))
    possibly = int(np.sum(relative > RANK_TOLERANCE / HYSTERESIS))
    return min(max(previous, surely), possibly)


def scaled_rows(A: Array, scale: Array, size: Array | None = None) -> Array:
    """Rows on scaled velocities, each divided by its size (m,), by default its length."""
    scaled = A / scale
    size = np.linalg.norm(scaled, axis=1) if size is None else size
    return np.asarray(scaled / np.where(size > 0.0, size, 1.0)[:, None])


def gap_at(pivots: Array, rank: int) -> float:
    """Smallest kept over largest dropped pivot."""
    dropped = pivots[rank] if rank < len(pivots) else 0.0
    return float(pivots[rank - 1] / dropped) if rank and dropped > 0.0 else np.inf


def independent_rows(reduced: Array) -> tuple[IntArray, IntArray]:
    """A maximal independent set of the rows of (m, r), which has rank r, and the others, both in order."""
    m, r = reduced.shape
    if r == 0:
        return np.empty(0, dtype=np.int64), np.arange(m)
    order = qr(reduced.T, mode="r", pivoting=True)[1].astype(np.int64)
    return np.sort(order[:r]), np.sort(order[r:])


def null_directions(P: Array, scale: Array) -> Array:
    """N (n, n − f): all directions with P N = 0, orthonormal in scaled velocities."""
    f = len(P)
    if f == 0:
        return np.asarray(np.diag(1.0 / scale))
    Q = qr((P / scale).T)[0]
    return np.asarray(Q[:, f:] / scale[:, None])

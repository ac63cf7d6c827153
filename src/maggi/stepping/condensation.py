"""A meshed body's response to forces at its attachments, for every step size in use: the constants of the step (T12)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.bodies.mesh_body import MeshBody
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.allocators import give_back
from maggi.linalg.factor import FEW, Factor, solve_rows
from maggi.linalg.lanes import WIDTH
from maggi.linalg.shifted import ShiftedFactors

Array = NDArray[np.float64]

# Constants of the step sizes used last are kept, so that changing back costs nothing: so many of them, and no more memory
# than this, but two in any case.
KEPT, KEPT_BYTES = 8, 2 << 30


@dataclass(frozen=True, eq=False)
class Condensation:
    """Constants of a body with k attachments for one step size (Eq. T12).

    factor of Ŝ = k₁M + k₂K, k₁ = σ + γh·mass, k₂ = βh² + γh·stiffness. Y = PŜ⁻¹B (nd, 6k), Z = Ŝ⁻¹KY,
    Z_D = Ŝ⁻¹DY = y Y + z Z, damping being (y, z); W, W_Z, W_D (6k, 6k): Bᵀ of them. responses (k, g, 12, 4): of every
    attachment, for four freedoms at a time, zeros after the last, the six columns of Y and those of Z: as the correction reads
    them. weights: k₁ and k₂. stiff: whether k₂K outweighs k₁M at most freedoms.
    """

    factor: Factor | None
    responses: Array
    W: Array
    W_Z: Array
    W_D: Array
    damping: tuple[float, float] = (0.0, 0.0)
    weights: tuple[float, float] = (1.0, 0.0)
    stiff: bool = False

    @staticmethod
    def none(body: MeshBody) -> Condensation:
        """Stands where nothing has been factorised yet."""
        n = body.B.shape[1]
        return Condensation(None, np.zeros((n // 6, 0, 12, WIDTH)), *np.zeros((3, n, n)))

    @property
    def nbytes(self) -> int:
        """Memory that it holds."""
        return self.responses.nbytes + (self.factor.nbytes if self.factor else 0)


class Condensations:
    """What bodies that are the same share: constants by step size."""

    def __init__(self, body: MeshBody) -> None:
        self._body = body
        self._factors = ShiftedFactors(body.K.indptr, body.K.indices, body.K.blocks, body.set_aside)
        self._kept: dict[GeneralizedAlpha, Condensation] = {}
        self._frequency = 0.0  # K over M on the diagonal (rad²/s²), their median; 0 where M has not been made yet

    def has(self, c: GeneralizedAlpha) -> bool:
        """Whether the constants of a step are kept."""
        return c in self._kept

    def of(self, c: GeneralizedAlpha) -> Condensation:
        """The constants of a step: kept, or made with a factorisation."""
        found = self._kept.pop(c, None)
        if found is None:
            self._make_room()
            k1, k2 = self._weights(c)
            found = self._condense(self.factorise(k1, k2), k1, k2)
        self._kept[c] = found  # the last one used
        return found

    def at_rest(self) -> Condensation:
        """The constants of an instant (h = 0): Ŝ = M. Not kept."""
        return self._condense(self._body.inertia.factorised(), 1.0, 0.0)

    def factorise(self, k1: float, k2: float) -> Factor:
        """The factor of k₁M + k₂K."""
        return self._factors.factorise(k1, self._mass, k2)

    def _mass(self) -> sp.csr_matrix:
        M = self._body.inertia.matrix
        if self._frequency == 0.0:
            self._frequency = float(np.median(self._body.K.diagonal() / M.diagonal()))
        return M

    def _make_room(self) -> None:
        """Before another is made, which will be about as large as the last."""
        kept = self._kept
        last = next(reversed(kept.values())).nbytes if kept else 0
        while len(kept) >= KEPT or (len(kept) >= 2 and sum(one.nbytes for one in kept.values()) + last > KEPT_BYTES):
            del kept[next(iter(kept))]

    def _weights(self, c: GeneralizedAlpha) -> tuple[float, float]:
        d = self._body.damping
        return c.sigma + c.gamma * c.h * d.mass, c.beta * c.h**2 + c.gamma * c.h * d.stiffness

    def _condense(self, factor: Factor, k1: float, k2: float) -> Condensation:
        """A few columns at a time: what works on all at once would take memory on top of the factor's."""
        body, d = self._body, self._body.damping
        n = body.B.shape[1]
        responses = np.zeros((n // 6, -(-body.size // WIDTH), 12, WIDTH))
        W, W_Z = np.zeros((2, n, n))
        for column in range(0, n, FEW):
            some, of_Y, of_Z = slice(column, column + FEW), column % 6, column % 6 + 6
            response = responses[column // 6]
            forces = body.B[:, some].T.toarray()
            Y = self._response(factor, forces)
            _by_fours(Y, response[:, of_Y : of_Y + FEW])
            W[:, some] = np.stack([body.B.T @ y for y in Y], axis=1)
            if k2 == 0.0:
                continue
            forces[:] = 0.0
            for displacements, force in zip(Y, forces, strict=True):
                body.K.add_product(displacements, force)
            body.set_aside()
            del Y
            Z = self._response(factor, forces)
            _by_fours(Z, response[:, of_Z : of_Z + FEW])
            W_Z[:, some] = np.stack([body.B.T @ z for z in Z], axis=1)
        W = 0.5 * (W + W.T)
        give_back()
        # D = mass M + stiffness K on mean axes, and M = (Ŝ − k₂K)/k₁
        y, z = (d.mass / k1, d.stiffness - d.mass * k2 / k1) if k2 else (0.0, 0.0)
        stiff = k2 * self._frequency >= k1
        return Condensation(factor, responses, W, W_Z, y * W + z * W_Z, (y, z), (k1, k2), stiff)

    def _response(self, factor: Factor, forces: Array) -> Array:
        """P Ŝ⁻¹ of forces (m, nd), a row each; (m, nd)."""
        rows = solve_rows(factor, forces)
        if self._body.floating:
            for row in rows:
                self._body.axes.project(row)
        return rows


def _by_fours(rows: Array, out: Array) -> None:
    """Rows (m, nd) into out (g, m, 4), four of their values at a time."""
    full, rest = divmod(rows.shape[1], WIDTH)
    for row, column in zip(
        rows, out.transpose(1, 0, 2), strict=True
    ):  # each by itself: all at once would be copied first
        column[:full] = row[: full * WIDTH].reshape(full, WIDTH)
        column[full:, :rest] = row[full * WIDTH :]

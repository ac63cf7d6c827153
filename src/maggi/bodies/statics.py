"""Static response of a meshed body that nothing supports, exactly and with one factorisation.

K is singular with the six rigid motions Φ. Six freedoms that rigid motions cannot leave at rest, a *determinate support*,
make it definite without adding stiffness; what is held besides, or instead, is a small dense border:

    K u + B λ = f,  Bᵀu = 0:     u = G (f − B λ) + Φ a,     [ BᵀGB  −BᵀΦ ] [λ]   [BᵀG f]
                                                           [ ΦᵀB     0  ] [a] = [Φᵀ f ]

with G the inverse on the support. So K with a border, a saddle point, is solved by the factor of a definite matrix.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.linalg.shifted import ShiftedFactors

from .mesh_body import MeshBody

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

BLOCK = 8  # right sides solved at once, as many as in a block of Lanczos's: a factor keeps the memory that its widest solve took


def determinate_support(body: MeshBody) -> IntArray:
    """Six freedoms (6,) without which no rigid motion is left: those of a rigid attachment, or well spread ones."""
    for k, coupling in enumerate(body.couplings):
        if coupling.rigid:
            return np.sort(body.B[:, 6 * k : 6 * k + 6].tocoo().row.astype(np.int64))
    weight = np.sqrt(body.inertia.matrix.diagonal())  # makes displacements and rotations comparable
    values, vectors = np.linalg.eigh(body.J6)
    motions = weight[:, None] * (body.Phi @ (vectors / np.sqrt(values)))
    _, _, pivots = scipy.linalg.qr(motions.T, mode="economic", pivoting=True)
    return np.sort(pivots[:6].astype(np.int64))


class FreeStatics:
    """The factor of K on a determinate support."""

    def __init__(self, body: MeshBody) -> None:
        self.body = body
        self._support = determinate_support(body)
        K = body.K
        self._factor = ShiftedFactors(K.indptr, K.indices, K.blocks, body.set_aside).factorise_held(self._support)

    def on_support(self, forces: Array) -> Array:
        """G f (nd, k): displacements of the supported body; the support takes what is not in equilibrium."""
        result = np.empty_like(forces)
        for first in range(0, forces.shape[1], BLOCK):
            some = slice(first, first + BLOCK)
            loads = forces[:, some].copy()
            loads[self._support] = 0.0
            result[:, some] = self._factor.solve_many(loads)
        return result

    def floating(self, forces: Array) -> Array:
        """P G Pᵀ f (nd, k): deformation of the body that its own inertia balances (inertia relief)."""
        body = self.body
        balanced = forces - body.C @ np.linalg.solve(body.J6, body.Phi.T @ forces)
        return body.without_rigid_motion(self.on_support(balanced))


class HeldStatics:
    """The body with ``Bᵀu`` given, B (nd, r) sparse, of full rank, and no rigid motion left."""

    def __init__(self, statics: FreeStatics, B: sp.csc_matrix) -> None:
        self._statics = statics
        self._B = B
        self._response = statics.on_support(B.toarray())
        self._Phi = Phi = statics.body.Phi
        r = B.shape[1]
        border = np.zeros((r + 6, r + 6))
        border[:r, :r] = B.T @ self._response
        border[:r, r:] = -(B.T @ Phi)
        border[r:, :r] = -border[:r, r:].T
        # rotations, displacements and forces side by side: equilibrated
        self._rows, self._columns = _equilibrium(border)
        self._border = scipy.linalg.lu_factor(self._rows[:, None] * border * self._columns)

    def displacements(self, forces: Array) -> Array:
        """u (nd, k) of forces (nd, k) with Bᵀu = 0."""
        u = self._statics.on_support(forces)
        return self._held(u, np.vstack([self._B.T @ u, self._Phi.T @ forces]))

    def unit_displacements(self) -> Array:
        """u (nd, r) without forces but at the border, where Bᵀu is the unit matrix: the constraint modes."""
        size, r = self._B.shape
        return self._held(np.zeros((size, r)), np.vstack([-np.eye(r), np.zeros((6, r))]))

    def _held(self, u: Array, right: Array) -> Array:
        x = self._columns[:, None] * scipy.linalg.lu_solve(self._border, self._rows[:, None] * right)
        r = self._B.shape[1]
        return np.asarray(u - self._response @ x[:r] + self._Phi @ x[r:])


def _equilibrium(matrix: Array) -> tuple[Array, Array]:
    """Row and column factors that make the largest entries of a matrix about one."""
    rows, columns = np.ones(len(matrix)), np.ones(len(matrix))
    for _ in range(4):
        scaled = np.abs(rows[:, None] * matrix * columns)
        rows /= np.sqrt(scaled.max(axis=1))
        columns /= np.sqrt(scaled.max(axis=0))
    return rows, columns

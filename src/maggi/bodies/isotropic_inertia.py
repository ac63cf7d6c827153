"""Inertia of meshes whose interpolation is isotropic, every solid element's: one nodal acceleration field (T4)."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.elements.moving_frame import InertiaConstants, contracted
from maggi.linalg.factor import Factor, factorise
from maggi.linalg.lanes import WIDTH
from maggi.linalg.paged import moved, release
from maggi.linalg.shared import crew

from .freedoms import Freedoms
from .isotropic_factor import IsotropicFactor
from .isotropic_kernels import (
    NodalForces,
    NodalMass,
    NodalSquares,
    accelerations,
    evaluate,
    inertia_forces,
    nodal_squares,
    three_times,
)
from .mean_axes import MeanAxes, RigidColumns

Array = NDArray[np.float64]

TOGETHER = 8  # columns that M is multiplied with at once: with more, what is between takes memory
PARTS = 16  # of the nodes, summed separately so that sums do not depend on the number of threads


class IsotropicForces:
    """See `InertiaForces`."""

    def __init__(self, of: NodalForces) -> None:
        self._of = of
        self._entries = np.array([accelerations.entry(of), inertia_forces.entry(of)])

    def residual(self, drive: Array, frame: Array) -> tuple[Array, Array]:
        """See `InertiaForces.residual`."""
        of = self._of
        of.drive[:] = drive
        evaluate(of, self._entries, crew())
        frame[:] = of.wrench
        return of.S, of.J


class IsotropicInertia:
    """T4: ``μ a`` with one nodal acceleration field, for every solid element.

    Nodes are taken in another order than the mesh's: free ones first, so that their part of a nodal field is that of
    the freedoms, and tied ones at the end.
    """

    def __init__(self, nodes: Array, mu: sp.csr_matrix, freedoms: Freedoms) -> None:
        self._freedoms = freedoms
        self._tied = freedoms.tied.size
        self._free = len(nodes) - self._tied
        self._order = freedoms.order()
        if self._tied:
            mu = mu[self._order][:, self._order]
            mu.sort_indices()
        mu = sp.csr_matrix((moved(mu.data), moved(mu.indices), mu.indptr), shape=mu.shape)
        self._mu = mu
        self._nodes = np.ascontiguousarray(nodes[self._order])
        self._weights = np.asarray(mu.sum(axis=1)).ravel()
        self._moments = np.ascontiguousarray(mu @ self._nodes)
        self.mass = float(self._weights.sum())
        self.S0 = self._moments.sum(axis=0)
        second = np.einsum("ni,nj->ij", self._nodes, self._moments)
        self.J0 = np.trace(second) * np.eye(3) - second
        starts = np.searchsorted(mu.indptr, np.linspace(0, mu.nnz, PARTS + 1)).astype(np.int64)
        starts[0], starts[-1] = 0, len(nodes)
        self._rows = NodalMass(mu.indptr, mu.indices, mu.data, starts)
        self._field, self._on_tied = np.zeros((len(nodes) + 1, 6)), np.empty((self._tied, 6))
        self._of_tied = np.empty((3, self._tied, 3))
        self._sums, self._wrenches = np.zeros((PARTS, 15)), np.zeros((PARTS, 6))

    @property
    def matrix(self) -> sp.csr_matrix:
        """See `MeshInertia.matrix`."""
        mu, n, f = self._mu, self._mu.shape[0], self._free
        indptr, indices, data = three_times(mu.indptr, mu.indices, mu.data)
        full = sp.csr_matrix((data, indices, indptr), shape=(3 * n, 3 * n))
        if self._tied == 0:
            return full
        T = self._tie()
        side = (full[: 3 * f, 3 * f :] @ T).tocsr()
        corner = (T.T @ full[3 * f :, 3 * f :] @ T).toarray()
        matrix = sp.bmat([[full[: 3 * f, : 3 * f], side], [side.T, sp.csr_matrix(0.5 * (corner + corner.T))]])
        matrix = matrix.tocsr()
        matrix.sort_indices()
        return matrix

    def _tie(self) -> sp.csr_matrix:
        """Displacements of the tied nodes from the attachments' freedoms, (3 tied, 6 attachments)."""
        rows = self._freedoms.matrix()[(3 * self._freedoms.tied[:, None] + np.arange(3)).ravel()]
        return rows[:, 3 * self._free :]

    def set_aside(self) -> None:
        """See `MeshInertia.set_aside`."""
        release(self._mu.data, self._mu.indices)

    def forces(
        self,
        u: Array,
        ud: Array,
        udd: Array,
        nodal: Array,
        relative: Array | None = None,
        axes: MeanAxes | None = None,
    ) -> IsotropicForces:
        """See `MeshInertia.forces`."""
        of = NodalForces(
            self._rows,
            self._nodes,
            self._weights,
            self._moments,
            self._freedoms.master,
            self._freedoms.arm,
            axes.inverse if axes else np.zeros((6, 6)),
            np.empty((3, 3)),
            np.zeros(2) if relative is None else relative,
            u,
            ud,
            udd,
            nodal,
            self._of_tied,
            self._field,
            self._on_tied,
            self._sums,
            self._wrenches,
            self.S0,
            self.J0,
            np.empty(6),
            np.empty(3),
            np.empty((3, 3)),
        )
        return IsotropicForces(of)

    def kinetic_energy(self, v: Array, w: Array, u: Array, ud: Array) -> float:
        momentum, resultants, rest = np.empty_like(u), np.empty(6), np.zeros(3)
        # with v for a_O and ω for ε, and no spin, T4 is the velocity
        self.forces(u, ud, ud, momentum).residual(np.array((v, rest, w)), resultants)
        return float(0.5 * (v @ resultants[:3] + w @ resultants[3:] + ud @ momentum))

    def squares(self, fields: Array) -> Array:
        """See `MeshInertia.squares`."""
        of = NodalSquares(self._rows, self._freedoms.with_tied(fields), np.empty((PARTS, WIDTH)))
        nodal_squares(of, PARTS)
        return np.asarray(of.sums.sum(axis=0))

    def product(self, x: Array) -> Array:
        """See `MeshInertia.product`."""
        result = np.empty((len(x) // 3, 3, x.shape[1]))
        for first in range(0, x.shape[1], TOGETHER):
            some = slice(first, first + TOGETHER)
            result[:, :, some] = self._forces_of(x[:, some].reshape(len(result), 3, -1))
        return result.reshape(x.shape)

    def _forces_of(self, fields: Array) -> Array:
        """M times fields (nd/3, 3, k)."""
        f, columns = self._free, fields.shape[2]
        nodal = self._freedoms.with_tied(fields)
        force = (self._mu @ nodal.reshape(-1, 3 * columns)).reshape(-1, 3, columns)
        result = np.zeros(fields.shape)
        result[:f] = force[:f]
        if self._tied:
            master, arm = self._freedoms.master, self._freedoms.arm[:, :, None]
            np.add.at(result, master, force[f:])
            np.add.at(result, master + 1, np.cross(arm, force[f:], axis=1))
        return result

    def constants(self, basis: Array) -> InertiaConstants:
        n = basis.shape[1]
        fields = self._freedoms.with_tied(basis.reshape(-1, 3, n))
        P, Q = np.empty((3, 3, n, n)), np.empty((3, 3, n))
        for i in range(3):
            component = np.ascontiguousarray(fields[:, i])
            Q[i] = self._moments.T @ component
            weighted = self._mu @ component
            for j in range(i, 3):
                P[j, i] = fields[:, j].T @ weighted
                P[i, j] = P[j, i].T
            P[i, i] = 0.5 * (P[i, i] + P[i, i].T)
        m_O = np.einsum("p,pia->ai", self._weights, fields)
        return contracted(np.array(self.mass), self.S0, self.J0, m_O, P, Q)

    def factorised(self) -> Factor:
        """See `MeshInertia.factorised`."""
        free = self._mu[: self._free, : self._free] if self._tied else self._mu
        return IsotropicFactor(factorise(free), self.matrix if self._tied else None)

    def mean_axes(self, Phi: Array, C: Array, J6: Array) -> MeanAxes:
        """See `MeshInertia.mean_axes`."""
        f = self._free
        return MeanAxes.of(
            RigidColumns.of(Phi, np.ones(f), self._nodes[:f]),
            RigidColumns.of(C, self._weights[:f], self._moments[:f]),
            J6,
        )

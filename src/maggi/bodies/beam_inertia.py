"""Inertia of beams, whose nodes also rotate: the constants of T3, assembled (T2, T5a)."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numba import njit
from numpy.typing import NDArray

from maggi.elements.beam import BeamTerms
from maggi.elements.moving_frame import InertiaConstants
from maggi.linalg.factor import Factor, factorise
from maggi.linalg.vectors import cross

from .mean_axes import MeanAxes, RigidColumns

Array = NDArray[np.float64]

NONE = np.zeros(2)  # of u and u̇ is added to the accelerations


class BeamForces:
    """See `InertiaForces`."""

    def __init__(
        self,
        inertia: BeamInertia,
        fields: tuple[Array, Array, Array],
        nodal: Array,
        relative: Array,
        axes: MeanAxes | None,
    ) -> None:
        self._inertia, self._fields, self._nodal, self._relative, self._axes = inertia, fields, nodal, relative, axes

    def residual(self, drive: Array, frame: Array) -> tuple[Array, Array]:
        """See `InertiaForces.residual`."""
        found = self._inertia.evaluate(self._fields, self._nodal, self._relative, drive, frame)
        if self._axes is not None:
            self._axes.project_forces(self._nodal)
        return found


class BeamInertia:
    """T2 with the assembled constants of T3, and T5a for the frame: beams, whose nodes also rotate."""

    def __init__(self, terms: BeamTerms) -> None:
        self.mass, self.S0, self.J0 = terms.mass, terms.S0, terms.J0
        self.matrix: sp.csr_matrix = terms.M.tocsr()
        self._m_O, self._s, self._s2 = terms.m_O, terms.s, terms.s2
        # All matrices stand on one graph, so that one pass over it serves all.
        self._indptr, self._indices = terms.M.indptr, terms.M.indices
        blocks = [terms.M, *terms.G, *(terms.H[k][l] for k in range(3) for l in range(3))]
        for block in blocks:
            if not np.array_equal(block.indices, self._indices):
                raise ValueError("the beam's matrices do not stand on one graph")
        self._blocks = np.ascontiguousarray(np.stack([block.data for block in blocks], axis=1))
        self._scalars = np.empty(21)

    def forces(
        self,
        u: Array,
        ud: Array,
        udd: Array,
        nodal: Array,
        relative: Array | None = None,
        axes: MeanAxes | None = None,
    ) -> BeamForces:
        """See `MeshInertia.forces`."""
        return BeamForces(self, (u, ud, udd), nodal, NONE if relative is None else relative, axes)

    def squares(self, fields: Array) -> Array:
        """See `MeshInertia.squares`."""
        flat = fields.reshape(self.matrix.shape[0], -1)
        return np.asarray(np.einsum("nk,nk->k", flat, self.matrix @ flat))

    def product(self, x: Array) -> Array:
        """See `MeshInertia.product`."""
        return np.asarray(self.matrix @ x)

    def evaluate(
        self, fields: tuple[Array, Array, Array], nodal: Array, relative: Array, drive: Array, frame: Array
    ) -> tuple[Array, Array]:
        """See `InertiaForces.residual`; without mean axes."""
        (u, ud, udd), (a_O, w, eps) = fields, drive
        sums = self._scalars
        _beam_pass(self._indptr, self._indices, self._blocks, w, eps, relative, u, ud, udd, nodal, sums)
        ww = np.outer(w, w)
        nodal += self._m_O @ a_O + eps @ self._s + np.einsum("kl,kln->n", ww, self._s2)
        S = self.S0 + self._m_O.T @ u
        J = self._inertia(u, sums[:9].reshape(3, 3))
        rate, acceleration = self._m_O.T @ ud, self._m_O.T @ udd
        frame[:3] = self.mass * a_O + cross(eps, S) + cross(w, cross(w, S))
        frame[:3] += 2.0 * cross(w, rate) + acceleration
        frame[3:] = cross(S, a_O) + J @ eps + cross(w, J @ w)
        frame[3:] += self._s @ udd + sums[9:12]
        coupling = self._s2 @ ud + sums[12:].reshape(3, 3)  # [l, k]: (s_lk + H_lk δ)·δ̇
        frame[3:] -= 2.0 * w @ coupling
        return S, J

    def kinetic_energy(self, v: Array, w: Array, u: Array, ud: Array) -> float:
        scratch = np.empty_like(u)
        zero = np.zeros(3)
        _beam_pass(self._indptr, self._indices, self._blocks, zero, zero, NONE, u, ud, ud, scratch, self._scalars)
        S, J = self.S0 + self._m_O.T @ u, self._inertia(u, self._scalars[:9].reshape(3, 3))
        linear = self.mass * v + cross(w, S) + self._m_O.T @ ud
        angular = cross(S, v) + J @ w + self._s @ ud + self._scalars[9:12]
        relative = self._m_O.T @ ud @ v + (self._s @ ud + self._scalars[9:12]) @ w + ud @ scratch
        return float(0.5 * (v @ linear + w @ angular + relative))

    def constants(self, basis: Array) -> InertiaConstants:
        products = [basis.T @ (self._block_matrix(i) @ basis) for i in range(13)]
        m, n = products[0], basis.shape[1]
        return InertiaConstants(
            mass=np.array(self.mass),
            S0=self.S0,
            J0=self.J0,
            m=0.5 * (m + m.T),
            m_O=basis.T @ self._m_O,
            G=np.array(products[1:4]),
            H=np.array(products[4:]).reshape(3, 3, n, n),
            s=self._s @ basis,
            s2=self._s2 @ basis,
        )

    def set_aside(self) -> None:
        """See `MeshInertia.set_aside`: a beam's M is small."""

    def factorised(self) -> Factor:
        """See `MeshInertia.factorised`."""
        return factorise(self.matrix)

    def mean_axes(self, Phi: Array, C: Array, J6: Array) -> MeanAxes:
        """See `MeshInertia.mean_axes`."""
        none = np.empty(0), np.empty((0, 3))
        return MeanAxes.of(RigidColumns.of(Phi, *none), RigidColumns.of(C, *none), J6)

    def _block_matrix(self, i: int) -> sp.bsr_matrix:
        """M, G_1 … G_3, H_11, H_12 … H_33 by number."""
        shape = self.matrix.shape
        return sp.bsr_matrix((np.ascontiguousarray(self._blocks[:, i]), self._indices, self._indptr), shape=shape)

    def _inertia(self, u: Array, quadratic: Array) -> Array:
        linear = self._s2 @ u
        return np.asarray(self.J0 - linear - linear.T - 0.5 * (quadratic + quadratic.T))


@njit(cache=True)
def _beam_pass(indptr, indices, blocks, w, eps, relative, u, ud, udd, out, sums):  # type: ignore[no-untyped-def]
    """out = m (ü + p u + q u̇) + 2 Σω_kG_k u̇ + Σ(ε_kG_k + Σ_l ω_kω_lH_kl) u; sums: uᵀH_klu, üᵀG_ku, u̇ᵀH_lku [l, k] (T2, T5a)."""
    sums[:] = 0.0
    for n in range(indptr.size - 1):
        for i in range(3):
            row = 3 * n + i
            value = 0.0
            for p in range(indptr[n], indptr[n + 1]):
                for j in range(3):
                    column = 3 * indices[p] + j
                    x, xd = u[column], ud[column]
                    value += blocks[p, 0, i, j] * (udd[column] + relative[0] * x + relative[1] * xd)
                    for k in range(3):
                        g = blocks[p, 1 + k, i, j]
                        value += g * (2.0 * w[k] * xd + eps[k] * x)
                        sums[9 + k] += udd[row] * g * x
                        for l in range(3):
                            h = blocks[p, 4 + 3 * k + l, i, j]
                            value += w[k] * w[l] * h * x
                            sums[3 * k + l] += u[row] * h * x
                            sums[12 + 3 * k + l] += ud[row] * h * x
            out[row] = value

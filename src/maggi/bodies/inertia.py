"""Inertia of a meshed body in a moving frame: for isotropic interpolations (T4) and for beams (T2, T3, T5a)."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numba import njit, prange
from numpy.typing import NDArray

from maggi.elements.beam import BeamTerms
from maggi.elements.moving_frame import InertiaConstants, contracted
from maggi.elements.products import mass_product
from maggi.linalg.vectors import cross

from .freedoms import Freedoms

Array = NDArray[np.float64]


class MeshInertia(Protocol):
    """What a meshed body's motion does to it, whatever its elements. u, u̇, ü are on the body's freedoms (nd,)."""

    mass: float
    S0: Array
    J0: Array
    matrix: sp.bsr_matrix  # M on the body's freedoms

    def residual(
        self, a_O: Array, w: Array, eps: Array, u: Array, ud: Array, udd: Array, nodal: Array, frame: Array
    ) -> None:
        """Inertia forces on the freedoms, `nodal` (nd,), and on the frame, `frame` (6,), set in place.

        a_O (3,): acceleration of the frame's origin less gravity, w, eps: body axes. Eq. T2, T5, T5a.
        """

    def frame_inertia(self, u: Array) -> tuple[Array, Array]:
        """First moment S (3,) and inertia J (3, 3) about the frame's origin, deformed; J to first order lumped in u²."""

    def kinetic_energy(self, v: Array, w: Array, u: Array, ud: Array) -> float:
        """Kinetic energy (J); v, w: the frame's twist, body axes."""

    def constants(self, basis: Array) -> InertiaConstants:
        """The constants of T3 and T5a for coordinates e that the freedoms follow, ``u = basis e``; basis (nd, n)."""


class IsotropicInertia:
    """T4: ``μ a`` with one nodal acceleration field, for every solid element."""

    def __init__(self, nodes: Array, mu: sp.csr_matrix, freedoms: Freedoms) -> None:
        self._mu = mu
        self._freedoms = freedoms
        self._nodes = np.ascontiguousarray(nodes)
        self._weights = np.asarray(mu.sum(axis=1)).ravel()
        self._mass_nodes = np.ascontiguousarray(mu @ nodes)
        self.mass = float(self._weights.sum())
        self.S0 = self._weights @ nodes
        second = nodes.T @ self._mass_nodes
        self.J0 = np.trace(second) * np.eye(3) - second
        block = sp.kron(mu, np.eye(3), format="bsr")
        self.matrix = freedoms.reduce_matrix(block)
        n = len(nodes)
        self._u, self._ud, self._udd = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
        self._field, self._force = np.empty((n, 3)), np.empty((n, 3))

    def residual(
        self, a_O: Array, w: Array, eps: Array, u: Array, ud: Array, udd: Array, nodal: Array, frame: Array
    ) -> None:
        u, ud, udd = self._expand(u, self._u), self._expand(ud, self._ud), self._expand(udd, self._udd)
        _acceleration_field(self._nodes, u, ud, udd, a_O, w, eps, self._field)
        mass_product(self._mu, self._field, self._force)
        _resultant(self._nodes, u, self._force, frame)
        self._freedoms.reduce(self._force, nodal)

    def frame_inertia(self, u: Array) -> tuple[Array, Array]:
        u = self._expand(u, self._u)
        S = self.S0 + self._weights @ u
        mixed = self._mass_nodes.T @ u
        second = mixed + mixed.T + (u.T * self._weights) @ u
        return S, self.J0 + np.trace(second) * np.eye(3) - second

    def kinetic_energy(self, v: Array, w: Array, u: Array, ud: Array) -> float:
        velocity = v + np.cross(w, self._nodes + self._expand(u, self._u)) + self._expand(ud, self._ud)
        return float(0.5 * np.sum(velocity * (self._mu @ velocity)))

    def constants(self, basis: Array) -> InertiaConstants:
        fields = self._freedoms.expand_many(basis)
        n = basis.shape[1]
        P, Q = np.empty((3, 3, n, n)), np.empty((3, 3, n))
        for i in range(3):
            component = np.ascontiguousarray(fields[:, i])
            Q[i] = self._mass_nodes.T @ component
            weighted = self._mu @ component
            for j in range(i, 3):
                P[j, i] = fields[:, j].T @ weighted
                P[i, j] = P[j, i].T
            P[i, i] = 0.5 * (P[i, i] + P[i, i].T)
        m_O = np.einsum("p,pia->ai", self._weights, fields)
        return contracted(np.array(self.mass), self.S0, self.J0, m_O, P, Q)

    def _expand(self, x: Array, out: Array) -> Array:
        return self._freedoms.expand(x, out)


class BeamInertia:
    """T2 with the assembled constants of T3, and T5a for the frame: beams, whose nodes also rotate."""

    def __init__(self, terms: BeamTerms) -> None:
        self.mass, self.S0, self.J0 = terms.mass, terms.S0, terms.J0
        self.matrix = terms.M
        self._m_O, self._s, self._s2 = terms.m_O, terms.s, terms.s2
        # All matrices stand on one graph, so that one pass over it serves all.
        self._indptr, self._indices = terms.M.indptr, terms.M.indices
        blocks = [terms.M, *terms.G, *(terms.H[k][l] for k in range(3) for l in range(3))]
        for block in blocks:
            if not np.array_equal(block.indices, self._indices):
                raise ValueError("the beam's matrices do not stand on one graph")
        self._blocks = np.ascontiguousarray(np.stack([block.data for block in blocks], axis=1))
        self._scalars = np.empty(21)

    def residual(
        self, a_O: Array, w: Array, eps: Array, u: Array, ud: Array, udd: Array, nodal: Array, frame: Array
    ) -> None:
        sums = self._scalars
        _beam_pass(self._indptr, self._indices, self._blocks, w, eps, u, ud, udd, nodal, sums)
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

    def frame_inertia(self, u: Array) -> tuple[Array, Array]:
        zero = np.zeros(3)
        scratch = np.empty_like(u)
        _beam_pass(self._indptr, self._indices, self._blocks, zero, zero, u, u, u, scratch, self._scalars)
        return self.S0 + self._m_O.T @ u, self._inertia(u, self._scalars[:9].reshape(3, 3))

    def kinetic_energy(self, v: Array, w: Array, u: Array, ud: Array) -> float:
        scratch = np.empty_like(u)
        zero = np.zeros(3)
        _beam_pass(self._indptr, self._indices, self._blocks, zero, zero, u, ud, ud, scratch, self._scalars)
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

    def _block_matrix(self, i: int) -> sp.bsr_matrix:
        """M, G_1 … G_3, H_11, H_12 … H_33 by number."""
        shape = self.matrix.shape
        return sp.bsr_matrix((np.ascontiguousarray(self._blocks[:, i]), self._indices, self._indptr), shape=shape)

    def _inertia(self, u: Array, quadratic: Array) -> Array:
        linear = self._s2 @ u
        return np.asarray(self.J0 - linear - linear.T - 0.5 * (quadratic + quadratic.T))


@njit(cache=True, parallel=True)
def _acceleration_field(X, u, ud, udd, a_O, w, eps, out):  # type: ignore[no-untyped-def]
    """a_n = a_O + ε × c + ω × (ω × c + 2 u̇) + ü, c = X + u (T4); gravity is in a_O."""
    w0, w1, w2 = w[0], w[1], w[2]
    e0, e1, e2 = eps[0], eps[1], eps[2]
    for n in prange(X.shape[0]):
        c0, c1, c2 = X[n, 0] + u[n, 0], X[n, 1] + u[n, 1], X[n, 2] + u[n, 2]
        y0 = w1 * c2 - w2 * c1 + 2.0 * ud[n, 0]
        y1 = w2 * c0 - w0 * c2 + 2.0 * ud[n, 1]
        y2 = w0 * c1 - w1 * c0 + 2.0 * ud[n, 2]
        out[n, 0] = a_O[0] + e1 * c2 - e2 * c1 + w1 * y2 - w2 * y1 + udd[n, 0]
        out[n, 1] = a_O[1] + e2 * c0 - e0 * c2 + w2 * y0 - w0 * y2 + udd[n, 1]
        out[n, 2] = a_O[2] + e0 * c1 - e1 * c0 + w0 * y1 - w1 * y0 + udd[n, 2]


@njit(cache=True)
def _resultant(X, u, force, out):  # type: ignore[no-untyped-def]
    """Resultant and moment about the frame's origin of nodal forces on the deformed body: Φ(c)ᵀ F."""
    f0 = f1 = f2 = m0 = m1 = m2 = 0.0
    for n in range(X.shape[0]):
        c0, c1, c2 = X[n, 0] + u[n, 0], X[n, 1] + u[n, 1], X[n, 2] + u[n, 2]
        x, y, z = force[n, 0], force[n, 1], force[n, 2]
        f0 += x
        f1 += y
        f2 += z
        m0 += c1 * z - c2 * y
        m1 += c2 * x - c0 * z
        m2 += c0 * y - c1 * x
    out[0], out[1], out[2], out[3], out[4], out[5] = f0, f1, f2, m0, m1, m2


@njit(cache=True)
def _beam_pass(indptr, indices, blocks, w, eps, u, ud, udd, out, sums):  # type: ignore[no-untyped-def]
    """out = m ü + 2 Σω_kG_k u̇ + Σ(ε_kG_k + Σ_l ω_kω_lH_kl) u; sums: uᵀH_klu, üᵀG_ku, u̇ᵀH_lku [l, k] (T2, T5a)."""
    sums[:] = 0.0
    for n in range(indptr.size - 1):
        for i in range(3):
            row = 3 * n + i
            value = 0.0
            for p in range(indptr[n], indptr[n + 1]):
                for j in range(3):
                    column = 3 * indices[p] + j
                    x, xd = u[column], ud[column]
                    value += blocks[p, 0, i, j] * udd[column]
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

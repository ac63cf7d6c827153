"""Inertia of a meshed body in a moving frame: for isotropic interpolations (T4) and for beams (T2, T3, T5a)."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numba import njit, prange
from numpy.typing import NDArray

from maggi.elements.beam import BeamTerms
from maggi.elements.moving_frame import InertiaConstants, contracted
from maggi.linalg.factor import Factor, factorise
from maggi.linalg.vectors import cross

from .freedoms import Freedoms
from .mean_axes import MeanAxes, RigidColumns

Array = NDArray[np.float64]

PARTS = 16  # of the nodes, summed separately so that sums do not depend on the number of threads


class MeshInertia(Protocol):
    """What a meshed body's motion does to it, whatever its elements. u, u̇, ü are on the body's freedoms (nd,)."""

    mass: float
    S0: Array
    J0: Array

    @property
    def matrix(self) -> sp.csr_matrix:
        """M on the body's freedoms, made anew each time."""

    def residual(
        self, a_O: Array, w: Array, eps: Array, u: Array, ud: Array, udd: Array, nodal: Array, frame: Array
    ) -> tuple[Array, Array]:
        """Inertia forces on the freedoms, `nodal` (nd,), and on the frame, `frame` (6,), set in place.

        a_O (3,): acceleration of the frame's origin less gravity, w, eps: body axes. Eq. T2, T5, T5a. Returns
        S and J as `frame_inertia` does; valid until the next call.
        """

    def multiply_mass(self, x: Array, out: Array) -> None:
        """``out = M x``, (nd,)."""

    def frame_inertia(self, u: Array) -> tuple[Array, Array]:
        """First moment S (3,) and inertia J (3, 3) about the frame's origin, deformed; J to first order lumped in u²."""

    def kinetic_energy(self, v: Array, w: Array, u: Array, ud: Array) -> float:
        """Kinetic energy (J); v, w: the frame's twist, body axes."""

    def constants(self, basis: Array) -> InertiaConstants:
        """The constants of T3 and T5a for coordinates e that the freedoms follow, ``u = basis e``; basis (nd, n)."""

    def factorised(self) -> Factor:
        """M, factorised."""

    def mean_axes(self, Phi: Array, C: Array, J6: Array) -> MeanAxes:
        """The projections by the rigid motions Phi (nd, 6) and C = M Phi."""


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
        self._mu = mu
        self._nodes = np.ascontiguousarray(nodes[self._order])
        self._weights = np.asarray(mu.sum(axis=1)).ravel()
        self._moments = np.ascontiguousarray(mu @ self._nodes)
        self.mass = float(self._weights.sum())
        self.S0 = self._moments.sum(axis=0)
        second = np.einsum("ni,nj->ij", self._nodes, self._moments)
        self.J0 = np.trace(second) * np.eye(3) - second
        self._starts = np.searchsorted(mu.indptr, np.linspace(0, mu.nnz, PARTS + 1)).astype(np.int64)
        self._starts[0], self._starts[-1] = 0, len(nodes)
        self._field = np.empty((len(nodes), 3))
        self._on_tied = np.empty((self._tied, 3))
        self._drive = np.empty(9)
        self._sums = np.zeros((PARTS, 6))
        self._moved = np.zeros(9)

    @property
    def matrix(self) -> sp.csr_matrix:
        """See `MeshInertia.matrix`."""
        mu, n, f = self._mu, self._mu.shape[0], self._free
        indptr, indices, data = _three_times(mu.indptr, mu.indices, mu.data)
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

    def residual(
        self, a_O: Array, w: Array, eps: Array, u: Array, ud: Array, udd: Array, nodal: Array, frame: Array
    ) -> tuple[Array, Array]:
        drive = self._drive
        drive[:3], drive[3:6], drive[6:] = a_O, w, eps
        self._accelerate(u, ud, udd)
        S, J = self._deformed()
        self._gather(u, nodal, frame)
        return S, J

    def multiply_mass(self, x: Array, out: Array) -> None:
        """See `MeshInertia.multiply_mass`."""
        self._drive[:] = 0.0
        self._accelerate(x, x, x)
        self._gather(x, out, np.empty(6))

    def frame_inertia(self, u: Array) -> tuple[Array, Array]:
        self._accelerate(u, u, u)
        return self._deformed()

    def _accelerate(self, u: Array, ud: Array, udd: Array) -> None:
        """The nodal accelerations of T4 for what `_drive` says of the frame, and the sums of S and J."""
        ties = self._freedoms
        _accelerations(
            self._drive,
            self._nodes,
            self._weights,
            self._moments,
            u.reshape(-1, 3),
            ud.reshape(-1, 3),
            udd.reshape(-1, 3),
            ties.master,
            ties.arm,
            self._field,
            self._moved,
        )

    def _gather(self, u: Array, nodal: Array, frame: Array) -> None:
        """The forces of these accelerations on the freedoms and on the frame."""
        mu, ties = self._mu, self._freedoms
        _inertia_forces(
            mu.indptr,
            mu.indices,
            mu.data,
            self._starts,
            self._field,
            self._nodes,
            u.reshape(-1, 3),
            ties.master,
            ties.arm,
            nodal.reshape(-1, 3),
            self._on_tied,
            frame,
            self._sums,
        )

    def _deformed(self) -> tuple[Array, Array]:
        """S and J from the sums ``Σ w u`` and the upper triangle of ``Σ (μX) uᵀ + u (μX)ᵀ + w u uᵀ``."""
        s = self._moved
        second = s[[3, 4, 5, 4, 6, 7, 5, 7, 8]].reshape(3, 3)
        return self.S0 + s[:3], self.J0 + (s[3] + s[6] + s[8]) * np.eye(3) - second

    def kinetic_energy(self, v: Array, w: Array, u: Array, ud: Array) -> float:
        velocity = v + np.cross(w, self._nodes + self._expand(u)) + self._expand(ud)
        return float(0.5 * np.sum(velocity * (self._mu @ velocity)))

    def constants(self, basis: Array) -> InertiaConstants:
        fields = self._freedoms.expand_many(basis)
        if self._tied:
            fields = fields[self._order]
        n = basis.shape[1]
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
        return _IsotropicFactor(factorise(free), self.matrix if self._tied else None)

    def mean_axes(self, Phi: Array, C: Array, J6: Array) -> MeanAxes:
        """See `MeshInertia.mean_axes`."""
        f = self._free
        return MeanAxes(
            RigidColumns.of(Phi, np.ones(f), self._nodes[:f]),
            RigidColumns.of(C, self._weights[:f], self._moments[:f]),
            J6,
        )

    def _expand(self, x: Array) -> Array:
        """Nodal field (n, 3) of the freedoms x, free nodes first."""
        field = self._freedoms.expand(x, np.empty_like(self._nodes))
        return field[self._order] if self._tied else field


class _IsotropicFactor:
    """M by the factor of the free nodes' scalar μ, three right sides for each, and a border of the attachments' freedoms.

    It has a ninth of the entries that a factor of M itself has.
    """

    def __init__(self, factor: Factor, matrix: sp.csr_matrix | None) -> None:
        self._factor = factor
        self._free = 3 * factor.order
        self.order = self._free if matrix is None else int(matrix.shape[0])
        self._border = self.order - self._free
        self.nbytes = factor.nbytes
        if matrix is not None:
            self._side = matrix[self._free :, : self._free].tocsr()
            self._response = self._interior(self._side.T.toarray())
            corner = matrix[self._free :, self._free :].toarray() - self._side @ self._response
            self._corner = np.linalg.inv(0.5 * (corner + corner.T))

    def solve(self, b: Array) -> Array:
        """See `Factor.solve`."""
        return self.solve_many(b[:, None])[:, 0].copy()

    def solve_many(self, B: Array) -> Array:
        """See `Factor.solve_many`."""
        x = self._interior(B[: self._free])
        if not self._border:
            return x
        y = self._corner @ (B[self._free :] - self._side @ x)
        return np.vstack([x - self._response @ y, y])

    def _interior(self, B: Array) -> Array:
        """μ⁻¹ of the components of fields (3f, k)."""
        k = B.shape[1]
        columns = np.ascontiguousarray(B).reshape(-1, 3 * k)
        return np.ascontiguousarray(self._factor.solve_many(columns)).reshape(-1, k)


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

    def residual(
        self, a_O: Array, w: Array, eps: Array, u: Array, ud: Array, udd: Array, nodal: Array, frame: Array
    ) -> tuple[Array, Array]:
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
        return S, J

    def multiply_mass(self, x: Array, out: Array) -> None:
        """See `MeshInertia.multiply_mass`."""
        out[:] = self.matrix @ x

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

    def factorised(self) -> Factor:
        """See `MeshInertia.factorised`."""
        return factorise(self.matrix)

    def mean_axes(self, Phi: Array, C: Array, J6: Array) -> MeanAxes:
        """See `MeshInertia.mean_axes`."""
        none = np.empty(0), np.empty((0, 3))
        return MeanAxes(RigidColumns.of(Phi, *none), RigidColumns.of(C, *none), J6)

    def _block_matrix(self, i: int) -> sp.bsr_matrix:
        """M, G_1 … G_3, H_11, H_12 … H_33 by number."""
        shape = self.matrix.shape
        return sp.bsr_matrix((np.ascontiguousarray(self._blocks[:, i]), self._indices, self._indptr), shape=shape)

    def _inertia(self, u: Array, quadratic: Array) -> Array:
        linear = self._s2 @ u
        return np.asarray(self.J0 - linear - linear.T - 0.5 * (quadratic + quadratic.T))


@njit(cache=True)
def _three_times(indptr, indices, data):  # type: ignore[no-untyped-def]
    """μ ⊗ I₃ as CSR arrays."""
    n = indptr.size - 1
    first, columns, values = np.empty(3 * n + 1, np.int32), np.empty(3 * data.size, np.int32), np.empty(3 * data.size)
    first[0] = 0
    filled = 0
    for row in range(n):
        for i in range(3):
            for p in range(indptr[row], indptr[row + 1]):
                columns[filled] = 3 * indices[p] + i
                values[filled] = data[p]
                filled += 1
            first[3 * row + i + 1] = filled
    return first, columns, values


@njit(cache=True)
def _at_node(drive, X, w, mX, u, ud, udd, out, sums):  # type: ignore[no-untyped-def]
    """T4 at one node, and its part in S and J."""
    w0, w1, w2 = drive[3], drive[4], drive[5]
    e0, e1, e2 = drive[6], drive[7], drive[8]
    u0, u1, u2 = u
    v0, v1, v2 = ud
    c0, c1, c2 = X[0] + u0, X[1] + u1, X[2] + u2
    y0 = w1 * c2 - w2 * c1 + 2.0 * v0
    y1 = w2 * c0 - w0 * c2 + 2.0 * v1
    y2 = w0 * c1 - w1 * c0 + 2.0 * v2
    out[0] = drive[0] + e1 * c2 - e2 * c1 + w1 * y2 - w2 * y1 + udd[0]
    out[1] = drive[1] + e2 * c0 - e0 * c2 + w2 * y0 - w0 * y2 + udd[1]
    out[2] = drive[2] + e0 * c1 - e1 * c0 + w0 * y1 - w1 * y0 + udd[2]
    m0, m1, m2 = mX[0], mX[1], mX[2]
    sums[0] += w * u0
    sums[1] += w * u1
    sums[2] += w * u2
    sums[3] += (2.0 * m0 + w * u0) * u0
    sums[4] += m0 * u1 + (m1 + w * u1) * u0
    sums[5] += m0 * u2 + (m2 + w * u2) * u0
    sums[6] += (2.0 * m1 + w * u1) * u1
    sums[7] += m1 * u2 + (m2 + w * u2) * u1
    sums[8] += (2.0 * m2 + w * u2) * u2


@njit(cache=True)
def _tied_value(x, block, arm):  # type: ignore[no-untyped-def]
    """d + θ × arm."""
    t0, t1, t2 = x[block + 1, 0], x[block + 1, 1], x[block + 1, 2]
    return (
        x[block, 0] + t1 * arm[2] - t2 * arm[1],
        x[block, 1] + t2 * arm[0] - t0 * arm[2],
        x[block, 2] + t0 * arm[1] - t1 * arm[0],
    )


@njit(cache=True)
def _accelerations(drive, X, weights, moments, u, ud, udd, master, arm, out, sums):  # type: ignore[no-untyped-def]
    """a_n = a_O + ε × c + ω × (ω × c + 2 u̇) + ü, c = X + u (T4), free nodes first; gravity is in a_O, drive (9,) is a_O, ω, ε.

    sums (9,): Σ w u and the upper triangle of Σ (μX) uᵀ + u (μX)ᵀ + w u uᵀ.
    """
    free = X.shape[0] - master.size
    sums[:] = 0.0
    for n in range(free):
        here = (u[n, 0], u[n, 1], u[n, 2]), (ud[n, 0], ud[n, 1], ud[n, 2]), (udd[n, 0], udd[n, 1], udd[n, 2])
        _at_node(drive, X[n], weights[n], moments[n], here[0], here[1], here[2], out[n], sums)
    for k in range(master.size):
        n, b, r = free + k, master[k], arm[k]
        tied = _tied_value(u, b, r), _tied_value(ud, b, r), _tied_value(udd, b, r)
        _at_node(drive, X[n], weights[n], moments[n], tied[0], tied[1], tied[2], out[n], sums)


@njit(cache=True, parallel=True, fastmath={"contract"})
def _inertia_forces(  # type: ignore[no-untyped-def]
    indptr, indices, values, starts, a, X, u, master, arm, nodal, on_tied, frame, sums
):
    """F = μ a, gathered on the freedoms' blocks, nodal (b, 3), and on the frame: resultant and moment Φ(c)ᵀ F, (6,)."""
    parts = sums.shape[0]
    free = X.shape[0] - master.size
    for part in prange(parts):
        f0 = f1 = f2 = m0 = m1 = m2 = 0.0
        for n in range(starts[part], starts[part + 1]):
            y0 = y1 = y2 = 0.0
            for p in range(indptr[n], indptr[n + 1]):
                m, value = np.uint32(indices[p]), values[p]  # unsigned: no look for places from the end
                y0 += value * a[m, 0]
                y1 += value * a[m, 1]
                y2 += value * a[m, 2]
            if n >= free:
                on_tied[n - free, 0], on_tied[n - free, 1], on_tied[n - free, 2] = y0, y1, y2
                continue
            nodal[n, 0], nodal[n, 1], nodal[n, 2] = y0, y1, y2
            c0, c1, c2 = X[n, 0] + u[n, 0], X[n, 1] + u[n, 1], X[n, 2] + u[n, 2]
            f0 += y0
            f1 += y1
            f2 += y2
            m0 += c1 * y2 - c2 * y1
            m1 += c2 * y0 - c0 * y2
            m2 += c0 * y1 - c1 * y0
        sums[part, 0], sums[part, 1], sums[part, 2] = f0, f1, f2
        sums[part, 3], sums[part, 4], sums[part, 5] = m0, m1, m2
    for i in range(6):
        total = 0.0
        for part in range(parts):
            total += sums[part, i]
        frame[i] = total
    for b in range(free, nodal.shape[0]):
        nodal[b, :] = 0.0
    for k in range(master.size):
        n, b, r = free + k, master[k], arm[k]
        x, y, z = on_tied[k, 0], on_tied[k, 1], on_tied[k, 2]
        u0, u1, u2 = _tied_value(u, b, r)
        c0, c1, c2 = X[n, 0] + u0, X[n, 1] + u1, X[n, 2] + u2
        frame[0] += x
        frame[1] += y
        frame[2] += z
        frame[3] += c1 * z - c2 * y
        frame[4] += c2 * x - c0 * z
        frame[5] += c0 * y - c1 * x
        nodal[b, 0] += x
        nodal[b, 1] += y
        nodal[b, 2] += z
        nodal[b + 1, 0] += r[1] * z - r[2] * y
        nodal[b + 1, 1] += r[2] * x - r[0] * z
        nodal[b + 1, 2] += r[0] * y - r[1] * x


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

"""Compiled terms of bodies of few coordinates, of which rigid ones have none (Eq. T2, T3, T5a)."""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.linalg.small import REORDERED, inner, multiply

from .tables import Array, BodyTable, MotionState


@njit(cache=True)
def turned_shapes(table: BodyTable, b: int, delta: Array, s2: Array, out: Array) -> None:
    """out (3, 3, n) = s_kl + H_kl δ of a Ritz body: the products that all terms of second order in ω take (Eq. T3)."""
    n = delta.shape[0]
    q = table.ritz_square[b]
    H = table.H[9 * q : 9 * (q + n * n)].reshape(3, 3, n, n)
    for k in range(3):
        for l in range(3):
            multiply(H[k, l], delta, out[k, l])
            for i in range(n):
                out[k, l, i] += s2[k, l, i]


@njit(cache=True)
def swept_shapes(table: BodyTable, b: int, delta: Array, out: Array) -> None:
    """out (3, n) = s_k + G_k δ of a Ritz body: what couples turning frame and coordinates (Eq. T3)."""
    n = delta.shape[0]
    c = table.ritz[b]
    q = table.ritz_square[b]
    s = table.s[3 * c : 3 * (c + n)].reshape(3, n)
    G = table.G[3 * q : 3 * (q + n * n)].reshape(3, n, n)
    for k in range(3):
        multiply(G[k], delta, out[k])
        for i in range(n):
            out[k, i] += s[k, i]


@njit(cache=True)
def _shape_inertia(table: BodyTable, b: int, delta: Array, s2: Array, turned: Array, S: Array, J: Array) -> None:
    """First moment S = S₀ + m_Oᵀδ and inertia J_kl = J0_kl − δᵀ(s_kl + s_lk) − δᵀH_klδ about the origin (Eq. T5a)."""
    n = delta.shape[0]
    c = table.ritz[b]
    m_O = table.m_O[3 * c : 3 * (c + n)].reshape(n, 3)
    for k in range(3):
        value = table.S0[b, k]
        for i in range(n):
            value += m_O[i, k] * delta[i]
        S[k] = value
        for l in range(3):
            J[k, l] = table.J0[b, k, l] - inner(delta, turned[k, l]) - inner(delta, s2[l, k])


@njit(cache=True)
def deformed_inertia(table: BodyTable, b: int, delta: Array, S: Array, J: Array) -> None:
    """First moment S and inertia J about the origin of a rigid or Ritz body in its present shape (Eq. T5a)."""
    n = delta.shape[0]
    if n == 0:
        for k in range(3):
            S[k] = table.S0[b, k]
            for l in range(3):
                J[k, l] = table.J0[b, k, l]
        return
    c = table.ritz[b]
    s2 = table.s2[9 * c : 9 * (c + n)].reshape(3, 3, n)
    turned = np.empty((3, 3, n))
    turned_shapes(table, b, delta, s2, turned)
    _shape_inertia(table, b, delta, s2, turned, S, J)


@njit(cache=True)
def frame_mass(table: BodyTable, b: int, delta: Array, mass: Array, coupling: Array) -> None:
    """The frame's part of the mass matrix about the present shape: mass (6, 6), coupling (6, n) (Eq. T5a)."""
    n = delta.shape[0]
    S = np.empty(3)
    J = np.empty((3, 3))
    deformed_inertia(table, b, delta, S, J)
    mass[:, :] = 0.0
    for k in range(3):
        mass[k, k] = table.mass[b]
        for l in range(3):
            mass[3 + k, 3 + l] = J[k, l]
    # m v̇ + ε × S
    mass[0, 4] = S[2]
    mass[0, 5] = -S[1]
    mass[1, 3] = -S[2]
    mass[1, 5] = S[0]
    mass[2, 3] = S[1]
    mass[2, 4] = -S[0]
    for k in range(3):
        for l in range(3):
            mass[3 + l, k] = mass[k, 3 + l]
    if n == 0:
        return
    c = table.ritz[b]
    m_O = table.m_O[3 * c : 3 * (c + n)].reshape(n, 3)
    for k in range(3):
        for i in range(n):
            coupling[k, i] = m_O[i, k]
    swept_shapes(table, b, delta, coupling[3:])


@njit(cache=True)
def mass_matrix(table: BodyTable, b: int, delta: Array, out: Array) -> None:
    """The (6 + n)² mass matrix of a rigid or Ritz body on (v, ω, δ̇), about its current shape (Eq. T5a)."""
    n = delta.shape[0]
    coupling = np.empty((6, n))
    frame_mass(table, b, delta, out[:6, :6], coupling)
    q = table.ritz_square[b]
    for i in range(n):
        for k in range(6):
            out[k, 6 + i] = coupling[k, i]
            out[6 + i, k] = coupling[k, i]
        for j in range(n):
            out[6 + i, 6 + j] = table.m[q + i * n + j]


@njit(cache=True, fastmath=REORDERED)
def _relative_forces(
    m: Array, stiffness: Array, D: Array, G: Array, w: Array, delta: Array, rate: Array, acceleration: Array, out: Array
) -> None:
    """Add m δ̈ + 2 Σ ω_k G_k δ̇ + k δ + D δ̇ to out (n,) (Eq. T2)."""
    x, y, z = 2.0 * w[0], 2.0 * w[1], 2.0 * w[2]
    for i in range(delta.shape[0]):
        value = 0.0
        for j in range(delta.shape[0]):
            value += (
                m[i, j] * acceleration[j]
                + stiffness[i, j] * delta[j]
                + (D[i, j] + x * G[0, i, j] + y * G[1, i, j] + z * G[2, i, j]) * rate[j]
            )
        out[i] += value


@njit(cache=True)
def inertia_residual(table: BodyTable, b: int, state: MotionState, gravity: Array, out: Array) -> None:
    """Inertia, gravity, elastic and damping forces of a rigid or Ritz body, `out` (6 + n) (Eq. T2, T5a).

    The unconstrained Maggi vector with the sign of ``M v̇ + …``: external and liaison forces are not in it.
    """
    o = table.offset[b]
    n = table.offset[b + 1] - o - 6
    R = state.rotation[b]
    v = state.v[o : o + 6]
    z = state.vd[o : o + 6]
    w = v[3:6]
    eps = z[3:6]
    a = np.empty(3)
    # a_O − Rᵀg: gravity enters as an acceleration of the frame
    a[0] = z[0] + w[1] * v[2] - w[2] * v[1]
    a[1] = z[1] + w[2] * v[0] - w[0] * v[2]
    a[2] = z[2] + w[0] * v[1] - w[1] * v[0]
    for k in range(3):
        a[k] -= R[0, k] * gravity[0] + R[1, k] * gravity[1] + R[2, k] * gravity[2]
    S = np.empty(3)
    J = np.empty((3, 3))
    if n == 0:
        deformed_inertia(table, b, state.e[o:o], S, J)
        _frame_forces(table.mass[b], S, J, a, w, eps, out)
        return
    delta = state.e[o + 6 : o + 6 + n]
    rate = state.v[o + 6 : o + 6 + n]
    acceleration = state.vd[o + 6 : o + 6 + n]
    c = table.ritz[b]
    q = table.ritz_square[b]
    m_O = table.m_O[3 * c : 3 * (c + n)].reshape(n, 3)
    s2 = table.s2[9 * c : 9 * (c + n)].reshape(3, 3, n)
    turned = np.empty((3, 3, n))
    swept = np.empty((3, n))
    turned_shapes(table, b, delta, s2, turned)
    swept_shapes(table, b, delta, swept)
    _shape_inertia(table, b, delta, s2, turned, S, J)
    _frame_forces(table.mass[b], S, J, a, w, eps, out)
    # frame: 2 ω × m_Oᵀδ̇ + m_Oᵀδ̈ and (s_k + G_kδ)·δ̈ − 2 Σ_l ω_l (s_lk + H_lkδ)·δ̇
    pd = np.zeros(3)
    for i in range(n):
        for k in range(3):
            pd[k] += m_O[i, k] * rate[i]
            out[k] += m_O[i, k] * acceleration[i]
    out[0] += 2.0 * (w[1] * pd[2] - w[2] * pd[1])
    out[1] += 2.0 * (w[2] * pd[0] - w[0] * pd[2])
    out[2] += 2.0 * (w[0] * pd[1] - w[1] * pd[0])
    for k in range(3):
        value = inner(swept[k], acceleration)
        for l in range(3):
            value -= 2.0 * w[l] * inner(turned[l, k], rate)
        out[3 + k] += value
    # coordinates: m_O a_O + Σ ε_k (s_k + G_kδ) + Σ ω_kω_l (s_kl + H_klδ) and what is relative to the frame
    for i in range(n):
        value = 0.0
        for k in range(3):
            value += m_O[i, k] * a[k] + eps[k] * swept[k, i]
            for l in range(3):
                value += w[k] * w[l] * turned[k, l, i]
        out[6 + i] = value
    m = table.m[q : q + n * n].reshape(n, n)
    stiffness = table.k[q : q + n * n].reshape(n, n)
    D = table.D[q : q + n * n].reshape(n, n)
    G = table.G[3 * q : 3 * (q + n * n)].reshape(3, n, n)
    _relative_forces(m, stiffness, D, G, w, delta, rate, acceleration, out[6:])


@njit(cache=True)
def _frame_forces(mass: float, S: Array, J: Array, a: Array, w: Array, eps: Array, out: Array) -> None:
    """Force and moment that the body as it stands asks of its frame, set in out[:6] (Eq. T5a)."""
    # force: m a_O + ε × S + ω × (ω × S)
    y0 = w[1] * S[2] - w[2] * S[1]
    y1 = w[2] * S[0] - w[0] * S[2]
    y2 = w[0] * S[1] - w[1] * S[0]
    out[0] = mass * a[0] + eps[1] * S[2] - eps[2] * S[1] + w[1] * y2 - w[2] * y1
    out[1] = mass * a[1] + eps[2] * S[0] - eps[0] * S[2] + w[2] * y0 - w[0] * y2
    out[2] = mass * a[2] + eps[0] * S[1] - eps[1] * S[0] + w[0] * y1 - w[1] * y0
    # moment: S × a_O + J ε + ω × J ω
    h0 = J[0, 0] * w[0] + J[0, 1] * w[1] + J[0, 2] * w[2]
    h1 = J[1, 0] * w[0] + J[1, 1] * w[1] + J[1, 2] * w[2]
    h2 = J[2, 0] * w[0] + J[2, 1] * w[1] + J[2, 2] * w[2]
    out[3] = S[1] * a[2] - S[2] * a[1] + w[1] * h2 - w[2] * h1
    out[4] = S[2] * a[0] - S[0] * a[2] + w[2] * h0 - w[0] * h2
    out[5] = S[0] * a[1] - S[1] * a[0] + w[0] * h1 - w[1] * h0
    for k in range(3):
        out[3 + k] += J[k, 0] * eps[0] + J[k, 1] * eps[1] + J[k, 2] * eps[2]

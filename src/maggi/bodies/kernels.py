"""Compiled kinematics of attachments and unconstrained terms of rigid and Ritz bodies (Eq. T2, T3, T5a)."""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.linalg.rotations import exp_se3_update, exp_so3, left_tangent, left_tangent_rates

from .tables import FIXED, RIGID, RITZ, Array, AttachmentState, BodyTable, MotionState

# Sums may be taken in any order, so that several entries are multiplied at once.
REORDERED = {"reassoc", "contract"}


@njit(cache=True, fastmath=REORDERED)
def multiply(matrix: Array, x: Array, out: Array) -> None:
    """out (n,) = matrix (n, n) x."""
    for i in range(x.shape[0]):
        value = 0.0
        for j in range(x.shape[0]):
            value += matrix[i, j] * x[j]
        out[i] = value


@njit(cache=True, fastmath=REORDERED)
def inner(x: Array, y: Array) -> float:
    """x · y."""
    value = 0.0
    for i in range(x.shape[0]):
        value += x[i] * y[i]
    return value


@njit(cache=True)
def add_multiple(factor: float, x: Array, out: Array) -> None:
    """out += factor · x."""
    for i in range(x.shape[0]):
        out[i] += factor * x[i]


@njit(cache=True, error_model="numpy")
def attachment_motion(table: BodyTable, state: MotionState, out: AttachmentState) -> None:
    """Position, rotation, velocities and accelerations of every attachment, exactly (Theory §3)."""
    for a in range(table.attachment_body.shape[0]):
        move_attachment(table, a, state, out)


@njit(cache=True, error_model="numpy")
def move_attachment(table: BodyTable, a: int, state: MotionState, out: AttachmentState) -> None:
    """One attachment of `attachment_motion`.

    A point at X + d turned by exp(θ~) in the body, (d, θ) = Ψ e:
    p = r + R(X + d),  velocity R(v + ω × c + ḋ),  angular velocity R(ω + T_l(θ) θ̇), and their rates.
    """
    b = table.attachment_body[a]
    o = table.offset[b]
    n = table.offset[b + 1] - o - 6
    R = state.rotation[b]
    rotation = out.rotation[a]
    c0, c1, c2 = table.attachment_point[a, 0], table.attachment_point[a, 1], table.attachment_point[a, 2]
    if n < 0:  # ground does not move
        point = table.attachment_point[a]
        for i in range(3):
            out.arm[a, i] = point[i]
            out.position[a, i] = point[i]
            for j in range(3):
                rotation[i, j] = R[i, j]
        return
    velocity, rate = state.v, state.vd
    # velocity and acceleration of the point in body axes; a_O = v̇ + ω × v
    v0, v1, v2 = velocity[o], velocity[o + 1], velocity[o + 2]
    o0, o1, o2 = velocity[o + 3], velocity[o + 4], velocity[o + 5]
    e0, e1, e2 = rate[o + 3], rate[o + 4], rate[o + 5]
    u0 = u1 = u2 = 0.0
    q0 = q1 = q2 = 0.0
    l0 = l1 = l2 = 0.0
    m0 = m1 = m2 = 0.0
    if n > 0:
        d = out.scratch[0]
        w = out.scratch[1]
        relative = out.scratch[2][:9].reshape(3, 3)
        _elastic_motion(table, a, o + 6, n, state, d)
        c0 += d[0]
        c1 += d[1]
        c2 += d[2]
        u0, u1, u2 = d[6], d[7], d[8]
        q0, q1, q2 = d[12], d[13], d[14]
        left_tangent_rates(d[3:6], d[9:12], d[15:18], w[:3], w[3:6])
        l0, l1, l2 = w[0], w[1], w[2]
        # rate of R w: R(ẇ + ω × w)
        m0 = w[3] + o1 * l2 - o2 * l1
        m1 = w[4] + o2 * l0 - o0 * l2
        m2 = w[5] + o0 * l1 - o1 * l0
        exp_so3(d[3:6], relative)
        left_tangent(d[3:6], out.tangent[a])
        for i in range(3):
            for j in range(3):
                rotation[i, j] = R[i, 0] * relative[0, j] + R[i, 1] * relative[1, j] + R[i, 2] * relative[2, j]
    elif table.attachment_turned[a] == 1:
        axes = table.attachment_axes[a]
        for i in range(3):
            for j in range(3):
                rotation[i, j] = R[i, 0] * axes[0, j] + R[i, 1] * axes[1, j] + R[i, 2] * axes[2, j]
    else:
        for i in range(3):
            for j in range(3):
                rotation[i, j] = R[i, j]
    arm = out.arm[a]
    arm[0] = c0
    arm[1] = c1
    arm[2] = c2
    # ω × c
    x0 = o1 * c2 - o2 * c1
    x1 = o2 * c0 - o0 * c2
    x2 = o0 * c1 - o1 * c0
    b0 = v0 + x0 + u0
    b1 = v1 + x1 + u1
    b2 = v2 + x2 + u2
    # a_O + ε × c + ω × (ω × c) + 2 ω × ḋ + d̈, with ω × (v + ω × c + ḋ) + ω × ḋ collected
    y0 = v0 + x0 + 2.0 * u0
    y1 = v1 + x1 + 2.0 * u1
    y2 = v2 + x2 + 2.0 * u2
    a0 = rate[o] + e1 * c2 - e2 * c1 + o1 * y2 - o2 * y1 + q0
    a1 = rate[o + 1] + e2 * c0 - e0 * c2 + o2 * y0 - o0 * y2 + q1
    a2 = rate[o + 2] + e0 * c1 - e1 * c0 + o0 * y1 - o1 * y0 + q2
    for i in range(3):
        r0, r1, r2 = R[i, 0], R[i, 1], R[i, 2]
        out.position[a, i] = state.origin[b, i] + r0 * c0 + r1 * c1 + r2 * c2
        out.velocity[a, i] = r0 * b0 + r1 * b1 + r2 * b2
        out.acceleration[a, i] = r0 * a0 + r1 * a1 + r2 * a2
        out.angular_velocity[a, i] = r0 * (o0 + l0) + r1 * (o1 + l1) + r2 * (o2 + l2)
        out.angular_acceleration[a, i] = r0 * (e0 + m0) + r1 * (e1 + m1) + r2 * (e2 + m2)


@njit(cache=True, error_model="numpy")
def _elastic_motion(table: BodyTable, a: int, first: int, n: int, state: MotionState, out: Array) -> None:
    """(d, θ) = Ψ e, its rate and its acceleration, to out (18,)."""
    p = table.psi_offset[a]
    psi, e, v, vd = table.psi, state.e, state.v, state.vd
    for i in range(6):
        x = 0.0
        xd = 0.0
        xdd = 0.0
        for j in range(n):
            s = psi[p + i * n + j]
            if s != 0.0:
                x += s * e[first + j]
                xd += s * v[first + j]
                xdd += s * vd[first + j]
        out[i] = x
        out[6 + i] = xd
        out[12 + i] = xdd


@njit(cache=True)
def generalised_force(
    table: BodyTable,
    state: MotionState,
    attachments: AttachmentState,
    a: int,
    f0: float,
    f1: float,
    f2: float,
    m0: float,
    m1: float,
    m2: float,
    out: Array,
) -> None:
    """Add Jᵀ(f, m) to `out` (6 + n_e): a global force and moment at attachment a in its body's small coordinates.

    The same map turns a liaison row's coefficients on an attachment's twist into its coefficients on the
    body's velocities, since J takes those velocities to the twist (Eq. T7).
    """
    if out.shape[0] == 0:
        return  # ground has no velocities
    b = table.attachment_body[a]
    n = table.offset[b + 1] - table.offset[b] - 6
    R = state.rotation[b]
    c = attachments.arm[a]
    b0 = R[0, 0] * f0 + R[1, 0] * f1 + R[2, 0] * f2
    b1 = R[0, 1] * f0 + R[1, 1] * f1 + R[2, 1] * f2
    b2 = R[0, 2] * f0 + R[1, 2] * f1 + R[2, 2] * f2
    t0 = R[0, 0] * m0 + R[1, 0] * m1 + R[2, 0] * m2
    t1 = R[0, 1] * m0 + R[1, 1] * m1 + R[2, 1] * m2
    t2 = R[0, 2] * m0 + R[1, 2] * m1 + R[2, 2] * m2
    out[0] += b0
    out[1] += b1
    out[2] += b2
    out[3] += c[1] * b2 - c[2] * b1 + t0
    out[4] += c[2] * b0 - c[0] * b2 + t1
    out[5] += c[0] * b1 - c[1] * b0 + t2
    if n > 0:
        T = attachments.tangent[a]
        s0 = T[0, 0] * t0 + T[1, 0] * t1 + T[2, 0] * t2
        s1 = T[0, 1] * t0 + T[1, 1] * t1 + T[2, 1] * t2
        s2 = T[0, 2] * t0 + T[1, 2] * t1 + T[2, 2] * t2
        p = table.psi_offset[a]
        for j in range(n):
            out[6 + j] += (
                table.psi[p + j] * b0
                + table.psi[p + n + j] * b1
                + table.psi[p + 2 * n + j] * b2
                + table.psi[p + 3 * n + j] * s0
                + table.psi[p + 4 * n + j] * s1
                + table.psi[p + 5 * n + j] * s2
            )


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


@njit(cache=True)
def small_body_energy(table: BodyTable, state: MotionState, gravity: Array, out: Array) -> None:
    """Add kinetic, strain and gravity energy (J) and dissipated power (W) of rigid and Ritz bodies to out (4,)."""
    for b in range(table.kind.shape[0]):
        if table.kind[b] != RIGID and table.kind[b] != RITZ:
            continue
        o = table.offset[b]
        size = table.offset[b + 1] - o
        n = size - 6
        delta = state.e[o + 6 : o + size]
        M = np.empty((size, size))
        mass_matrix(table, b, delta, M)
        v = state.v[o : o + size]
        for i in range(size):
            for j in range(size):
                out[0] += 0.5 * v[i] * M[i, j] * v[j]
        S = np.empty(3)
        J = np.empty((3, 3))
        deformed_inertia(table, b, delta, S, J)
        R = state.rotation[b]
        for k in range(3):
            x = table.mass[b] * state.origin[b, k] + R[k, 0] * S[0] + R[k, 1] * S[1] + R[k, 2] * S[2]
            out[2] -= gravity[k] * x
        if n > 0:
            q = table.ritz_square[b]
            for i in range(n):
                for j in range(n):
                    out[1] += 0.5 * delta[i] * table.k[q + i * n + j] * delta[j]
                    out[3] += v[6 + i] * table.D[q + i * n + j] * v[6 + j]


@njit(cache=True)
def move(bodies: BodyTable, now: MotionState, increment: Array, out: MotionState) -> None:
    """q₁ = q₀ ∘ exp(Δq): frames on SE(3), elastic coordinates additively."""
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED:
            continue
        o = bodies.offset[b]
        for i in range(o + 6, bodies.offset[b + 1]):
            out.e[i] = now.e[i] + increment[i]
        if bodies.floating[b] == 1:
            exp_se3_update(
                now.rotation[b],
                now.origin[b],
                increment[o : o + 3],
                increment[o + 3 : o + 6],
                out.rotation[b],
                out.origin[b],
            )

"""Compiled kinematics of bodies and attachments: motions, forces on them, moves of frames (Theory §3)."""

from __future__ import annotations

from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.rotations import exp_se3_update, exp_so3, left_tangent, left_tangent_rates

from .tables import FIXED, Array, AttachmentState, BodyTable, MotionState


@kernel
def attachment_motion(table: BodyTable, state: MotionState, out: AttachmentState) -> None:
    """Position, rotation, velocities and accelerations of every attachment, exactly (Theory §3)."""
    for a in range(table.attachment_body.shape[0]):
        move_attachment(table, a, state, out)


@inner_kernel
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


@inner_kernel
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


@kernel
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


@kernel
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

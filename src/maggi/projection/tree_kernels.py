"""Compiled passes over a tree of rigid bodies: motion outwards, forces inwards, the factor Sᵀ M S = L D Lᵀ (Eq. T8–T10).

S takes the joints' free motions ν to the bodies' twists; it is never formed. A joint's free motions are components of its
body's twist, so that eliminating them from a 6 × 6 matrix is the whole projection at that joint.
"""

from __future__ import annotations

import math

from maggi.bodies.tables import Array, BodyTable, IntArray, MotionState
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.rotations import exp_se3_update

from .tree_tables import PRISMATIC, REVOLUTE, JointPoses, Tree, TreeWork


@inner_kernel
def place_joint(tree: Tree, x: int, now: JointPoses, increment: Array, following: JointPoses, work: TreeWork) -> None:
    """The pose of joint x after an increment of its free motions, and of its body in the carrier's frame."""
    s = tree.free_start[x]
    out, R, arm = tree.out_rotation[x], work.rotation[x], work.arm[x]
    kind = tree.pair[x]
    for i in range(3):
        arm[i] = tree.out_position[x, i]
    if kind == REVOLUTE:
        angle = now.value[x] + increment[s]
        following.value[x] = angle
        sine, cosine = math.sin(angle), math.cos(angle)
        for i in range(3):
            a, b = out[i, 0], out[i, 1]
            R[i, 0] = cosine * a + sine * b
            R[i, 1] = cosine * b - sine * a
            R[i, 2] = out[i, 2]
        return
    if kind == PRISMATIC:
        shift = now.value[x] + increment[s]
        following.value[x] = shift
        for i in range(3):
            arm[i] += out[i, 2] * shift
            for j in range(3):
                R[i, j] = out[i, j]
        return
    step = work.twist[x]
    for i in range(6):
        step[i] = 0.0
    for d in range(s, tree.free_start[x + 1]):
        step[tree.free[d]] = increment[d]
    following.value[x] = now.value[x] + step[5]
    turn, shift_to = following.rotation[x], following.position[x]
    exp_se3_update(now.rotation[x], now.position[x], step[:3], step[3:], turn, shift_to)
    for i in range(3):
        a, b, c = out[i, 0], out[i, 1], out[i, 2]
        arm[i] += a * shift_to[0] + b * shift_to[1] + c * shift_to[2]
        for j in range(3):
            R[i, j] = a * turn[0, j] + b * turn[1, j] + c * turn[2, j]


@kernel
def tree_motion(
    tree: Tree,
    bodies: BodyTable,
    now: JointPoses,
    increment: Array,
    nu: Array,
    nud: Array,
    following: JointPoses,
    work: TreeWork,
    motion: MotionState,
) -> None:
    """Poses, twists and their rates of all tree bodies from the joints' free motions, outwards.

    τ = X τ_p + S ν,  τ̇ = X τ̇_p + S ν̇ + ad(τ) S ν, with S constant, in the body's frame.
    """
    body, parent, free_start, free = tree.body, tree.parent, tree.free_start, tree.free
    offset = bodies.offset
    origin, rotation, velocity, rate = motion.origin, motion.rotation, motion.v, motion.vd
    relative, arms = work.rotation, work.arm
    for x in range(body.shape[0]):
        place_joint(tree, x, now, increment, following, work)
        b = body[x]
        o = offset[b]
        Q = relative[x]
        R = rotation[b]
        p = parent[x]
        if p < 0:
            for i in range(3):
                origin[b, i] = arms[x, i]
                for j in range(3):
                    R[i, j] = Q[i, j]
            v0 = v1 = v2 = w0 = w1 = w2 = 0.0
            a0 = a1 = a2 = e0 = e1 = e2 = 0.0
        else:
            c = body[p]
            k = offset[c]
            P = rotation[c]
            r0, r1, r2 = arms[x, 0], arms[x, 1], arms[x, 2]
            for i in range(3):
                p0, p1, p2 = P[i, 0], P[i, 1], P[i, 2]
                origin[b, i] = origin[c, i] + p0 * r0 + p1 * r1 + p2 * r2
                R[i, 0] = p0 * Q[0, 0] + p1 * Q[1, 0] + p2 * Q[2, 0]
                R[i, 1] = p0 * Q[0, 1] + p1 * Q[1, 1] + p2 * Q[2, 1]
                R[i, 2] = p0 * Q[0, 2] + p1 * Q[1, 2] + p2 * Q[2, 2]
            u0, u1, u2 = velocity[k + 3], velocity[k + 4], velocity[k + 5]
            q0 = velocity[k] + u1 * r2 - u2 * r1
            q1 = velocity[k + 1] + u2 * r0 - u0 * r2
            q2 = velocity[k + 2] + u0 * r1 - u1 * r0
            v0 = Q[0, 0] * q0 + Q[1, 0] * q1 + Q[2, 0] * q2
            v1 = Q[0, 1] * q0 + Q[1, 1] * q1 + Q[2, 1] * q2
            v2 = Q[0, 2] * q0 + Q[1, 2] * q1 + Q[2, 2] * q2
            w0 = Q[0, 0] * u0 + Q[1, 0] * u1 + Q[2, 0] * u2
            w1 = Q[0, 1] * u0 + Q[1, 1] * u1 + Q[2, 1] * u2
            w2 = Q[0, 2] * u0 + Q[1, 2] * u1 + Q[2, 2] * u2
            u0, u1, u2 = rate[k + 3], rate[k + 4], rate[k + 5]
            q0 = rate[k] + u1 * r2 - u2 * r1
            q1 = rate[k + 1] + u2 * r0 - u0 * r2
            q2 = rate[k + 2] + u0 * r1 - u1 * r0
            a0 = Q[0, 0] * q0 + Q[1, 0] * q1 + Q[2, 0] * q2
            a1 = Q[0, 1] * q0 + Q[1, 1] * q1 + Q[2, 1] * q2
            a2 = Q[0, 2] * q0 + Q[1, 2] * q1 + Q[2, 2] * q2
            e0 = Q[0, 0] * u0 + Q[1, 0] * u1 + Q[2, 0] * u2
            e1 = Q[0, 1] * u0 + Q[1, 1] * u1 + Q[2, 1] * u2
            e2 = Q[0, 2] * u0 + Q[1, 2] * u1 + Q[2, 2] * u2
        s = free_start[x]
        if tree.pair[x] == REVOLUTE:
            n = nu[s]
            w2 += n
            velocity[o], velocity[o + 1], velocity[o + 2] = v0, v1, v2
            velocity[o + 3], velocity[o + 4], velocity[o + 5] = w0, w1, w2
            rate[o], rate[o + 1], rate[o + 2] = a0 + n * v1, a1 - n * v0, a2
            rate[o + 3], rate[o + 4], rate[o + 5] = e0 + n * w1, e1 - n * w0, e2 + nud[s]
            continue
        velocity[o], velocity[o + 1], velocity[o + 2] = v0, v1, v2
        velocity[o + 3], velocity[o + 4], velocity[o + 5] = w0, w1, w2
        rate[o], rate[o + 1], rate[o + 2] = a0, a1, a2
        rate[o + 3], rate[o + 4], rate[o + 5] = e0, e1, e2
        step = work.twist[x]
        for i in range(6):
            step[i] = 0.0
        for d in range(s, free_start[x + 1]):
            i = free[d]
            step[i] = nu[d]
            velocity[o + i] += nu[d]
            rate[o + i] += nud[d]
        # ad(τ) Sν
        v0, v1, v2 = velocity[o], velocity[o + 1], velocity[o + 2]
        w0, w1, w2 = velocity[o + 3], velocity[o + 4], velocity[o + 5]
        q0, q1, q2, u0, u1, u2 = step[0], step[1], step[2], step[3], step[4], step[5]
        rate[o] += w1 * q2 - w2 * q1 + v1 * u2 - v2 * u1
        rate[o + 1] += w2 * q0 - w0 * q2 + v2 * u0 - v0 * u2
        rate[o + 2] += w0 * q1 - w1 * q0 + v0 * u1 - v1 * u0
        rate[o + 3] += w1 * u2 - w2 * u1
        rate[o + 4] += w2 * u0 - w0 * u2
        rate[o + 5] += w0 * u1 - w1 * u0


@inner_kernel
def carry_force(Q: Array, arm: Array, f: Array, out: Array) -> None:
    """Add to out (6,) a force and moment f (6,) on a body as felt in its carrier's frame."""
    g0 = Q[0, 0] * f[0] + Q[0, 1] * f[1] + Q[0, 2] * f[2]
    g1 = Q[1, 0] * f[0] + Q[1, 1] * f[1] + Q[1, 2] * f[2]
    g2 = Q[2, 0] * f[0] + Q[2, 1] * f[1] + Q[2, 2] * f[2]
    out[0] += g0
    out[1] += g1
    out[2] += g2
    out[3] += Q[0, 0] * f[3] + Q[0, 1] * f[4] + Q[0, 2] * f[5] + arm[1] * g2 - arm[2] * g1
    out[4] += Q[1, 0] * f[3] + Q[1, 1] * f[4] + Q[1, 2] * f[5] + arm[2] * g0 - arm[0] * g2
    out[5] += Q[2, 0] * f[3] + Q[2, 1] * f[4] + Q[2, 2] * f[5] + arm[0] * g1 - arm[1] * g0


@inner_kernel
def add_inertia_force(
    tree: Tree, bodies: BodyTable, x: int, motion: MotionState, gravity: Array, given: Array, out: Array
) -> None:
    """Add to out (6,) what tree body x asks of its joint: inertia less gravity (Eq. T5a), and `given` (n,) forces."""
    b = tree.body[x]
    o = bodies.offset[b]
    R = motion.rotation[b]
    v, rate = motion.v, motion.vd
    S, J = tree.S[x], tree.J[x]
    m = tree.mass[x]
    g0, g1, g2 = gravity[0], gravity[1], gravity[2]
    w0, w1, w2 = v[o + 3], v[o + 4], v[o + 5]
    e0, e1, e2 = rate[o + 3], rate[o + 4], rate[o + 5]
    a0 = rate[o] + w1 * v[o + 2] - w2 * v[o + 1] - (R[0, 0] * g0 + R[1, 0] * g1 + R[2, 0] * g2)
    a1 = rate[o + 1] + w2 * v[o] - w0 * v[o + 2] - (R[0, 1] * g0 + R[1, 1] * g1 + R[2, 1] * g2)
    a2 = rate[o + 2] + w0 * v[o + 1] - w1 * v[o] - (R[0, 2] * g0 + R[1, 2] * g1 + R[2, 2] * g2)
    S0, S1, S2 = S[0], S[1], S[2]
    y0 = w1 * S2 - w2 * S1
    y1 = w2 * S0 - w0 * S2
    y2 = w0 * S1 - w1 * S0
    out[0] += given[o] + m * a0 + e1 * S2 - e2 * S1 + w1 * y2 - w2 * y1
    out[1] += given[o + 1] + m * a1 + e2 * S0 - e0 * S2 + w2 * y0 - w0 * y2
    out[2] += given[o + 2] + m * a2 + e0 * S1 - e1 * S0 + w0 * y1 - w1 * y0
    h0 = J[0, 0] * w0 + J[0, 1] * w1 + J[0, 2] * w2
    h1 = J[1, 0] * w0 + J[1, 1] * w1 + J[1, 2] * w2
    h2 = J[2, 0] * w0 + J[2, 1] * w1 + J[2, 2] * w2
    k0 = J[0, 0] * e0 + J[0, 1] * e1 + J[0, 2] * e2
    k1 = J[1, 0] * e0 + J[1, 1] * e1 + J[1, 2] * e2
    k2 = J[2, 0] * e0 + J[2, 1] * e1 + J[2, 2] * e2
    out[3] += given[o + 3] + S1 * a2 - S2 * a1 + w1 * h2 - w2 * h1 + k0
    out[4] += given[o + 4] + S2 * a0 - S0 * a2 + w2 * h0 - w0 * h2 + k1
    out[5] += given[o + 5] + S0 * a1 - S1 * a0 + w0 * h1 - w1 * h0 + k2


@kernel
def tree_residual(
    tree: Tree,
    bodies: BodyTable,
    motion: MotionState,
    gravity: Array,
    given: Array,
    on_joints: Array,
    work: TreeWork,
    out: Array,
) -> None:
    """out (d,) = L⁻¹[Sᵀ(M τ̇ + h + given) + on_joints], inwards (Eq. T10).

    given (n,): forces on bodies beside inertia and gravity. on_joints (d,): forces on free motions alone.
    """
    force, column = work.force, work.column
    parent, free_start, free = tree.parent, tree.free_start, tree.free
    for x in range(parent.shape[0]):
        for i in range(6):
            force[x, i] = 0.0
    for x in range(parent.shape[0] - 1, -1, -1):
        f = force[x]
        add_inertia_force(tree, bodies, x, motion, gravity, given, f)
        for d in range(free_start[x], free_start[x + 1]):
            y = f[free[d]] + on_joints[d]
            out[d] = y
            for i in range(6):
                f[i] -= column[d, i] * y
        if parent[x] >= 0:
            carry_force(work.rotation[x], work.arm[x], f, force[parent[x]])


@kernel
def outwards(tree: Tree, work: TreeWork, z: Array) -> None:
    """z (d,) = L⁻ᵀ z in place: the joints' free motions from D⁻¹y, outwards."""
    twist, column = work.twist, work.column
    parent, free_start, free = tree.parent, tree.free_start, tree.free
    for x in range(parent.shape[0]):
        t = twist[x]
        carry_twist(work, x, parent[x], t)
        for d in range(free_start[x + 1] - 1, free_start[x] - 1, -1):
            value = z[d]
            for i in range(6):
                value -= column[d, i] * t[i]
            z[d] = value
            t[free[d]] += value


@kernel
def inwards(tree: Tree, work: TreeWork, s: Array, z: Array) -> None:
    """z (d,) = Lᵀ s, the inverse of `outwards`."""
    twist, column = work.twist, work.column
    parent, free_start, free = tree.parent, tree.free_start, tree.free
    for x in range(parent.shape[0]):
        t = twist[x]
        carry_twist(work, x, parent[x], t)
        for d in range(free_start[x + 1] - 1, free_start[x] - 1, -1):
            value = s[d]
            for i in range(6):
                value += column[d, i] * t[i]
            z[d] = value
            t[free[d]] += s[d]


@inner_kernel
def carry_twist(work: TreeWork, x: int, p: int, out: Array) -> None:
    """The twist of tree body p as it is at body x that hangs on it; none where p is the ground, −1."""
    if p < 0:
        for i in range(6):
            out[i] = 0.0
        return
    u, Q = work.twist[p], work.rotation[x]
    r0, r1, r2 = work.arm[x, 0], work.arm[x, 1], work.arm[x, 2]
    w0, w1, w2 = u[3], u[4], u[5]
    v0 = u[0] + w1 * r2 - w2 * r1
    v1 = u[1] + w2 * r0 - w0 * r2
    v2 = u[2] + w0 * r1 - w1 * r0
    for i in range(3):
        out[i] = Q[0, i] * v0 + Q[1, i] * v1 + Q[2, i] * v2
        out[3 + i] = Q[0, i] * w0 + Q[1, i] * w1 + Q[2, i] * w2


@inner_kernel
def carry_inertia(Q: Array, arm: Array, M: Array, out: Array) -> None:
    """Add to out (6, 6) an inertia M (6, 6) on a body's twist as its carrier feels it: Xᵀ M X; M is overwritten."""
    r0, r1, r2 = arm[0], arm[1], arm[2]
    # turned into the carrier's axes, block by block: A (linear), B, D (angular)
    for block in range(3):
        i0 = 0 if block < 2 else 3
        j0 = 0 if block == 0 else 3
        m00, m01, m02 = M[i0, j0], M[i0, j0 + 1], M[i0, j0 + 2]
        m10, m11, m12 = M[i0 + 1, j0], M[i0 + 1, j0 + 1], M[i0 + 1, j0 + 2]
        m20, m21, m22 = M[i0 + 2, j0], M[i0 + 2, j0 + 1], M[i0 + 2, j0 + 2]
        for j in range(3):
            q0, q1, q2 = Q[j, 0], Q[j, 1], Q[j, 2]
            x0 = m00 * q0 + m01 * q1 + m02 * q2
            x1 = m10 * q0 + m11 * q1 + m12 * q2
            x2 = m20 * q0 + m21 * q1 + m22 * q2
            for i in range(3):
                M[i0 + i, j0 + j] = Q[i, 0] * x0 + Q[i, 1] * x1 + Q[i, 2] * x2
    # moved by the arm: v = v_p + ω × r gives B' = B − A r̃, D' = D + r̃ B' − Bᵀ r̃
    for i in range(3):
        a0, a1, a2 = M[i, 0], M[i, 1], M[i, 2]
        b0, b1, b2 = M[0, 3 + i], M[1, 3 + i], M[2, 3 + i]
        out[i, 0] += a0
        out[i, 1] += a1
        out[i, 2] += a2
        out[3 + i, 3] += M[3 + i, 3] - (b1 * r2 - b2 * r1)
        out[3 + i, 4] += M[3 + i, 4] - (b2 * r0 - b0 * r2)
        out[3 + i, 5] += M[3 + i, 5] - (b0 * r1 - b1 * r0)
    for i in range(3):
        a0, a1, a2 = M[i, 0], M[i, 1], M[i, 2]
        M[i, 3] -= a1 * r2 - a2 * r1
        M[i, 4] -= a2 * r0 - a0 * r2
        M[i, 5] -= a0 * r1 - a1 * r0
    for j in range(3):
        b0, b1, b2 = M[0, 3 + j], M[1, 3 + j], M[2, 3 + j]
        out[0, 3 + j] += b0
        out[1, 3 + j] += b1
        out[2, 3 + j] += b2
        out[3 + j, 0] += b0
        out[3 + j, 1] += b1
        out[3 + j, 2] += b2
        out[3, 3 + j] += r1 * b2 - r2 * b1
        out[4, 3 + j] += r2 * b0 - r0 * b2
        out[5, 3 + j] += r0 * b1 - r1 * b0


@kernel
def tree_factor(tree: Tree, M: Array, sigma: float, stiffness: Array, work: TreeWork) -> None:
    """SᵀŜS = L D Lᵀ with Ŝ = σM, M (x, 6, 6) on the bodies' twists, from the leaves inwards (Eq. T10, T12).

    stiffness (≥ d,): βh²k + γhd of springs on single free motions, added to their own pivots.
    """
    inertia, column, inverse = work.inertia, work.column, work.inverse
    parent, free_start, free = tree.parent, tree.free_start, tree.free
    for x in range(parent.shape[0]):
        for i in range(6):
            for j in range(6):
                inertia[x, i, j] = sigma * M[x, i, j]
    for x in range(parent.shape[0] - 1, -1, -1):
        left = inertia[x]
        for d in range(free_start[x], free_start[x + 1]):
            c = free[d]
            L = column[d]
            one = 1.0 / (left[c, c] + stiffness[d])
            inverse[d] = one
            for i in range(6):
                L[i] = left[i, c] * one
            pivot = work.force[x]
            for j in range(6):
                pivot[j] = left[c, j]
            for i in range(6):
                for j in range(6):
                    left[i, j] -= L[i] * pivot[j]
        if parent[x] >= 0:
            carry_inertia(work.rotation[x], work.arm[x], left, inertia[parent[x]])


@kernel
def closure_columns(tree: Tree, A: Array, kept: IntArray, work: TreeWork) -> None:
    """L⁻¹ Sᵀ Aᵀ of every closure that is kept on the tree bodies between it and the ground, Aᵀ on blocks; A (flat) on the bodies."""
    column, columns, force = work.column, work.columns, work.path_force
    free_start, free, path, node_start = tree.free_start, tree.free, tree.path, tree.node_start
    count = tree.parent.shape[0]
    for q in range(tree.path_start.shape[0] - 1):
        if kept[q] == 0:
            continue
        first, last = tree.path_start[q], tree.path_start[q + 1]
        for place in range(first, last):
            for i in range(6):
                force[place - first, i] = 0.0
            if path[place, 0] >= count:
                start = path[place, 1]
                for i in range(node_start[path[place, 0] + 1] - node_start[path[place, 0]]):
                    columns[start + i] = 0.0
        for e in range(tree.end_start[q], tree.end_start[q + 1]):
            start, place = tree.end[e, 0], tree.end[e, 1]
            if place < 0:
                continue
            node = path[place, 0]
            if node < count:
                for i in range(6):
                    force[place - first, i] += A[start + i]
            else:
                for i in range(node_start[node + 1] - node_start[node]):
                    columns[path[place, 1] + i] += A[start + i]
        for place in range(first, last):
            node = path[place, 0]
            if node >= count:
                continue
            f = force[place - first]
            start = path[place, 1] - free_start[node]
            for d in range(free_start[node], free_start[node + 1]):
                y = f[free[d]]
                columns[start + d] = y
                for i in range(6):
                    f[i] -= column[d, i] * y
            up = path[place, 2]
            if up >= 0:
                carry_force(work.rotation[node], work.arm[node], f, force[up - first])

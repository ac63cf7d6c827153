"""What an instant shows, compiled: from the frames of the step to those of the model, and all liaison forces."""

from __future__ import annotations

from maggi.bodies.attachment_kernels import attachment_motion
from maggi.bodies.tables import Array
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.links import Link, call3, call5
from maggi.projection.range_space import transpose_product
from maggi.projection.tree_kernels import add_inertia_force, carry_force

from .residuals import scaled_residuals
from .tables import EVALUATE, REPEATED, ROWS, Instant, SmallSystem, StepState, StepWork


@Link
def show(small: SmallSystem, state: StepState, work: StepWork, out: Instant, t: float) -> None:
    """The accepted state at time t as an instant: motion, attachments, rows and multipliers in the frames of the model.

    What stands in `state.motion` is overwritten.
    """
    vectors, tree = state.vectors, small.tree
    for i in range(vectors.nu.shape[0]):
        vectors.increment[i] = 0.0
        vectors.nu_next[i] = vectors.nu[i]
        vectors.nud_next[i] = vectors.nud[i]
    call3(small.links[EVALUATE], small, state, work, t)
    to_model(small, state, out)
    previous = out.rows.previous
    for x in range(small.joint_turn.shape[0]):
        previous[small.joint_turn[x, 0]] = small.joint_turn[x, 2] * state.joints.value[small.joint_turn[x, 1]]
    for x in range(small.closures.measured.shape[0]):
        previous[small.closures.measured[x]] = state.rows.previous[small.closures.measured[x]]
    for x in range(tree.tracked.shape[0]):
        previous[tree.tracked[x]] = state.rows.previous[tree.tracked[x]]
    attachment_motion(small.bodies, out.now, out.attachments)
    call5(small.links[ROWS], small.all_liaisons, small.bodies, out.now, out.attachments, out.rows, t)
    repeated = 0
    for q in range(small.closure_row.shape[0]):
        out.multipliers[small.closure_row[q]] = vectors.multipliers[q]
        out.active[small.closure_row[q]] = work.active[q]
        if not work.pivot[q] > 0.0:
            repeated = 1
    out.counts[REPEATED] = repeated
    joint_multipliers(small, state, work, out)
    scaled_residuals(small.all_liaisons, out.rows, out.scales, out.residuals)


@kernel
def to_model(small: SmallSystem, state: StepState, out: Instant) -> None:
    """`state.motion` to `out.now`, with the bodies' own frames."""
    bodies, motion, now = small.bodies, state.motion, out.now
    for i in range(now.e.shape[0]):
        now.e[i] = motion.e[i]
        now.v[i] = motion.v[i]
        now.vd[i] = motion.vd[i]
    for b in range(1, bodies.kind.shape[0]):
        F, f = small.frame_rotation[b], small.frame_position[b]
        R, Q, r = motion.rotation[b], now.rotation[b], now.origin[b]
        o = bodies.offset[b]
        for i in range(3):
            for j in range(3):
                Q[i, j] = R[i, 0] * F[j, 0] + R[i, 1] * F[j, 1] + R[i, 2] * F[j, 2]
        for i in range(3):
            r[i] = motion.origin[b, i] - (Q[i, 0] * f[0] + Q[i, 1] * f[1] + Q[i, 2] * f[2])
        _turn_twist(F, f, motion.v[o : o + 6], now.v[o : o + 6])
        _turn_twist(F, f, motion.vd[o : o + 6], now.vd[o : o + 6])


@inner_kernel
def _turn_twist(F: Array, f: Array, twist: Array, out: Array) -> None:
    """A twist (6,) in a frame F, f of a body as that of the body's own frame: ω = F ω', v = F v' − ω × f."""
    for i in range(3):
        out[3 + i] = F[i, 0] * twist[3] + F[i, 1] * twist[4] + F[i, 2] * twist[5]
    w0, w1, w2 = out[3], out[4], out[5]
    out[0] = F[0, 0] * twist[0] + F[0, 1] * twist[1] + F[0, 2] * twist[2] - (w1 * f[2] - w2 * f[1])
    out[1] = F[1, 0] * twist[0] + F[1, 1] * twist[1] + F[1, 2] * twist[2] - (w2 * f[0] - w0 * f[2])
    out[2] = F[2, 0] * twist[0] + F[2, 1] * twist[1] + F[2, 2] * twist[2] - (w0 * f[1] - w1 * f[0])


@inner_kernel
def joint_multipliers(small: SmallSystem, state: StepState, work: StepWork, out: Instant) -> None:
    """Multipliers of the tree's joints by Newton–Euler, from the leaves inwards: Aᵀλ = Q − h − M τ̇ (Eq. T11).

    A joint bears what its body and all that hangs on it ask for, and its own rows' coefficients say how.
    """
    tree, rows, force, right = small.tree, out.rows, work.tree.force, work.product
    # forces of closures and loads on the bodies, in the frames of the step
    transpose_product(small.closures, small.step_bodies, state.rows.A, state.vectors.multipliers, work.given)
    for i in range(work.given.shape[0]):
        work.given[i] -= work.loads[i]
    for x in range(tree.parent.shape[0]):
        for i in range(6):
            force[x, i] = 0.0
    for x in range(tree.parent.shape[0] - 1, -1, -1):
        f = force[x]
        add_inertia_force(tree, small.step_bodies, x, state.motion, small.forces.gravity, work.given, f)
        if tree.parent[x] >= 0:
            carry_force(work.tree.rotation[x], work.tree.arm[x], f, force[tree.parent[x]])
    for x in range(tree.parent.shape[0]):
        first, last = small.joint_row_start[x], small.joint_row_start[x + 1]
        k = last - first
        if k == 0:
            continue
        b = tree.body[x]
        R, f = state.motion.rotation[b], force[x]
        # global force and moment at the body's frame in the joint, which is its attachment's point
        g = work.tree.twist[x]
        for i in range(3):
            g[i] = R[i, 0] * f[0] + R[i, 1] * f[1] + R[i, 2] * f[2]
            g[3 + i] = R[i, 0] * f[3] + R[i, 1] * f[4] + R[i, 2] * f[5]
        N = work.tree.inertia[x]
        for i in range(k):
            p = rows.wrench[small.joint_end[first + i]]
            right[i] = 0.0
            for l in range(6):
                right[i] -= p[l] * g[l]
            for j in range(k):
                q = rows.wrench[small.joint_end[first + j]]
                value = 0.0
                for l in range(6):
                    value += p[l] * q[l]
                N[i, j] = value
        _solve(N, k, right)
        for i in range(k):
            out.multipliers[small.joint_row[first + i]] = right[i]


@inner_kernel
def _solve(N: Array, k: int, x: Array) -> None:
    """x = N⁻¹ x in place for the leading (k, k) part of a positive definite N, which L D Lᵀ overwrites."""
    for i in range(k):
        for j in range(i):
            value = N[i, j]
            for l in range(j):
                value -= N[i, l] * N[j, l] * N[l, l]
            N[i, j] = value / N[j, j]
            x[i] -= N[i, j] * x[j]
            N[i, i] -= N[i, j] * N[i, j] * N[j, j]
    for i in range(k - 1, -1, -1):
        x[i] /= N[i, i]
        for j in range(i + 1, k):
            x[i] -= N[j, i] * x[j]

"""Compiled: one correction of Newton's iteration, at position, velocity and acceleration level together."""

from __future__ import annotations

from maggi.bodies.tables import MESH, Array
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.liaisons.tables import ROW_HOLONOMIC
from maggi.linalg.compiling import inner_kernel
from maggi.linalg.links import Link, call3
from maggi.projection.closures import (
    add_closure_forces,
    apply_compliance,
    apply_mesh_compliance,
    closure_rates,
)
from maggi.projection.range_space import solve, transpose_product
from maggi.projection.tree_kernels import inwards, outwards, tree_residual

from .evaluation import has_forces
from .prediction import coefficients
from .spring_kernels import joint_spring_forces
from .tables import BLOCK_FORCES, FIRST, SPRING_FORCES, SmallSystem, StepState, StepWork


@inner_kernel
def shifts(small: SmallSystem, c: GeneralizedAlpha, state: StepState, work: StepWork, t: float) -> None:
    """π and κ: what closures are off by at position and velocity level, and the shifts that mend it.

    Λ κ = −(A v + b) + (γh/σ)(A v̇ + γ),   Λ π = −Φ + (βh²/σ)(A v̇ + γ). Leaves −Zπ − Z_Dκ of mesh bodies in `delta`,
    forces of springs in `force` and `on_joints`. The first correction of a step puts W Aᵀπ in the place of what was
    predicted, so that predictions leave nothing behind.
    """
    tree, bodies, rows, vectors = small.tree, small.step_bodies, state.rows, state.vectors
    first, start = tree.skyline_first, tree.skyline_start
    pi, kappa, columns = work.pi, work.kappa, work.tree.columns
    for i in range(pi.shape[0]):
        acceleration = rows.acceleration[i] / c.sigma
        kappa[i] = -rows.velocity[i] + c.gamma * c.h * acceleration
        pi[i] = -rows.position[i] + c.beta * c.h * c.h * acceleration
    predicted = work.flags[FIRST] == 1 and vectors.shift.shape[0] > 0
    if predicted:
        add_predicted(small, work, vectors.shift_next, work.shift_before, pi)
        add_predicted(small, work, vectors.rate_shift_next, work.rate_shift_before, kappa)
    for i in range(pi.shape[0]):
        if small.closures.row[i, ROW_HOLONOMIC] == 0:
            pi[i] = 0.0
    solve(first, start, work.L, work.pivot, pi)
    solve(first, start, work.L, work.pivot, kappa)
    step = work.step
    for i in range(step.shape[0]):
        step[i] = 0.0
    add_closure_forces(tree, columns, pi, 1.0, step)
    for i in range(step.shape[0]):
        work.position_force[i] += step[i]
    apply_compliance(tree, bodies, work.W, work.tree, step, work.shift)
    apply_mesh_compliance(tree, bodies, work.W_Z, step, work.delta)
    for i in range(step.shape[0]):
        step[i] = 0.0
    add_closure_forces(tree, columns, kappa, 1.0, step)
    for i in range(step.shape[0]):
        work.velocity_force[i] += step[i]
    apply_compliance(tree, bodies, work.W, work.tree, step, work.rate_shift)
    apply_mesh_compliance(tree, bodies, work.W_D, step, work.delta)
    if predicted:
        for i in range(step.shape[0]):
            work.shift[i] -= work.shift_before[i]
            work.rate_shift[i] -= work.rate_shift_before[i]
    if small.links[SPRING_FORCES] != 0:
        call3(small.links[SPRING_FORCES], small, state, work, t)
    outwards(tree, work.tree, work.shift)
    outwards(tree, work.tree, work.rate_shift)
    joint_spring_forces(small, work)
    for i in range(vectors.shift_next.shape[0]):
        vectors.shift_next[i] += work.shift[i]
        vectors.rate_shift_next[i] += work.rate_shift[i]


@inner_kernel
def add_predicted(small: SmallSystem, work: StepWork, shift: Array, before: Array, out: Array) -> None:
    """A predicted shift (m,) in the variables of `apply_compliance`, Lᵀ shift, to `before`; add A shift to out (r,)."""
    tree, rates = small.tree, work.rates
    for i in range(shift.shape[0]):
        before[i] = shift[i]
    inwards(tree, work.tree, shift, before)
    closure_rates(tree, work.tree.columns, before, 0, rates)
    for i in range(out.shape[0]):
        out[i] += rates[i]


@inner_kernel
def forces_on_meshes(small: SmallSystem, work: StepWork) -> None:
    """To `force` (m,) of mesh bodies what their back-substitution has not seen; to `delta` what it has found."""
    tree, bodies = small.tree, small.step_bodies
    force, given, accounted = work.force, work.given, work.accounted
    count = tree.parent.shape[0]
    for k in range(tree.block.shape[0]):
        b = tree.block[k]
        if bodies.kind[b] != MESH:
            continue
        s, o = tree.node_start[count + k], bodies.offset[b]
        n = bodies.offset[b + 1] - o
        for i in range(n):
            total = given[o + i] + force[s + i]
            force[s + i] = total - accounted[s + i]
            accounted[s + i] = total
        if work.flags[FIRST] == 1:
            for i in range(6):
                force[s + i] += work.base[s + i]
            for i in range(6, n):
                work.delta[s + i] += work.base[s + i]


@Link
def correct(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """One correction δ of the algorithmic accelerations (v̇ changes by σδ, v by γhδ, q by βh²δ).

    In the compliance W = Ŝ⁻¹, with shifts by π and κ (`shifts`) and residual r:
    x = −W (r + K Wᵀπ + D Wᵀκ),   Λ φ = A x + (A v̇ + γ)/σ,   δ = x − W Aᵀ φ
    after which Φ, A v + b, A v̇ + γ vanish together to first order.
    """
    c = coefficients(work)
    tree, bodies, rows, vectors = small.tree, small.step_bodies, state.rows, state.vectors
    delta, force, step, phi = work.delta, work.force, work.step, work.phi
    r = work.pi.shape[0]
    q = phi.shape[0]
    m = delta.shape[0]
    if r > 0 or has_forces(small):
        transpose_product(small.closures, bodies, rows.A, vectors.multipliers_next, work.given)
        for i in range(work.given.shape[0]):
            work.given[i] -= work.loads[i]
    for i in range(m):
        delta[i] = 0.0
        force[i] = 0.0
        work.shift[i] = 0.0
        work.rate_shift[i] = 0.0
        work.on_joints[i] = 0.0
    if r > 0 and c.h > 0.0:
        shifts(small, c, state, work, t)
    tree_residual(tree, bodies, state.motion, small.forces.gravity, work.given, work.on_joints, work.tree, step)
    for d in range(tree.free.shape[0]):
        force[d] += step[d]
    if tree.block.shape[0] > 0:
        forces_on_meshes(small, work)
        if small.links[BLOCK_FORCES] != 0:
            call3(small.links[BLOCK_FORCES], small, state, work, t)
    apply_compliance(tree, bodies, work.W, work.tree, force, step)
    for i in range(m):
        delta[i] -= step[i]
    if q > 0:
        closure_rates(tree, work.tree.columns, delta, 0, phi)
        for i in range(r):
            phi[i] += rows.acceleration[i] / c.sigma
        solve(tree.skyline_first, tree.skyline_start, work.L, work.pivot, phi)
        for i in range(m):
            force[i] = 0.0
        add_closure_forces(tree, work.tree.columns, phi, 1.0, force)
        count = tree.parent.shape[0]
        for k in range(tree.block.shape[0]):
            if bodies.kind[tree.block[k]] == MESH:
                for i in range(tree.node_start[count + k], tree.node_start[count + k + 1]):
                    work.accounted[i] += force[i]
        apply_compliance(tree, bodies, work.W, work.tree, force, step)
        for i in range(m):
            delta[i] -= step[i]
        for i in range(r):
            vectors.multipliers_next[i] += phi[i]
    outwards(tree, work.tree, delta)
    a_next, nud, nu, increment = vectors.a_next, vectors.nud_next, vectors.nu_next, vectors.increment
    x1, x2 = c.gamma * c.h, c.beta * c.h * c.h
    for i in range(m):
        d = delta[i]
        a_next[i] += d
        nud[i] += c.sigma * d
        nu[i] += x1 * d + work.rate_shift[i]
        increment[i] += x2 * d + work.shift[i]

"""The compiled step of the small system (Theory §5): predict, iterate on closures and bodies together, accept.

In relative coordinates: the free motions of the tree's joints and the velocities of blocks (`projection.tree_tables`).
"""

from __future__ import annotations

import math

from numba import njit

from maggi.bodies.kernels import move_attachment
from maggi.bodies.tables import FIXED, MESH, Array, MotionState
from maggi.forces.kernels import applied_forces
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.liaisons.coordinates import joint_coordinate
from maggi.liaisons.tables import ROW_ANGULAR, ROW_HOLONOMIC, LiaisonState, LiaisonTable
from maggi.linalg.links import Link, call3, call5
from maggi.linalg.rotations import exp_se3_update
from maggi.projection.closures import (
    add_closure_forces,
    apply_compliance,
    apply_mesh_compliance,
    closure_compliance,
    closure_rates,
    closure_scale,
)
from maggi.projection.range_space import SUSPECT, factorise, find_singular, solve, transpose_product
from maggi.projection.tree_kernels import closure_columns, outwards, tree_factor, tree_motion, tree_residual
from maggi.projection.tree_tables import GENERAL

from .spring_kernels import (
    add_spring_compliance,
    joint_spring_forces,
    joint_stiffness,
    spring_coefficients,
    spring_forces,
)
from .tables import (
    ACCEPT_STEP,
    BEST,
    BLOCK_COMPLIANCES,
    BLOCK_FORCES,
    BLOCK_POWER,
    BOUND,
    CALM,
    CORRECT,
    DISSIPATION,
    ERROR,
    EVALUATE,
    FIRST,
    GIVEN_POWER,
    ORDER,
    PREDICT_STEP,
    PRESCRIBE,
    REFRESH,
    ROWS,
    SINE,
    TAKEN_POWER,
    SmallSystem,
    StepState,
    StepVectors,
    StepWork,
)

CONVERGED, NOT_CONVERGED, NOT_FINITE, TOO_LARGE, COULD_BE_LONGER = 0, 1, 2, 3, 4
WHOLE_STEPS, PREDICT, ITERATE, ACCEPT = 0, 1, 2, 3
MAX_ITERATIONS = 25
HIGHEST_ORDER = 3  # of the polynomial that accelerations are predicted by
REFRESH_ABOVE = 0.1  # contraction above which the iteration's matrices are made anew
ROUND_OFF = 1e-12  # liaison residuals, relative to size, speed and acceleration
STALLED = 1e-10  # accepted where round-off lets them fall no further
DROPPED = 1e-6  # what positions of dependent rows may be off by, and 100 times that their velocities
EPSILON = 2.2e-16
TWICE = 1.0 / 16.0  # of the local error allowed, which a step twice as long multiplies by eight
CALM_STEPS = 4  # of that kind in a row before steps become longer


@njit(cache=True, error_model="numpy")
def coefficients(work: StepWork) -> GeneralizedAlpha:
    """Those of the present step size."""
    m = work.method
    return GeneralizedAlpha(m[0], m[1], m[2], m[3], m[4], m[5])


@Link
def predict(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Accelerations extrapolated by a polynomial, 0 to 3, of the order that did best, and the Newmark state that follows."""
    c, order = coefficients(work), min(work.flags[ORDER], work.flags[BEST])
    vectors = state.vectors
    a, a_next, a_previous, a_older = vectors.a, vectors.a_next, vectors.a_previous, vectors.a_older
    a_oldest = vectors.a_oldest
    nu, nu_next, nud, nud_next, increment = (
        vectors.nu,
        vectors.nu_next,
        vectors.nud,
        vectors.nud_next,
        vectors.increment,
    )
    f0, f1, f2, f3 = 1.0, 0.0, 0.0, 0.0
    if order == 1:
        f0, f1 = 2.0, -1.0
    elif order == 2:
        f0, f1, f2 = 3.0, -3.0, 1.0
    elif order >= 3:
        f0, f1, f2, f3 = 4.0, -6.0, 4.0, -1.0
    x0, x1 = c.h * (1.0 - c.gamma), c.h * c.gamma
    y0, y1 = c.h * c.h * (0.5 - c.beta), c.h * c.h * c.beta
    z0, z1, z2 = (1.0 - c.alpha_m) / (1.0 - c.alpha_f), c.alpha_m / (1.0 - c.alpha_f), c.alpha_f / (1.0 - c.alpha_f)
    for i in range(a.shape[0]):
        b = f0 * a[i] + f1 * a_previous[i] + f2 * a_older[i] + f3 * a_oldest[i]
        a_next[i] = b
        nud_next[i] = z0 * b + z1 * a[i] - z2 * nud[i]
        nu_next[i] = nu[i] + x0 * a[i] + x1 * b
        increment[i] = c.h * nu[i] + y0 * a[i] + y1 * b
    before, following, last = vectors.multipliers_previous, vectors.multipliers_next, vectors.multipliers
    for i in range(last.shape[0]):
        following[i] = last[i] + (last[i] - before[i] if order > 0 else 0.0)


@njit(cache=True, error_model="numpy")
def move_blocks(small: SmallSystem, state: StepState) -> None:
    """Frames of blocks on SE(3), elastic coordinates additively, and their velocities from ν."""
    tree, bodies = small.tree, small.step_bodies
    now, motion, vectors = state.accepted, state.motion, state.vectors
    increment, nu, nud = vectors.increment, vectors.nu_next, vectors.nud_next
    count = tree.parent.shape[0]
    for k in range(tree.block.shape[0]):
        b = tree.block[k]
        s, o = tree.node_start[count + k], bodies.offset[b]
        for i in range(6, bodies.offset[b + 1] - o):
            motion.e[o + i] = now.e[o + i] + increment[s + i]
            motion.v[o + i] = nu[s + i]
            motion.vd[o + i] = nud[s + i]
        if bodies.floating[b] == 1:
            for i in range(6):
                motion.v[o + i] = nu[s + i]
                motion.vd[o + i] = nud[s + i]
            exp_se3_update(
                now.rotation[b],
                now.origin[b],
                increment[s : s + 3],
                increment[s + 3 : s + 6],
                motion.rotation[b],
                motion.origin[b],
            )


@njit(cache=True, error_model="numpy")
def has_forces(small: SmallSystem) -> bool:
    """Whether there are springs or loads."""
    tree = small.tree
    return bool(tree.spring.shape[0] + tree.on_joint.shape[0] + small.forces.load_attachment.shape[0] > 0)


@Link
def evaluate(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """All bodies, and attachments, closures and applied forces, at the end of the step."""
    tree, bodies, motion, vectors = small.tree, small.step_bodies, state.motion, state.vectors
    tree_motion(
        tree,
        bodies,
        state.joints,
        vectors.increment,
        vectors.nu_next,
        vectors.nud_next,
        state.joints_next,
        work.tree,
        motion,
    )
    if tree.block.shape[0] > 0:
        move_blocks(small, state)
        if small.links[PRESCRIBE] != 0:
            call3(small.links[PRESCRIBE], small, state, work, t)
    for x in range(tree.needed.shape[0]):
        move_attachment(bodies, tree.needed[x], motion, state.attachments)
    if small.closures.measured.shape[0] > 0 or state.rows.position.shape[0] > 0:
        call5(small.links[ROWS], small.closures, bodies, motion, state.attachments, state.rows, t)
    if has_forces(small):
        applied_forces(
            small.forces, bodies, small.closures, motion, state.attachments, state.rows, t, work.loads, state.power
        )


@njit(cache=True, error_model="numpy")
def scaled_residuals(liaisons: LiaisonTable, rows: LiaisonState, scales: Array, out: Array) -> None:
    """The largest |Φ|, |A v + b|, |A v̇ + γ| over size, speed and acceleration (rotations: as angles); out (3,)."""
    row = liaisons.row
    row_position = rows.position
    row_velocity = rows.velocity
    row_acceleration = rows.acceleration
    for i in range(3):
        out[i] = 0.0
    size, speed, acceleration = scales[0], scales[1], scales[2]
    for i in range(row.shape[0]):
        arm = size if row[i, ROW_ANGULAR] == 1 else 1.0
        x = abs(row_velocity[i]) * arm / speed
        y = abs(row_acceleration[i]) * arm / acceleration
        z = abs(row_position[i]) * arm / size if row[i, ROW_HOLONOMIC] == 1 else 0.0
        # written so that a NaN stays
        out[0] = z if not (z <= out[0]) else out[0]
        out[1] = x if not (x <= out[1]) else out[1]
        out[2] = y if not (y <= out[2]) else out[2]


@njit(cache=True, error_model="numpy")
def active_residuals(liaisons: LiaisonTable, rows: LiaisonState, scales: Array, pivot: Array) -> tuple[float, float]:
    """The largest scaled residual at any level of independent rows, and what those that depend on others are off by.

    Passing a singular position, a dependent row is not met for a step, its acceleration least of all.
    """
    row = liaisons.row
    position, velocity, acceleration = rows.position, rows.velocity, rows.acceleration
    worst = 0.0
    dropped = 0.0
    for i in range(row.shape[0]):
        arm = scales[0] if row[i, ROW_ANGULAR] == 1 else 1.0
        x = abs(position[i]) * arm / scales[0] if row[i, ROW_HOLONOMIC] == 1 else 0.0
        y = abs(velocity[i]) * arm / scales[1]
        z = abs(acceleration[i]) * arm / scales[2]
        # written so that a NaN stays
        if pivot[i] > 0.0:
            worst = x if not (x <= worst) else worst
            worst = y if not (y <= worst) else worst
            worst = z if not (z <= worst) else worst
        else:
            dropped = x if not (x <= dropped) else dropped
            dropped = 0.01 * y if not (0.01 * y <= dropped) else dropped
    return worst, dropped


@njit(cache=True, error_model="numpy")
def correction_size(small: SmallSystem, c: GeneralizedAlpha, scales: Array, state: StepState, delta: Array) -> float:
    """The largest component of δ over what counts as one.

    Frames and joints are judged by acceleration. Elastic coordinates too, but never finer than what a change of 1e-4 of
    the tolerance of their own position would be: below that their accelerations are round-off of K u.
    """
    tree, bodies, motion, elastic = small.tree, small.step_bodies, state.motion, state.vectors.elastic
    size = tree.size
    largest = 0.0
    one = 1.0 / scales[2]
    for d in range(tree.free.shape[0]):
        x = abs(delta[d]) * size[d] * one
        if not (x <= largest):
            largest = x
    floor = 1e-4 / (c.beta * c.h * c.h) if c.h > 0.0 else 0.0
    count = tree.parent.shape[0]
    for k in range(tree.block.shape[0]):
        b = tree.block[k]
        s, o = tree.node_start[count + k], bodies.offset[b]
        n = bodies.offset[b + 1] - o
        reference = max(elastic[b, 1], floor * elastic[b, 0])
        for i in range(6, n):
            reference = max(reference, abs(motion.vd[o + i]), floor * abs(motion.e[o + i]))
        for i in range(n):
            if i < 6:
                x = abs(delta[s + i]) * size[s + i] * one
            else:
                x = abs(delta[s + i]) / reference if reference > 0.0 else 0.0
            if not (x <= largest):
                largest = x
    return largest


@njit(cache=True, error_model="numpy")
def largest_of(delta: Array) -> float:
    """max |δ|, NaN where one is."""
    largest = 0.0
    for i in range(delta.shape[0]):
        x = abs(delta[i])
        if not (x <= largest):
            largest = x
    return largest


@Link
def refresh(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Ŝ = L D Lᵀ of the tree, compliances of Ritz blocks, Λ and its factor, as the bodies stand.

    To `numbers` the sine of the smallest angle between rows, 1 unless a singular position is close.
    """
    c = coefficients(work)
    work.numbers[SINE] = 1.0
    tree, bodies, rows = small.tree, small.step_bodies, state.rows
    first, start = tree.skyline_first, tree.skyline_start
    if small.links[BLOCK_COMPLIANCES] != 0:
        call3(small.links[BLOCK_COMPLIANCES], small, state, work, t)
    joint_stiffness(small, c, work.stiffness)
    tree_factor(tree, c.sigma, False, work.stiffness, work.tree)
    if first.shape[0] == 0:
        return
    spring_coefficients(small, state)
    closure_columns(tree, rows.A, work.tree)
    if work.scale.shape[0] > 0 and work.scale[0] == 0.0:
        closure_scale(tree, bodies, rows.A, c.sigma, False, work.W, work.product, work.scale)
    closure_compliance(tree, bodies, work.W, work.tree, work.product, work.L)
    add_spring_compliance(small, c, work)
    if factorise(first, start, work.L, work.pivot, work.scale, work.active, True) < SUSPECT:
        tree_factor(tree, c.sigma, True, work.stiffness, work.tree)
        closure_columns(tree, rows.A, work.tree)
        closure_scale(tree, bodies, rows.A, c.sigma, True, work.metric, work.product, work.metric_scale)
        closure_compliance(tree, bodies, work.metric, work.tree, work.product, work.L)
        sine = find_singular(first, start, work.L, work.pivot, work.metric_scale, work.active)
        work.numbers[SINE] = math.sqrt(sine)
        tree_factor(tree, c.sigma, False, work.stiffness, work.tree)
        closure_columns(tree, rows.A, work.tree)
        closure_compliance(tree, bodies, work.W, work.tree, work.product, work.L)
        add_spring_compliance(small, c, work)
        factorise(first, start, work.L, work.pivot, work.scale, work.active, False)
    else:
        for i in range(work.active.shape[0]):
            work.active[i] = 1


@njit(cache=True, error_model="numpy")
def shifts(small: SmallSystem, c: GeneralizedAlpha, state: StepState, work: StepWork) -> None:
    """π and κ: what closures are off by at position and velocity level, and the shifts that mend it.

    Λ κ = −(A v + b) + (γh/σ)(A v̇ + γ),   Λ π = −Φ + (βh²/σ)(A v̇ + γ). Leaves −Zπ − Z_Dκ of mesh bodies in `delta`,
    forces of springs in `force` and `on_joints`.
    """
    tree, bodies, rows = small.tree, small.step_bodies, state.rows
    first, start = tree.skyline_first, tree.skyline_start
    pi, kappa, columns = work.pi, work.kappa, work.tree.columns
    for i in range(pi.shape[0]):
        acceleration = rows.acceleration[i] / c.sigma
        kappa[i] = -rows.velocity[i] + c.gamma * c.h * acceleration
        pi[i] = 0.0
        if small.closures.row[i, ROW_HOLONOMIC] == 1:
            pi[i] = -rows.position[i] + c.beta * c.h * c.h * acceleration
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
    spring_forces(small, work)
    outwards(tree, work.tree, work.shift)
    outwards(tree, work.tree, work.rate_shift)
    joint_spring_forces(small, work)


@njit(cache=True, error_model="numpy")
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
        shifts(small, c, state, work)
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
        closure_rates(tree, work.tree.columns, delta, phi)
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


@njit(cache=True, error_model="numpy")
def iterate(
    small: SmallSystem, state: StepState, work: StepWork, c: GeneralizedAlpha, t: float, tolerance: float
) -> tuple[int, int]:
    """Newton's iteration on the small system; returns (CONVERGED or why not, number of corrections).

    Full-mesh bodies enter by `work.base` (their one back-substitution) and `work.accounted` and are linear here.
    """
    scales = state.scales
    rho = state.vectors.contraction
    multipliers = state.vectors.multipliers_next
    size = scales[0]
    error = 0.0
    previous = 0.0
    contraction = rho[0]
    worst_before = math.inf
    measured = rho[1] < 10.0
    renew = True
    for i in range(work.accounted.shape[0]):
        work.accounted[i] = 0.0
        work.position_force[i] = 0.0
        work.velocity_force[i] = 0.0
    sine = 1.0  # of the smallest angle between rows
    # joints of the tree hold by themselves: where there is nothing else, nobody need look at the state of the last correction
    bare = state.rows.position.shape[0] + small.tree.block.shape[0] == 0 and not has_forces(small)
    for iteration in range(MAX_ITERATIONS + 1):
        call3(small.links[EVALUATE], small, state, work, t)
        worst, dropped = active_residuals(small.closures, state.rows, scales, work.pivot)
        if not math.isfinite(worst + dropped) or not math.isfinite(error):
            return NOT_FINITE, iteration
        if iteration > 0:
            # near a singular position accelerations along the vanishing direction are magnified round-off
            noise = 10.0 * EPSILON / sine**3 / tolerance
            round_off = max(ROUND_OFF, 10.0 * EPSILON / sine**2)
            estimate = error * contraction / (1.0 - contraction) if contraction < 1.0 else math.inf
            if error <= noise:
                estimate = 0.0
            if iteration == 1 and not measured:
                estimate = math.inf
            settled = worst <= round_off or (worst <= STALLED and worst > 0.3 * worst_before)
            # at round-off corrections no longer fall: a stiff body answers that of the joints' positions
            stalled = (
                iteration >= 3
                and error > 0.3 * previous
                and c.beta * c.h * c.h * largest_of(work.delta) <= ROUND_OFF * size
            )
            if (estimate <= 1.0 or stalled) and settled and dropped <= DROPPED:
                if iteration >= 2:
                    rho[1] = 0.0
                else:
                    rho[1] += 1.0
                return CONVERGED, iteration
        if iteration == MAX_ITERATIONS:
            break
        worst_before = worst
        if renew:
            call3(small.links[REFRESH], small, state, work, t)
            sine = work.numbers[SINE]
            for i in range(multipliers.shape[0]):
                if work.pivot[i] == 0.0:
                    multipliers[i] = 0.0
            renew = False
        work.flags[FIRST] = 1 if iteration == 0 else 0
        call3(small.links[CORRECT], small, state, work, t)
        previous = error
        error = correction_size(small, c, scales, state, work.delta) / tolerance
        if iteration > 0 and previous > 0.0:
            contraction = max(min(error / previous, 2.0), 1e-3)
            if contraction > REFRESH_ABOVE:
                renew = True
            rho[0] = min(contraction, 0.5)
        if bare and (iteration > 0 or measured) and error * contraction <= 1.0 - contraction:
            rho[1] = 0.0 if iteration > 0 else rho[1] + 1.0
            return CONVERGED, iteration + 1
    return NOT_CONVERGED, MAX_ITERATIONS


@njit(cache=True, error_model="numpy")
def best_order(small: SmallSystem, order: int, vectors: StepVectors) -> int:
    """The order, up to that available, by which this step's accelerations would have been predicted best.

    Smooth motion asks for the highest. Where a step does not resolve an oscillation, accelerations change sign from step to
    step, and every order more would double what a prediction is off by.
    """
    a, a_next, a_previous, a_older, size = (
        vectors.a,
        vectors.a_next,
        vectors.a_previous,
        vectors.a_older,
        small.tree.size,
    )
    a_oldest = vectors.a_oldest
    e0 = e1 = e2 = e3 = 0.0
    for i in range(a.shape[0]):
        w = size[i] if size[i] > 0.0 else 1.0
        # differences of rising order
        d0 = w * (a_next[i] - a[i])
        d1 = d0 - w * (a[i] - a_previous[i])
        d2 = d1 - w * (a[i] - 2.0 * a_previous[i] + a_older[i])
        d3 = d2 - w * (a[i] - 3.0 * a_previous[i] + 3.0 * a_older[i] - a_oldest[i])
        e0 += d0 * d0
        e1 += d1 * d1
        e2 += d2 * d2
        e3 += d3 * d3
    best = 0
    least = e0
    if order >= 1 and e1 < least:
        best, least = 1, e1
    if order >= 2 and e2 < least:
        best, least = 2, e2
    if order >= 3 and e3 < least:
        best = 3
    # one more than could be tried for as long as the steps before are few
    return best + 1 if best == order else best


@Link
def accept(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Make the end of the step the present: integrate work and dissipation by the trapezoidal rule, renew the scales."""
    tree, bodies, motion, vectors, rows = small.tree, small.step_bodies, state.motion, state.vectors, state.rows
    h = work.method[0]
    given = state.power[2]  # of loads, of driven rows λᵀb, and of prescribed frames
    taken = state.power[1] + work.numbers[DISSIPATION]
    multipliers, rhs, done = vectors.multipliers_next, rows.rhs, state.work
    for i in range(rhs.shape[0]):
        given += multipliers[i] * rhs[i]
    if small.links[BLOCK_POWER] != 0:
        call3(small.links[BLOCK_POWER], small, state, work, t)
        given += work.numbers[GIVEN_POWER]
        taken += work.numbers[TAKEN_POWER]
    done[0] += 0.5 * h * (done[2] + given)
    done[1] += 0.5 * h * (done[3] + taken)
    done[2] = given
    done[3] = taken
    now = state.accepted
    for k in range(tree.block.shape[0]):
        b = tree.block[k]
        for i in range(bodies.offset[b], bodies.offset[b + 1]):
            now.e[i] = motion.e[i]
        for i in range(3):
            now.origin[b, i] = motion.origin[b, i]
            for j in range(3):
                now.rotation[b, i, j] = motion.rotation[b, i, j]
    work.flags[BEST] = best_order(small, work.flags[ORDER], vectors)
    a, a_next, a_previous, a_older = vectors.a, vectors.a_next, vectors.a_previous, vectors.a_older
    a_oldest = vectors.a_oldest
    nu, nu_next, nud, nud_next = vectors.nu, vectors.nu_next, vectors.nud, vectors.nud_next
    for i in range(a.shape[0]):
        a_oldest[i] = a_older[i]
        a_older[i] = a_previous[i]
        a_previous[i] = a[i]
        a[i] = a_next[i]
        nu[i] = nu_next[i]
        nud[i] = nud_next[i]
    joints, joints_next = state.joints, state.joints_next
    for x in range(tree.parent.shape[0]):
        joints.value[x] = joints_next.value[x]
        if tree.pair[x] == GENERAL:
            for i in range(3):
                joints.position[x, i] = joints_next.position[x, i]
                for j in range(3):
                    joints.rotation[x, i, j] = joints_next.rotation[x, i, j]
    for i in range(vectors.multipliers.shape[0]):
        vectors.multipliers_previous[i] = vectors.multipliers[i]
        vectors.multipliers[i] = multipliers[i]
    for x in range(tree.tracked.shape[0]):
        joint_coordinate(small.closures, state.attachments, tree.tracked[x], rows)
        rows.previous[tree.tracked[x]] = rows.coordinate[tree.tracked[x], 0]
    for x in range(small.closures.measured.shape[0]):
        rows.previous[small.closures.measured[x]] = rows.coordinate[small.closures.measured[x], 0]
    update_scales(small, motion, vectors, state.scales)


@njit(cache=True, error_model="numpy")
def update_scales(small: SmallSystem, motion: MotionState, vectors: StepVectors, scales: Array) -> None:
    """Speed and acceleration of the mechanism: the largest so far, fading over some hundred steps."""
    bodies, elastic = small.step_bodies, vectors.elastic
    v, rate, e = motion.v, motion.vd, motion.e
    square = scales[0] * scales[0]
    speed = 0.0  # squares
    acceleration = 0.0
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED:
            continue
        o = bodies.offset[b]
        spin = v[o + 3] * v[o + 3] + v[o + 4] * v[o + 4] + v[o + 5] * v[o + 5]
        linear = v[o] * v[o] + v[o + 1] * v[o + 1] + v[o + 2] * v[o + 2]
        speed = max(speed, linear, square * spin)
        turn = rate[o + 3] * rate[o + 3] + rate[o + 4] * rate[o + 4] + rate[o + 5] * rate[o + 5]
        linear = rate[o] * rate[o] + rate[o + 1] * rate[o + 1] + rate[o + 2] * rate[o + 2]
        acceleration = max(acceleration, linear, square * turn, square * spin * spin)
        if bodies.offset[b + 1] > o + 6:
            elastic[b, 0] *= 0.99
            elastic[b, 1] *= 0.99
            for i in range(o + 6, bodies.offset[b + 1]):
                elastic[b, 0] = max(elastic[b, 0], abs(e[i]))
                elastic[b, 1] = max(elastic[b, 1], abs(rate[i]))
    scales[1] = max(0.99 * scales[1], math.sqrt(speed), scales[3])
    scales[2] = max(0.99 * scales[2], math.sqrt(acceleration), scales[4])


@njit(cache=True, error_model="numpy")
def local_error(small: SmallSystem, c: GeneralizedAlpha, state: StepState) -> float:
    """The error that a step adds to positions, over the mechanism's size: |β + (½ − γ)/2 − 1/6| h² |a₁ − a₀|.

    What Newmark's polynomial lacks of h³/6 of the jerk (Zienkiewicz and Xie 1991), with a = v̇ + (½ − γ) h v̈ + …
    """
    a, a_next, size = state.vectors.a, state.vectors.a_next, small.tree.size
    largest = 0.0
    for i in range(a.shape[0]):
        # elastic coordinates are lengths
        x = abs(a_next[i] - a[i]) * (size[i] if size[i] > 0.0 else 1.0)
        if not (x <= largest):
            largest = x
    return float(abs(c.beta + 0.5 * (0.5 - c.gamma) - 1.0 / 6.0) * c.h * c.h * largest / state.scales[0])


@njit(cache=True, error_model="numpy")
def advance(
    small: SmallSystem,
    state: StepState,
    work: StepWork,
    phase: int,
    t: float,
    steps: int,
    tolerance: float,
) -> tuple[int, int, int]:
    """Up to `steps` steps from time t, or one phase of a step; returns (reason it ended, steps done, corrections).

    phase: WHOLE_STEPS, or PREDICT, ITERATE, ACCEPT of a single step to t + h for mechanisms with meshed bodies,
    whose back-substitutions come between. By what polynomial the first step predicts is in `flags`; each that follows
    takes one more, up to HIGHEST_ORDER. With a BOUND the steps end where one makes a larger local error, which is not accepted, and
    where they could be twice as long.
    """
    bound = work.numbers[BOUND] if phase == WHOLE_STEPS else 0.0
    c, links = coefficients(work), small.links
    total = 0
    for k in range(steps):
        end = t + (k + 1) * c.h
        if phase == WHOLE_STEPS or phase == PREDICT:
            call3(links[PREDICT_STEP], small, state, work, end)
            if phase == PREDICT:
                move_blocks(small, state)
                if links[PRESCRIBE] != 0:
                    call3(links[PRESCRIBE], small, state, work, end)
        if phase == WHOLE_STEPS or phase == ITERATE:
            reason, corrections = iterate(small, state, work, c, end, tolerance)
            total += corrections
            if reason != CONVERGED:
                return reason, k, total
        if bound > 0.0:
            error = local_error(small, c, state)
            work.numbers[ERROR] = error
            if not error <= bound:
                return TOO_LARGE, k, total
            work.flags[CALM] = work.flags[CALM] + 1 if error <= TWICE * bound else 0
        if phase == WHOLE_STEPS or phase == ACCEPT:
            call3(links[ACCEPT_STEP], small, state, work, end)
            work.flags[ORDER] = min(work.flags[ORDER] + 1, HIGHEST_ORDER)
        if bound > 0.0 and work.flags[CALM] >= CALM_STEPS:
            return COULD_BE_LONGER, k + 1, total
    return CONVERGED, steps, total

"""The compiled step of the small system (Theory §5): predict, iterate on liaisons and bodies together, accept."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from maggi.bodies.kernels import add_multiple, attachment_motion, frame_mass, inertia_residual, inner, multiply
from maggi.bodies.motions import MotionTable, prescribe
from maggi.bodies.tables import FIXED, MESH, RIGID, RITZ, Array, AttachmentState, BodyTable, IntArray, MotionState
from maggi.forces.kernels import applied_forces
from maggi.forces.tables import ForceTable
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.liaisons.kernels import evaluate_rows
from maggi.liaisons.tables import ROW_ANGULAR, ROW_HOLONOMIC, LiaisonState, LiaisonTable
from maggi.linalg.rotations import exp_se3_update
from maggi.projection.range_space import (
    SUSPECT,
    assemble_compliance,
    block_product,
    factorise,
    find_singular,
    product,
    solve,
    transpose_product,
)

from .springs import invert, shift_springs, solve_springs, spring_border, spring_rows
from .tables import StepVectors, StepWork

CONVERGED, NOT_CONVERGED, NOT_FINITE = 0, 1, 2
WHOLE_STEPS, PREDICT, ITERATE, ACCEPT = 0, 1, 2, 3
MAX_ITERATIONS = 25
REFRESH_ABOVE = 0.1  # contraction above which the iteration's matrices are made anew
ROUND_OFF = 1e-12  # liaison residuals, relative to size, speed and acceleration
STALLED = 1e-10  # accepted where round-off lets them fall no further
DROPPED = 1e-6  # what positions of dependent rows may be off by, and 100 times that their velocities
EPSILON = 2.2e-16


@njit(cache=True)
def compliances(
    bodies: BodyTable, state: MotionState, c: GeneralizedAlpha, floor: Array, elastic: Array, W: Array
) -> None:
    """W = Ŝ⁻¹ with Ŝ = σM + γhD + βh²K for all rigid and Ritz bodies, as they stand (Eq. T12).

    A rigid body's is constant in its own axes; mesh bodies' are kept by `stepping.mesh`. Of a Ritz body only the
    frame's rows change with its shape, so that with the inverse E⁻¹ of the rest, `elastic`, which a step size keeps, and
    the coupling X = σ[m_Oᵀ; s + Gδ] it is that of the frame's Schur complement F = σM₆ − X E⁻¹ Xᵀ:

        W = [ F⁻¹             −F⁻¹ X E⁻¹            ]
            [ −E⁻¹ Xᵀ F⁻¹     E⁻¹ + E⁻¹ Xᵀ F⁻¹ X E⁻¹ ]

    `floor` (b,) is a small inertia (kg m²) added to the iteration matrix, never to the equations, where a body has none
    of its own.
    """
    frame = np.empty((6, 6))
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] != RIGID and bodies.kind[b] != RITZ:
            continue
        o = bodies.offset[b]
        size = bodies.offset[b + 1] - o
        n = size - 6
        q = bodies.ritz_square[b]
        E = elastic[q : q + n * n].reshape(n, n)
        block = W[bodies.block[b] : bodies.block[b + 1]].reshape(size, size)
        if bodies.floating[b] == 0:
            block[:6, :] = 0.0
            block[6:, :6] = 0.0
            block[6:, 6:] = E
            continue
        coupling = np.empty((6, n))
        response = np.empty((6, n))
        frame_mass(bodies, b, state.e[o + 6 : o + size], frame, coupling)
        for k in range(6):
            for i in range(n):
                coupling[k, i] *= c.sigma
            multiply(E, coupling[k], response[k])
        for k in range(6):
            for l in range(6):
                frame[k, l] = c.sigma * frame[k, l] - inner(coupling[k], response[l])
        for i in range(3):
            frame[3 + i, 3 + i] += c.sigma * floor[b]
        invert(frame, block[:6, :6])
        for k in range(6):
            column = block[k][6:]
            column[:] = 0.0
            for l in range(6):
                add_multiple(-block[k, l], response[l], column)
            for i in range(n):
                block[6 + i, k] = column[i]
        for i in range(n):
            row = block[6 + i][6:]
            row[:] = E[i]
            for k in range(6):
                add_multiple(-response[k, i], block[k][6:], row)


@njit(cache=True)
def add_elastic_forces(bodies: BodyTable, b: int, shift: Array, rate_shift: Array, out: Array) -> None:
    """Add K Δe + D Δė of a Ritz body to out (n,)."""
    n = out.shape[0]
    q = bodies.ritz_square[b]
    k = bodies.k[q : q + n * n].reshape(n, n)
    D = bodies.D[q : q + n * n].reshape(n, n)
    for i in range(n):
        out[i] += inner(k[i], shift) + inner(D[i], rate_shift)


@njit(cache=True)
def damping_power(bodies: BodyTable, b: int, rate: Array) -> float:
    """Power (W) that the damping of a Ritz body takes."""
    n = rate.shape[0]
    q = bodies.ritz_square[b]
    D = bodies.D[q : q + n * n].reshape(n, n)
    power = 0.0
    for i in range(n):
        power += rate[i] * inner(D[i], rate)
    return power


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


@njit(cache=True)
def predict(
    bodies: BodyTable,
    motions: MotionTable,
    c: GeneralizedAlpha,
    t: float,
    linear: float,
    now: MotionState,
    next_motion: MotionState,
    state: StepVectors,
) -> None:
    """Predicted accelerations (linear: 1 extrapolates, 0 keeps them) and the Newmark state at time t."""
    a = state.a
    a_next = state.a_next
    a_previous = state.a_previous
    increment = state.increment
    multipliers = state.multipliers
    multipliers_next = state.multipliers_next
    multipliers_previous = state.multipliers_previous
    v = next_motion.v
    vd = next_motion.vd
    now_v = now.v
    now_vd = now.vd
    for i in range(a.shape[0]):
        a_next[i] = a[i] + linear * (a[i] - a_previous[i])
        vd[i] = ((1.0 - c.alpha_m) * a_next[i] + c.alpha_m * a[i] - c.alpha_f * now_vd[i]) / (1.0 - c.alpha_f)
        v[i] = now_v[i] + c.h * ((1.0 - c.gamma) * a[i] + c.gamma * a_next[i])
        increment[i] = c.h * now_v[i] + c.h * c.h * ((0.5 - c.beta) * a[i] + c.beta * a_next[i])
    for i in range(multipliers.shape[0]):
        multipliers_next[i] = multipliers[i] + linear * (multipliers[i] - multipliers_previous[i])
    move(bodies, now, increment, next_motion)
    prescribe(motions, bodies, t, next_motion)


@njit(cache=True)
def evaluate_state(
    bodies: BodyTable,
    liaisons: LiaisonTable,
    forces: ForceTable,
    t: float,
    next_motion: MotionState,
    attachments: AttachmentState,
    rows: LiaisonState,
    loads: Array,
    power: Array,
) -> None:
    """Attachments, liaison rows and applied forces at the end of the step."""
    attachment_motion(bodies, next_motion, attachments)
    evaluate_rows(liaisons, bodies, next_motion, attachments, t, rows)
    applied_forces(
        forces,
        bodies,
        liaisons,
        next_motion,
        attachments,
        rows,
        t,
        loads,
        power,
    )


@njit(cache=True)
def scaled_residuals(liaisons: LiaisonTable, rows: LiaisonState, scales: Array, out: Array) -> None:
    """The largest |Φ|, |A v + b|, |A v̇ + γ| over size, speed and acceleration (rotations: as angles); out (3,)."""
    row = liaisons.row
    row_position = rows.position
    row_velocity = rows.velocity
    row_acceleration = rows.acceleration
    out[:] = 0.0
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


@njit(cache=True)
def active_residuals(liaisons: LiaisonTable, rows: LiaisonState, scales: Array, pivot: Array) -> tuple[float, float]:
    """The largest scaled residual at any level of independent rows, and what those that depend on others are off by.

    Passing a singular position, a dependent row is not met for a step, its acceleration least of all.
    """
    row = liaisons.row
    worst = 0.0
    dropped = 0.0
    for i in range(row.shape[0]):
        arm = scales[0] if row[i, ROW_ANGULAR] == 1 else 1.0
        x = abs(rows.position[i]) * arm / scales[0] if row[i, ROW_HOLONOMIC] == 1 else 0.0
        y = abs(rows.velocity[i]) * arm / scales[1]
        z = abs(rows.acceleration[i]) * arm / scales[2]
        # written so that a NaN stays
        if pivot[i] > 0.0:
            worst = x if not (x <= worst) else worst
            worst = y if not (y <= worst) else worst
            worst = z if not (z <= worst) else worst
        else:
            dropped = x if not (x <= dropped) else dropped
            dropped = 0.01 * y if not (0.01 * y <= dropped) else dropped
    return worst, dropped


@njit(cache=True)
def correction_size(
    bodies: BodyTable,
    c: GeneralizedAlpha,
    tolerance: float,
    next_motion: MotionState,
    elastic: Array,
    scales: Array,
    delta: Array,
) -> float:
    """The largest component of δ over what counts as one, in units of the tolerance.

    Frames are judged by acceleration. Elastic coordinates too, but never finer than what a change of 1e-4 of
    the tolerance of their own position would be: below that their accelerations are round-off of K u.
    """
    kind = bodies.kind
    offset = bodies.offset
    elastic_next = next_motion.e
    vd = next_motion.vd
    largest = 0.0
    size, acceleration = scales[0], scales[2]
    floor = 1e-4 / (c.beta * c.h * c.h) if c.h > 0.0 else 0.0
    for b in range(kind.shape[0]):
        if kind[b] == FIXED:
            continue
        o = offset[b]
        e = offset[b + 1]
        reference = max(elastic[b, 1], floor * elastic[b, 0])
        for i in range(o + 6, e):
            reference = max(reference, abs(vd[i]), floor * abs(elastic_next[i]))
        for i in range(o, e):
            if i < o + 3:
                x = abs(delta[i]) / acceleration
            elif i < o + 6:
                x = abs(delta[i]) * size / acceleration
            else:
                x = abs(delta[i]) / reference if reference > 0.0 else 0.0
            if not (x <= largest):
                largest = x
    return largest / tolerance


@njit(cache=True)
def largest_move(bodies: BodyTable, c: GeneralizedAlpha, delta: Array) -> float:
    """By how much a correction changes positions at most: βh²|δ| (m, rad)."""
    largest = 0.0
    for i in range(bodies.offset[bodies.offset.shape[0] - 1]):
        x = abs(delta[i])
        if not (x <= largest):
            largest = x
    return c.beta * c.h * c.h * largest


@njit(cache=True)
def iterate(
    bodies: BodyTable,
    liaisons: LiaisonTable,
    forces: ForceTable,
    c: GeneralizedAlpha,
    t: float,
    tolerance: float,
    floor: Array,
    now: MotionState,
    next_motion: MotionState,
    attachments: AttachmentState,
    rows: LiaisonState,
    state: StepVectors,
    work: StepWork,
) -> tuple[int, int]:
    """Newton's iteration on the small system; returns (CONVERGED or why not, number of corrections).

    Unknown: the increment δ of the algorithmic accelerations (v̇ changes by σδ, v by γhδ, q by βh²δ), and
    three sets of liaison increments in the compliance W = Ŝ⁻¹: φ (acceleration), κ (velocity), π (position),

        Λ = A W Aᵀ,   Λ κ = −(A v + b) + (γh/σ)(A v̇ + γ),   Λ π = −Φ + (βh²/σ)(A v̇ + γ),
        x = −W (r + K Wᵀπ + D Wᵀκ),   Λ φ = A x + (A v̇ + γ)/σ,   δ = x − W Aᵀ φ

    after which Φ, A v + b, A v̇ + γ vanish together to first order; the loop takes them to round-off. Full-mesh
    bodies enter by `work.base` (their one back-substitution) and `work.accounted` and are linear here.
    """
    gravity = forces.gravity
    kind = bodies.kind
    offset = bodies.offset
    row = liaisons.row
    first = liaisons.skyline_first
    start = liaisons.skyline_start
    a = state.a
    a_next = state.a_next
    applied = state.applied
    rho = state.contraction
    increment = state.increment
    multipliers_next = state.multipliers_next
    power = state.power
    scales = state.scales
    elastic = state.elastic
    v = next_motion.v
    vd = next_motion.vd
    A = rows.A
    row_position = rows.position
    row_velocity = rows.velocity
    row_acceleration = rows.acceleration
    L = work.L
    W = work.W
    W_D = work.W_D
    W_Z = work.W_Z
    accounted = work.accounted
    base = work.base
    delta = work.delta
    active = work.active
    kappa = work.kappa
    loads = work.loads
    phi = work.phi
    pi = work.pi
    pivot = work.pivot
    position_force = work.position_force
    rate_shift = work.rate_shift
    residual = work.residual
    scale = work.scale
    shift = work.shift
    vector = work.vector
    velocity_force = work.velocity_force
    size = state.scales[0]
    J = work.spring_J
    border = work.spring_border
    springs = J.shape[0]
    n = a.shape[0]
    r = row.shape[0]
    error = 0.0
    previous = 0.0
    contraction = rho[0]
    worst_before = math.inf
    measured = rho[1] < 10.0
    refresh = True
    accounted[:] = 0.0
    position_force[:] = 0.0
    velocity_force[:] = 0.0
    sine = 1.0  # of the smallest angle between rows
    has_ritz = False
    for b in range(kind.shape[0]):
        if kind[b] == RITZ:
            has_ritz = True
    for iteration in range(MAX_ITERATIONS + 1):
        evaluate_state(bodies, liaisons, forces, t, next_motion, attachments, rows, loads, power)
        worst, dropped = active_residuals(liaisons, rows, scales, pivot)
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
            stalled = iteration >= 3 and error > 0.3 * previous and largest_move(bodies, c, delta) <= ROUND_OFF * size
            if (estimate <= 1.0 or stalled) and settled and dropped <= DROPPED:
                if iteration >= 2:
                    rho[1] = 0.0
                else:
                    rho[1] += 1.0
                return CONVERGED, iteration
        if iteration == MAX_ITERATIONS:
            break
        worst_before = worst
        if refresh:
            if has_ritz:
                compliances(bodies, next_motion, c, floor, work.elastic, W)
            assemble_compliance(liaisons, bodies, A, W, L)
            sine = 1.0
            if factorise(first, start, L, pivot, scale, active, True) < SUSPECT:
                assemble_compliance(liaisons, bodies, A, work.metric, L)
                sine = math.sqrt(find_singular(first, start, L, pivot, work.metric_scale, active))
                assemble_compliance(liaisons, bodies, A, W, L)
                factorise(first, start, L, pivot, scale, active, False)
            else:
                active[:] = 1
            for i in range(r):
                if pivot[i] == 0.0:
                    multipliers_next[i] = 0.0
            if springs > 0:
                spring_rows(forces, bodies, liaisons, next_motion, attachments, rows.coordinate_wrench, J)
                spring_border(
                    forces, bodies, liaisons, c, A, W, L, pivot, J, work.spring_W, border, work.spring_inverse
                )
            refresh = False
        transpose_product(liaisons, bodies, A, multipliers_next, applied)
        for i in range(n):
            applied[i] -= loads[i]
        for i in range(r):
            acceleration = row_acceleration[i] / c.sigma
            kappa[i] = -row_velocity[i] + c.gamma * c.h * acceleration
            pi[i] = -row_position[i] + c.beta * c.h * c.h * acceleration
            if row[i, ROW_HOLONOMIC] == 0:
                pi[i] = 0.0
        if c.h > 0.0:
            solve(first, start, L, pivot, kappa)
            solve(first, start, L, pivot, pi)
            transpose_product(liaisons, bodies, A, pi, vector)
            block_product(bodies, W, vector, shift)
            for i in range(n):
                position_force[i] += vector[i]
            block_product(bodies, W_Z, vector, delta, True)
            transpose_product(liaisons, bodies, A, kappa, vector)
            block_product(bodies, W, vector, rate_shift)
            for i in range(n):
                velocity_force[i] += vector[i]
            block_product(bodies, W_D, vector, residual, True)
            # what the shifts of mesh bodies' elastic coordinates do through K and D: −Zπ, −Z_Dκ
            for i in range(n):
                delta[i] = -delta[i] - residual[i]
        else:
            shift[:] = 0.0
            rate_shift[:] = 0.0
            delta[:] = 0.0
        residual[:] = 0.0
        vector[:] = 0.0
        if springs > 0:
            shift_springs(forces, J, shift, rate_shift, vector)
        for b in range(kind.shape[0]):
            o = offset[b]
            e = offset[b + 1]
            if kind[b] == RIGID or kind[b] == RITZ:
                inertia_residual(bodies, b, next_motion, gravity, residual[o:e])
                if e > o + 6:
                    add_elastic_forces(bodies, b, shift[o + 6 : e], rate_shift[o + 6 : e], residual[o + 6 : e])
                for i in range(o, e):
                    residual[i] += applied[i] + vector[i]
            elif kind[b] == MESH:
                for i in range(o, e):
                    residual[i] = applied[i] + vector[i] - accounted[i]
                    accounted[i] = applied[i] + vector[i]
                if iteration == 0:
                    for i in range(o, o + 6):
                        residual[i] += base[i]
                    for i in range(o + 6, e):
                        delta[i] += base[i]
        block_product(bodies, W, residual, vector)
        for i in range(n):
            delta[i] -= vector[i]
        product(liaisons, bodies, A, delta, phi)
        for i in range(r):
            phi[i] += row_acceleration[i] / c.sigma
            kappa[i] = phi[i]
        solve(first, start, L, pivot, phi)
        if springs > 0:
            residual[:] = 0.0
            solve_springs(J, border, work.spring_inverse, delta, kappa, phi, residual, work.spring_force)
        transpose_product(liaisons, bodies, A, phi, vector)
        if springs > 0:
            for i in range(n):
                vector[i] += residual[i]
        for b in range(kind.shape[0]):
            if kind[b] == MESH:
                for i in range(offset[b], offset[b + 1]):
                    accounted[i] += vector[i]
        block_product(bodies, W, vector, residual)
        for i in range(n):
            delta[i] -= residual[i]
        for i in range(r):
            multipliers_next[i] += phi[i]
        for i in range(n):
            d = delta[i]
            a_next[i] += d
            vd[i] += c.sigma * d
            v[i] += c.gamma * c.h * d + rate_shift[i]
            increment[i] += c.beta * c.h * c.h * d + shift[i]
        if c.h > 0.0:
            move(bodies, now, increment, next_motion)
        previous = error
        error = correction_size(bodies, c, tolerance, next_motion, elastic, scales, delta)
        if iteration > 0 and previous > 0.0:
            contraction = max(min(error / previous, 2.0), 1e-3)
            if contraction > REFRESH_ABOVE:
                refresh = True
            rho[0] = min(contraction, 0.5)
    return NOT_CONVERGED, MAX_ITERATIONS


@njit(cache=True)
def constraint_power(
    bodies: BodyTable,
    gravity: Array,
    next_motion: MotionState,
    rhs: Array,
    multipliers_next: Array,
    applied: Array,
    base: Array,
    residual: Array,
) -> float:
    """Power (W) that driven rows and prescribed frames put into the mechanism: λᵀb and frame force × twist."""
    floating = bodies.floating
    kind = bodies.kind
    offset = bodies.offset
    v = next_motion.v
    value = 0.0
    for i in range(rhs.shape[0]):
        value += multipliers_next[i] * rhs[i]
    for b in range(kind.shape[0]):
        if kind[b] == FIXED or floating[b] == 1:
            continue
        o = offset[b]
        if kind[b] == MESH:
            for i in range(o, o + 6):
                value += (base[i] + applied[i]) * v[i]
        else:
            inertia_residual(bodies, b, next_motion, gravity, residual[o : offset[b + 1]])
            for i in range(o, o + 6):
                value += (residual[i] + applied[i]) * v[i]
    return value


@njit(cache=True)
def accept(
    bodies: BodyTable,
    liaisons: LiaisonTable,
    gravity: Array,
    c: GeneralizedAlpha,
    mesh_dissipation: float,
    now: MotionState,
    next_motion: MotionState,
    rows: LiaisonState,
    state: StepVectors,
    work: StepWork,
) -> None:
    """Make `next` the present: integrate work and dissipation by the trapezoidal rule, renew the scales.

    mesh_dissipation: power (W) that the damping of meshed bodies takes now.
    """
    kind = bodies.kind
    offset = bodies.offset
    applied = state.applied
    multipliers = state.multipliers
    multipliers_next = state.multipliers_next
    multipliers_previous = state.multipliers_previous
    v = next_motion.v
    transpose_product(liaisons, bodies, rows.A, multipliers_next, applied)
    for i in range(applied.shape[0]):
        applied[i] -= work.loads[i]
    dissipation = state.power[1] + mesh_dissipation
    for b in range(kind.shape[0]):
        if kind[b] != RITZ:
            continue
        dissipation += damping_power(bodies, b, v[offset[b] + 6 : offset[b + 1]])
    power = constraint_power(
        bodies, gravity, next_motion, rows.rhs, multipliers_next, applied, work.base, work.residual
    )
    power += state.power[2]
    done = state.work
    done[0] += 0.5 * c.h * (done[2] + power)
    done[1] += 0.5 * c.h * (done[3] + dissipation)
    done[2] = power
    done[3] = dissipation
    state.a_previous[:] = state.a
    state.a[:] = state.a_next
    now.e[:] = next_motion.e
    now.v[:] = v
    now.vd[:] = next_motion.vd
    now.origin[:] = next_motion.origin
    now.rotation[:] = next_motion.rotation
    for i in range(multipliers.shape[0]):
        multipliers_previous[i] = multipliers[i]
        multipliers[i] = multipliers_next[i]
    rows.previous[:] = rows.coordinate[:, 0]
    update_scales(bodies.kind, bodies.offset, now, state.elastic, state.scales)


@njit(cache=True)
def update_scales(kind: IntArray, offset: IntArray, now: MotionState, elastic: Array, scales: Array) -> None:
    """Speed and acceleration of the mechanism: the largest so far, fading over some hundred steps."""
    now_e = now.e
    now_v = now.v
    now_vd = now.vd
    speed = 0.99 * scales[1]
    acceleration = 0.99 * scales[2]
    size = scales[0]
    for b in range(kind.shape[0]):
        if kind[b] == FIXED:
            continue
        o = offset[b]
        v = now_v[o : o + 6]
        z = now_vd[o : o + 6]
        linear = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        spin = math.sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5])
        speed = max(speed, linear, size * spin)
        linear = math.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
        turn = math.sqrt(z[3] * z[3] + z[4] * z[4] + z[5] * z[5])
        acceleration = max(acceleration, linear, size * turn, size * spin * spin)
        elastic[b, 0] *= 0.99
        elastic[b, 1] *= 0.99
        for i in range(o + 6, offset[b + 1]):
            elastic[b, 0] = max(elastic[b, 0], abs(now_e[i]))
            elastic[b, 1] = max(elastic[b, 1], abs(now_vd[i]))
    scales[1] = max(speed, scales[3])
    scales[2] = max(acceleration, scales[4])


@njit(cache=True)
def advance(
    bodies: BodyTable,
    motions: MotionTable,
    liaisons: LiaisonTable,
    forces: ForceTable,
    c: GeneralizedAlpha,
    phase: int,
    t: float,
    steps: int,
    linear: float,
    tolerance: float,
    floor: Array,
    mesh_dissipation: float,
    now: MotionState,
    next_motion: MotionState,
    attachments: AttachmentState,
    rows: LiaisonState,
    state: StepVectors,
    work: StepWork,
) -> tuple[int, int, int]:
    """Up to `steps` steps from time t, or one phase of a step; returns (reason it ended, steps done, corrections).

    phase: WHOLE_STEPS, or PREDICT, ITERATE, ACCEPT of a single step to t + h for mechanisms with meshed bodies,
    whose back-substitutions come between. One entry point, because each costs seconds to compile. linear: how the first
    step predicts (1 extrapolates); later ones extrapolate.
    """
    total = 0
    for k in range(steps):
        end = t + (k + 1) * c.h
        if phase == WHOLE_STEPS or phase == PREDICT:
            predict(bodies, motions, c, end, linear if k == 0 else 1.0, now, next_motion, state)
        if phase == WHOLE_STEPS or phase == ITERATE:
            reason, corrections = iterate(
                bodies, liaisons, forces, c, end, tolerance, floor, now, next_motion, attachments, rows, state, work
            )
            total += corrections
            if reason != CONVERGED:
                return reason, k, total
        if phase == WHOLE_STEPS or phase == ACCEPT:
            accept(bodies, liaisons, forces.gravity, c, mesh_dissipation, now, next_motion, rows, state, work)
    return CONVERGED, steps, total

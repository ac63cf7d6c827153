"""The compiled step of the small system (Theory §5): predict, iterate on liaisons and bodies together, accept."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from maggi.bodies.kernels import attachment_motion, inertia_residual, mass_matrix
from maggi.bodies.motions import prescribe
from maggi.bodies.tables import FIXED, MESH, RIGID, RITZ, Array, BodyTable, MotionState
from maggi.forces.kernels import applied_forces
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.liaisons.kernels import evaluate_rows
from maggi.liaisons.tables import DRIVEN, DRIVEN_RATE, OFFSET, ROTATION, LiaisonTable
from maggi.linalg.rotations import exp_se3_update
from maggi.projection.range_space import (
    assemble_compliance,
    block_product,
    factorise,
    product,
    solve,
    transpose_product,
)

from .tables import SmallSystem, StepState, StepWork

CONVERGED, NOT_CONVERGED, NOT_FINITE = 0, 1, 2
MAX_ITERATIONS = 25
REFRESH_ABOVE = 0.1  # contraction above which the iteration's matrices are made anew
ROUND_OFF = 1e-12  # liaison residuals, relative to size, speed and acceleration
STALLED = 1e-10  # accepted where round-off lets them fall no further


@njit(cache=True)
def compliances(
    bodies: BodyTable, kind: int, state: MotionState, c: GeneralizedAlpha, floor: Array, W: Array
) -> None:
    """W = Ŝ⁻¹ with Ŝ = σM + γhD + βh²K for all bodies of one kind, RIGID or RITZ, as they stand (Eq. T12).

    A rigid body's is constant in its own axes; mesh bodies' are kept by `stepping.mesh`. `floor` (b,) is a small
    inertia (kg m²) added to the iteration matrix, never to the equations, where a body has none of its own.
    """
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] != kind:
            continue
        o = bodies.offset[b]
        size = bodies.offset[b + 1] - o
        n = size - 6
        matrix = np.empty((size, size))
        mass_matrix(bodies, b, state.e[o + 6 : o + size], matrix)
        q = bodies.ritz_square[b]
        for i in range(size):
            for j in range(size):
                matrix[i, j] *= c.sigma
        for i in range(3):
            matrix[3 + i, 3 + i] += c.sigma * floor[b]
        for i in range(n):
            for j in range(n):
                matrix[6 + i, 6 + j] += (
                    c.gamma * c.h * bodies.D[q + i * n + j] + c.beta * c.h * c.h * bodies.k[q + i * n + j]
                )
        block = W[bodies.block[b] : bodies.block[b + 1]].reshape(size, size)
        block[:, :] = 0.0
        if bodies.floating[b] == 1:
            block[:, :] = np.linalg.inv(matrix)
        elif n > 0:
            block[6:, 6:] = np.linalg.inv(matrix[6:, 6:].copy())


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
def copy_motion(source: MotionState, target: MotionState) -> None:
    """Copy one state's arrays into another's."""
    target.origin[:] = source.origin
    target.rotation[:] = source.rotation
    target.e[:] = source.e
    target.v[:] = source.v
    target.vd[:] = source.vd


@njit(cache=True)
def predict(system: SmallSystem, c: GeneralizedAlpha, t: float, linear: float, state: StepState) -> None:
    """Predicted accelerations (linear: 1 extrapolates, 0 keeps them) and the Newmark state at time t."""
    bodies = system.bodies
    for i in range(state.a.shape[0]):
        state.a_next[i] = state.a[i] + linear * (state.a[i] - state.a_previous[i])
        state.next.vd[i] = (
            (1.0 - c.alpha_m) * state.a_next[i] + c.alpha_m * state.a[i] - c.alpha_f * state.now.vd[i]
        ) / (1.0 - c.alpha_f)
        state.next.v[i] = state.now.v[i] + c.h * ((1.0 - c.gamma) * state.a[i] + c.gamma * state.a_next[i])
        state.increment[i] = c.h * state.now.v[i] + c.h * c.h * (
            (0.5 - c.beta) * state.a[i] + c.beta * state.a_next[i]
        )
    for i in range(state.multipliers.shape[0]):
        state.multipliers_next[i] = state.multipliers[i] + linear * (
            state.multipliers[i] - state.multipliers_previous[i]
        )
    move(bodies, state.now, state.increment, state.next)
    prescribe(system.motions, bodies, t, state.next)


@njit(cache=True)
def evaluate_state(system: SmallSystem, t: float, state: StepState, work: StepWork) -> None:
    """Attachments, liaison rows and applied forces of `state.next`."""
    attachment_motion(system.bodies, state.next, state.attachments)
    evaluate_rows(system.liaisons, system.bodies, state.next, state.attachments, t, state.rows)
    applied_forces(
        system.forces,
        system.bodies,
        system.liaisons,
        state.next,
        state.attachments,
        state.rows,
        t,
        work.loads,
        state.power,
    )


@njit(cache=True)
def row_is_rotation(liaisons: LiaisonTable, i: int) -> bool:
    """Whether a row restricts a rotation: its residuals are then in rad, rad/s, rad/s²."""
    kind = liaisons.row_kind[i]
    if kind == DRIVEN or kind == DRIVEN_RATE:
        return liaisons.coordinate_kind[liaisons.row_first[i]] == ROTATION
    return kind != OFFSET


@njit(cache=True)
def scaled_residuals(liaisons: LiaisonTable, state: StepState, out: Array) -> None:
    """The largest |Φ|, |A v + b|, |A v̇ + γ| over size, speed and acceleration (rotations: as angles); out (3,)."""
    out[:] = 0.0
    size, speed, acceleration = state.scales[0], state.scales[1], state.scales[2]
    for i in range(liaisons.row_kind.shape[0]):
        arm = size if row_is_rotation(liaisons, i) else 1.0
        x = abs(state.rows.velocity[i]) * arm / speed
        y = abs(state.rows.acceleration[i]) * arm / acceleration
        z = abs(state.rows.position[i]) * arm / size if liaisons.holonomic[i] == 1 else 0.0
        # written so that a NaN stays
        out[0] = z if not (z <= out[0]) else out[0]
        out[1] = x if not (x <= out[1]) else out[1]
        out[2] = y if not (y <= out[2]) else out[2]


@njit(cache=True)
def correction_size(bodies: BodyTable, c: GeneralizedAlpha, tolerance: float, state: StepState, delta: Array) -> float:
    """The largest component of δ over what counts as one, in units of the tolerance.

    Frames are judged by acceleration. Elastic coordinates too, but never finer than what a change of 1e-4 of
    the tolerance of their own position would be: below that their accelerations are round-off of K u.
    """
    largest = 0.0
    size, acceleration = state.scales[0], state.scales[2]
    floor = 1e-4 / (c.beta * c.h * c.h) if c.h > 0.0 else 0.0
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED:
            continue
        o = bodies.offset[b]
        e = bodies.offset[b + 1]
        reference = max(state.elastic[b, 1], floor * state.elastic[b, 0])
        for i in range(o + 6, e):
            reference = max(reference, abs(state.next.vd[i]), floor * abs(state.next.e[i]))
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
def iterate(
    system: SmallSystem,
    c: GeneralizedAlpha,
    t: float,
    tolerance: float,
    floor: Array,
    state: StepState,
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
    bodies = system.bodies
    liaisons = system.liaisons
    n = state.a.shape[0]
    r = liaisons.row_kind.shape[0]
    first, start = liaisons.skyline_first, liaisons.skyline_start
    gravity = system.forces.gravity
    residuals = np.empty(3)
    error = 0.0
    previous = 0.0
    contraction = state.contraction[0]
    worst_before = math.inf
    measured = state.contraction[1] < 10.0
    refresh = True
    work.accounted[:] = 0.0
    work.position_force[:] = 0.0
    work.velocity_force[:] = 0.0
    has_ritz = False
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == RITZ:
            has_ritz = True
    for iteration in range(MAX_ITERATIONS + 1):
        evaluate_state(system, t, state, work)
        scaled_residuals(liaisons, state, residuals)
        worst = max(residuals[0], residuals[1], residuals[2])
        if not math.isfinite(worst) or not math.isfinite(error):
            return NOT_FINITE, iteration
        if iteration > 0:
            estimate = error * contraction / (1.0 - contraction) if contraction < 1.0 else math.inf
            if iteration == 1 and not measured:
                estimate = math.inf
            settled = worst <= ROUND_OFF or (worst <= STALLED and worst > 0.3 * worst_before)
            if estimate <= 1.0 and settled:
                if iteration >= 2:
                    state.contraction[1] = 0.0
                else:
                    state.contraction[1] += 1.0
                return CONVERGED, iteration
        if iteration == MAX_ITERATIONS:
            break
        worst_before = worst
        if refresh:
            if has_ritz:
                compliances(bodies, RITZ, state.next, c, floor, work.W)
            assemble_compliance(liaisons, bodies, state.rows.A, work.W, work.L)
            work.independent[0] = factorise(first, start, work.L, work.pivot, work.scale)
            for i in range(r):
                if work.pivot[i] == 0.0:
                    state.multipliers_next[i] = 0.0
            refresh = False
        transpose_product(liaisons, bodies, state.rows.A, state.multipliers_next, state.applied)
        for i in range(n):
            state.applied[i] -= work.loads[i]
        for i in range(r):
            acceleration = state.rows.acceleration[i] / c.sigma
            work.kappa[i] = -state.rows.velocity[i] + c.gamma * c.h * acceleration
            work.pi[i] = -state.rows.position[i] + c.beta * c.h * c.h * acceleration
            if liaisons.holonomic[i] == 0:
                work.pi[i] = 0.0
        if c.h > 0.0:
            solve(first, start, work.L, work.pivot, work.kappa)
            solve(first, start, work.L, work.pivot, work.pi)
            transpose_product(liaisons, bodies, state.rows.A, work.pi, work.vector)
            block_product(bodies, work.W, work.vector, work.shift)
            for i in range(n):
                work.position_force[i] += work.vector[i]
            block_product(bodies, work.W_Z, work.vector, work.delta)
            transpose_product(liaisons, bodies, state.rows.A, work.kappa, work.vector)
            block_product(bodies, work.W, work.vector, work.rate_shift)
            for i in range(n):
                work.velocity_force[i] += work.vector[i]
            block_product(bodies, work.W_D, work.vector, work.residual)
            # what the shifts of mesh bodies' elastic coordinates do through K and D: −Zπ, −Z_Dκ
            for i in range(n):
                work.delta[i] = -work.delta[i] - work.residual[i]
        else:
            work.shift[:] = 0.0
            work.rate_shift[:] = 0.0
            work.delta[:] = 0.0
        work.residual[:] = 0.0
        for b in range(bodies.kind.shape[0]):
            o = bodies.offset[b]
            e = bodies.offset[b + 1]
            if bodies.kind[b] == RIGID or bodies.kind[b] == RITZ:
                inertia_residual(bodies, b, state.next, gravity, work.residual[o:e])
                m = e - o - 6
                q = bodies.ritz_square[b]
                for i in range(m):
                    value = 0.0
                    for j in range(m):
                        value += (
                            bodies.k[q + i * m + j] * work.shift[o + 6 + j]
                            + bodies.D[q + i * m + j] * work.rate_shift[o + 6 + j]
                        )
                    work.residual[o + 6 + i] += value
                for i in range(o, e):
                    work.residual[i] += state.applied[i]
            elif bodies.kind[b] == MESH:
                for i in range(o, e):
                    work.residual[i] = state.applied[i] - work.accounted[i]
                    work.accounted[i] = state.applied[i]
                if iteration == 0:
                    for i in range(o, o + 6):
                        work.residual[i] += work.base[i]
                    for i in range(o + 6, e):
                        work.delta[i] += work.base[i]
        block_product(bodies, work.W, work.residual, work.vector)
        for i in range(n):
            work.delta[i] -= work.vector[i]
        product(liaisons, bodies, state.rows.A, work.delta, work.phi)
        for i in range(r):
            work.phi[i] += state.rows.acceleration[i] / c.sigma
        solve(first, start, work.L, work.pivot, work.phi)
        transpose_product(liaisons, bodies, state.rows.A, work.phi, work.vector)
        for b in range(bodies.kind.shape[0]):
            if bodies.kind[b] == MESH:
                for i in range(bodies.offset[b], bodies.offset[b + 1]):
                    work.accounted[i] += work.vector[i]
        block_product(bodies, work.W, work.vector, work.residual)
        for i in range(n):
            work.delta[i] -= work.residual[i]
        for i in range(r):
            state.multipliers_next[i] += work.phi[i]
        for i in range(n):
            d = work.delta[i]
            state.a_next[i] += d
            state.next.vd[i] += c.sigma * d
            state.next.v[i] += c.gamma * c.h * d + work.rate_shift[i]
            state.increment[i] += c.beta * c.h * c.h * d + work.shift[i]
        if c.h > 0.0:
            move(bodies, state.now, state.increment, state.next)
        previous = error
        error = correction_size(bodies, c, tolerance, state, work.delta)
        if iteration > 0 and previous > 0.0:
            contraction = max(min(error / previous, 2.0), 1e-3)
            if contraction > REFRESH_ABOVE:
                refresh = True
            state.contraction[0] = min(contraction, 0.5)
    return NOT_CONVERGED, MAX_ITERATIONS


@njit(cache=True)
def constraint_power(system: SmallSystem, state: StepState, work: StepWork) -> float:
    """Power (W) that driven rows and prescribed frames put into the mechanism: λᵀb and frame force × twist."""
    value = 0.0
    for i in range(system.liaisons.row_kind.shape[0]):
        value += state.multipliers_next[i] * state.rows.rhs[i]
    bodies = system.bodies
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED or bodies.floating[b] == 1:
            continue
        o = bodies.offset[b]
        if bodies.kind[b] == MESH:
            for i in range(o, o + 6):
                value += (work.base[i] + state.applied[i]) * state.next.v[i]
        else:
            inertia_residual(bodies, b, state.next, system.forces.gravity, work.residual[o : bodies.offset[b + 1]])
            for i in range(o, o + 6):
                value += (work.residual[i] + state.applied[i]) * state.next.v[i]
    return value


@njit(cache=True)
def accept(
    system: SmallSystem, c: GeneralizedAlpha, mesh_dissipation: float, state: StepState, work: StepWork
) -> None:
    """Make `next` the present: integrate work and dissipation by the trapezoidal rule, renew the scales.

    mesh_dissipation: power (W) that the damping of meshed bodies takes now.
    """
    bodies = system.bodies
    transpose_product(system.liaisons, bodies, state.rows.A, state.multipliers_next, state.applied)
    for i in range(state.applied.shape[0]):
        state.applied[i] -= work.loads[i]
    ritz_power = 0.0
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] != RITZ:
            continue
        o = bodies.offset[b] + 6
        m = bodies.offset[b + 1] - o
        q = bodies.ritz_square[b]
        for i in range(m):
            for j in range(m):
                ritz_power += state.next.v[o + i] * bodies.D[q + i * m + j] * state.next.v[o + j]
    power = constraint_power(system, state, work) + state.power[2]
    dissipation = state.power[1] + ritz_power + mesh_dissipation
    state.work[0] += 0.5 * c.h * (state.work[2] + power)
    state.work[1] += 0.5 * c.h * (state.work[3] + dissipation)
    state.work[2] = power
    state.work[3] = dissipation
    for i in range(state.a.shape[0]):
        state.a_previous[i] = state.a[i]
        state.a[i] = state.a_next[i]
        state.now.e[i] = state.next.e[i]
        state.now.v[i] = state.next.v[i]
        state.now.vd[i] = state.next.vd[i]
    state.now.origin[:] = state.next.origin
    state.now.rotation[:] = state.next.rotation
    for i in range(state.multipliers.shape[0]):
        state.multipliers_previous[i] = state.multipliers[i]
        state.multipliers[i] = state.multipliers_next[i]
    state.rows.previous[:] = state.rows.coordinate
    update_scales(bodies, state)


@njit(cache=True)
def update_scales(bodies: BodyTable, state: StepState) -> None:
    """Speed and acceleration of the mechanism: the largest so far, fading over some hundred steps."""
    speed = 0.99 * state.scales[1]
    acceleration = 0.99 * state.scales[2]
    size = state.scales[0]
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED:
            continue
        o = bodies.offset[b]
        v = state.now.v[o : o + 6]
        z = state.now.vd[o : o + 6]
        linear = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        spin = math.sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5])
        speed = max(speed, linear, size * spin)
        linear = math.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
        turn = math.sqrt(z[3] * z[3] + z[4] * z[4] + z[5] * z[5])
        acceleration = max(acceleration, linear, size * turn, size * spin * spin)
        state.elastic[b, 0] *= 0.99
        state.elastic[b, 1] *= 0.99
        for i in range(o + 6, bodies.offset[b + 1]):
            state.elastic[b, 0] = max(state.elastic[b, 0], abs(state.now.e[i]))
            state.elastic[b, 1] = max(state.elastic[b, 1], abs(state.now.vd[i]))
    state.scales[1] = max(speed, state.scales[3])
    state.scales[2] = max(acceleration, state.scales[4])


@njit(cache=True)
def run_steps(
    system: SmallSystem,
    c: GeneralizedAlpha,
    t: float,
    steps: int,
    linear: float,
    tolerance: float,
    floor: Array,
    state: StepState,
    work: StepWork,
) -> tuple[int, int, int]:
    """Up to `steps` steps from time t; returns (reason it ended, steps done, corrections in all)."""
    total = 0
    for k in range(steps):
        predict(system, c, t + (k + 1) * c.h, linear if k == 0 else 1.0, state)
        reason, corrections = iterate(system, c, t + (k + 1) * c.h, tolerance, floor, state, work)
        total += corrections
        if reason != CONVERGED:
            return reason, k, total
        accept(system, c, 0.0, state, work)
    return CONVERGED, steps, total

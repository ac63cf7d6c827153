"""Compiled: the end of a step becomes the present."""

from __future__ import annotations

import math

from maggi.bodies.tables import FIXED, Array, MotionState
from maggi.liaisons.coordinates import joint_coordinate
from maggi.linalg.compiling import inner_kernel
from maggi.linalg.links import Link, call3
from maggi.projection.tree_tables import GENERAL

from .tables import (
    BEST,
    BLOCK_POWER,
    GIVEN_POWER,
    HIGHEST_ORDER,
    ORDER,
    TAKEN_POWER,
    SmallSystem,
    StepState,
    StepVectors,
    StepWork,
)

FADING = 0.6  # a step, of what predictions were off by


@inner_kernel
def best_order(small: SmallSystem, order: int, vectors: StepVectors, misses: Array) -> int:
    """The order, up to that available, by which the accelerations of the last steps would have been predicted best.

    Smooth motion asks for the highest. Where a step does not resolve an oscillation, accelerations change sign from step to
    step, and every order more would double what a prediction is off by. A single step is not enough to tell, since any
    difference may happen to pass through zero: `misses` fade over some steps, and a new order starts with those of the
    one below.
    """
    a, a_next, differences, size = vectors.a, vectors.a_next, vectors.a_differences, small.tree.size
    e0 = e1 = e2 = e3 = e4 = e5 = 0.0
    for i in range(a.shape[0]):
        w = size[i] if size[i] > 0.0 else 1.0
        # a prediction of order k misses by ∇ᵏ⁺¹ of this step
        d0 = w * (a_next[i] - a[i])
        d1 = d0 - w * differences[0, i]
        d2 = d1 - w * differences[1, i]
        d3 = d2 - w * differences[2, i]
        d4 = d3 - w * differences[3, i]
        d5 = d4 - w * differences[4, i]
        e0 += d0 * d0
        e1 += d1 * d1
        e2 += d2 * d2
        e3 += d3 * d3
        e4 += d4 * d4
        e5 += d5 * d5
    now = (e0, e1, e2, e3, e4, e5)
    best = 0
    if order == 0:
        for k in range(misses.shape[0]):
            misses[k] = 0.0
    for k in range(order + 1):
        if k > 0 and k == order and (k < HIGHEST_ORDER or misses[k] == 0.0):
            misses[k] = misses[k - 1]
        misses[k] = FADING * misses[k] + now[k]
        if misses[k] < misses[best]:
            best = k
    # one more than could be tried for as long as the steps before are few
    return best + 1 if best == order else best


@Link
def accept(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Make the end of the step the present: integrate work and dissipation by the trapezoidal rule, renew the scales.

    What damping of meshes takes is added by `Stepper`.
    """
    tree, bodies, motion, vectors, rows = small.tree, small.step_bodies, state.motion, state.vectors, state.rows
    h = work.method[0]
    given = state.power[2]  # of loads, of driven rows λᵀb, and of prescribed frames
    taken = state.power[1]
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
    work.flags[BEST] = best_order(small, work.flags[ORDER], vectors, work.misses)
    renew(vectors.a_next, vectors.a, vectors.a_differences)
    renew(vectors.shift_next, vectors.shift, vectors.shift_differences)
    renew(vectors.rate_shift_next, vectors.rate_shift, vectors.rate_shift_differences)
    nu, nu_next, nud, nud_next = vectors.nu, vectors.nu_next, vectors.nud, vectors.nud_next
    for i in range(nu.shape[0]):
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


@inner_kernel
def renew(x_next: Array, x: Array, differences: Array) -> None:
    """x becomes x_next, and `differences` (HIGHEST_ORDER, n) its backward differences ∇x … ∇⁵x."""
    for i in range(x.shape[0]):
        d0 = x_next[i] - x[i]
        d1 = d0 - differences[0, i]
        d2 = d1 - differences[1, i]
        d3 = d2 - differences[2, i]
        d4 = d3 - differences[3, i]
        x[i] = x_next[i]
        differences[0, i] = d0
        differences[1, i] = d1
        differences[2, i] = d2
        differences[3, i] = d3
        differences[4, i] = d4


@inner_kernel
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

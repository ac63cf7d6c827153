"""Compiled: where a step begins, by extrapolation."""

from __future__ import annotations

from maggi.bodies.tables import Array
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.compiling import inner_kernel
from maggi.linalg.links import Link
from maggi.linalg.rotations import exp_se3_update

from .tables import BEST, ORDER, SmallSystem, StepState, StepWork


@inner_kernel
def coefficients(work: StepWork) -> GeneralizedAlpha:
    """Those of the present step size."""
    m = work.method
    return GeneralizedAlpha(m[0], m[1], m[2], m[3], m[4], m[5])


@Link
def predict(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Accelerations extrapolated by a polynomial of the order that did best, and the Newmark state that follows.

    So are the shifts by which closures are met: Newmark's polynomials miss them by much the same from step to step.
    """
    c, order = coefficients(work), min(work.flags[ORDER], work.flags[BEST])
    vectors = state.vectors
    a, a_next = vectors.a, vectors.a_next
    nu, nu_next, nud, nud_next = vectors.nu, vectors.nu_next, vectors.nud, vectors.nud_next
    increment = vectors.increment
    extrapolate(a, vectors.a_differences, order, a_next)
    x0, x1 = c.h * (1.0 - c.gamma), c.h * c.gamma
    y0, y1 = c.h * c.h * (0.5 - c.beta), c.h * c.h * c.beta
    z0, z1, z2 = (1.0 - c.alpha_m) / (1.0 - c.alpha_f), c.alpha_m / (1.0 - c.alpha_f), c.alpha_f / (1.0 - c.alpha_f)
    for i in range(a.shape[0]):
        b = a_next[i]
        nud_next[i] = z0 * b + z1 * a[i] - z2 * nud[i]
        nu_next[i] = nu[i] + x0 * a[i] + x1 * b
        increment[i] = c.h * nu[i] + y0 * a[i] + y1 * b
    shift, rate_shift = vectors.shift_next, vectors.rate_shift_next
    if order > 0:  # the first step of a size has none before
        extrapolate(vectors.shift, vectors.shift_differences, order - 1, shift)
        extrapolate(vectors.rate_shift, vectors.rate_shift_differences, order - 1, rate_shift)
        for i in range(shift.shape[0]):
            increment[i] += shift[i]
            nu_next[i] += rate_shift[i]
    else:
        for i in range(shift.shape[0]):
            shift[i] = 0.0
            rate_shift[i] = 0.0
    before, following, last = vectors.multipliers_previous, vectors.multipliers_next, vectors.multipliers
    for i in range(last.shape[0]):
        following[i] = last[i] + (last[i] - before[i] if order > 0 else 0.0)


@inner_kernel
def extrapolate(x: Array, differences: Array, order: int, out: Array) -> None:
    """The polynomial through the last values, one step further: x + ∇x + … + ∇ᵏx, k the order."""
    for i in range(x.shape[0]):
        out[i] = x[i]
    for k in range(order):
        for i in range(x.shape[0]):
            out[i] += differences[k, i]


@inner_kernel
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

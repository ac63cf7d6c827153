"""Compiled: how far a step is from converged, and by how much its size errs."""

from __future__ import annotations

from maggi.bodies.tables import Array
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.liaisons.tables import ROW_ANGULAR, ROW_HOLONOMIC, LiaisonState, LiaisonTable
from maggi.linalg.compiling import inner_kernel, kernel

from .tables import SmallSystem, StepState


@kernel
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


@inner_kernel
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


@inner_kernel
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


@inner_kernel
def largest_of(delta: Array) -> float:
    """max |δ|, NaN where one is."""
    largest = 0.0
    for i in range(delta.shape[0]):
        x = abs(delta[i])
        if not (x <= largest):
            largest = x
    return largest


@kernel
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

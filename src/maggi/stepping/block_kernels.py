"""Compiled stages for Ritz bodies and prescribed frames: compliances, forces, powers, given motions."""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.bodies.motions import move_prescribed
from maggi.bodies.ritz_kernels import frame_mass, inertia_residual
from maggi.bodies.tables import MESH, RITZ, Array, BodyTable, MotionState
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.links import Link
from maggi.linalg.small import add_multiple, inner, invert, multiply
from maggi.projection.range_space import transpose_product

from .tables import GIVEN_POWER, TAKEN_POWER, SmallSystem, StepState, StepWork


@njit(cache=True)
def compliances(
    bodies: BodyTable, state: MotionState, c: GeneralizedAlpha, floor: Array, elastic: Array, W: Array
) -> None:
    """W = Ŝ⁻¹ with Ŝ = σM + γhD + βh²K for all Ritz bodies, as they stand (Eq. T12).

    Only the frame's rows change with a body's shape, so that with the inverse E⁻¹ of the rest, `elastic`, which a step size keeps, and
    the coupling X = σ[m_Oᵀ; s + Gδ] it is that of the frame's Schur complement F = σM₆ − X E⁻¹ Xᵀ:

        W = [ F⁻¹             −F⁻¹ X E⁻¹            ]
            [ −E⁻¹ Xᵀ F⁻¹     E⁻¹ + E⁻¹ Xᵀ F⁻¹ X E⁻¹ ]

    `floor` (b,) is a small inertia (kg m²) added to the iteration matrix, never to the equations, where a body has none
    of its own.
    """
    frame = np.empty((6, 6))
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] != RITZ:
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


@Link
def block_compliances(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """`compliances` as the bodies stand."""
    m = work.method
    c = GeneralizedAlpha(m[0], m[1], m[2], m[3], m[4], m[5])
    compliances(small.step_bodies, state.motion, c, small.floor, work.elastic, work.W)


@Link
def block_forces(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Add to `force` (m,) the residual of blocks that are no meshes, with K Δe + D Δė of their shifts."""
    tree, bodies = small.tree, small.step_bodies
    count = tree.parent.shape[0]
    for k in range(tree.block.shape[0]):
        b = tree.block[k]
        if bodies.kind[b] == MESH:
            continue
        s, o = tree.node_start[count + k], bodies.offset[b]
        n = bodies.offset[b + 1] - o
        residual = work.product[:n]
        inertia_residual(bodies, b, state.motion, small.forces.gravity, residual)
        if n > 6:
            add_elastic_forces(bodies, b, work.shift[s + 6 : s + n], work.rate_shift[s + 6 : s + n], residual[6:])
        for i in range(n):
            work.force[s + i] += residual[i] + work.given[o + i]


@Link
def block_power(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Powers (W) that damping of Ritz bodies takes, and that prescribed frames give: frame force × twist."""
    tree, bodies, motion = small.tree, small.step_bodies, state.motion
    transpose_product(small.closures, bodies, state.rows.A, state.vectors.multipliers_next, work.given)
    for i in range(work.given.shape[0]):
        work.given[i] -= work.loads[i]
    given = 0.0
    taken = 0.0
    count = tree.parent.shape[0]
    for k in range(tree.block.shape[0]):
        b = tree.block[k]
        o = bodies.offset[b]
        n = bodies.offset[b + 1] - o
        if bodies.kind[b] == RITZ:
            taken += damping_power(bodies, b, motion.v[o + 6 : o + n])
        if bodies.floating[b] == 1:
            continue
        if bodies.kind[b] == MESH:
            s = tree.node_start[count + k]
            for i in range(6):
                given += (work.base[s + i] + work.given[o + i]) * motion.v[o + i]
        else:
            residual = work.product[:n]
            inertia_residual(bodies, b, motion, small.forces.gravity, residual)
            for i in range(6):
                given += (residual[i] + work.given[o + i]) * motion.v[o + i]
    work.numbers[GIVEN_POWER] = given
    work.numbers[TAKEN_POWER] = taken


@Link
def prescribe_frames(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Set the frames that move as given."""
    move_prescribed(small.motions, small.step_bodies, t, state.motion)

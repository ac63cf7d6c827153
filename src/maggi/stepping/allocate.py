"""Fresh states and scratch arrays for a system."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import RITZ, BodyTable, MotionState
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.system.dense import new_attachments, new_rows, velocity_scale
from maggi.system.system import System

from .tables import SmallSystem, StepState, StepVectors, StepWork

Array = NDArray[np.float64]


def small_system(system: System) -> SmallSystem:
    """The constants that the kernels read."""
    return SmallSystem(system.bodies, system.motions, system.liaisons, system.forces)


def copy_motion(motion: MotionState) -> MotionState:
    """An independent copy."""
    return MotionState(*(part.copy() for part in motion))


def new_state(system: System, least_speed: float, least_acceleration: float) -> StepState:
    """A state at the initial pose, at rest; the leasts keep residuals finite where nothing moves."""
    n, r, b = system.coordinates, system.rows, system.bodies.kind.size
    vectors = StepVectors(
        a=np.zeros(n),
        a_next=np.zeros(n),
        a_previous=np.zeros(n),
        increment=np.zeros(n),
        multipliers=np.zeros(r),
        multipliers_next=np.zeros(r),
        multipliers_previous=np.zeros(r),
        applied=np.zeros(n),
        work=np.zeros(4),
        power=np.zeros(3),
        scales=np.array([system.size, least_speed, least_acceleration, least_speed, least_acceleration]),
        elastic=np.zeros((b, 2)),
        contraction=np.array([0.1, 100.0]),
    )
    return StepState(
        copy_motion(system.start),
        copy_motion(system.start),
        new_attachments(system.bodies.attachment_body.size),
        new_rows(system),
        vectors,
    )


def geometric_metric(system: System) -> Array:
    """A metric of velocities that knows no masses: the mechanism's size makes lengths of angles (flat blocks)."""
    bodies = system.bodies
    inverse = 1.0 / velocity_scale(system) ** 2
    metric = np.zeros(int(bodies.block[-1]))
    for b in range(bodies.kind.size):
        o, e = int(bodies.offset[b]), int(bodies.offset[b + 1])
        diagonal = inverse[o:e].copy()
        if not bodies.floating[b]:
            diagonal[:6] = 0.0
        metric[bodies.block[b] : bodies.block[b + 1]] = np.diag(diagonal).ravel()
    return metric


def elastic_compliances(bodies: BodyTable, c: GeneralizedAlpha, out: Array) -> None:
    """(σ m + γh D + βh² k)⁻¹ of every Ritz body, flat as `BodyTable.m`; not finite where that is singular."""
    for b in np.flatnonzero(bodies.kind == RITZ):
        n = int(bodies.offset[b + 1] - bodies.offset[b]) - 6
        part = slice(int(bodies.ritz_square[b]), int(bodies.ritz_square[b]) + n * n)
        matrix = c.sigma * bodies.m[part] + c.gamma * c.h * bodies.D[part] + c.beta * c.h**2 * bodies.k[part]
        try:
            inverse = np.linalg.inv(matrix.reshape(n, n))
        except np.linalg.LinAlgError:
            inverse = np.full((n, n), np.nan)
        out[part] = (0.5 * (inverse + inverse.T)).ravel()


def new_work(system: System) -> StepWork:
    """Scratch arrays."""
    n, r = system.coordinates, system.rows
    blocks = int(system.bodies.block[-1])
    skyline = int(system.liaisons.skyline_start[-1])
    springs = len(system.forces.spring_ends) + system.forces.torsion_coordinate.size
    return StepWork(
        W=np.zeros(blocks),
        elastic=np.zeros(system.bodies.m.size),
        W_Z=np.zeros(blocks),
        W_D=np.zeros(blocks),
        L=np.zeros(skyline),
        pivot=np.zeros(r),
        scale=np.zeros(r),
        base=np.zeros(n),
        accounted=np.zeros(n),
        position_force=np.zeros(n),
        velocity_force=np.zeros(n),
        residual=np.zeros(n),
        loads=np.zeros(n),
        delta=np.zeros(n),
        shift=np.zeros(n),
        rate_shift=np.zeros(n),
        vector=np.zeros(n),
        pi=np.zeros(r),
        kappa=np.zeros(r),
        phi=np.zeros(r),
        active=np.ones(r, dtype=np.int64),
        metric=geometric_metric(system),
        metric_scale=np.zeros(r),
        spring_J=np.zeros((springs, n)),
        spring_W=np.zeros((springs, n)),
        spring_border=np.zeros((springs, r)),
        spring_inverse=np.zeros((springs, springs)),
        spring_force=np.zeros(springs),
    )

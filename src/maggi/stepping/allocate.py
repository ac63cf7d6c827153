"""Fresh states and scratch arrays for a system."""

from __future__ import annotations

import numpy as np

from maggi.bodies.tables import MotionState
from maggi.system.dense import new_attachments, new_rows
from maggi.system.system import System

from .tables import SmallSystem, StepState, StepVectors, StepWork


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


def new_work(system: System) -> StepWork:
    """Scratch arrays."""
    n, r = system.coordinates, system.rows
    blocks = int(system.bodies.block[-1])
    skyline = int(system.liaisons.skyline_start[-1])
    springs = len(system.forces.spring_ends) + system.forces.torsion_coordinate.size
    return StepWork(
        W=np.zeros(blocks),
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
        independent=np.zeros(1, dtype=np.int64),
        spring_J=np.zeros((springs, n)),
        spring_W=np.zeros((springs, n)),
        spring_border=np.zeros((springs, r)),
        spring_inverse=np.zeros((springs, springs)),
        spring_force=np.zeros(springs),
    )

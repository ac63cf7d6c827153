"""Fresh states and scratch arrays for a system."""

from __future__ import annotations

import numpy as np

from maggi.bodies.tables import MotionState
from maggi.system.dense import new_attachments, new_rows
from maggi.system.system import System

from .tables import SmallSystem, StepState, StepWork


def small_system(system: System) -> SmallSystem:
    """The constants that the kernels read."""
    return SmallSystem(system.bodies, system.motions, system.liaisons, system.forces)


def copy_motion(motion: MotionState) -> MotionState:
    """An independent copy."""
    return MotionState(*(part.copy() for part in motion))


def new_state(system: System, least_speed: float, least_acceleration: float) -> StepState:
    """A state at the initial pose, at rest; the leasts keep residuals finite where nothing moves."""
    n, r, b = system.coordinates, system.rows, system.bodies.kind.size
    return StepState(
        copy_motion(system.start),
        copy_motion(system.start),
        *(np.zeros(n) for _ in range(4)),
        *(np.zeros(r) for _ in range(3)),
        new_attachments(system.bodies.attachment_body.size),
        new_rows(system),
        np.zeros(n),
        np.zeros(4),
        np.zeros(3),
        np.array([system.size, least_speed, least_acceleration, least_speed, least_acceleration]),
        np.zeros((b, 2)),
        np.array([0.1, 100.0]),
    )


def new_work(system: System) -> StepWork:
    """Scratch arrays."""
    n, r = system.coordinates, system.rows
    blocks = int(system.bodies.block[-1])
    skyline = int(system.liaisons.skyline_start[-1])
    return StepWork(
        *(np.zeros(blocks) for _ in range(3)),
        np.zeros(skyline),
        *(np.zeros(r) for _ in range(2)),
        *(np.zeros(n) for _ in range(10)),
        *(np.zeros(r) for _ in range(3)),
        np.zeros(1, dtype=np.int64),
    )

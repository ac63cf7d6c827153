"""Which compiled stages a mechanism needs, and where they are."""

from __future__ import annotations

import numpy as np

from maggi.bodies.tables import MESH, RITZ
from maggi.liaisons.kernels import all_rows

from . import kernels, ritz_kernels
from .tables import (
    ACCEPT_STEP,
    BLOCK_COMPLIANCES,
    BLOCK_FORCES,
    BLOCK_POWER,
    CORRECT,
    EVALUATE,
    PREDICT_STEP,
    PRESCRIBE,
    REFRESH,
    ROWS,
    SmallSystem,
    StepState,
    StepWork,
)

STAGES = {
    EVALUATE: kernels.evaluate,
    REFRESH: kernels.refresh,
    CORRECT: kernels.correct,
    ACCEPT_STEP: kernels.accept,
    PREDICT_STEP: kernels.predict,
}
"""What every step goes through."""


def link(small: SmallSystem, state: StepState, work: StepWork) -> None:
    """Fill `small.links` with the stages that the mechanism needs, compiled if they have not been before."""
    wanted = dict(STAGES)
    bodies, blocks = small.step_bodies, small.tree.block
    prescribed = bool((bodies.floating[blocks] == 0).any())
    ritz = bool((bodies.kind[blocks] == RITZ).any())
    if small.motions.given_body.size or small.motions.recorded_body.size:
        wanted[PRESCRIBE] = ritz_kernels.prescribe_frames
    if ritz:
        wanted[BLOCK_COMPLIANCES] = ritz_kernels.block_compliances
    if bool(np.any(bodies.kind[blocks] != MESH)):
        wanted[BLOCK_FORCES] = ritz_kernels.block_forces
    if ritz or prescribed:
        wanted[BLOCK_POWER] = ritz_kernels.block_power
    for place, stage in wanted.items():
        small.links[place] = stage.address(small, state, work)
    small.links[ROWS] = all_rows.address(small.closures, bodies, state.motion, state.attachments, state.rows)

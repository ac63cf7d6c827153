"""Which compiled stages a mechanism needs, and where they are."""

from __future__ import annotations

import numpy as np

from maggi.bodies.tables import MESH, RITZ
from maggi.liaisons.kernels import all_rows

from . import block_kernels, spring_kernels
from .acceptance import accept
from .correction import correct
from .evaluation import evaluate
from .linearization import refresh
from .prediction import predict
from .tables import (
    ACCEPT_STEP,
    ADD_SPRINGS,
    BLOCK_COMPLIANCES,
    BLOCK_FORCES,
    BLOCK_POWER,
    CORRECT,
    EVALUATE,
    LOADS,
    PREDICT_STEP,
    PRESCRIBE,
    REFRESH,
    ROWS,
    SPRING_COEFFICIENTS,
    SPRING_FORCES,
    SmallSystem,
    StepState,
    StepWork,
)

STAGES = {
    EVALUATE: evaluate,
    REFRESH: refresh,
    CORRECT: correct,
    ACCEPT_STEP: accept,
    PREDICT_STEP: predict,
}
"""What every step goes through."""


def link(small: SmallSystem, state: StepState, work: StepWork) -> None:
    """Fill `small.links` with the stages that the mechanism needs, compiled if they have not been before."""
    wanted = dict(STAGES)
    bodies, blocks = small.step_bodies, small.tree.block
    prescribed = bool((bodies.floating[blocks] == 0).any())
    ritz = bool((bodies.kind[blocks] == RITZ).any())
    if small.motions.given_body.size or small.motions.recorded_body.size:
        wanted[PRESCRIBE] = block_kernels.prescribe_frames
    if ritz:
        wanted[BLOCK_COMPLIANCES] = block_kernels.block_compliances
    if bool(np.any(bodies.kind[blocks] != MESH)):
        wanted[BLOCK_FORCES] = block_kernels.block_forces
    if ritz or prescribed:
        wanted[BLOCK_POWER] = block_kernels.block_power
    if not small.forces.empty:
        wanted[LOADS] = spring_kernels.loads
    if small.tree.on_joint.size or small.tree.spring.size:
        wanted[SPRING_COEFFICIENTS] = spring_kernels.spring_coefficients
    if small.tree.spring.size:
        wanted[ADD_SPRINGS] = spring_kernels.add_springs
        wanted[SPRING_FORCES] = spring_kernels.spring_forces
    for place, stage in wanted.items():
        small.links[place] = stage.address(small, state, work)
    small.links[ROWS] = all_rows.address(small.closures, bodies, state.motion, state.attachments, state.rows)

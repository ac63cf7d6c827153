"""Which compiled stages a mechanism needs, and where they are."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, cast

import numpy as np
from numba import types

from maggi.bodies.tables import MESH, RITZ
from maggi.liaisons.kernels import all_rows
from maggi.linalg.links import Link
from maggi.linalg.table import numba_type

from . import ahead, block_kernels, spring_kernels
from .acceptance import accept
from .correction import correct
from .evaluation import evaluate
from .instant_kernels import show
from .iteration import advance
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
    SHOW,
    SPRING_COEFFICIENTS,
    SPRING_FORCES,
    Instant,
    Record,
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


def link(
    small: SmallSystem,
    state: StepState,
    work: StepWork,
    instant: Instant,
    record: Record,
    announce: Callable[[str], None],
) -> None:
    """Fill `small.links` with the stages that the mechanism needs, and have them and their callers compiled.

    Where a second process is at it, what that has not begun is compiled here, from the end, and the rest waited for.
    """
    ahead.announce(announce)
    ahead.share(reversed(compilations(small, state, work, instant, record).items()))
    ahead.finish()
    for place, stage in _wanted(small).items():
        small.links[place] = stage.address(small, state, work)
    small.links[SHOW] = show.address(small, state, work, instant)
    small.links[ROWS] = all_rows.address(small.closures, small.step_bodies, state.motion, state.attachments, state.rows)


def compilations(
    small: SmallSystem, state: StepState, work: StepWork, instant: Instant, record: Record
) -> dict[str, Callable[[], object]]:
    """What is to be compiled for a mechanism, by name, in the order of its use."""
    number, integer = types.float64, types.int64
    tables = (numba_type(table) for table in (small, state, work, instant, record))
    stages = {stage.kernel.__name__: partial(stage.address, small, state, work) for stage in _wanted(small).values()}
    return {
        **stages,
        "advance": partial(cast(Any, advance).compile, (*tables, integer, number, integer, number)),
        "show": partial(show.address, small, state, work, instant),
    }


def _wanted(small: SmallSystem) -> dict[int, Link]:
    """The stages that a mechanism needs, by their places in `small.links`."""
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
    return wanted

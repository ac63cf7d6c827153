"""Compiled: the state at the end of a step, from its increments and velocities."""

from __future__ import annotations

from maggi.bodies.attachment_kernels import move_attachment
from maggi.linalg.compiling import inner_kernel
from maggi.linalg.links import Link, call3, call5
from maggi.projection.tree_kernels import tree_motion

from .prediction import move_blocks
from .tables import LOADS, PRESCRIBE, ROWS, SmallSystem, StepState, StepWork


@inner_kernel
def has_forces(small: SmallSystem) -> bool:
    """Whether there are springs or loads."""
    tree = small.tree
    return bool(tree.spring.shape[0] + tree.on_joint.shape[0] + small.forces.load_attachment.shape[0] > 0)


@Link
def evaluate(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """All bodies, and attachments, closures and applied forces, at the end of the step."""
    tree, bodies, motion, vectors = small.tree, small.step_bodies, state.motion, state.vectors
    tree_motion(
        tree,
        bodies,
        state.joints,
        vectors.increment,
        vectors.nu_next,
        vectors.nud_next,
        state.joints_next,
        work.tree,
        motion,
    )
    if tree.block.shape[0] > 0:
        move_blocks(small, state)
        if small.links[PRESCRIBE] != 0:
            call3(small.links[PRESCRIBE], small, state, work, t)
    for x in range(tree.needed.shape[0]):
        move_attachment(bodies, tree.needed[x], motion, state.attachments)
    if small.closures.measured.shape[0] > 0 or state.rows.position.shape[0] > 0:
        call5(small.links[ROWS], small.closures, bodies, motion, state.attachments, state.rows, t)
    if has_forces(small):
        call3(small.links[LOADS], small, state, work, t)

"""Fresh states and scratch arrays for a system."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import MESH, RITZ, BodyTable, MotionState
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.table import packed
from maggi.projection.relative_motion import new_joint_poses, new_tree_work
from maggi.projection.relative_system import RelativeSystem
from maggi.system.dense import new_attachments, new_row_values, new_rows, velocity_scale
from maggi.system.system import System

from .tables import HIGHEST_ORDER, LINKS, Instant, Record, SmallSystem, StepState, StepVectors, StepWork

Array = NDArray[np.float64]

RECORD_BYTES = 1 << 20  # of instants that are kept before something is made of them


def small_system(system: System, relative: RelativeSystem) -> SmallSystem:
    """The constants that the kernels read."""
    return SmallSystem(
        bodies=system.bodies,
        step_bodies=relative.bodies,
        frame_rotation=relative.frame_rotation,
        frame_position=relative.frame_position,
        motions=system.motions,
        closures=relative.closures,
        all_liaisons=system.liaisons,
        forces=system.forces,
        tree=relative.tree,
        floor=system.inertia_floor,
        links=np.zeros(LINKS, dtype=np.int64),
        joint_row_start=relative.joint_row_start,
        joint_row=relative.joint_row,
        joint_end=relative.joint_end,
        closure_row=relative.closure_row,
        joint_turn=relative.joint_turn,
    )


def copy_motion(motion: MotionState) -> MotionState:
    """An independent copy."""
    return motion.copy()


def new_instant(system: System, least_speed: float, least_acceleration: float) -> Instant:
    """The initial pose, at rest; the leasts keep residuals finite where nothing moves."""
    instant = Instant(
        now=system.start.copy(),
        attachments=new_attachments(system.bodies.attachment_body.size),
        rows=new_rows(system),
        multipliers=np.zeros(system.rows),
        active=np.ones(system.rows, dtype=np.int64),
        power=np.zeros(3),
        work=np.zeros(4),
        scales=np.array([system.size, least_speed, least_acceleration, least_speed, least_acceleration]),
        residuals=np.zeros(3),
        counts=np.zeros(2, dtype=np.int64),
        flat=np.empty(0),
    )
    instant, flat = packed(instant)
    return replace(instant, flat=flat)


def new_record(instant: Instant, most: int) -> Record:
    """Room for instants, not for more than `most`."""
    count = max(1, min(most, RECORD_BYTES // instant.flat.nbytes))
    return Record(np.empty((count, instant.flat.size)), np.zeros(count, dtype=np.int64), np.zeros(4, dtype=np.int64))


def new_state(system: System, relative: RelativeSystem, instant: Instant) -> StepState:
    """The initial pose, at rest, in the frames of the step, of a run that `instant` shows."""
    m, r, b, x = len(relative.tree.size), len(relative.closures.row), system.bodies.kind.size, len(relative.tree.body)
    shifted = 0 if (system.bodies.kind == MESH).any() or r == 0 else m
    vectors = StepVectors(
        a=np.zeros(m),
        a_next=np.zeros(m),
        a_differences=np.zeros((HIGHEST_ORDER, m)),
        nu=np.zeros(m),
        nu_next=np.zeros(m),
        nud=np.zeros(m),
        nud_next=np.zeros(m),
        increment=np.zeros(m),
        multipliers=np.zeros(r),
        multipliers_next=np.zeros(r),
        multipliers_previous=np.zeros(r),
        shift=np.zeros(shifted),
        shift_next=np.zeros(shifted),
        shift_differences=np.zeros((HIGHEST_ORDER, shifted)),
        rate_shift=np.zeros(shifted),
        rate_shift_next=np.zeros(shifted),
        rate_shift_differences=np.zeros((HIGHEST_ORDER, shifted)),
        elastic=np.zeros((b, 2)),
        contraction=np.array([0.1, 100.0]),
    )
    return StepState(
        accepted=system.start.copy(),
        joints=new_joint_poses(x),
        motion=system.start.copy(),
        joints_next=new_joint_poses(x),
        attachments=new_attachments(system.bodies.attachment_body.size),
        rows=new_row_values(relative.closures, relative.coefficients),
        vectors=vectors,
        scales=instant.scales,
        power=instant.power,
        work=instant.work,
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


def new_work(system: System, relative: RelativeSystem) -> StepWork:
    """Scratch arrays."""
    tree = relative.tree
    n, m = system.coordinates, len(tree.size)
    r, q = len(relative.closures.row), len(tree.skyline_first)
    blocks = int(system.bodies.block[-1])
    widest = int(np.diff(system.bodies.offset).max(initial=0))
    return StepWork(
        tree=new_tree_work(tree),
        W=np.zeros(blocks),
        elastic=np.zeros(system.bodies.m.size),
        W_Z=np.zeros(blocks),
        W_D=np.zeros(blocks),
        L=np.zeros(int(tree.skyline_start[-1])),
        pivot=np.zeros(q),
        scale=np.zeros(r),
        active=np.ones(r, dtype=np.int64),
        kept=np.ones(q, dtype=np.int64),
        kept_before=np.ones(q, dtype=np.int64),
        metric=geometric_metric(system),
        metric_scale=np.zeros(r),
        base=np.zeros(m),
        accounted=np.zeros(m),
        position_force=np.zeros(m),
        velocity_force=np.zeros(m),
        given=np.zeros(n),
        loads=np.zeros(n),
        stiffness=np.zeros(m),
        unsprung=np.zeros(m),
        on_joints=np.zeros(m),
        force=np.zeros(m),
        delta=np.zeros(m),
        shift=np.zeros(m),
        rate_shift=np.zeros(m),
        shift_before=np.zeros(m),
        rate_shift_before=np.zeros(m),
        step=np.zeros(m),
        pi=np.zeros(r),
        kappa=np.zeros(r),
        phi=np.zeros(q),
        rates=np.zeros(q),
        product=np.zeros(max(widest, m)),
        method=np.zeros(6),
        flags=np.zeros(5, dtype=np.int64),
        numbers=np.zeros(6),
        misses=np.zeros(HIGHEST_ORDER + 1),
    )

"""The small system as dense matrices: liaison rows and mass at one state, for starting and auditing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import attachment_motion
from maggi.bodies.small_bodies import body_mass
from maggi.bodies.tables import FIXED, MESH, AttachmentState, MotionState
from maggi.liaisons.kernels import evaluate_rows
from maggi.liaisons.sums import POSE
from maggi.liaisons.tables import END_ATTACHMENT, JETS, LiaisonState, LiaisonTable

from .system import System

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DenseRows:
    """Liaison rows at one state (T7): A (r, n), Φ (r,), A v + b, b, and A v̇ + γ (r,)."""

    A: Array
    position: Array
    velocity: Array
    b: Array
    acceleration: Array


def new_attachments(count: int) -> AttachmentState:
    """Attachment states; tangents start as identities, which those of rigid bodies stay."""
    tangent = np.zeros((count, 3, 3))
    tangent[:] = np.eye(3)
    return AttachmentState(
        position=np.zeros((count, 3)),
        rotation=np.zeros((count, 3, 3)),
        velocity=np.zeros((count, 3)),
        angular_velocity=np.zeros((count, 3)),
        acceleration=np.zeros((count, 3)),
        angular_acceleration=np.zeros((count, 3)),
        arm=np.zeros((count, 3)),
        tangent=tangent,
        scratch=np.zeros((3, 18)),
    )


def new_rows(system: System) -> LiaisonState:
    """Row values, all zero; the joint coordinates' unwrapping starts at zero, the initial pose."""
    width = np.diff(system.bodies.offset)
    table = system.liaisons
    return new_row_values(table, int(width[system.bodies.attachment_body[table.end[:, END_ATTACHMENT]]].sum()))


def new_row_values(table: LiaisonTable, coefficients: int) -> LiaisonState:
    """Values of a table's rows, all zero, with room for as many coefficients on bodies."""
    r, c = len(table.row), len(table.coordinate)
    # room for the variables of functions: time, and coordinates, or poses of ends
    ends = int(np.diff(table.end_start).max(initial=0))
    return LiaisonState(
        A=np.zeros(coefficients),
        position=np.zeros(r),
        velocity=np.zeros(r),
        acceleration=np.zeros(r),
        rhs=np.zeros(r),
        wrench=np.zeros((len(table.end), 6)),
        coordinate=np.zeros((c, 3)),
        coordinate_wrench=np.zeros((c, 2, 6)),
        previous=np.zeros(c),
        scratch=np.zeros((JETS + 2 + POSE * ends, 3)),
    )


def dense_rows(system: System, motion: MotionState, t: float, previous: Array | None = None) -> DenseRows:
    """All rows at a state. previous (c,): joint coordinates that unwrapping starts from."""
    attachments = new_attachments(system.bodies.attachment_body.size)
    rows = new_rows(system)
    if previous is not None:
        rows.previous[:] = previous
    attachment_motion(system.bodies, motion, attachments)
    evaluate_rows(system.liaisons, system.bodies, motion, attachments, rows, t)
    table, bodies = system.liaisons, system.bodies
    A = np.zeros((system.rows, system.coordinates))
    for i in range(system.rows):
        for attachment, start in table.end[table.end_start[i] : table.end_start[i + 1]]:
            body = bodies.attachment_body[attachment]
            o, e = bodies.offset[body], bodies.offset[body + 1]
            A[i, o:e] += rows.A[start : start + e - o]
    return DenseRows(A, rows.position.copy(), rows.velocity.copy(), rows.velocity - A @ motion.v, rows.acceleration)


def dense_mass(system: System, motion: MotionState) -> Array:
    """Mass matrix (n, n) of the small system; a meshed body's is its frame's, undeformed, with no elastic part."""
    bodies = system.bodies
    M = np.zeros((system.coordinates, system.coordinates))
    for b in range(bodies.kind.size):
        if bodies.kind[b] == FIXED:
            continue
        o, e = int(bodies.offset[b]), int(bodies.offset[b + 1])
        if bodies.kind[b] == MESH:
            e = o + 6
        M[o:e, o:e] = body_mass(bodies, b, motion.e[o + 6 : e])
        M[o + 3 : o + 6, o + 3 : o + 6] += system.inertia_floor[b] * np.eye(3)
    return M


def velocity_scale(system: System) -> Array:
    """The size of one unit of each velocity (n,): 1 for velocities, the mechanism's size for angular ones."""
    scale = np.ones(system.coordinates)
    bodies = system.bodies
    for b in range(bodies.kind.size):
        if bodies.kind[b] == FIXED:
            continue
        o, e = int(bodies.offset[b]), int(bodies.offset[b + 1])
        scale[o + 3 : o + 6] = system.size
        if bodies.kind[b] == MESH:
            for k in range(o + 9, e, 6):
                scale[k : k + 3] = system.size
    return scale


def floating_velocities(system: System) -> NDArray[np.int64]:
    """Which small coordinates are velocities of floating frames."""
    bodies = system.bodies
    parts = [
        np.arange(bodies.offset[b], bodies.offset[b] + 6)
        for b in range(bodies.kind.size)
        if bodies.kind[b] != FIXED and bodies.floating[b] == 1
    ]
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])

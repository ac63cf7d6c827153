"""Parts of a mechanism that its joints lock by more rows than it has velocities, and the joint that would free them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import MotionState
from maggi.liaisons.tables import ROW_OWNER
from maggi.projection.maggi import project
from maggi.system.dense import dense_rows, floating_velocities, velocity_scale
from maggi.system.system import System

from .nearby import nearby_poses
from .parts import parts
from .remedies import dependences, releases

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def locked_parts(system: System, motion: MotionState) -> list[str]:
    """A sentence for each part whose rigid bodies cannot move and whose rows repeat each other.

    Such a part is no mistake in a structure; in a mechanism it is, mostly an axis that is not quite parallel. Parts held by
    welds alone, and those that drivers hold, are not told.
    """
    frames = floating_velocities(system)
    scale = velocity_scale(system)
    A = dense_rows(system, motion, 0.0).A / scale
    sentences = []
    for part in parts(system):
        columns = np.intersect1d(part.columns, frames)
        rows = part.rows[~system.driven[part.rows]]
        rows = rows[np.abs(A[np.ix_(rows, columns)]).max(axis=1, initial=0.0) > 0.0]
        rank = project(A[np.ix_(rows, columns)]).rank
        if columns.size == 0 or rank < columns.size or rank == len(rows):
            continue
        within = np.zeros((system.rows, columns.size))
        within[rows] = A[np.ix_(rows, columns)]
        joints = _locking(system, within[rows], rows)
        if joints:
            bodies = [entry.name for entry in system.body_entries if entry.index in part.bodies and entry.visible]
            bends = bool(np.setdiff1d(part.columns, frames).size)
            sentences.append(
                _sentence(
                    bodies, joints, len(rows), columns.size, bends, _release(system, motion, within, rows, joints)
                )
            )
    return sentences


def _locking(system: System, A: Array, rows: IntArray) -> list[str]:
    """The liaisons whose rows (k, n) depend on each other; none where all of those are welds."""
    involved = {int(rows[k]) for of, _ in dependences(system, A, rows) for k in of}
    owners = sorted({int(system.liaisons.row[row, ROW_OWNER]) for row in involved})
    entries = [system.liaison_entries[k] for k in owners if system.liaison_entries[k].visible]
    return [entry.name for entry in entries] if any(entry.kind != "weld" for entry in entries) else []


def _release(system: System, motion: MotionState, A: Array, rows: IntArray, joints: list[str]) -> str:
    """The simplest replacement that lets the part move, not only for an instant; empty where none does."""
    for replacement, taken in releases(system, A, rows, joints):
        if nearby_poses(system, motion, without=tuple(int(row) for row in taken)).places:
            return str(replacement)
    return ""


def _sentence(bodies: list[str], joints: list[str], rows: int, velocities: int, bends: bool, release: str) -> str:
    can = "can only bend" if bends else "cannot move"
    text = (
        f"{', '.join(bodies)} {can}: the joints {', '.join(joints)} lock {'them' if len(bodies) > 1 else 'it'} by "
        f"over-constraint ({rows} rows on {velocities} velocities)"
    )
    return f"{text}; {release} would free a motion" if release else f"{text}; free a motion of one of these joints"

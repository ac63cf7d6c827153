"""Counting freedoms: rows, rank, redundant rows by name, and the mobility that is left (Theory §4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq

from maggi.bodies.tables import MotionState
from maggi.liaisons.tables import ROW_OWNER
from maggi.projection.maggi import project
from maggi.system.dense import dense_rows, floating_velocities, velocity_scale
from maggi.system.system import System

from .nearby import Nearby
from .parts import unknown_velocities

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

SINGULAR = 1e-6
"""A smallest kept singular value below this, rows and velocities scaled, tells a pose close to a singular one."""
_SHARE = 1e-6  # of a redundant row that another liaison's rows must repeat to be named


@dataclass(frozen=True)
class Redundant:
    """A row that repeats others: what it does, its joint or driver, and those whose rows make it up.

    repeats is empty where the row has nothing free to act on, as between prescribed frames.
    """

    row: str
    liaison: str
    repeats: tuple[str, ...]


@dataclass(frozen=True)
class Mobility:
    """Freedoms at one pose.

    velocities : of all bodies without liaisons. Of a rigid body six; of a Ritz body six and its coordinates; of a
        meshed body all nodal freedoms, among which its six rigid motions are. On a prescribed frame only the elastic
        ones.
    rows, rank, freedoms = velocities − rank. drivers : how many of the rows are drivers'.
    position_freedoms : velocities − rank of the rows that hold positions; with rows of velocities alone it is more.
    redundant : the rows beyond the rank. Which of a dependent group is called redundant is a choice.
    rigid_velocities, rigid_rank, rigid_mobility, rigid_redundant : the same with every elastic body rigid.
        Rows that act on prescribed frames alone do not count there.
    gruebler : rigid_velocities − rows, the count that takes no notice of redundancy.
    generic_freedoms, generic_rigid_mobility : the same in neighbouring poses that the joints admit; more freedoms here
        than there tell a singular pose, such as a dead centre. None where there are no such poses.
    shaky : the joints admit velocities of rigid bodies here but, it seems, no motion along them.
    smallest_kept, largest_dropped : singular values of the rows, scaled, on either side of the rank (1 and 0 where
        there are none). conditioning : of S, scaled, the basis of the admitted velocities (Eq. T8).
    """

    velocities: int
    rows: int
    drivers: int
    rank: int
    freedoms: int
    position_freedoms: int
    generic_freedoms: int | None
    redundant: tuple[Redundant, ...]
    rigid_velocities: int
    rigid_rank: int
    rigid_mobility: int
    generic_rigid_mobility: int | None
    shaky: bool
    rigid_redundant: tuple[Redundant, ...]
    gruebler: int
    smallest_kept: float
    largest_dropped: float
    conditioning: float


def mobility(system: System, motion: MotionState, nearby: Nearby) -> Mobility:
    """Count the freedoms of a system at a pose, and at others near it, by the rank of its liaison rows."""
    A = dense_rows(system, motion, 0.0).A
    scale = velocity_scale(system)
    frames, unknown = floating_velocities(system), unknown_velocities(system)
    of_frames = A[:, frames]
    acting = np.flatnonzero(np.abs(of_frames).max(axis=1, initial=0.0) > 0.0)
    full, rigid = project(A[:, unknown], scale[unknown]), project(of_frames[acting], scale[frames])
    velocities = len(unknown) + sum(
        body.size - 6 * int(system.bodies.floating[b]) - _width(system, b) for b, body in system.mesh_bodies.items()
    )
    kept, dropped = _singular_values(A[:, unknown] / scale[unknown], full.rank)
    elsewhere = [dense_rows(system, place.motion, place.time).A for place in nearby.places]
    ranks = [tuple(project(B[:, columns], scale[columns]).rank for columns in (unknown, frames)) for B in elsewhere]
    return Mobility(
        velocities,
        system.rows,
        int(system.driven.sum()),
        full.rank,
        velocities - full.rank,
        velocities - project(A[np.ix_(system.holonomic, unknown)], scale[unknown]).rank,
        velocities - max(rank for rank, _ in ranks) if ranks else None,
        _named(system, A[:, unknown] / scale[unknown], full.rows, full.redundant),
        len(frames),
        rigid.rank,
        len(frames) - rigid.rank,
        len(frames) - max(rank for _, rank in ranks) if ranks else None,
        nearby.shaky,
        _named(system, of_frames / scale[frames], acting[rigid.rows], acting[rigid.redundant]),
        len(frames) - len(acting),
        kept,
        dropped,
        _conditioning(full.S, scale[unknown], scale[unknown][full.independent]),
    )


def _conditioning(S: Array, scale: Array, independent: Array) -> float:
    """Largest over smallest singular value of S on velocities of one unit, m/s."""
    if S.shape[1] == 0:
        return 1.0
    values = np.linalg.svd(scale[:, None] * S / independent, compute_uv=False)
    return float(values[0] / values[-1])


def _width(system: System, body: int) -> int:
    """Elastic coordinates of a body in the small system."""
    return int(system.bodies.offset[body + 1] - system.bodies.offset[body]) - 6


def _normalised(A: Array) -> Array:
    size = np.linalg.norm(A, axis=1)
    return np.asarray(A / np.where(size > 0.0, size, 1.0)[:, None])


def _singular_values(A: Array, rank: int) -> tuple[float, float]:
    values = np.linalg.svd(_normalised(A), compute_uv=False) if A.size else np.empty(0)
    kept = float(values[rank - 1]) if rank else 1.0
    return kept, float(values[rank]) if rank < len(values) else 0.0


def _named(system: System, A: Array, rows: IntArray, redundant: IntArray) -> tuple[Redundant, ...]:
    """Redundant rows with the liaisons whose rows add up to them: the solution x of ``A[rows]ᵀ x = A[row]``."""
    A = _normalised(A)
    owner, entries = system.liaisons.row[:, ROW_OWNER], system.liaison_entries
    found = []
    for row in redundant:
        share = lstsq(A[rows].T, A[row])[0] if len(rows) else np.empty(0)
        others = {int(owner[k]) for k, x in zip(rows, share, strict=True) if abs(x) > _SHARE} - {int(owner[row])}
        repeats = tuple(entries[k].name for k in sorted(others))
        found.append(Redundant(system.row_name(int(row)), entries[owner[row]].name, repeats))
    return tuple(found)

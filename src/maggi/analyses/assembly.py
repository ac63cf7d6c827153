"""Assembly: whether bodies that do not meet in their given poses could, by least squares on the liaisons' positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import MotionState
from maggi.liaisons.tables import ROW_ANGULAR
from maggi.linalg.rotations import rotation_vector
from maggi.system.dense import floating_velocities
from maggi.system.system import LiaisonEntry, System

from .chart import Chart, Place, at_rest, chart, kernel

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

ASSEMBLED = 1e-9  # of the mechanism's size: what may be left of a gap that counts as closed
_ITERATIONS = 100
_LONGEST = 0.3  # step, of the mechanism's size
_LEAST = 1e-5  # part of the gap that a step has to take away for the next one to be tried
_STARTS = 4  # the given poses, and others beside them in case those lead to a local minimum
_SPREAD = 0.2  # how far beside, of the mechanism's size


@dataclass(frozen=True, eq=False)
class Assembly:
    """The nearest that the bodies come to satisfying every liaison that holds a position.

    motion : their poses then. gap : what is left at the joint named by `at` (m, or rad where `angular`) with all
    others closed as far as they can be. shift (m), turn (rad) : the largest displacement of a frame's origin and rotation on
    the way, and `body` the one that moves furthest.
    """

    motion: MotionState
    closed: bool
    at: str
    gap: float
    angular: bool
    shift: float
    turn: float
    body: str


def assemble(system: System, motion: MotionState, entry: LiaisonEntry) -> Assembly:
    """Close all gaps from the given poses, that of one joint last: damped Gauss–Newton over the floating frames.

    The other joints are closed first and stay so; where they cannot be, all gaps are made small together.
    """
    here = at_rest(system, motion)
    around = chart(system, floating_velocities(system), here, time=False)
    every = np.flatnonzero(system.holonomic)
    others = np.setdiff1d(every, entry.rows)
    rng = np.random.default_rng(0)
    best, least = here, np.inf
    for start in range(_STARTS):
        x = rng.normal(size=len(around.unit)) * (_SPREAD if start else 0.0) / np.sqrt(len(around.unit))
        beside = around.moved(here, x)
        closed = around.held(beside, others)
        if closed is None:
            place = _least_gap(around, beside, every, np.empty(0, dtype=np.int64))
        else:
            place = _least_gap(around, closed, np.setdiff1d(every, others), others)
        left = float(np.abs(around.rows(place)[1]).max(initial=0.0))
        if left < least:
            best, least = place, left
        if least <= ASSEMBLED * system.size:
            break
    return _told(system, around, here, best, entry, least <= ASSEMBLED * system.size)


def _least_gap(around: Chart, place: Place, open_rows: IntArray, closed: IntArray) -> Place:
    """Levenberg's method on the open rows within the places that hold the closed ones.

    The damping falls where a step succeeds and rises where it does not.
    """
    damping = 1e-3
    forms, Phi = around.rows(place)
    for _ in range(_ITERATIONS):
        free = kernel(forms[closed, :-1])
        J, r = _scaled(around, forms, Phi, open_rows)
        d = free.shape[1]
        y = np.linalg.lstsq(np.vstack([J @ free, np.sqrt(damping) * np.eye(d)]), np.append(-r, np.zeros(d)))[0]
        y *= min(1.0, _LONGEST / max(float(np.linalg.norm(y)), 1e-300))
        trial = around.held(around.moved(place, np.append(free @ y, 0.0)), closed)
        before, after = float(np.linalg.norm(r)), np.inf
        if trial is not None:
            new_forms, new_Phi = around.rows(trial)
            if np.isfinite(new_forms[open_rows]).all():
                after = float(np.linalg.norm(_scaled(around, new_forms, new_Phi, open_rows)[1]))
        if trial is not None and after < before:
            place, forms, Phi = trial, new_forms, new_Phi
            damping = max(0.1 * damping, 1e-14)
            if before - after < _LEAST * before or after < 0.1 * ASSEMBLED:
                break
        else:
            damping *= 10.0
            if damping > 1e6:
                break
    return place


def _scaled(around: Chart, forms: Array, Phi: Array, rows: IntArray) -> tuple[Array, Array]:
    """Rows and residuals without unit: lengths by the mechanism's size."""
    scale = np.where(around.system.liaisons.row[rows, ROW_ANGULAR] == 1, 1.0, 1.0 / around.system.size)
    return forms[rows, :-1] * scale[:, None], Phi[rows] * scale


def _told(system: System, around: Chart, here: Place, there: Place, entry: LiaisonEntry, closed: bool) -> Assembly:
    _, Phi = around.rows(there)
    # where even the other joints stay open, the worst of them
    worst = system.owner(int(np.argmax(np.abs(Phi))))
    if np.abs(Phi[entry.rows]).max(initial=0.0) >= 0.5 * np.abs(Phi).max(initial=0.0):
        worst = entry
    angular = system.liaisons.row[worst.rows, ROW_ANGULAR] == 1
    lengths, angles = Phi[worst.rows][~angular], Phi[worst.rows][angular]
    gap, turned = float(np.linalg.norm(lengths)), float(np.abs(angles).max(initial=0.0))
    of_angle = gap <= 1e-3 * system.size * turned
    moves = {
        frame.name: (
            float(np.linalg.norm(there.motion.origin[b] - here.motion.origin[b])),
            float(np.linalg.norm(rotation_vector(here.motion.rotation[b].T @ there.motion.rotation[b]))),
        )
        for frame in system.body_entries
        if system.bodies.floating[b := frame.index]
    }
    body = max(moves, key=lambda name: moves[name][0] + system.size * moves[name][1])
    return Assembly(
        there.motion,
        closed,
        worst.name,
        turned if of_angle else gap,
        of_angle,
        _clean(max(shift for shift, _ in moves.values()), system.size),
        _clean(max(turn for _, turn in moves.values()), 1.0),
        body,
    )


def _clean(value: float, scale: float) -> float:
    """A value, or zero where it is round-off."""
    return value if value > 1e-12 * scale else 0.0

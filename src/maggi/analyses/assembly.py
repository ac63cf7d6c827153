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

from .chart import Chart, Place, at_rest, chart

Array = NDArray[np.float64]

ASSEMBLED = 1e-9  # of the mechanism's size: what may be left of a gap that counts as closed
_LIGHT = 1e-3  # weight of the joint whose gap is sought: the others are closed first
_ITERATIONS = 60
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
    """Close all gaps from the given poses, that of one joint last: damped Gauss–Newton over the floating frames."""
    here = at_rest(system, motion)
    around = chart(system, floating_velocities(system), here, time=False)
    held = np.flatnonzero(system.holonomic)
    weight = np.where(np.isin(held, entry.rows), _LIGHT, 1.0)
    rng = np.random.default_rng(0)
    best, least = here, np.inf
    for start in range(_STARTS):
        x = rng.normal(size=len(around.unit)) * (_SPREAD if start else 0.0) / np.sqrt(len(around.unit))
        place = _least_squares(around, around.moved(here, x), held, weight)
        left = _largest(around, place, held)
        if left < least:
            best, least = place, left
        if least <= ASSEMBLED * system.size:
            break
    return _told(system, around, here, best, entry, least <= ASSEMBLED * system.size)


def _least_squares(around: Chart, place: Place, rows: NDArray[np.int64], weight: Array) -> Place:
    """Levenberg's method: the damping falls where a step succeeds and rises where it does not."""
    damping = 1e-3
    forms, residual = _weighted(around, place, rows, weight)
    for _ in range(_ITERATIONS):
        k = forms.shape[1] - 1
        system = np.vstack([forms[:, :-1], np.sqrt(damping) * np.eye(k)])
        step = np.append(np.linalg.lstsq(system, np.append(-residual, np.zeros(k)))[0], 0.0)
        trial = around.moved(place, step)
        new_forms, new_residual = _weighted(around, trial, rows, weight)
        if np.isfinite(new_forms).all() and np.linalg.norm(new_residual) < np.linalg.norm(residual):
            place, forms, residual = trial, new_forms, new_residual
            damping = max(0.1 * damping, 1e-14)
        else:
            damping *= 10.0
        if np.linalg.norm(step) < 1e-13 or damping > 1e8:
            break
    return place


def _weighted(around: Chart, place: Place, rows: NDArray[np.int64], weight: Array) -> tuple[Array, Array]:
    """Rows and residuals without unit: lengths by the mechanism's size."""
    forms, Phi = around.rows(place)
    size = around.system.size
    scale = weight * np.where(around.system.liaisons.row[rows, ROW_ANGULAR] == 1, 1.0, 1.0 / size)
    return forms[rows] * scale[:, None], Phi[rows] * scale


def _largest(around: Chart, place: Place, rows: NDArray[np.int64]) -> float:
    return float(np.abs(around.rows(place)[1][rows]).max(initial=0.0))


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
        entry.name: (
            float(np.linalg.norm(there.motion.origin[b] - here.motion.origin[b])),
            float(np.linalg.norm(rotation_vector(here.motion.rotation[b].T @ there.motion.rotation[b]))),
        )
        for entry in system.body_entries
        if system.bodies.floating[b := entry.index]
    }
    body = max(moves, key=lambda name: moves[name][0] + system.size * moves[name][1])
    return Assembly(
        there.motion,
        closed,
        worst.name,
        turned if of_angle else gap,
        of_angle,
        max(shift for shift, _ in moves.values()),
        max(turn for _, turn in moves.values()),
        body,
    )

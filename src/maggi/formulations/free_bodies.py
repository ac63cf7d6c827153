"""Bodies without liaisons at one state: accelerations of their mass points, and the forces that act on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .constraints.locked import Locked, Places
from .kinematics import moving, point_positions
from .question import Question

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FreeBody:
    """A body's p mass points, as functions of its own velocities and their rates, s of them from `start` on.

    masses (p,); position (p, 3); acceleration (1 + s, p, 3): with v̇ zero, and its slopes to v̇; partial (s, p, 3):
    partial velocities. All global. elastic (s,): generalised elastic and damping forces.
    """

    name: str
    start: int
    masses: Array
    position: Array
    acceleration: Array
    partial: Array
    elastic: Array

    @property
    def slots(self) -> slice:
        """Its place among all velocities."""
        return slice(self.start, self.start + len(self.partial))


def free_bodies(question: Question) -> list[FreeBody]:
    """All bodies of the question; gravity is taken off the accelerations of their points."""
    result = []
    for name, body in question.mechanism.bodies.items():
        state = question.states[name]
        points = point_positions(body, moving(body, state, question.t, 2, 0, state.size))
        velocities = point_positions(body, moving(body, state, question.t, 1, 0, state.size))
        acceleration = _full(points.highest, state.size)
        acceleration[0] -= question.mechanism.gravity
        elastic = np.zeros(state.size)
        elastic[6:] = body.elasticity.force(state.e, state.v[6:])
        partial = _full(velocities.highest, state.size)[1:]
        result.append(FreeBody(name, state.start, body.masses, points.value, acceleration, partial, elastic))
    return result


def places_at(question: Question) -> Places:
    """Where everything is, in all unknowns of the question."""
    return Places(
        question.t,
        {
            name: moving(body, question.states[name], question.t, 2, question.states[name].start, question.size)
            for name, body in question.mechanism.bodies.items()
        },
    )


def applied_forces(question: Question, places: Places) -> Array:
    """Generalised applied forces (n,): springs, loads; gravity and elastic forces are the bodies' own."""
    result = np.zeros(question.size)
    for force in question.mechanism.forces.values():
        result += force.at(places).generalised(question.size)
    return result


def locked_at(question: Question, places: Places) -> dict[str, Locked]:
    """What every liaison locks, by name."""
    return {name: liaison.at(places) for name, liaison in question.mechanism.liaisons.items()}


def acceleration_rows(question: Question, locked: dict[str, Locked]) -> tuple[Array, Array]:
    """Rows C (m, k) and γ (m,) of all liaisons at the level of accelerations, ``C v̇ + γ = 0``."""
    rows = [_full(residual.highest, question.size) for entry in locked.values() for residual in entry.residuals]
    table = np.array(rows).reshape(len(rows), 1 + question.size)
    return table[:, 1 + question.moving], table[:, 0]


def _full(rows: Array, count: int) -> Array:
    """A row for the value and one for each of `count` unknowns: what does not depend on them has only the first."""
    result = np.zeros((1 + count, *rows.shape[1:]))
    result[: len(rows)] = rows
    return result

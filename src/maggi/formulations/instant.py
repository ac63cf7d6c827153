"""A mechanism at one state, in points: free bodies, the forces on them, and what liaisons lock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .constraints.locked import Locked, Places
from .kinematics import BodyState, moving, point_positions
from .mechanism import Mechanism

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FreeBody:
    """A body's p mass points, as functions of its own velocities and their rates, s of them from `start` on.

    masses (p,); position (p, 3); acceleration (1 + s, p, 3): less gravity, with v̇ zero, and its slopes to v̇; partial
    (s, p, 3): partial velocities. All global. elastic (s,): generalised elastic and damping forces.
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


@dataclass(frozen=True, eq=False)
class Instant:
    """A mechanism at time t (s), with a state for each body: all that Gibbs–Appell, Kane and Newton–Euler look at.

    size: number n of all velocities; moving (k,): which of them are unknown, frames that move as prescribed being none.
    What follows from it is computed where it is first asked for.
    """

    t: float
    mechanism: Mechanism
    states: Mapping[str, BodyState]
    size: int
    moving: IntArray

    @cached_property
    def bodies(self) -> tuple[FreeBody, ...]:
        """All bodies, their points moving; positions to second order give accelerations, to first partial velocities."""
        result = []
        for name, body in self.mechanism.bodies.items():
            state = self.states[name]
            points = point_positions(body, moving(body, state, self.t, 2, 0, state.size))
            velocities = point_positions(body, moving(body, state, self.t, 1, 0, state.size))
            acceleration = _full(points.highest, state.size)
            acceleration[0] -= self.mechanism.gravity
            elastic = np.zeros(state.size)
            elastic[6:] = body.elasticity.force(state.e, state.v[6:])
            partial = _full(velocities.highest, state.size)[1:]
            result.append(FreeBody(name, state.start, body.masses, points.value, acceleration, partial, elastic))
        return tuple(result)

    @cached_property
    def places(self) -> Places:
        """Where everything is, to second order in the rates of all velocities."""
        motions = {}
        for name, body in self.mechanism.bodies.items():
            state = self.states[name]
            motions[name] = moving(body, state, self.t, 2, state.start, self.size)
        return Places(self.t, motions)

    @cached_property
    def locked(self) -> Mapping[str, Locked]:
        """What every liaison locks, by name."""
        return {name: liaison.at(self.places) for name, liaison in self.mechanism.liaisons.items()}

    def applied_forces(self) -> Array:
        """Generalised applied forces (n,): springs, loads; gravity and elastic forces are the bodies' own."""
        forces = [force.at(self.places).generalised(self.size) for force in self.mechanism.forces.values()]
        return np.asarray(np.sum([np.zeros(self.size), *forces], axis=0))

    def acceleration_rows(self) -> tuple[Array, Array]:
        """Rows C (m, k) and γ (m,) of all liaisons at the level of accelerations, ``C v̇ + γ = 0``."""
        residuals = [residual for entry in self.locked.values() for residual in entry.residuals]
        rows = np.zeros((len(residuals), 1 + self.size))
        for row, residual in zip(rows, residuals, strict=True):
            row[: len(residual.highest)] = residual.highest
        return rows[:, 1 + self.moving], rows[:, 0]

    def kinetic_weights(self) -> Array:
        """Root of twice the kinetic energy of each unit velocity (k,); 1 for velocities of what has no mass."""
        square = np.zeros(self.size)
        for body in self.bodies:
            square[body.slots] = np.einsum("p,kpi,kpi->k", body.masses, body.partial, body.partial)
        return np.asarray(np.sqrt(np.where(square > 0.0, square, 1.0))[self.moving])


def _full(rows: Array, count: int) -> Array:
    """A row for the value and one for each of `count` unknowns: what does not depend on them has only the first."""
    result = np.zeros((1 + count, *rows.shape[1:]))
    result[: len(rows)] = rows
    return result

"""Newton–Euler's formulation: free bodies, unknown joint wrenches, and the accelerations that the liaisons ask for.

For each body the momentum and the angular momentum about its centre of mass change by the forces and torques on it, joint
wrenches included; an elastic body's shape functions give one equation more each, the work of all forces on it. The
wrenches are along what each joint locks, written from its geometry and not from its rows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .constraints.locked import Locked, Places, Wrench
from .free_bodies import FreeBody, acceleration_rows, free_bodies, locked_at, places_at
from .kinematics import partials
from .linear import least_squares
from .question import Answer, Question

Array = NDArray[np.float64]


def newton_euler(question: Question) -> Answer:
    """Accelerations and joint forces, joint by joint, from the equations of all free bodies."""
    bodies, places = free_bodies(question), places_at(question)
    locked = locked_at(question, places)
    wrenches = [wrench for entry in locked.values() for wrench in entry.wrenches]
    n, w, moving = question.size, len(wrenches), question.moving
    momentum, right = np.zeros((n, n)), np.zeros(n)
    joint = np.zeros((n, w))
    for body in bodies:
        frame = _Resultant(question, body, places)
        momentum[body.slots, body.slots], right[body.slots] = frame.momentum()
        for force in question.mechanism.forces.values():
            right[body.slots] += frame.of(force.at(places))
        for k, wrench in enumerate(wrenches):
            joint[body.slots, k] = frame.of(wrench)
    C, gamma = acceleration_rows(question, locked)
    equations = np.block([[momentum[np.ix_(moving, moving)], -joint[moving]], [C, np.zeros((len(C), w))]])
    solution = least_squares(equations, np.concatenate([right[moving], -gamma]))
    accelerations, strengths = solution[: len(moving)], solution[len(moving) :]
    liaisons = _by_liaison(question, locked, strengths)
    total = sum(liaisons.values(), np.zeros(len(moving)))
    return Answer(accelerations, total, liaisons)


def _by_liaison(question: Question, locked: dict[str, Locked], strengths: Array) -> dict[str, Array]:
    """Generalised forces (k,) of each liaison."""
    result, first = {}, 0
    for name, entry in locked.items():
        force = np.zeros(question.size)
        for wrench in entry.wrenches:
            force += strengths[first] * wrench.generalised(question.size)
            first += 1
        result[name] = force[question.moving]
    return result


class _Resultant:
    """Resultants on one free body: force, moment about its centre of mass (global), and work on its shape functions."""

    def __init__(self, question: Question, body: FreeBody, places: Places) -> None:
        self._body = body
        self._size = question.size
        mass = float(body.masses.sum())
        motion = places.body(body.name)
        self._frame = motion.frame
        self._centre = body.masses @ body.position / mass if mass > 0.0 else motion.frame.position.value
        # displacements of the points for unit elastic coordinates, global
        shapes = question.mechanism.bodies[body.name].shapes
        self._modes = np.einsum("ij,pja->api", motion.frame.axes.value, shapes)

    def momentum(self) -> tuple[Array, Array]:
        """Slopes (s, s) of the rates of momentum to v̇, and minus what they are at v̇ = 0, elastic forces included."""
        body = self._body
        force = body.masses[:, None] * body.acceleration
        arms = body.position - self._centre
        rows = np.concatenate(
            [force.sum(axis=1), np.cross(arms, force).sum(axis=1), np.einsum("api,kpi->ka", self._modes, force)], axis=1
        )
        return rows[1:].T, body.elastic - rows[0]

    def of(self, wrench: Wrench) -> Array:
        """Resultants (s,) of the parts of a wrench that act on this body."""
        body = self._body
        result = np.zeros(len(body.partial))
        for frame, force, torque in wrench.parts:
            if frame.body != body.name:
                continue
            result[:3] += force
            result[3:6] += torque + np.cross(frame.position.value - self._centre, force)
            elastic = slice(body.start + 6, body.start + len(result))
            velocity, rotation = partials(frame, self._size)
            result[6:] += velocity[elastic] @ force + rotation[elastic] @ torque
        return result

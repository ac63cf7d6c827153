"""Newton–Euler's formulation: free bodies, unknown joint wrenches, and the accelerations that the liaisons ask for.

For each body the momentum and the angular momentum about its centre of mass change by the forces and torques on it, joint
wrenches included; an elastic body's shape functions give one equation more each, the work of all forces on it. The
wrenches are along what each joint locks, written from its geometry and not from its rows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .constraints.locked import Wrench
from .instant import FreeBody, Instant
from .kinematics import partials
from .linear import least_squares
from .question import Answer, Question

Array = NDArray[np.float64]


def newton_euler(question: Question) -> Answer:
    """Accelerations and joint forces, joint by joint, from the equations of all free bodies."""
    instant = question.instant
    n, moving = instant.size, instant.moving
    wrenches = [wrench for entry in instant.locked.values() for wrench in entry.wrenches]
    momentum, right, joint = np.zeros((n, n)), np.zeros(n), np.zeros((n, len(wrenches)))
    for body in instant.bodies:
        resultant = Resultant(instant, body)
        momentum[body.slots, body.slots], right[body.slots] = resultant.momentum()
        for force in instant.mechanism.forces.values():
            right[body.slots] += resultant.of(force.at(instant.places))
        for k, wrench in enumerate(wrenches):
            joint[body.slots, k] = resultant.of(wrench)
    C, gamma = instant.acceleration_rows()
    equations = np.block([[momentum[np.ix_(moving, moving)], -joint[moving]], [C, np.zeros((len(C), len(wrenches)))]])
    solution = least_squares(equations, np.concatenate([right[moving], -gamma]))
    accelerations, strengths = solution[: len(moving)], solution[len(moving) :]
    liaisons = _by_liaison(instant, strengths)
    return Answer(accelerations, np.sum([np.zeros(len(moving)), *liaisons.values()], axis=0), liaisons)


def _by_liaison(instant: Instant, strengths: Array) -> dict[str, Array]:
    """Generalised forces (k,) of each liaison, from the strengths (w,) of all wrenches."""
    result, left = {}, list(strengths)
    for name, entry in instant.locked.items():
        force = np.zeros(instant.size)
        for wrench in entry.wrenches:
            force += left.pop(0) * wrench.generalised(instant.size)
        result[name] = force[instant.moving]
    return result


class Resultant:
    """What acts on one free body: force, moment about its centre of mass (global), and work on its shape functions."""

    def __init__(self, instant: Instant, body: FreeBody) -> None:
        self._body = body
        self._size = instant.size
        frame = instant.places.body(body.name).frame
        mass = float(body.masses.sum())
        self._centre = body.masses @ body.position / mass if mass > 0.0 else frame.position.value
        # displacements of the points for unit elastic coordinates, global
        self._modes = np.einsum("ij,pja->api", frame.axes.value, instant.mechanism.bodies[body.name].shapes)

    def momentum(self) -> tuple[Array, Array]:
        """Slopes (s, s) of the rates of momentum to v̇; and what acts less these rates at v̇ = 0 (s,): elastic forces."""
        body = self._body
        force = body.masses[:, None] * body.acceleration
        moment = np.cross(body.position - self._centre, force)
        work = np.einsum("api,kpi->ka", self._modes, force)
        rows = np.concatenate([force.sum(axis=1), moment.sum(axis=1), work], axis=1)
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
            if len(result) > 6:
                velocity, rotation = partials(frame, self._size)
                result[6:] += (velocity @ force + rotation @ torque)[body.slots][6:]
        return result

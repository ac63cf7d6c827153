"""Kane's formulation: for each independent motion, the sum over all points of partial velocity · (force − m a) vanishes.

    Σ ∂v_p/∂ν · (F_p − m_p a_p) = 0

Partial velocities come from velocities (order 1), accelerations from positions (order 2); nothing is minimised and no
liaison force appears.
"""

from __future__ import annotations

import numpy as np

from .admissible import admissible, kinetic_weights
from .free_bodies import acceleration_rows, applied_forces, free_bodies, locked_at, places_at
from .question import Answer, Question


def kane(question: Question) -> Answer:
    """Accelerations and joint forces by Kane's equations."""
    bodies, places = free_bodies(question), places_at(question)
    active = applied_forces(question, places)
    inertia, slope = np.zeros(question.size), np.zeros((question.size, question.size))
    for body in bodies:
        active[body.slots] += body.elastic
        weighted = body.masses[:, None] * body.partial
        inertia[body.slots] -= np.einsum("kpi,pi->k", weighted, body.acceleration[0])
        slope[body.slots, body.slots] -= np.einsum("kpi,lpi->kl", weighted, body.acceleration[1:])
    moving = question.moving
    generalised, slope = (active + inertia)[moving], slope[np.ix_(moving, moving)]
    C, gamma = acceleration_rows(question, locked_at(question, places))
    allowed = admissible(C, gamma, kinetic_weights(bodies, question.size)[moving])
    motions = allowed.motions
    rates = np.linalg.lstsq(
        motions.T @ slope @ motions, -motions.T @ (generalised + slope @ allowed.particular), rcond=1e-13
    )[0]
    accelerations = allowed.particular + motions @ rates
    return Answer(accelerations, -(generalised + slope @ accelerations), {})

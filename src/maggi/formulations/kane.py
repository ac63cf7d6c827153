"""Kane's formulation: for each independent motion, the sum over all points of partial velocity · (force − m a) vanishes.

    Σ ∂v_p/∂ν · (F_p − m_p a_p) = 0

Partial velocities come from velocities (order 1), accelerations from positions (order 2); nothing is minimised and no
liaison force appears.
"""

from __future__ import annotations

import numpy as np

from .admissible import admissible
from .question import Answer, Question


def kane(question: Question) -> Answer:
    """Accelerations and joint forces by Kane's equations."""
    instant = question.instant
    n, moving = instant.size, instant.moving
    active = instant.applied_forces()
    inertia, slope = np.zeros(n), np.zeros((n, n))
    for body in instant.bodies:
        active[body.slots] += body.elastic
        weighted = body.masses[:, None] * body.partial
        inertia[body.slots] -= np.einsum("kpi,pi->k", weighted, body.acceleration[0])
        slope[body.slots, body.slots] -= np.einsum("kpi,lpi->kl", weighted, body.acceleration[1:])
    generalised, slope = (active + inertia)[moving], slope[np.ix_(moving, moving)]
    allowed = admissible(*instant.acceleration_rows(), instant.kinetic_weights())
    motions, accelerations = allowed.motions, allowed.particular
    inertia_of_motions = motions.T @ slope @ motions
    for _ in range(2):  # the second time takes off the round-off of the first
        remaining = motions.T @ (generalised + slope @ accelerations)
        accelerations = accelerations - motions @ np.linalg.lstsq(inertia_of_motions, remaining, rcond=1e-13)[0]
    return Answer(accelerations, -(generalised + slope @ accelerations), {})

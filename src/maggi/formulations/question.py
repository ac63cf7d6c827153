"""The question that every formulation answers: accelerations and joint forces of a mechanism at one state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import FIXED, MotionState
from maggi.system.system import System

from .bodies import with_inertia
from .kinematics import BodyState
from .mechanism import Mechanism, mechanism_of
from .terms import Terms, terms_at

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Question:
    """A mechanism at one state.

    t (s); mechanism and states (by body): what it is made of and where that is, all that Gibbs–Appell, Kane and
    Newton–Euler look at. size: number n of all velocities; moving (k,): which of them are unknown, frames that move as
    prescribed being none. terms: the program's own matrices at this state, for Maggi and Lagrange.
    """

    t: float
    mechanism: Mechanism
    states: Mapping[str, BodyState]
    size: int
    moving: IntArray
    terms: Terms


@dataclass(frozen=True, eq=False)
class Answer:
    """What a formulation found.

    accelerations (k,): v̇ of the moving velocities. joint_forces (k,): generalised liaison forces −Aᵀλ on them.
    liaisons: of single liaisons by name, (k,) each, from formulations that tell them apart; where liaisons share what
    they lock, only the sum is determined.
    """

    accelerations: Array
    joint_forces: Array
    liaisons: Mapping[str, Array]


def question_at(system: System, motion: MotionState, t: float, floor: bool = False) -> Question:
    """The question for a system at positions and velocities that its liaisons admit.

    motion : of its accelerations only those of frames that follow another run are looked at. Every elastic body must
        bend by coordinates of the small system, or be taken as rigid: meshes with nodal freedoms have none.
    floor : give bodies without inertia about some axis a little (`System.inertia_floor`), so that accelerations about
        that axis are determined where no liaison determines them.

    Raises ModelError where a body or a liaison has no description in points.
    """
    bodies = system.bodies
    moving = [
        np.arange(bodies.offset[b] + (0 if bodies.floating[b] else 6), bodies.offset[b + 1])
        for b in range(bodies.kind.size)
        if bodies.kind[b] != FIXED
    ]
    mechanism = mechanism_of(system.model, {})
    states = {}
    added: dict[str, float] = {}
    for entry in system.body_entries:
        o, e = int(bodies.offset[entry.index]), int(bodies.offset[entry.index + 1])
        prescribed = bodies.floating[entry.index] == 0
        states[entry.name] = BodyState(
            o,
            motion.origin[entry.index].copy(),
            motion.rotation[entry.index].copy(),
            motion.e[o + 6 : e].copy(),
            motion.v[o:e].copy(),
            motion.vd[o : o + 6].copy() if prescribed else None,
        )
        if floor and system.inertia_floor[entry.index] > 0.0:
            added[entry.name] = float(system.inertia_floor[entry.index])
    if set(states) != set(mechanism.bodies):
        raise ValueError(f"bodies differ: {sorted(set(states) ^ set(mechanism.bodies))}")
    heavier = {name: with_inertia(mechanism.bodies[name], moment) for name, moment in added.items()}
    mechanism = replace(mechanism, bodies={**mechanism.bodies, **heavier})
    indices = np.concatenate([np.empty(0, dtype=np.int64), *moving])
    return Question(t, mechanism, states, system.coordinates, indices, terms_at(system, motion, t, indices, floor))

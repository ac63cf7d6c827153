"""The question that every formulation answers: accelerations and joint forces of a mechanism at one state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import FIXED, MESH, MotionState
from maggi.model.bodies import ElasticBody
from maggi.model.meshes import BeamMesh
from maggi.system.system import System

from .bodies import with_inertia
from .instant import Instant
from .kinematics import BodyState
from .mechanism import mechanism_of
from .terms import Terms, terms_at

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Question:
    """A mechanism at one state: in points for Gibbs–Appell, Kane and Newton–Euler, as matrices for Maggi and Lagrange."""

    instant: Instant
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

    motion : of its accelerations only those of frames that follow another run are looked at; joint angles are within half
        a turn of the initial pose, as nothing here counts turns (which torsion springs would feel). Every elastic body must
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
    if np.any(bodies.kind == MESH):
        raise ValueError(
            "a full mesh has no coordinates here: build the system with `dense`, or take the body as rigid"
        )
    mechanism = mechanism_of(system.model, _fields(system))
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
    instant = Instant(t, mechanism, states, system.coordinates, indices)
    return Question(instant, terms_at(system, motion, t, indices, floor))


def _fields(system: System) -> dict[str, Array]:
    """Nodal displacements for unit coordinates of meshed bodies on shapes, (nodes, 3, n); with beams' rotations (nodes, 6, n)."""
    fields = {}
    for entry in system.body_entries:
        reduced = system.reduced.get(entry.index)
        if reduced is not None:
            body, basis = system.model.bodies[entry.name], reduced.basis
            beam = isinstance(body, ElasticBody) and isinstance(body.mesh, BeamMesh)
            fields[entry.name] = basis.reshape(-1, 6, basis.shape[1]) if beam else reduced.nodal_basis()
    return fields

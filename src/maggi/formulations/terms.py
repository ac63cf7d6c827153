"""The program's own matrices at one state, as dense arrays: what Maggi's and Lagrange's formulations solve with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import attachment_motion
from maggi.bodies.ritz_kernels import inertia_residual
from maggi.bodies.tables import FIXED, MotionState
from maggi.forces.kernels import applied_forces
from maggi.liaisons.kernels import evaluate_rows
from maggi.system.dense import dense_mass, dense_rows, new_attachments, new_rows, velocity_scale
from maggi.system.system import System

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Terms:
    """``M v̇ = f − Aᵀλ``, ``A v̇ + γ = 0`` on the k moving velocities; what prescribed frames do is in f and γ.

    M (k, k); A (r, k); gamma (r,); f (k,). scale (k,): the size of one unit of each velocity. owner: rows by the name
    of their liaison.
    """

    M: Array
    A: Array
    gamma: Array
    f: Array
    scale: Array
    owner: Mapping[str, IntArray]


def terms_at(system: System, motion: MotionState, t: float, moving: IntArray, floor: bool) -> Terms:
    """M, A, γ and f of a system at one state (Eq. T5a, T7, T10). floor: see `question.question_at`."""
    given = np.setdiff1d(np.arange(system.coordinates), moving)
    rates = np.zeros(system.coordinates)
    rates[given] = motion.vd[given]
    at = MotionState(motion.origin, motion.rotation, motion.e, motion.v, rates)
    rows = dense_rows(system, at, t)
    M = dense_mass(system, at)
    for b in range(system.bodies.kind.size):
        # the small inertia that the stepping adds to bodies without any is no part of the equations
        if system.bodies.kind[b] != FIXED and not floor:
            o = int(system.bodies.offset[b])
            M[o + 3 : o + 6, o + 3 : o + 6] -= system.inertia_floor[b] * np.eye(3)
    owner = {entry.name: np.asarray(entry.rows) for entry in system.liaison_entries}
    return Terms(
        M[np.ix_(moving, moving)],
        rows.A[:, moving],
        rows.acceleration.copy(),
        _forces(system, at, t)[moving],
        velocity_scale(system)[moving],
        owner,
    )


def _forces(system: System, motion: MotionState, t: float) -> Array:
    """f (n,): applied forces less gravity, elastic forces and all inertia that remains where nothing accelerates."""
    bodies = system.bodies
    attachments, rows = new_attachments(bodies.attachment_body.size), new_rows(system)
    attachment_motion(bodies, motion, attachments)
    evaluate_rows(system.liaisons, bodies, motion, attachments, rows, t)
    Q, power = np.empty(system.coordinates), np.empty(3)
    applied_forces(system.forces, bodies, system.liaisons, motion, attachments, rows, t, Q, power)
    inertia = np.zeros(system.coordinates)
    for b in range(bodies.kind.size):
        if bodies.kind[b] != FIXED:
            inertia_residual(bodies, b, motion, system.forces.gravity, inertia[bodies.offset[b] : bodies.offset[b + 1]])
    return np.asarray(Q - inertia)

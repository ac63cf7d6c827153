"""Inverse dynamics: the actuator forces that produce a desired motion, by Maggi's projection.

Outputs y and actuators are joint coordinates; with G and B their velocities' coefficients, ẏ = G v, and forces Bᵀu,

    Sᵀ M S ν̇ − Sᵀ Bᵀ u = Sᵀ (f − M a_p)         motion that the liaisons admit (T9, T10)
    G S ν̇              = ÿ − g − G a_p           g: what ÿ is without accelerations

As many outputs as actuators determine u, and ν̇ too: freedoms that are no outputs, such as elastic ones, move as the
forces make them (feedback linearisation). Source: the paper's references to robotics; Eq. T8–T10.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import attachment_motion, generalised_force
from maggi.bodies.tables import FIXED, MESH, MotionState
from maggi.formulations.terms import terms_at
from maggi.liaisons.kernels import evaluate_rows
from maggi.liaisons.tables import COORDINATE_JOINT, COORDINATE_KIND, ROTATION, ROTATION_SECOND, TRANSLATION
from maggi.model.errors import ModelError
from maggi.projection.maggi import project
from maggi.system.dense import new_attachments, new_rows
from maggi.system.system import System

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

SINGULAR = 1e-10
"""Smallest singular value of G S (SᵀMS)⁻¹ SᵀBᵀ, relative to the largest, from which on actuators move the outputs."""


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Joint coordinates at one state: values (m,), rates (m,), and ÿ = G v̇ + g with G (m, n), g (m,)."""

    values: Array
    rates: Array
    G: Array
    g: Array


@dataclass(frozen=True, eq=False)
class ActuatorForces:
    """forces (m,): u, N or N m, exerted by first on second; accelerations (n,): v̇ of all small coordinates."""

    forces: Array
    accelerations: Array


def coordinate_numbers(system: System, names: Sequence[str]) -> IntArray:
    """Rows of joint coordinates by name: ``elbow``, ``slider.displacement``, or ``tip.0`` for the first of several.

    A joint that is `free` has six and no rows: its translations are the place of a point as outputs.
    Raises ModelError where there is no such coordinate, or several.
    """
    found = []
    for name in names:
        joint, _, which = name.partition(".")
        entry = next((e for e in system.liaison_entries if e.name == joint), None)
        if entry is None:
            known = ", ".join(e.name for e in system.liaison_entries if len(e.coordinates))
            raise ModelError(f"there is no joint {joint!r}", remedy=f"joints with coordinates are {known}")
        kinds = system.liaisons.coordinate[entry.coordinates, COORDINATE_KIND]
        if which.isdigit():
            chosen = entry.coordinates[int(which) : int(which) + 1]
        else:
            wanted = {"angle": (ROTATION, ROTATION_SECOND), "displacement": (TRANSLATION,)}
            if which not in ("", *wanted):
                raise ModelError(f"{name!r} names no coordinate", remedy="write .angle, .displacement or a number")
            chosen = entry.coordinates[np.isin(kinds, wanted[which])] if which else entry.coordinates
        if len(chosen) != 1:
            raise ModelError(
                f"{name!r} means {len(chosen)} coordinates of joint {joint!r} ({entry.kind})",
                remedy="write .angle, .displacement, or a number from 0 on",
            )
        found.append(int(chosen[0]))
    return np.array(found, dtype=np.int64)


def coordinates_at(
    system: System, motion: MotionState, t: float, chosen: IntArray, previous: Array | None = None
) -> Coordinates:
    """Chosen joint coordinates at a state; of its accelerations only those of prescribed frames count.

    previous (c,): all joint coordinates a little earlier, that unwrapping starts from.
    """
    bodies, table = system.bodies, system.liaisons
    attachments, rows = new_attachments(bodies.attachment_body.size), new_rows(system)
    if previous is not None:
        rows.previous[:] = previous
    attachment_motion(bodies, motion, attachments)
    evaluate_rows(table, bodies, motion, attachments, rows, t)
    G = np.zeros((len(chosen), system.coordinates))
    for i, c in enumerate(chosen):
        for side in range(2):
            end = int(table.joint[table.coordinate[c, COORDINATE_JOINT], side])
            b = int(bodies.attachment_body[end])
            part = G[i, bodies.offset[b] : bodies.offset[b + 1]]
            f = rows.coordinate_wrench[c, side]
            generalised_force(bodies, motion, attachments, end, f[0], f[1], f[2], f[3], f[4], f[5], part)
    at = rows.coordinate[chosen]
    return Coordinates(at[:, 0].copy(), at[:, 1].copy(), G, at[:, 2] - G @ motion.vd)


def inverse_dynamics(
    system: System,
    motion: MotionState,
    t: float,
    actuators: Sequence[str],
    outputs: Sequence[str],
    accelerations: Array,
) -> ActuatorForces:
    """The forces of `actuators` that give `outputs` the wanted accelerations ÿ (m,) at a state on the liaisons.

    motion : positions and velocities, on the liaisons; its accelerations are not looked at. actuators, outputs : joint
    coordinates by name (see `coordinate_numbers`), as many of one as of the other.

    Raises ModelError where numbers differ, or where the actuators cannot move the outputs in this position.
    """
    return solve(
        system, motion, t, coordinate_numbers(system, actuators), coordinate_numbers(system, outputs), accelerations
    )


def solve(
    system: System, motion: MotionState, t: float, actuators: IntArray, outputs: IntArray, accelerations: Array
) -> ActuatorForces:
    """`inverse_dynamics` with coordinates by number."""
    if len(actuators) != len(outputs) or len(outputs) != len(accelerations):
        raise ModelError(
            f"{len(actuators)} actuators, {len(outputs)} outputs and {len(accelerations)} accelerations are given",
            remedy="give as many outputs as actuators, and an acceleration for each",
        )
    _refuse_meshes(system)
    moving = _moving(system)
    still = replace(motion, vd=np.where(np.isin(np.arange(system.coordinates), moving), 0.0, motion.vd))
    terms = terms_at(system, still, t, moving, floor=True)
    wanted = coordinates_at(system, still, t, outputs)
    B = coordinates_at(system, still, t, actuators).G[:, moving]
    G = wanted.G[:, moving]
    projection = project(terms.A, terms.scale)
    S, a_p = projection.S, projection.particular(terms.gamma)
    given = wanted.G @ still.vd + wanted.g
    reduced = S.T @ terms.M @ S
    free = np.linalg.solve(reduced, S.T @ (terms.f - terms.M @ a_p))
    effect = np.linalg.solve(reduced, S.T @ B.T)
    response = G @ S @ effect
    values = np.linalg.svd(response, compute_uv=False)
    if len(values) and not values[-1] > SINGULAR * values[0]:
        raise ModelError(
            "the actuators cannot give the outputs these accelerations here: they do not move them, or not apart",
            remedy="choose outputs that the actuators reach, or leave this position",
        )
    u = np.asarray(np.linalg.solve(response, accelerations - given - G @ (S @ free + a_p)), dtype=np.float64)
    vd = still.vd.copy()
    vd[moving] = S @ (free + effect @ u) + a_p
    return ActuatorForces(u, vd)


def _moving(system: System) -> IntArray:
    """The small coordinates whose velocities are unknown."""
    bodies = system.bodies
    parts = [
        np.arange(bodies.offset[b] + (0 if bodies.floating[b] else 6), bodies.offset[b + 1])
        for b in range(bodies.kind.size)
        if bodies.kind[b] != FIXED
    ]
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])


def _refuse_meshes(system: System) -> None:
    for entry in system.body_entries:
        if system.bodies.kind[entry.index] == MESH:
            raise ModelError(
                f"the meshed body {entry.name!r} has too many freedoms for inverse dynamics",
                path=f"bodies.{entry.name}",
                remedy="give it `reduction: {method: craig-bampton, modes: …}`",
            )

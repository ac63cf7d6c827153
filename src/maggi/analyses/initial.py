"""Initial positions and velocities: what is given holds, the rest follows with the least kinetic energy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import move
from maggi.bodies.motions import prescribe
from maggi.bodies.tables import MotionState
from maggi.liaisons.tables import ROW_ANGULAR
from maggi.model.bodies import RitzBody
from maggi.model.errors import ModelError
from maggi.projection.maggi import closest_velocities, project, restore
from maggi.stepping.allocate import copy_motion
from maggi.system.dense import dense_mass, dense_rows, floating_velocities, velocity_scale
from maggi.system.system import System

from .assembly import assemble
from .drivers import refuse_overdriven

Array = NDArray[np.float64]

ROUND_OFF = 1e-12
SMALL = 1e-6  # contradictions up to this, relative to size and speed, are projected away and told; larger ones refused


def initial_motion(system: System, notes: list[str]) -> MotionState:
    """Positions and velocities at t = 0 that the liaisons admit; accelerations still zero.

    Raises ModelError where joints do not meet, drivers start off zero, or velocities contradict each other.
    """
    motion = copy_motion(system.start)
    prescribe(system.motions, system.bodies, 0.0, motion)
    _ritz_coordinates(system, motion)
    refuse_undefined(system, motion)
    _refuse_driven_gaps(system, motion)
    _close_gaps(system, motion, notes)
    refuse_overdriven(system, motion)
    set_velocities(system, motion, notes)
    return motion


def refuse_undefined(system: System, motion: MotionState) -> None:
    """Raise ModelError where a joint's rows have no finite value: a formula outside its domain, a point where no normal is."""
    with np.errstate(invalid="ignore"):
        rows = dense_rows(system, motion, 0.0)
    defined = np.isfinite(rows.A).all(axis=1) & np.isfinite(rows.velocity)
    defined &= np.isfinite(np.where(system.holonomic, rows.position, 0.0))
    if not defined.all():
        wrong = int(np.argmin(defined))
        name = system.owner(wrong).name
        raise ModelError(
            f"joint {name!r}: {system.row_label(wrong)} has no finite value in the initial pose",
            path=f"joints.{name}",
            remedy="keep formulas inside the domain of their functions, and points away from where a curve or surface "
            "has no direction",
        )


def _ritz_coordinates(system: System, motion: MotionState) -> None:
    """Given initial coordinates and rates of Ritz bodies."""
    for entry in system.body_entries:
        body = system.model.bodies.get(entry.name)
        if not isinstance(body, RitzBody) or body.initial is None:
            continue
        o, e = system.bodies.offset[entry.index] + 6, system.bodies.offset[entry.index + 1]
        for values, target in zip(body.initial, (motion.e, motion.v), strict=True):
            if len(values) != e - o:
                raise ModelError(
                    f"{len(values)} initial values are given for {e - o} coordinates",
                    path=f"bodies.{entry.name}.initial",
                    remedy="give one for each shape function",
                )
            target[o:e] = values


def _refuse_driven_gaps(system: System, motion: MotionState) -> None:
    Phi = dense_rows(system, motion, 0.0).position
    for driven in np.flatnonzero(system.driven & system.holonomic & (np.abs(Phi) > ROUND_OFF * system.size)):
        raise ModelError(
            f"the driver starts at {-Phi[driven]:.6g} instead of 0",
            path=f"joints.{system.owner(int(driven)).name}",
            remedy="a joint's coordinate is zero in the initial pose; subtract the function's value at t = 0",
        )


def _close_gaps(system: System, motion: MotionState, notes: list[str]) -> None:
    holonomic = system.holonomic
    Phi = np.where(holonomic, dense_rows(system, motion, 0.0).position, 0.0)
    worst = float(np.abs(Phi).max(initial=0.0))
    if worst <= ROUND_OFF * system.size:
        return
    row = int(np.argmax(np.abs(Phi)))
    owner = system.owner(row)
    if worst > SMALL * system.size:
        _assemble(system, motion, row, float(Phi[row]), notes)
        worst = 0.0  # what is left is no gap that was given
    moving = floating_velocities(system)
    scale = velocity_scale(system)[moving]
    M = dense_mass(system, motion)[np.ix_(moving, moving)]

    def rows_at(step: Array) -> tuple[Array, Array]:
        full = np.zeros(system.coordinates)
        full[moving] = step
        move(system.bodies, motion, full, motion)
        at = dense_rows(system, motion, 0.0)
        return at.A[holonomic][:, moving], at.position[holonomic]

    left = restore(rows_at, M, scale, ROUND_OFF * system.size)
    if left > 1e-10 * system.size:
        raise ModelError(
            f"the joints cannot all be closed: {left:.3g} m are left at best",
            path=f"joints.{owner.name}",
            remedy="correct the poses or the attachments",
        )
    if worst > 0.0:
        notes.append(f"initial gaps up to {worst:.2g} m (joint {owner.name}) were closed")


def _assemble(system: System, motion: MotionState, row: int, gap: float, notes: list[str]) -> None:
    """Move the bodies until a joint whose ends do not meet closes, if the model asks for it.

    Raises ModelError otherwise, and where that is not possible.
    """
    owner, simulation = system.owner(row), system.model.simulation
    unit = "rad" if system.liaisons.row[row, ROW_ANGULAR] else "m"
    text = (
        f"the ends of joint {owner.name!r} ({owner.first}, {owner.second}) do not meet: "
        f"{system.row_label(row)} is off by {abs(gap):.3g} {unit}"
    )
    nearest = assemble(system, motion, owner)
    moves = f"by up to {nearest.shift:.3g} m and {nearest.turn:.3g} rad ({nearest.body} most)"
    if not nearest.closed:
        raise ModelError(
            f"{text}; the mechanism cannot be assembled: the smallest gap reached is {nearest.gap:.3g} "
            f"{'rad' if nearest.angular else 'm'} at {nearest.at}",
            path=f"joints.{owner.name}",
            remedy="correct the dimensions: attachments, joints' places or axes; `maggi check` prints where they are",
        )
    if simulation is None or not simulation.assemble:
        raise ModelError(
            f"{text}; all joints would close if bodies moved {moves}",
            path=f"joints.{owner.name}",
            remedy="correct the poses or the attachments, which `maggi check` prints, or let `simulation: {assemble: true}` "
            "move the bodies",
        )
    motion.origin[:], motion.rotation[:] = nearest.motion.origin, nearest.motion.rotation
    notes.append(f"the joints were assembled: bodies moved {moves}")


def set_velocities(system: System, motion: MotionState, notes: list[str]) -> None:
    """The frames' velocities at t = 0; elastic rates in `motion.v` are taken as given.

    Given velocities hold; the others make the kinetic energy least. Small contradictions are projected away
    mass-orthogonally, larger ones refused by ModelError.
    """
    given_rates = _given_rates(system)
    rates = motion.v[given_rates]
    moving = np.concatenate([floating_velocities(system), given_rates])
    if moving.size == 0:
        return
    motion.v[moving] = 0.0
    rows = dense_rows(system, motion, 0.0)
    A, b = rows.A[:, moving], rows.velocity
    G, g, owners = _given(system, motion, moving)
    G, g = np.vstack([G, np.eye(moving.size)[moving.size - rates.size :]]), np.concatenate([g, rates])
    owners += [_owner(system, int(c)) for c in given_rates]
    if not b.any() and not g.any():
        return  # at rest: no kinetic energy is less
    scale = velocity_scale(system)[moving]
    M = dense_mass(system, motion)[np.ix_(moving, moving)]
    together = project(np.vstack([A, G]), scale)
    stacked = np.concatenate([b, -g])
    v = closest_velocities(together, M, np.zeros(moving.size), stacked)
    speed = max(float(np.abs(v * scale).max()), float(np.abs(g).max(initial=0.0)), _least_speed(system))
    defect = together.A @ v + stacked
    worst = float(np.abs(defect).max(initial=0.0))
    if worst > ROUND_OFF * speed:
        alone = project(A, scale)
        gap = alone.inconsistency(b)
        if np.abs(gap).max(initial=0.0) > SMALL * speed:
            row = int(np.argmax(np.abs(gap)))
            owner = system.owner(int(row)).name
            raise ModelError(
                f"no velocity satisfies all joints and drivers: {system.row_name(row)} is off by {abs(gap[row]):.3g}",
                path=f"joints.{owner}",
                remedy="two drivers contradict each other, or one drives a motion that the joints lock",
            )
        if owners:
            start = closest_velocities(project(G, scale), M, v, -g)
            v = closest_velocities(alone, M, start, b)
            change = np.abs(G @ v - g)
            row = int(np.argmax(change))
            if change[row] > SMALL * speed:
                raise ModelError(
                    f"the initial velocity contradicts the joints: off by {change[row]:.3g} of {speed:.3g} m/s or rad/s",
                    path=f"bodies.{owners[row]}.velocity",
                    remedy="give the velocity to fewer bodies: those without one follow from the joints",
                )
            notes.append(f"initial velocities were changed by up to {change[row]:.2g} to satisfy the joints")
    motion.v[moving] = v


def _least_speed(system: System) -> float:
    """A speed (m/s) that moves nothing in a run: contradictions of what rests are judged by it."""
    simulation = system.model.simulation
    return 1e-300 if simulation is None else SMALL * system.size / simulation.duration


def _given_rates(system: System) -> NDArray[np.int64]:
    """Which small coordinates are rates of Ritz bodies whose initial values are given."""
    parts = [np.empty(0, dtype=np.int64)]
    for entry in system.body_entries:
        body = system.model.bodies.get(entry.name)
        if isinstance(body, RitzBody) and body.initial is not None:
            parts.append(np.arange(system.bodies.offset[entry.index] + 6, system.bodies.offset[entry.index + 1]))
    return np.concatenate(parts)


def _owner(system: System, coordinate: int) -> str:
    """The body that a small coordinate belongs to."""
    index = int(np.searchsorted(system.bodies.offset, coordinate, side="right")) - 1
    return next(entry.name for entry in system.body_entries if entry.index == index)


def _given(system: System, motion: MotionState, moving: NDArray[np.int64]) -> tuple[Array, Array, list[str]]:
    """Rows G v = g of the velocities that the model gives, and the body that each belongs to."""
    G, g, owners = [], [], []
    place = {int(c): k for k, c in enumerate(moving)}
    for entry in system.body_entries:
        body = system.model.bodies.get(entry.name)
        if body is None or system.bodies.floating[entry.index] == 0:
            continue
        R = motion.rotation[entry.index]
        first = place[int(system.bodies.offset[entry.index])]
        for shift, value in ((0, body.velocity.linear), (3, body.velocity.angular)):
            if value is None:
                continue
            for i in range(3):
                row = np.zeros(moving.size)
                row[first + shift : first + shift + 3] = R[i]
                G.append(row)
                g.append(value[i])
                owners.append(entry.name)
    return np.array(G).reshape(-1, moving.size), np.array(g), owners

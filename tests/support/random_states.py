"""Random states of any system, away from its initial pose and in motion, that all liaisons admit."""

from __future__ import annotations

import numpy as np

from maggi.bodies.attachment_kernels import move
from maggi.bodies.motions import prescribe
from maggi.projection.maggi import closest_velocities, project, restore
from maggi.stepping.allocate import copy_motion
from maggi.system.dense import dense_mass, dense_rows, floating_velocities, velocity_scale


def state_in_motion(system, rng, t=0.1, steps=3, length=0.1):
    """Positions away from the initial pose and velocities, at time t (s), that all liaisons admit; None if there are none.

    steps : how many times everything moves by about `length` (m, rad) and is put back on Φ = 0.
    """
    moving = _moving(system)
    motion = copy_motion(system.start)
    scale = velocity_scale(system)
    for step in range(1, steps + 1):
        now = t * step / steps
        prescribe(system.motions, system.bodies, now, motion)
        wanted = admitted_velocities(system, motion, now, rng.normal(size=len(moving)), moving)
        if wanted is None:
            return None
        size = np.abs(wanted * scale[moving]).max(initial=0.0)
        base, shift = copy_motion(motion), np.zeros(system.coordinates)
        shift[moving] = wanted * (length / size if size > 0.0 else 0.0)
        move(system.bodies, base, shift, motion)
        if not _close(system, motion, now, moving):
            return None
    velocities = admitted_velocities(system, motion, t, rng.normal(size=len(moving)), moving)
    if velocities is None:
        return None
    motion.v[moving] = velocities
    return motion


def _moving(system):
    """Velocities that are unknown: of floating frames, and rates of elastic coordinates."""
    offset, bodies = system.bodies.offset, range(1, system.bodies.kind.size)
    elastic = [np.arange(offset[b] + 6, offset[b + 1]) for b in bodies]
    return np.sort(np.concatenate([floating_velocities(system), *elastic]))


def admitted_velocities(system, motion, t, wanted, moving):
    """The admitted velocities (k,) nearest to wanted ones; None where the liaisons contradict each other."""
    motion.v[moving] = 0.0
    rows = dense_rows(system, motion, t)
    M = dense_mass(system, motion)[np.ix_(moving, moving)]
    projection = project(rows.A[:, moving], velocity_scale(system)[moving])
    if np.abs(projection.inconsistency(rows.velocity)).max(initial=0.0) > 1e-9:
        return None
    return closest_velocities(projection, M, wanted, rows.velocity)


def _close(system, motion, t, moving):
    holonomic = np.flatnonzero(system.holonomic)
    M = dense_mass(system, motion)[np.ix_(moving, moving)]

    def rows_at(step):
        shift = np.zeros(system.coordinates)
        shift[moving] = step
        move(system.bodies, motion, shift, motion)
        rows = dense_rows(system, motion, t)
        return rows.A[np.ix_(holonomic, moving)], rows.position[holonomic]

    left = restore(rows_at, M, velocity_scale(system)[moving], 1e-12)
    return left < 1e-11

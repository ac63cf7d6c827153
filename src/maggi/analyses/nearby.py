"""Neighbouring poses that the joints admit: what is general about a mechanism, and what only its initial pose has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from maggi.bodies.tables import MotionState
from maggi.system.dense import floating_velocities
from maggi.system.system import System

from .chart import Place, at_rest, chart

PLACES = 3
REACH = 0.05  # how far away they are, of the mechanism's size
_STUCK = 0.1  # places within this part of that have not moved


@dataclass(frozen=True, eq=False)
class Nearby:
    """Random poses near another one. shaky : there are none although velocities are admitted (a shaky structure)."""

    places: tuple[Place, ...]
    shaky: bool


def nearby_poses(system: System, motion: MotionState, without: tuple[int, ...] = ()) -> Nearby:
    """Poses of rigid bodies, elastic ones bent as they are, that hold the positions of all joints but no drivers.

    without : rows left out as well.
    """
    here = at_rest(system, motion)
    around = chart(system, floating_velocities(system), here, time=False)
    passive = np.setdiff1d(np.flatnonzero(system.holonomic & ~system.driven), without)
    rng = np.random.default_rng(0)
    found = [around.nearby(here, passive, rng, REACH) for _ in range(PLACES)]
    moved = tuple(one for one in found if one is not None and around.distance(here, one) > _STUCK * REACH)
    return Nearby(moved, around.admitted(here, passive) > 0 and not moved and None not in found)

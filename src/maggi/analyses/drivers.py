"""Drivers that prescribe more than the joints leave free, or a motion that the initial pose does not have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq

from maggi.bodies.tables import MotionState
from maggi.liaisons.tables import ROW_OWNER
from maggi.model.errors import ModelError
from maggi.model.joints import Coupler, Driver
from maggi.projection.maggi import project
from maggi.system.dense import dense_rows, velocity_scale
from maggi.system.system import LiaisonEntry, System

from .nearby import nearby_poses

Array = NDArray[np.float64]

_SHARE = 1e-6  # of a driver's row that another liaison's rows must repeat to be named
_NAMED = 6  # joints named in a message at most


def refuse_overdriven(system: System, motion: MotionState) -> None:
    """Raise ModelError for the first driver, in the model's order, whose row adds nothing to those of joints and drivers before it.

    Where it would in neighbouring poses, the message tells the dead centre.
    """
    driven = np.flatnonzero(system.driven)
    if driven.size == 0:
        return
    driven = driven[np.argsort(system.liaisons.row[driven, ROW_OWNER])]
    # velocities of prescribed frames count: those that follow a rigid run are driven there
    scale = velocity_scale(system)
    A = dense_rows(system, motion, 0.0).A
    before = [int(row) for row in np.flatnonzero(~system.driven)]
    rank = project(A[before], scale).rank
    for row in map(int, driven):
        more = project(A[[*before, row]], scale).rank
        if more == rank:
            raise _one_too_many(system, motion, A / scale, before, row)
        rank = more
        before.append(row)


def _one_too_many(system: System, motion: MotionState, A: Array, before: Sequence[int], row: int) -> ModelError:
    driver = system.owner(row)
    given = system.model.joints[driver.name]
    assert isinstance(given, Driver)
    path = f"joints.{driver.name}"
    if _free_nearby(system, motion, before, row):
        return ModelError(
            f"the mechanism starts in a dead centre of {given.joint!r}, where driver {driver.name!r} cannot move it",
            path=path,
            remedy="start it a little beside, or drive another joint",
        )
    share = lstsq(A[before].T, A[row])[0]
    owners = {system.owner(k).name: system.owner(k) for k, x in zip(before, share, strict=True) if abs(x) > _SHARE}
    decisive = [name for name, one in owners.items() if _moves_others(system, one)]
    if decisive:
        text = f"the joints together with {', '.join(decisive)} leave its coordinate no freedom"
    else:
        joints = [name for name, one in owners.items() if one.visible]
        more = "" if len(joints) <= _NAMED else f" and {len(joints) - _NAMED} more"
        text = f"the joints ({', '.join(joints[:_NAMED])}{more}) leave its coordinate no freedom"
    return ModelError(
        f"driver {driver.name!r} is one too many: {text}",
        path=path,
        remedy="remove a driver, or free a joint so that every driver has a motion of its own",
    )


def _moves_others(system: System, entry: LiaisonEntry) -> bool:
    """Whether a liaison is a driver or a coupler."""
    return isinstance(system.model.joints.get(entry.name), Driver | Coupler)


def _free_nearby(system: System, motion: MotionState, before: Sequence[int], row: int) -> bool:
    """Whether the row is independent in neighbouring poses, which drivers need not admit."""
    scale = velocity_scale(system)
    for place in nearby_poses(system, motion).places:
        A = dense_rows(system, place.motion, place.time).A
        if project(A[[*before, row]], scale).rank > project(A[list(before)], scale).rank:
            return True
    return False

"""Why a step fails, where a joint itself says so: its geometry has ended, or the function behind it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import attachment_motion, move
from maggi.bodies.motions import prescribe
from maggi.bodies.tables import MotionState
from maggi.liaisons.tables import ROLL, ROW_JOINT, ROW_KIND
from maggi.system.dense import dense_rows, new_attachments
from maggi.system.system import LiaisonEntry, System

from .allocate import copy_motion

Array = NDArray[np.float64]

_ALMOST_FLAT = 0.05  # rad between a disc and its plane, from which on a failing step is put down to that
_DOUBLINGS = 10
_ENDED = {
    "rolling-disc": "the disc {name!r} lies flat on its plane, where no point of it is the one that rolls",
    "point-on-curve": "the point of {name!r} has left its curve: it is beyond an end, or no point of the curve is nearest",
    "point-on-surface": "the point of {name!r} has left its surface: it is beyond the grid, or where there is no normal",
    "cam": "the follower of {name!r} has lost its profile: it is beyond an end, or no point of the profile is nearest",
    "distance": "the ends of the rod {name!r} coincide, so that it has no direction",
}
_FORMULA = "a function of {name!r} has no finite value"


def why_undefined(
    system: System, now: MotionState, trial: MotionState, previous: Array, t: float, h: float
) -> str | None:
    """Which joint has no finite rows in a trial step of size h (s) to time t although the motion is finite, and why.

    previous (c,): joint coordinates at the beginning of the step. Where the trial has already spoilt the motion, the present
    one is continued at constant velocity over one step and more instead. None where all rows are finite there.
    """
    raised = why_raised(system)
    if raised is not None:
        return raised
    if all(np.isfinite(part).all() for part in (trial.origin, trial.rotation, trial.e, trial.v)):
        with np.errstate(invalid="ignore"):
            rows = dense_rows(system, trial, t, previous)
        return _ended(system, _Rows(rows.position, rows.velocity, rows.acceleration))
    ahead = copy_motion(now)
    for k in range(_DOUBLINGS):
        move(system.bodies, now, 2.0**k * h * now.v, ahead)
        prescribe(system.motions, system.bodies, t, ahead)
        with np.errstate(invalid="ignore"):
            rows = dense_rows(system, ahead, t, previous)
        ended = _ended(system, _Rows(rows.position, rows.velocity, rows.acceleration))
        if ended is not None:
            return ended
    return None


class _Rows(NamedTuple):
    """Values of all rows, (r,) each."""

    position: Array
    velocity: Array
    acceleration: Array


def _ended(system: System, rows: _Rows) -> str | None:
    """What has ended at the first joint whose rows are not finite, if there is one."""
    wrong = ~np.all([np.isfinite(part) for part in rows], axis=0)
    if not wrong.any():
        return None
    entry = system.owner(int(np.argmax(wrong)))
    return _ENDED.get(entry.kind, _FORMULA).format(name=entry.name)


def why_raised(system: System) -> str | None:
    """What a Python function of rows raised, if one did."""
    for function in system.row_functions:
        if function.error is not None:
            return f"the function of {function.name!r} raised {type(function.error).__name__}: {function.error}"
    return None


def almost_flat(system: System, motion: MotionState) -> tuple[LiaisonEntry, float] | None:
    """The rolling disc that lies flattest, if it is almost flat, and its angle (rad) with its plane."""
    attachments = new_attachments(system.bodies.attachment_body.size)
    attachment_motion(system.bodies, motion, attachments)
    table = system.liaisons
    found: tuple[LiaisonEntry, float] | None = None
    for row in np.flatnonzero(table.row[:, ROW_KIND] == ROLL):
        joint = table.row[row, ROW_JOINT]
        first, second = table.joint[joint]
        normal = attachments.rotation[first] @ table.frame[joint, 0][:, 2]
        axis = attachments.rotation[second] @ table.frame[joint, 1][:, 2]
        angle = float(np.arctan2(np.linalg.norm(np.cross(normal, axis)), abs(normal @ axis)))
        if angle < (_ALMOST_FLAT if found is None else found[1]):
            found = system.owner(int(row)), angle
    return found

"""Rates of joint coordinates: by name, and as linear functions of the velocities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import attachment_motion
from maggi.bodies.tables import MotionState
from maggi.liaisons.kernels import evaluate_rows
from maggi.liaisons.tables import (
    COORDINATE_AXIS,
    COORDINATE_KIND,
    CURVE_FACE,
    CURVE_POINT,
    ROTATION,
    ROTATION_SECOND,
    TRANSLATION,
)
from maggi.stepping.allocate import copy_motion
from maggi.system.dense import new_attachments, new_rows
from maggi.system.system import LiaisonEntry, System

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Coordinate:
    """A coordinate of a joint: its number, its joint, what it is (``angle``, ``displacement along x``) and its unit."""

    index: int
    joint: str
    quantity: str
    unit: str


def joint_coordinate_list(system: System) -> list[Coordinate]:
    """All coordinates of the joints that the model names, in its order; a driver's is its joint's."""
    return [
        Coordinate(int(c), entry.name, *_quantity(system, entry, int(c)))
        for entry in system.liaison_entries
        if entry.visible and entry.kind != "driver"
        for c in entry.coordinates
    ]


def coordinate_rates(system: System, motion: MotionState, S: Array) -> Array:
    """Rates (c, k) of all joint coordinates for each of the velocities in the columns of S (n, k)."""
    motion, attachments, rows = (
        copy_motion(motion),
        new_attachments(system.bodies.attachment_body.size),
        new_rows(system),
    )
    rates = np.empty((len(system.liaisons.coordinate), S.shape[1]))
    for k in range(S.shape[1]):
        motion.v[:] = S[:, k]
        attachment_motion(system.bodies, motion, attachments)
        evaluate_rows(system.liaisons, system.bodies, motion, attachments, rows, 0.0)
        rates[:, k] = rows.coordinate[:, 1]
    return rates


def _quantity(system: System, entry: LiaisonEntry, c: int) -> tuple[str, str]:
    """What a coordinate is, and its unit."""
    table = system.liaisons.coordinate
    kind = int(table[c, COORDINATE_KIND])
    if kind in (CURVE_POINT, CURVE_FACE):
        return "curve parameter", "1"
    name, unit = ("displacement", "m") if kind == TRANSLATION else ("angle", "rad")
    if sum(_name(int(table[k, COORDINATE_KIND])) == name for k in entry.coordinates) == 1:
        return name, unit
    axis = "xyz"[int(table[c, COORDINATE_AXIS])]
    if kind in (ROTATION, ROTATION_SECOND):
        return f"angle about its {axis} axis", unit
    return f"displacement along {axis}" if kind == TRANSLATION else f"rotation about {axis}", unit


def _name(kind: int) -> str:
    return "displacement" if kind == TRANSLATION else "angle"

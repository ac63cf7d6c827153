"""Joint ─► Outline: circles of wheels, curves as they are sampled, rods between their ends."""

from __future__ import annotations

from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from maggi.liaisons.tables import ROW_JOINT
from maggi.model.curves import Curve
from maggi.model.joints import Cam, Distance, KnifeEdge, Liaison, PointOnCurve, RollingDisc, RollingSphere
from maggi.system.curve_builder import sampled
from maggi.system.frames import around
from maggi.system.system import LiaisonEntry, System

from .outline import Outline

Array = NDArray[np.float64]
POINTS = 200  # of a curve
_AROUND = 72  # of a circle
_BLADE = 0.05  # half a blade's length, of the mechanism's extent
_FACE = 0.6  # half a follower's face, of the cam's size


class _Ends:
    """The two points of a joint, and how global vectors look from its bodies, in the initial pose."""

    def __init__(self, system: System, entry: LiaisonEntry) -> None:
        table, start = system.bodies, system.start
        ends = system.liaisons.joint[system.liaisons.row[entry.rows[0], ROW_JOINT]]
        self.points = [table.attachment_point[end] for end in ends]
        self._rotations = [start.rotation[table.attachment_body[end]] for end in ends]
        self.axis = np.array([0.0, 0.0, 1.0]) if entry.axis is None else entry.axis
        self.size = system.size

    def seen(self, end: int, direction: Array) -> Array:
        """A global direction (3,) in the axes of the first (0) or second (1) body."""
        return np.asarray(self._rotations[end].T @ direction)

    def circle(self, radius: float, axis: Array) -> Array:
        """A circle (p, 3) about the second's point."""
        x, y, _ = around(self.seen(1, axis)).T
        angles = np.linspace(0.0, 2.0 * np.pi, _AROUND + 1)
        return np.asarray(self.points[1] + radius * (np.outer(np.cos(angles), x) + np.outer(np.sin(angles), y)))


def build_outline(system: System, entry: LiaisonEntry) -> Outline | None:
    """The outline of a joint of the model; None where its point and axis say all, and for what has no place."""
    if len(entry.rows) == 0:
        return None
    return _outline(system.model.joints[entry.name], _Ends(system, entry))


@singledispatch
def _outline(liaison: Liaison, ends: _Ends) -> Outline | None:
    return None


@_outline.register
def _rod(rod: Distance, ends: _Ends) -> Outline:
    return Outline(ends.points[0][None], ends.points[1][None])


@_outline.register
def _wire(joint: PointOnCurve, ends: _Ends) -> Outline:
    return Outline(first=_curve(joint.curve))


@_outline.register
def _cam(cam: Cam, ends: _Ends) -> Outline:
    profile = _curve(cam.profile)
    if cam.face is not None:
        along = ends.seen(1, np.cross(ends.axis, np.array(cam.face)))
        reach = _FACE * float(np.ptp(profile, axis=0).max()) * along / np.linalg.norm(along)
        return Outline(profile, np.stack([ends.points[1] - reach, ends.points[1] + reach]))
    if cam.radius == 0.0:
        return Outline(profile)
    return Outline(profile, ends.circle(cam.radius, ends.axis))


@_outline.register
def _disc(disc: RollingDisc, ends: _Ends) -> Outline:
    """The rim, and across to its other side, which shows how the wheel turns."""
    rim = ends.circle(disc.radius, ends.axis)
    return Outline(second=np.vstack([rim, rim[_AROUND // 2]]))


@_outline.register
def _sphere(sphere: RollingSphere, ends: _Ends) -> Outline:
    """Three great circles in one line: a circle and a quarter in each plane lead to where the next one starts."""
    turn = np.linspace(0.0, 2.5 * np.pi, (5 * _AROUND) // 4 + 1)
    c, s, o = np.cos(turn), np.sin(turn), np.zeros_like(turn)
    parts = [np.column_stack(columns) for columns in ((c, s, o), (o, c, s), (s, o, c))]
    return Outline(second=ends.points[1] + sphere.radius * np.concatenate(parts))


@_outline.register
def _blade(blade: KnifeEdge, ends: _Ends) -> Outline:
    reach = _BLADE * ends.size * ends.seen(1, np.array(blade.direction) / np.linalg.norm(blade.direction))
    return Outline(second=np.stack([ends.points[1] - reach, ends.points[1] + reach]))


def _curve(curve: Curve) -> Array:
    points = sampled(curve, "")[1]
    return np.asarray(points[np.linspace(0, len(points) - 1, POINTS + 1).astype(int)])

"""Joints by their geometry: lower pairs, universal and constant-velocity joints, screws, and their coordinates."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ..bodies import Marker
from ..kinematics import Frame
from ..taylor import Taylor, arc_tangent, product
from .locked import Locked, Places, Wrench, between

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Relative:
    """Motion of a joint's second frame as seen from its first: shift (3,), turn (3, 3); pitch: of a screw, m per turn."""

    first: Frame
    second: Frame
    shift: Taylor
    turn: Taylor
    pitch: float

    def axis(self, k: int) -> Array:
        """Axis k of the first frame, global."""
        return np.asarray(self.first.axes.value[:, k])

    def angle(self) -> Taylor:
        """The turn about the common z axis."""
        return arc_tangent(self.turn[1, 0], self.turn[0, 0])


Directions = tuple[Array, Array]


@dataclass(frozen=True)
class Lock:
    """One locked motion: its residual, and the force and torque (3,), global, at the second frame's point that hold it."""

    residual: Callable[[Relative], Taylor]
    wrench: Callable[[Relative], Directions]


NONE = np.zeros(3)


def _offset(k: int) -> Lock:
    """The second's point stays on the first's plane normal to axis k."""
    return Lock(lambda r: r.shift[k], lambda r: (r.axis(k), NONE))


def _parallel(k: int) -> Lock:
    """The second's z axis does not lean towards axis k of the first (0 or 1)."""
    return Lock(lambda r: r.turn[k, 2], lambda r: (NONE, r.axis(1 - k)))


def _untwisted(k: int) -> Lock:
    """No rotation about axis k, where nothing else turns either: the axial vector of the relative rotation."""
    i, j = (k + 1) % 3, (k + 2) % 3
    return Lock(lambda r: r.turn[j, i] - r.turn[i, j], lambda r: (NONE, r.axis(k)))


# The cross of a universal joint: x on the first, y on the second, at right angles.
_CROSS = Lock(
    lambda r: r.turn[0, 1],
    lambda r: (NONE, np.cross(r.first.axes.value[:, 0], r.second.axes.value[:, 1])),
)
# Both shafts turn alike: the relative rotation has no part about the shafts, and the joint carries a torque about the
# bisector of the two.
_HOMOKINETIC = Lock(
    lambda r: r.turn[0, 1] - r.turn[1, 0],
    lambda r: (NONE, r.first.axes.value[:, 2] + r.second.axes.value[:, 2]),
)
_HELIX = Lock(
    lambda r: r.shift[2] - r.angle() * (r.pitch / (2.0 * math.pi)),
    lambda r: (r.axis(2), -r.pitch / (2.0 * math.pi) * r.axis(2)),
)

_POINT = (_offset(0), _offset(1), _offset(2))
_ORIENTATION = (_untwisted(0), _untwisted(1), _untwisted(2))
_AXIS = (_parallel(0), _parallel(1))

LOCKS: Mapping[str, tuple[Lock, ...]] = MappingProxyType(
    {
        "revolute": (*_POINT, *_AXIS),
        "prismatic": (_offset(0), _offset(1), *_ORIENTATION),
        "cylindrical": (_offset(0), _offset(1), *_AXIS),
        "spherical": _POINT,
        "planar": (_offset(2), *_AXIS),
        "weld": (*_POINT, *_ORIENTATION),
        "universal": (*_POINT, _CROSS),
        "constant-velocity": (*_POINT, _HOMOKINETIC),
        "screw": (_offset(0), _offset(1), *_AXIS, _HELIX),
        "free": (),
    }
)

_ANGLE = Lock(lambda r: r.angle(), lambda r: (NONE, r.axis(2)))
_SLIDE = _offset(2)

COORDINATES: Mapping[str, Mapping[str, Lock]] = MappingProxyType(
    {
        "revolute": {"angle": _ANGLE},
        "prismatic": {"displacement": _SLIDE},
        "cylindrical": {"displacement": _SLIDE, "angle": _ANGLE},
        "screw": {"displacement": _SLIDE, "angle": _ANGLE},
        "planar": {"angle": _ANGLE},
    }
)
"""Coordinates that drivers, couplers and torsion springs may name; unnamed, the last: a screw's displacement follows."""


@dataclass(frozen=True, eq=False)
class JointGeometry:
    """A joint of a kind in `LOCKS` between two markers, whose axes coincide in the initial pose."""

    kind: str
    first: Marker
    second: Marker
    pitch: float = 0.0

    def relative(self, places: Places) -> Relative:
        """The second frame as seen from the first."""
        first, second = places.frame(self.first), places.frame(self.second)
        gap = second.position - first.position
        return Relative(
            first,
            second,
            product("ij,i->j", first.axes, gap),
            product("ij,ik->jk", first.axes, second.axes),
            self.pitch,
        )

    def at(self, places: Places) -> Locked:
        relative = self.relative(places)
        locks = LOCKS[self.kind]
        return Locked(
            tuple(lock.residual(relative) for lock in locks), tuple(unit_wrench(relative, lock) for lock in locks)
        )

    def coordinate(self, quantity: str | None, places: Places) -> tuple[Taylor, Wrench]:
        """A coordinate, and the unit wrench that works on it: ``angle``, ``displacement``, or the only one."""
        named = COORDINATES[self.kind]
        lock = named[quantity] if quantity is not None else list(named.values())[-1]
        relative = self.relative(places)
        return lock.residual(relative), unit_wrench(relative, lock)


def unit_wrench(relative: Relative, lock: Lock) -> Wrench:
    """What holds a locked motion, on both ends."""
    force, torque = lock.wrench(relative)
    return between(relative.first, relative.second, relative.second.position.value, force, torque)

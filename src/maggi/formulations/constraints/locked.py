"""What a liaison is to the formulations: scalar residuals that stay zero, and the unit wrenches that keep them so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..bodies import Marker
from ..kinematics import GROUND, Frame, MovingBody, marker_frame, partials
from ..taylor import Taylor

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Wrench:
    """A unit liaison force: for each frame that it acts on, force and torque (3,), global, at the frame's point."""

    parts: tuple[tuple[Frame, Array, Array], ...]

    def generalised(self, count: int) -> Array:
        """Its generalised forces on all `count` unknowns."""
        result = np.zeros(count)
        for frame, force, torque in self.parts:
            velocity, rotation = partials(frame, count)
            result += velocity @ force + rotation @ torque
        return result


@dataclass(frozen=True, eq=False)
class Locked:
    """What a liaison locks: residuals, positions (order 2) or velocities (order 1), and a unit wrench for each.

    Of either the highest derivative is at the level of accelerations: ``A v̇ + γ`` without any γ derived by hand.
    """

    residuals: tuple[Taylor, ...]
    wrenches: tuple[Wrench, ...]


@dataclass(frozen=True, eq=False)
class Places:
    """Where everything is at an instant: time t (s), and the motion of every body by name."""

    t: float
    bodies: Mapping[str, MovingBody]

    def body(self, name: str) -> MovingBody:
        """A body's motion; that of ground is none."""
        return self.bodies.get(name, GROUND)

    def frame(self, marker: Marker) -> Frame:
        """Where a marker is."""
        return marker_frame(marker, self.body(marker.body))


class Geometry(Protocol):
    """A liaison, placed on its bodies."""

    def at(self, places: Places) -> Locked:
        """What it locks at an instant."""


def between(first: Frame, second: Frame, point: Array, force: Array, torque: Array) -> Wrench:
    """Force at a global point (3,) and torque of first on second, and the reaction on first."""
    return Wrench(
        (
            (second, force, torque + np.cross(point - second.position.value, force)),
            (first, -force, -torque - np.cross(point - first.position.value, force)),
        )
    )

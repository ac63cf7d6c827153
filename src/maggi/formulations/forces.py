"""Applied forces by their descriptions: spring-dampers, torsion springs, loads. Gravity acts on the mass points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from maggi.model.forces import PointLoad

from .bodies import Marker
from .constraints.joints import JointGeometry
from .constraints.locked import Places, Wrench, between
from .programs import at_time
from .taylor import norm, unit

Array = NDArray[np.float64]
NONE = np.zeros(3)


class AppliedForce(Protocol):
    """A force that depends on positions, velocities and time."""

    def at(self, places: Places) -> Wrench:
        """The forces and torques at an instant."""


@dataclass(frozen=True, eq=False)
class SpringGeometry:
    """A linear spring-damper between two points: stiffness (N/m), damping (N s/m), free length (m)."""

    first: Marker
    second: Marker
    stiffness: float
    damping: float
    length: float

    def at(self, places: Places) -> Wrench:
        first, second = places.frame(self.first), places.frame(self.second)
        gap = second.position - first.position
        distance = norm(gap)
        tension = self.stiffness * (float(distance.value) - self.length) + self.damping * float(distance.rate)
        return between(first, second, second.position.value, -tension * unit(gap).value, NONE)


@dataclass(frozen=True, eq=False)
class TorsionGeometry:
    """A spring-damper on a joint's angle: stiffness (N m/rad), damping (N m s/rad), free angle (rad)."""

    joint: JointGeometry
    stiffness: float
    damping: float
    angle: float

    def at(self, places: Places) -> Wrench:
        angle, wrench = self.joint.coordinate("angle", places)
        torque = self.stiffness * (float(angle.value) - self.angle) + self.damping * float(angle.rate)
        return Wrench(tuple((frame, -torque * force, -torque * moment) for frame, force, moment in wrench.parts))


@dataclass(frozen=True, eq=False)
class LoadGeometry:
    """A force or torque on an attachment, its components global or in the attachment's axes."""

    on: Marker
    load: PointLoad

    def at(self, places: Places) -> Wrench:
        frame = places.frame(self.on)
        value = np.array([float(at_time(component, places.t).value) for component in self.load.value])
        if self.load.frame == "body":
            value = frame.axes.value @ value
        parts = (value, NONE) if self.load.kind == "force" else (NONE, value)
        return Wrench(((frame, *parts),))

"""Rolling and sliding without slip: discs and spheres on a plane, knife edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bodies import Marker
from ..kinematics import Frame
from ..taylor import Taylor, angular_velocity, cross, dot, scaled, unit
from .locked import Locked, Places, between

Array = NDArray[np.float64]
NONE = np.zeros(3)


def _material_velocity(frame: Frame, point: Taylor) -> Taylor:
    """Velocity (order 1) of a body's material that is at a point just now: ``ṗ + ω × (point − p)``."""
    arm = point.lower() - frame.position.lower()
    return frame.position.derivative() + cross(angular_velocity(frame.axes), arm)


def _rolling(plane: Frame, wheel: Frame, radius_to_contact: Taylor) -> Locked:
    """The contact stays in the plane (normal: its z axis), and both materials there have one velocity in it."""
    contact = wheel.position + radius_to_contact
    height = dot(contact - plane.position, plane.axis(2))
    slip = _material_velocity(wheel, contact) - _material_velocity(plane, contact)
    directions = [plane.axis(k) for k in (2, 0, 1)]
    return Locked(
        (height, *(dot(slip, direction.lower()) for direction in directions[1:])),
        tuple(between(plane, wheel, contact.value, direction.value, NONE) for direction in directions),
    )


@dataclass(frozen=True, eq=False)
class DiscGeometry:
    """A thin disc of `radius` (m) on a plane.

    plane : z axis the normal, its point in the plane; fixed in first. disc: z axis the disc's axis, its point the
    centre; fixed in second. Contact at ``c + r e``, e in the disc, straight towards the plane.
    """

    plane: Marker
    disc: Marker
    radius: float

    def at(self, places: Places) -> Locked:
        plane, disc = places.frame(self.plane), places.frame(self.disc)
        n, u = plane.axis(2), disc.axis(2)
        down = scaled(dot(n, u), u) - n
        side = np.sign(float(dot(disc.position - plane.position, n).value))
        return _rolling(plane, disc, unit(down) * (side * self.radius))


@dataclass(frozen=True, eq=False)
class SphereGeometry:
    """A sphere of `radius` (m) on a plane; markers as for `DiscGeometry`, of which the sphere needs only the centre."""

    plane: Marker
    centre: Marker
    radius: float

    def at(self, places: Places) -> Locked:
        plane, sphere = places.frame(self.plane), places.frame(self.centre)
        side = np.sign(float(dot(sphere.position - plane.position, plane.axis(2)).value))
        return _rolling(plane, sphere, plane.axis(2) * (-side * self.radius))


@dataclass(frozen=True, eq=False)
class KnifeEdgeGeometry:
    """A blade on second that does not move sideways (its marker's y axis) over the material of first below it."""

    first: Marker
    blade: Marker

    def at(self, places: Places) -> Locked:
        first, blade = places.frame(self.first), places.frame(self.blade)
        sideways = blade.axis(1)
        slip = blade.position.derivative() - _material_velocity(first, blade.position)
        wrench = between(first, blade, blade.position.value, sideways.value, NONE)
        return Locked((dot(slip, sideways.lower()),), (wrench,))

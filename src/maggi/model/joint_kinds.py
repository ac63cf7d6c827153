"""Which coordinates every kind of joint has, in the order of results: what drivers, springs and couplers refer to."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

Quantity = Literal["angle", "displacement"]

JOINT_COORDINATES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "revolute": ("angle",),
        "prismatic": ("displacement",),
        "cylindrical": ("displacement", "angle"),
        "screw": ("displacement", "angle"),
        "spherical": ("rotation", "rotation", "rotation"),
        "planar": ("displacement", "displacement", "angle"),
        "universal": ("angle", "angle"),
        "constant-velocity": (),
        "free": ("displacement", "displacement", "displacement", "rotation", "rotation", "rotation"),
        "weld": (),
    }
)
"""By kind: an ``angle`` (rad) about the axis, a ``displacement`` (m), a ``rotation`` vector's component (rad).

Second end relative to first, zero in the initial pose, angles counted over full turns.
"""


def named_coordinates(kind: str) -> tuple[Quantity, ...]:
    """Those of angle and displacement that a kind of joint has exactly once, so that the word alone names it.

    Example: a planar joint has an ``angle``, but two displacements, of which neither can be named.
    """
    has = JOINT_COORDINATES.get(kind, ())
    quantities: tuple[Quantity, ...] = ("angle", "displacement")
    return tuple(quantity for quantity in quantities if has.count(quantity) == 1)

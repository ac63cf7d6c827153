"""Descriptions of joints and drivers."""

from __future__ import annotations

from dataclasses import dataclass

from .functions import TimeFunction
from .geometry import Vector

GROUND = "ground"


@dataclass(frozen=True)
class End:
    """One end of a joint or a spring: a body, one of its attachments, or a fixed point of ground (global, m)."""

    body: str
    attachment: str | None = None
    point: Vector | None = None

    def __str__(self) -> str:
        if self.point is not None:
            return str(list(self.point))
        return self.body if self.attachment is None else f"{self.body}.{self.attachment}"


@dataclass(frozen=True)
class Joint:
    """A joint of a registered `kind` between two ends.

    at, axis : global, in the initial pose; fixed in both bodies from then on. `axes` is the universal
    joint's pair (on first, on second).
    """

    kind: str
    first: End
    second: End
    at: Vector | None = None
    axis: Vector | None = None
    axes: tuple[Vector, Vector] | None = None


@dataclass(frozen=True)
class Driver:
    """Prescribes one coordinate of a joint: `quantity` is ``angle``, ``displacement`` or ``speed``."""

    joint: str
    quantity: str
    function: TimeFunction


Liaison = Joint | Driver

"""Descriptions of forces other than gravity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .functions import TimeFunction
from .joints import End

Components = tuple[TimeFunction, TimeFunction, TimeFunction]


@dataclass(frozen=True)
class PointLoad:
    """A force (N) or a torque (N m) on an attachment; `frame` body: the components turn with it (following)."""

    on: End
    kind: Literal["force", "torque"]
    value: Components
    frame: Literal["global", "body"] = "global"


@dataclass(frozen=True)
class SpringDamper:
    """A linear spring-damper between two points: stiffness (N/m), damping (N s/m), free length (m; None: initial)."""

    first: End
    second: End
    stiffness: float = 0.0
    damping: float = 0.0
    length: float | None = None


@dataclass(frozen=True)
class TorsionSpring:
    """A spring-damper on a joint's rotation: stiffness (N m/rad), damping (N m s/rad), free angle (rad; None: initial)."""

    joint: str
    stiffness: float = 0.0
    damping: float = 0.0
    angle: float | None = None


Force = PointLoad | SpringDamper | TorsionSpring

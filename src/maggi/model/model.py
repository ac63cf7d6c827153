"""A whole mechanism as a frozen description."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .bodies import Body
from .forces import Force
from .geometry import Vector
from .joints import Liaison
from .simulation import Outputs, Simulation


@dataclass(frozen=True, eq=False)
class Model:
    """Bodies, joints and drivers, forces, and what to compute; SI units, radians.

    text : the model file's text where it came from one (kept in the result file).
    folder : where relative mesh paths start.
    """

    bodies: Mapping[str, Body]
    joints: Mapping[str, Liaison] = field(default_factory=dict)
    forces: Mapping[str, Force] = field(default_factory=dict)
    gravity: Vector = (0.0, 0.0, 0.0)
    simulation: Simulation | None = None
    outputs: Outputs = field(default_factory=Outputs)
    title: str = ""
    text: str = ""
    folder: str = "."

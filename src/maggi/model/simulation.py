"""What to compute and what to keep."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

QUANTITIES = ("bodies", "attachments", "displacement", "joints", "energy", "residuals")


@dataclass(frozen=True)
class Outputs:
    """Rows at every `every`-th step and the `quantities` kept in them (groups of the result file)."""

    every: int = 1
    quantities: tuple[str, ...] = field(default=QUANTITIES)


@dataclass(frozen=True)
class Simulation:
    """A transient run: duration and step (s), generalised-α with spectral radius `rho_inf` at infinity.

    tolerance: relative error allowed per step by the iteration. start: elastic bodies in balance with the
    inertia of the rigid motion (``quasi-static``) or free of strain (``undeformed``). assemble: joints that do not meet in
    the given poses are closed from there instead of being refused.
    """

    duration: float
    step: float
    rho_inf: float = 0.9
    tolerance: float = 1e-8
    start: Literal["quasi-static", "undeformed"] = "quasi-static"
    method: Literal["generalized-alpha"] = "generalized-alpha"
    assemble: bool = False

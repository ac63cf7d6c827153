"""What to compute and what to keep."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

Method = Literal["generalized-alpha", "dop853", "radau"]
QUANTITIES = ("bodies", "attachments", "displacement", "joints", "energy", "residuals")


@dataclass(frozen=True)
class Outputs:
    """Rows at every `every`-th step and the `quantities` kept in them (groups of the result file)."""

    every: int = 1
    quantities: tuple[str, ...] = field(default=QUANTITIES)


@dataclass(frozen=True)
class Simulation:
    """A transient run: duration and step (s).

    accuracy: None for steps of that size; otherwise the local error that a step may make in any position, relative to the
    mechanism's size (angles: rad), and steps are `step` over powers of two, as long as that allows.
    method: ``generalized-alpha``, with spectral radius `rho_inf` at infinity and `tolerance` the relative
    error left by a step's iteration; or an adaptive integrator of the equations in the true freedoms, ``dop853`` (explicit,
    order 8) or ``radau`` (implicit, order 5), with `tolerance` the relative error of one of its own steps and `step` the
    grid of instants that rows are written at. start: elastic bodies in balance with the
    inertia of the rigid motion (``quasi-static``) or free of strain (``undeformed``). assemble: joints that do not meet in
    the given poses are closed from there instead of being refused.
    """

    duration: float
    step: float
    rho_inf: float = 0.9
    tolerance: float = 1e-8
    start: Literal["quasi-static", "undeformed"] = "quasi-static"
    method: Method = "generalized-alpha"
    assemble: bool = False
    accuracy: float | None = None

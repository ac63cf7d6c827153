"""Stands in for the numerical core where only the commands around it are tested."""

from __future__ import annotations

import sys
import time
import types
from dataclasses import dataclass, field

import fake_runs

from maggi.model.errors import ModelError, SimulationError

MODEL = """\
maggi: 1
title: Fake slider-crank
bodies:
  crank: {kind: rigid, mass: 0.4, inertia: [1e-4, 4e-4, 4e-4]}
joints:
  bearing: {type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 1, 0]}
simulation: {duration: 0.1, step: 1e-3}
"""
ROWS = 41


@dataclass(frozen=True)
class RunSummary:
    """As `maggi.analyses.transient.RunSummary`."""

    steps: int = 40
    iterations: int = 44
    back_substitutions: int = 44
    residuals: tuple[float, float, float] = (3e-16, 6e-13, 6e-9)
    factorisations: int = 1
    restarts: int = 2
    energy_balance: float = 2e-9
    numerical_loss: float = 3e-7
    warnings: tuple[str, ...] = ("the initial velocities were projected",)
    seconds: float = 1.25
    timings: dict[str, float] = field(default_factory=lambda: {"factorising": 0.5})


class Audit:
    """As `maggi.analyses.audit.Audit`."""

    problems = ()

    def text(self) -> str:
        return "1 freedom"

    def data(self) -> dict[str, int]:
        return {"freedoms": 1}


def run(model, recorder, progress, *, stop=None):
    """Ends as the title of the model says."""
    progress.stage("compiling kernels (once per installation)")
    if "over-driven" in model.title:
        raise ModelError("over-driven joint", path="joints.bearing", remedy="leave one driver out")
    recorder.begin(fake_runs.layout(ROWS))
    status = "complete"
    for step, row in enumerate(fake_runs.rows(ROWS)):
        if step == 3 and "bug" in model.title:
            raise ZeroDivisionError("division by zero")
        if step == 20 and "diverges" in model.title:
            recorder.end("failed: no convergence")
            raise SimulationError("no convergence at t = 0.03 s in rod")
        if step == 20 and "stopped" in model.title:
            recorder.end("interrupted")
            raise KeyboardInterrupt
        if "slow" in model.title:
            try:
                time.sleep(0.05 if step < 10 else 5.0)  # whoever interrupts it may be kept waiting himself
            except KeyboardInterrupt:
                recorder.end("interrupted")
                raise
        recorder.write(row.rows())
        progress.advance(step, ROWS - 1, row.time, "1 iteration")
    recorder.end(status)
    return RunSummary()


def install(setitem=sys.modules.__setitem__) -> None:
    """Put the stand-ins where the commands look for the core."""
    transient, audit = types.ModuleType("maggi.analyses.transient"), types.ModuleType("maggi.analyses.audit")
    transient.run, transient.RunSummary = run, RunSummary
    audit.audit = lambda model: Audit()
    setitem("maggi.analyses.transient", transient)
    setitem("maggi.analyses.audit", audit)

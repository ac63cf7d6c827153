"""A transient run by generalised-α steps, of one size or as long as an error allows."""

from __future__ import annotations

import time

from maggi.model.simulation import Simulation
from maggi.stepping.stepper import Stepper

from .adaptive import AdaptiveSteps
from .fixed_steps import FixedSteps
from .snapshot import next_row

CHUNK_SECONDS = 0.1  # of compiled steps between two looks at progress and interrupts


class AlphaRun:
    """A `transient.March` in chunks that grow until a call's own cost vanishes."""

    def __init__(self, stepper: Stepper, simulation: Simulation, every: int) -> None:
        self.system, self.state, self.meshes = stepper.system, stepper.state, stepper.meshes
        self.counts, self.record = stepper.counts, stepper.record
        self._stepper = stepper
        self._steps, self._every = round(simulation.duration / simulation.step), every
        self._adaptive = simulation.accuracy is not None
        self._through_rows = not (self._adaptive or self.meshes)  # as many as there is room for
        self._advance = (
            FixedSteps(stepper, simulation, every if self._through_rows else 0)
            if simulation.accuracy is None
            else AdaptiveSteps(stepper, simulation.step, simulation.accuracy)
        )
        self._chunk = 1

    @property
    def last_iterations(self) -> int:
        """Back-substitutions or corrections of the last step."""
        return self._stepper.last_iterations

    def dissipated(self) -> float:
        """See `Stepper.dissipated`."""
        return self._stepper.dissipated()

    def advance(self, done: int) -> int:
        """See `March.advance`."""
        until = next_row(done, self._steps, self._every)
        if self._through_rows:
            until = min(self._steps, until + (self.record.room - 1) * self._every)
        count = min(self._chunk, until - done)
        began = time.perf_counter()
        self._advance.steps(done, count)
        if count == self._chunk:
            took = max(time.perf_counter() - began, 1e-6)
            self._chunk = max(1, min(2 * self._chunk, int(self._chunk * CHUNK_SECONDS / took)))
        return count

    def note(self) -> str:
        """See `March.note`."""
        per_step = self.counts.back_substitutions / max(1, self.counts.steps)
        parts = [f"{per_step:.2f} solves a step"] if self.meshes else []
        if self._adaptive:
            parts.append(f"steps of {self._stepper.coefficients.h:.2g} s")
        return ", ".join(parts)

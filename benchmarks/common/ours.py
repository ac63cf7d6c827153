"""Runs of a model by this program, step by step and timed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from maggi.analyses.prepare import prepare
from maggi.linalg.threads import one_blas_thread
from maggi.model.model import Model

from .timing import cpu_seconds

Array = NDArray[np.float64]


class Ours:
    """A model in steps of h (s). `clock` times it: processor time, or wall time where threads work.

    exact : iterate every step to round-off.
    """

    def __init__(
        self,
        model: Model,
        h: float,
        clock: Callable[[Callable[[], object]], float] = cpu_seconds,
        *,
        exact: bool = False,
    ) -> None:
        assert model.simulation is not None
        self.model = replace(model, simulation=replace(model.simulation, step=h))
        self.h = h
        self.iterations = 0.0  # corrections of the small system in a step of the last `advance`
        self._clock, self._exact = clock, exact
        self.restart()

    def restart(self) -> None:
        """Back to t = 0, ready to step."""
        with one_blas_thread():
            self.stepper, _, _, _ = prepare(self.model, exact=self._exact)
        self.stepper.set_step(self.h)
        self._done = 0

    def advance(self, steps: int) -> float:
        """Seconds of one of the next `steps` steps."""
        before, done = self.stepper.counts.corrections, 0

        def action() -> None:
            nonlocal done
            done = self.stepper.advance(self._done * self.h, steps)

        with one_blas_thread():  # as a run has it
            seconds = self._clock(action)
        self._done += done
        if done < steps:
            raise self.stepper.failure(self._done * self.h)
        self.iterations = (self.stepper.counts.corrections - before) / steps
        return seconds / steps

    def run(self, steps: int, repeats: int = 1) -> float:
        """Seconds of a step of the run from t = 0, the median of some repeats; building and starting do not count."""
        taken = []
        for _ in range(repeats):
            self.restart()
            taken.append(self.advance(steps))
        return float(np.median(taken))

    def position(self, body: str, attachment: str) -> Array:
        """Where an attachment is now (3,), global (m)."""
        entries = self.stepper.system.attachment_entries
        index = next(entry.index for entry in entries if (entry.body, entry.name) == (body, attachment))
        return self.stepper.state.attachments.position[index].copy()

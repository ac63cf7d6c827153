"""Steps as long as an error allows: nominal steps over powers of two, so that changing back finds what was prepared."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from maggi.stepping import iteration
from maggi.stepping.stepper import Stepper

from .time_functions import SAMPLES, Watch

BUSY = SAMPLES.bit_length() - 1  # halvings after which steps are as close as the samples
DEEPEST = 20  # halvings of a nominal step at most
ORDER = 3  # of the local error: a step half as long makes an eighth of it


class AdaptiveSteps:
    """Advances a stepper from nominal step to nominal step by parts of them whose local error stays below `accuracy`.

    A part begins at a multiple of its own length. Parts become shorter where one makes too large an error, by as many
    halvings as that error asks for, and twice as long after some whose error leaves room for it. Nominal steps in which
    loads or drivers do what their ends do not show are taken in parts at least as short as the samples that saw it.
    """

    def __init__(self, stepper: Stepper, step: float, accuracy: float) -> None:
        self._stepper = stepper
        self._step = step
        self._accuracy = accuracy
        self._halvings = 0
        self._longer = False  # steps become longer as soon as the place allows it
        self._watch = Watch(stepper.system.model, step)
        stepper.set_step(step)
        stepper.bound(accuracy)

    def steps(self, first: int, count: int) -> None:
        """Nominal steps first … first + count − 1; raises SimulationError where the shortest part fails."""
        busy = self._watch.busy(first, count)
        edges = [0, *(np.flatnonzero(np.diff(busy)) + 1).tolist(), count]
        for start, end in pairwise(edges):
            self._go(first + start, first + end, BUSY if busy[start] else 0)

    def _go(self, first: int, last: int, least: int) -> None:
        """From nominal step `first` to `last` with at least so many halvings."""
        stepper, whole = self._stepper, 2**DEEPEST
        if self._halvings < least:
            self._change(least - self._halvings)
        place, end = first * whole, last * whole
        while place < end:
            part = 2 ** (DEEPEST - self._halvings)
            if self._longer and self._halvings > least and place % (2 * part) == 0:
                self._change(-1)
                continue
            parts = 1 if self._longer else (end - place) // part
            done = stepper.advance(self._step * (place / whole), parts)
            place += done * part
            if stepper.reason == iteration.COULD_BE_LONGER:
                stepper.bound(self._accuracy)
                self._longer = self._halvings > least
            elif stepper.reason == iteration.TOO_LARGE:
                stepper.counts.rejected += 1
                excess = stepper.error / self._accuracy
                self._shorten(place, max(1, math.ceil(math.log2(excess) / ORDER)) if math.isfinite(excess) else 1)
            elif stepper.reason != iteration.CONVERGED:
                stepper.counts.restarts += 1
                self._shorten(place, 1)

    def _shorten(self, place: int, halvings: int) -> None:
        if self._halvings == DEEPEST:
            part = self._step / 2**DEEPEST
            raise self._stepper.failure(self._step * (place / 2**DEEPEST) + part)
        self._change(min(halvings, DEEPEST - self._halvings))

    def _change(self, halvings: int) -> None:
        self._halvings += halvings
        self._longer = False
        self._stepper.set_step(self._step / 2**self._halvings)
        self._stepper.bound(self._accuracy)

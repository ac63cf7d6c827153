"""Steps of the nominal size; smaller ones where the iteration fails, a message where it cannot."""

from __future__ import annotations

from maggi.model.simulation import Simulation
from maggi.stepping.stepper import Stepper
from maggi.stepping.tables import ITERATIONS

from .snapshot import next_row

HALVINGS = 6  # a step that fails is tried in up to 2⁶ parts


class FixedSteps:
    """Nominal steps, halved where the iteration fails.

    every : keep an instant for a row after every so many steps, 0 for none. See `Stepper.keep`.
    """

    def __init__(self, stepper: Stepper, simulation: Simulation, every: int = 0) -> None:
        self._stepper = stepper
        self._h = simulation.step
        self._every, self._last = every, round(simulation.duration / simulation.step)
        self._stepper.set_step(self._h)

    def steps(self, first: int, count: int) -> None:
        """Steps first … first + count − 1; raises SimulationError where even 2⁶ parts of one fail."""
        stepper, every, last, done = self._stepper, self._every, self._last, 0
        while done < count:
            stepper.keep(first + done, every, last)
            done += stepper.advance((first + done) * self._h, count - done)
            if done < count:
                stepper.keep(0, 0, 0)
                self._in_parts(first + done)
                done += 1
                if every and first + done == next_row(first + done - 1, last, every):
                    stepper.state.counts[ITERATIONS] = stepper.last_iterations
                    stepper.record.keep(stepper.state, first + done)

    def _in_parts(self, k: int) -> None:
        stepper = self._stepper
        whole = 2**HALVINGS
        part, position = whole, 0
        while position < whole:
            if part == 1 and stepper.coefficients.h <= self._h / whole:
                raise stepper.failure(self._h * (k + (position + 1) / whole))
            part //= 2
            stepper.counts.restarts += 1
            stepper.set_step(self._h * part / whole)
            count = (whole - position) // part
            position += part * stepper.advance(self._h * (k + position / whole), count)
        stepper.set_step(self._h)

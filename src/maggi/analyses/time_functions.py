"""Functions of time in a model, looked at between steps: what is over before a step ends leaves no trace in it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.model.expression import value_at
from maggi.model.forces import PointLoad
from maggi.model.functions import TimeFunction
from maggi.model.joints import Driver
from maggi.model.model import Model
from maggi.model.operations import Operation

Array = NDArray[np.float64]

SAMPLES = 16  # of a nominal step
NOTICED = 0.1  # how far a function may be from a straight line over a step, of the largest value that it has had


def time_functions(model: Model) -> list[TimeFunction]:
    """The loads and drivers of a model that vary in time."""
    found = [c for force in model.forces.values() if isinstance(force, PointLoad) for c in force.value]
    found += [joint.function for joint in model.joints.values() if isinstance(joint, Driver)]
    return [function for function in found if int(Operation.VARIABLE) in function.codes]


class Watch:
    """Tells the nominal steps in which a function of time does something that their ends do not show."""

    def __init__(self, model: Model, step: float) -> None:
        self._functions = time_functions(model)
        self._step = step
        # what values count as large, to begin with from a look at the whole run
        duration = step if model.simulation is None else model.simulation.duration
        times = np.linspace(0.0, duration, 16 * SAMPLES + 1).tolist()
        seen = [np.abs(np.nan_to_num(value_at(function, times))) for function in self._functions]
        self._largest = np.array([float(values.max()) for values in seen])

    def busy(self, first: int, count: int) -> NDArray[np.bool_]:
        """Which of the nominal steps first … first + count − 1 are such (count,)."""
        found = np.zeros(count, dtype=np.bool_)
        times = self._step * (first + np.arange(count * SAMPLES + 1) / SAMPLES)
        share = np.arange(SAMPLES) / SAMPLES
        for k, function in enumerate(self._functions):
            values = np.array(value_at(function, times.tolist()))
            if not np.isfinite(values).all():
                continue  # the step that meets it says so
            self._largest[k] = max(self._largest[k], float(np.abs(values).max()))
            ends = values[::SAMPLES]
            chord = ends[:-1, None] + share * np.diff(ends)[:, None]
            off = np.abs(values[:-1].reshape(count, SAMPLES) - chord).max(axis=1)
            found |= off > NOTICED * self._largest[k]
        return found

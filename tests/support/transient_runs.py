"""Runs of whole models kept in memory, and what convergence studies need."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from maggi.analyses.transient import RunSummary, run
from maggi.model import End, Joint, Model, Outputs, Simulation
from maggi.results.memory import MemoryRecorder
from maggi.results.results import Results

Array = NDArray[np.float64]


def simulate(
    model: Model, duration: float, step: float, *, rho_inf: float = 1.0, tolerance: float = 1e-12, rows: int = 1
) -> tuple[Results, RunSummary]:
    """Run a model and keep `rows` equidistant rows after t = 0 (a divisor of the number of steps)."""
    steps = round(duration / step)
    assert steps % rows == 0
    recorder = MemoryRecorder()
    timed = replace(
        model, simulation=Simulation(duration, step, rho_inf, tolerance), outputs=Outputs(every=steps // rows)
    )
    summary = run(timed, recorder)
    return recorder.results(), summary


def joint(kind: str, first: str, second: str, **place: object) -> Joint:
    """A joint between two ends written as in model files, ``body`` or ``body.attachment``."""
    return Joint(kind, end(first), end(second), **place)  # type: ignore[arg-type]


def end(text: str) -> End:
    """``body`` or ``body.attachment``."""
    body, _, attachment = text.partition(".")
    return End(body, attachment or None)


def orders(error: Callable[[float], float], steps: list[float]) -> tuple[Array, Array]:
    """Errors at the given step sizes and the order between neighbours, log(e_i / e_i+1) / log(h_i / h_i+1)."""
    errors = np.array([error(h) for h in steps])
    return errors, np.diff(np.log(errors)) / np.diff(np.log(steps))


def extrapolated(values: list[Array], counts: list[int]) -> Array:
    """Richardson's extrapolation to zero step of results with counts[i] steps each (Neville's scheme in h²)."""
    table, squares = list(values), [float(count) ** 2 for count in counts]
    for k in range(1, len(values)):
        table = [
            (squares[i + k] * table[i + 1] - squares[i] * table[i]) / (squares[i + k] - squares[i])
            for i in range(len(values) - k)
        ]
    return table[0]

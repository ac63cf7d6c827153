"""`step: auto` against fixed steps on a run with an impact: how many steps either needs for the same error.

The rod of impact.yml rests, is hit for a millisecond and then turns and rings down. Errors: the largest distance of the
tip from that of a run with far smaller steps, over how far the tip moves.
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

import maggi
from common.tables import Table, error, figure, times
from common.targets import Target
from maggi.analyses.transient import run
from maggi.model.model import Model
from maggi.results.memory import MemoryRecorder

Array = NDArray[np.float64]
FILE = Path(__file__).with_name("impact.yml")
FIXED = (2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5, 3.125e-5)  # s
REFERENCE = 7.8125e-6  # s
ACCURACIES = (1e-5, 1e-6, 1e-7)
TARGET = Target(3.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="a reference of steps half as large")
    given = parser.parse_args()
    model = maggi.load(FILE)
    truth = path_of(fixed(model, REFERENCE / (2 if given.long else 1)))[:2]
    table = Table(
        "A rod that is hit, 1 s", "steps", "number", "error", "fixed steps for that error", "ratio", "target", "reached"
    )
    errors, numbers = [], []
    for h in FIXED:
        time, tip, steps = path_of(fixed(model, h))
        errors.append(apart(time, tip, truth))
        numbers.append(steps)
        table.row(f"fixed, {1e3 * h:g} ms", steps, error(errors[-1]), "-", "-", "-", "-")
    for accuracy in ACCURACIES:
        time, tip, steps = path_of(with_auto(accuracy))
        wrong = apart(time, tip, truth)
        # on lines through the logarithms of the fixed runs, of which a coarser one may be right by chance
        least = np.minimum.accumulate(errors)
        needed = float(np.exp(np.interp(np.log(wrong), np.log(least)[::-1], np.log(numbers)[::-1])))
        quotient = needed / steps
        cells = TARGET.cells(f"fixed over automatic steps, accuracy {accuracy:g}", quotient)
        table.row(f"auto, {accuracy:g}", steps, error(wrong), figure(needed), times(quotient), *cells)
    table.show()


def fixed(model: Model, h: float) -> Model:
    """With steps of h (s)."""
    assert model.simulation is not None
    return replace(model, simulation=replace(model.simulation, step=h))


def with_auto(accuracy: float) -> Model:
    """With steps that the program chooses."""
    text = FILE.read_text().replace("step: 1e-3", f"step: auto, accuracy: {accuracy:g}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / FILE.name
        path.write_text(text)
        return maggi.load(path)


def path_of(model: Model) -> tuple[Array, Array, int]:
    """Times (n,), the tip's positions (n, 3), and the number of steps taken."""
    recorder = MemoryRecorder()
    summary = run(model, recorder)
    results = recorder.results()
    return results.time, results.body("rod").attachment("tip").position, summary.steps


def apart(time: Array, tip: Array, truth: tuple[Array, Array]) -> float:
    """The largest distance from the true path at these times, over the path's extent."""
    exact = CubicSpline(*truth)(time)
    extent = float(np.linalg.norm(np.ptp(truth[1], axis=0)))
    return float(np.linalg.norm(tip - exact, axis=1).max()) / extent


if __name__ == "__main__":
    main()

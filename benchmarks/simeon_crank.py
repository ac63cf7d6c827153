"""Simeon's crank with the program's own integrals of the shape functions, to t = 0.1 s: six digits of every coordinate.

The rod's longitudinal modes, at up to 9e4 rad/s and undamped, pass 1400 periods, so that a second-order step must be
small; three step sizes are extrapolated to zero (Richardson). The reference was found by two independent integrators,
and tests/verification/test_simeon_crank.py finds it again by DOP853 on the equations of the case.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from maggi.analyses.transient import run
from maggi.model.model import Model
from maggi.model.simulation import Outputs, Simulation
from maggi.modelfile import read
from maggi.results.memory import MemoryRecorder

DURATION = 0.1
COUNTS = (300_000, 400_000, 500_000)
NAMES = ("phi2", "x3", "q1", "q2", "q3", "q4")
REFERENCE = np.array([-0.33117343033, 0.16973739583, 1.8930813742e-4, 2.376201180e-5, -5.28102478e-6, -8.30355447e-6])


def final(model: Model, count: int) -> np.ndarray:
    """φ₂, x₃, q₁ … q₄ at the end of a run of `count` steps."""
    recorder = MemoryRecorder()
    simulation = Simulation(DURATION, DURATION / count, rho_inf=1.0, tolerance=1e-9)
    run(replace(model, simulation=simulation, outputs=Outputs(every=count)), recorder)
    results = recorder.results()
    R = results.body("rod").rotation[-1]
    return np.array([np.arctan2(R[1, 0], R[0, 0]), results.body("block").origin[-1, 0], *results.body("rod").modal[-1]])


def main() -> None:
    """Print every run's errors, and what extrapolation leaves."""
    model, _ = read(Path(__file__).with_suffix(".yml"))
    print("relative errors at 0.1 s".ljust(26) + "".join(name.rjust(10) for name in NAMES))
    rows = []
    for count in COUNTS:
        began = time.perf_counter()
        rows.append(final(model, count))
        took = (time.perf_counter() - began) / count
        print(f"{count:8d} steps, {1e6 * took:4.0f} µs each" + _errors(rows[-1]))
    squares = [float(count) ** 2 for count in COUNTS]
    while len(rows) > 1:
        k = len(COUNTS) - len(rows) + 1
        rows = [
            (squares[i + k] * rows[i + 1] - squares[i] * rows[i]) / (squares[i + k] - squares[i])
            for i in range(len(rows) - 1)
        ]
    print("extrapolated".ljust(26) + _errors(rows[0]))


def _errors(values: np.ndarray) -> str:
    return "".join(f"{error:10.1e}" for error in values / REFERENCE - 1.0)


if __name__ == "__main__":
    main()

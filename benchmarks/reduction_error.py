"""Reduced against full: the slider-crank's rod by more and more Craig–Bampton modes, against its whole mesh.

The deflection of the middle of the rod and the force in the wrist pin over a turn and a half at 3000 rpm, with the same
integrator and step, so that what is left is the reduction.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import maggi
from common.bars import CRANK_STEP, cells_for, slider_crank
from common.tables import MISSING, Table, error, micro
from maggi.model.bodies import CraigBampton
from maggi.model.simulation import Outputs, Simulation
from maggi.results.results import Results

Array = NDArray[np.float64]
MODES = (0, 1, 2, 4, 8, 16, 32)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--long", action="store_true", help="30,000 freedoms, a turn and a half; else 5,000, half a turn"
    )
    given = parser.parse_args()
    cells = cells_for(30_000 if given.long else 5_000, "hex20")
    steps = 750 if given.long else 250
    whole = simulate(cells, None, steps)
    bent, pull = deflection(whole), whole.joint("wristpin").force
    table = Table(
        f"Slider-crank, {3 * len(whole.body('rod').nodes):,} nodal freedoms (hex20), {steps} steps of {CRANK_STEP:g} s",
        *("modes", "coordinates", "deflection, largest (µm)", "its error", "force, largest (N)", "its error"),
    )
    for modes in MODES:
        run = simulate(cells, modes, steps)
        found, force = deflection(run), run.joint("wristpin").force
        table.row(
            modes,
            run.body("rod").modal.shape[1],
            micro(largest(found)),
            error(largest(found - bent) / largest(bent)),
            f"{largest(force):.1f}",
            error(largest(force - pull) / largest(pull)),
        )
    table.row(
        "full mesh",
        f"{3 * len(whole.body('rod').nodes):,}",
        micro(largest(bent)),
        MISSING,
        f"{largest(pull):.1f}",
        MISSING,
    )
    table.note(
        "Errors: the largest difference from the full mesh over the run, over the largest value there. Besides the"
    )
    table.note("modes there are six static shapes of the two ends' relative motions.")
    table.show()


def simulate(cells: tuple[int, int, int], modes: int | None, steps: int) -> Results:
    """A run in memory, every second step kept."""
    model = slider_crank(cells, "hex20", None if modes is None else CraigBampton(modes))
    simulation = Simulation(steps * CRANK_STEP, CRANK_STEP)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # joints repeat each other in a plane mechanism of 3-D joints
        return maggi.run(replace(model, simulation=simulation, outputs=Outputs(every=2)))


def deflection(results: Results) -> Array:
    """How far the node in the rod's middle is from the line between the ends' nearest nodes (n, 3), body axes (m)."""
    rod = results.body("rod")
    nodes = rod.nodes
    center = nodes.mean(axis=0)
    ends = [[x, center[1], center[2]] for x in (nodes[:, 0].min(), nodes[:, 0].max())]
    first, middle, last = (int(np.argmin(np.linalg.norm(nodes - p, axis=1))) for p in (ends[0], center, ends[1]))
    part = (nodes[middle, 0] - nodes[first, 0]) / (nodes[last, 0] - nodes[first, 0])
    u = np.array([frame[[first, middle, last]] for frame in rod.displacement])
    return np.asarray(u[:, 1] - (1.0 - part) * u[:, 0] - part * u[:, 2])


def largest(vectors: Array) -> float:
    """The largest length of vectors (n, 3)."""
    return float(np.linalg.norm(vectors, axis=1).max())


if __name__ == "__main__":
    main()

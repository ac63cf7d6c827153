"""What a row of results costs beside a step: whole runs into a file, a row for every step."""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from chains import chain
from common.bars import CRANK_STEP, cells_for, slider_crank
from common.rod import rod
from common.tables import Table, micro, times
from common.timing import in_turn, median, ratio
from four_bars import mechanism
from maggi.analyses.transient import run
from maggi.model.bodies import CraigBampton
from maggi.model.model import Model
from maggi.results.store import FileRecorder


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="ten times as many steps, nine rounds")
    given = parser.parse_args()
    more, rounds = (10, 9) if given.long else (1, 3)
    cells = cells_for(10_000, "tet10")
    cases = {
        "four-bar": (mechanism(1), 1e-3, 1_000),
        "chain of 50 links": (chain(50), 1e-3, 500),
        "rod with 20 modes": (rod((40, 2, 2), "hex20", 1e-4, CraigBampton(20)), 1e-4, 500),
        "slider-crank, 10,000 freedoms": (slider_crank(cells, "tet10"), CRANK_STEP, 100),
    }
    table = Table("Results: µs a step and a row of them", "run", "rows", "a step", "a row", "a row over a step")
    for name, (model, step, steps) in cases.items():
        measure(table, name, model, step, more * steps, rounds)
    table.note("Runs into a file, a row for every step; preparing them does not count. A row of the last holds the")
    table.note("displacements of all nodes.")
    table.show()


def measure(table: Table, name: str, model: Model, step: float, steps: int, rounds: int) -> None:
    """One line of the table."""
    assert model.simulation is not None
    model = replace(
        model,
        simulation=replace(model.simulation, duration=steps * step, step=step),
        outputs=replace(model.outputs, every=1),
    )
    rows = []

    def once() -> float:
        with tempfile.TemporaryDirectory() as folder:
            timings = run(model, FileRecorder(str(Path(folder) / "run.h5"))).timings
        rows.append(timings["rows"] / steps)
        return timings["steps"] / steps

    taken = in_turn({"step": once}, rounds)["step"]
    of_rows = np.array(rows[1:])  # without the round that is thrown away
    table.row(name, f"{steps:,}", micro(median(taken)), micro(median(of_rows)), times(ratio(of_rows, taken)))


if __name__ == "__main__":
    main()

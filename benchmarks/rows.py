"""What a step costs with a row of results after each: whole runs into a file, with a row for every step and with the last row only.

Beside it for the four-bar: Exudyn's step with what it offers for the same, that is its solution file, which has the coordinates
with their rates, and sensors for the motion of bodies and attachments and for the joints' forces and torques.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from chains import chain
from common.bars import CRANK_STEP, cells_for, slider_crank
from common.rod import rod
from common.tables import MISSING, Table, micro, times
from common.timing import in_turn, median, ratio
from four_bars import mechanism
from maggi.analyses.transient import run
from maggi.model.bodies import CraigBampton
from maggi.model.model import Model
from maggi.results.store import FileRecorder
from peers import exudyn_runs
from peers.exudyn_four_bars import four_bars

BARE, SENSORS, FILE = "peer: a step", "peer: with sensors", "peer: with sensors and its file"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="ten times as many steps, nine rounds")
    given = parser.parse_args()
    more, rounds = (10, 9) if given.long else (1, 3)
    cells = cells_for(10_000, "tet10")
    cases = {
        "four-bar": (mechanism(1), 1e-3, 5_000),
        "40 four-bars": (mechanism(40), 1e-3, 200),
        "chain of 50 links": (chain(50), 1e-3, 2_000),
        "rod with 20 modes": (rod((40, 2, 2), "hex20", 1e-4, CraigBampton(20)), 1e-4, 1_000),
        "slider-crank, 10,000 freedoms": (slider_crank(cells, "tet10"), CRANK_STEP, 100),
    }
    table = Table(
        "Results: µs a step, without and with a row of results for each",
        *("run", "rows", "a step", "with its row", "more by", BARE, SENSORS, FILE, "ratio"),
    )
    for name, (model, step, steps) in cases.items():
        runs = {
            "step": of_run(model, step, more * steps, every=more * steps),
            "row": of_run(model, step, more * steps, every=1),
        }
        if name == "four-bar" and exudyn_runs.load():
            runs |= of_peer(step, more * steps)
        measure(table, name, runs, more * steps, rounds)
    table.note(
        "Runs into a file; preparing them does not count. A row of the last one holds the displacements of all nodes."
    )
    table.note("Ratio: the peer with sensors and its file over ours with rows.")
    table.show()


def of_run(model: Model, step: float, steps: int, every: int) -> Callable[[], float]:
    """A run whose seconds a step are returned."""
    assert model.simulation is not None
    model = replace(
        model,
        simulation=replace(model.simulation, duration=steps * step, step=step),
        outputs=replace(model.outputs, every=every),
    )

    def once() -> float:
        with tempfile.TemporaryDirectory() as folder:
            timings = run(model, FileRecorder(str(Path(folder) / "run.h5"))).timings
        return (timings["steps"] + timings["rows"]) / steps

    return once


def of_peer(step: float, steps: int) -> dict[str, Callable[[], float]]:
    """The same for Exudyn's quickest four-bar, with and without its outputs."""
    tuned = [bars.peer.tuned(exudyn_runs.IMPLICIT, step, 500) for bars in four_bars(1, full=False)]
    quickest = min(tuned, key=lambda peer: peer.run(step, 2_000))
    watched = next(bars for bars in four_bars(1, full=False) if bars.peer.name == quickest.name)
    watched.watch()
    peer = replace(watched.peer, settings=quickest.settings)

    def with_file() -> float:
        with tempfile.TemporaryDirectory() as folder:
            return peer.run(step, steps, every=1, file=str(Path(folder) / "solution.txt"))

    return {BARE: lambda: quickest.run(step, steps), SENSORS: lambda: peer.run(step, steps, every=1), FILE: with_file}


def measure(table: Table, name: str, runs: dict[str, Callable[[], float]], steps: int, rounds: int) -> None:
    """One line of the table."""
    taken = in_turn(runs, rounds)
    peers = [micro(median(taken[way])) if way in taken else MISSING for way in (BARE, SENSORS, FILE)]
    quotient = ratio(taken[FILE], taken["row"]) if FILE in taken else None
    table.row(
        name,
        f"{steps:,}",
        micro(median(taken["step"])),
        micro(median(taken["row"])),
        micro(median(taken["row"] - taken["step"])),
        *peers,
        times(quotient),
    )


if __name__ == "__main__":
    main()

"""Where the time of a step goes, by function: Python's profiler on a full mesh, and on the program around a small system.

Own time of every function of the program, with that of the compiled kernels and library calls that it makes.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
from pathlib import Path

import maggi
from common.bars import BAR_STEP, CRANK_STEP, cells_for, hinged_bars, slider_crank
from common.ours import Ours
from common.tables import Table, milli
from common.timing import wall_seconds

PACKAGE = Path(maggi.__file__).parent
LEAST = 0.01  # of the whole: what is less is not listed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="100,000 freedoms")
    given = parser.parse_args()
    cells = cells_for(100_000 if given.long else 30_000, "tet10")
    show("Hinged bar", Ours(hinged_bars(cells, "tet10"), BAR_STEP, wall_seconds))
    show("Slider-crank", Ours(slider_crank(cells, "tet10"), CRANK_STEP, wall_seconds))


def show(name: str, ours: Ours, steps: int = 100) -> None:
    """Profile some steps and print the table."""
    ours.advance(20)
    profiler = cProfile.Profile()
    profiler.enable()
    seconds = ours.advance(steps)
    profiler.disable()
    table = Table(
        f"{name}, tet10, {ours.stepper.meshes[0].body.size:,} freedoms: where a step's {milli(seconds)} ms go",
        *("function", "ms a step", "of the whole", "calls a step"),
    )
    shares = own_times(pstats.Stats(profiler))
    whole = sum(spent for spent, _ in shares.values())
    for function, (spent, calls) in sorted(shares.items(), key=lambda item: -item[1][0]):
        if spent > LEAST * whole:
            table.row(function, milli(spent / steps), f"{100 * spent / whole:.0f} %", f"{calls / steps:.1f}")
    table.show()


def own_times(stats: pstats.Stats) -> dict[str, tuple[float, int]]:
    """Seconds and calls by function of the program; whatever else is called counts as its caller's."""
    entries = stats.stats  # type: ignore[attr-defined]
    found: dict[str, list[float]] = {}

    def credit(function: tuple[str, int, str], seconds: float, calls: int, seen: frozenset[object]) -> None:
        file, _, name = function
        if file.startswith(str(PACKAGE)):
            spent = found.setdefault(f"{Path(file).relative_to(PACKAGE)}: {name}", [0.0, 0.0])
            spent[0] += seconds
            spent[1] += calls
            return
        callers = entries[function][4] if function in entries and function not in seen else {}
        total = sum(caller[2] for caller in callers.values())
        for caller, (_, _, own, _) in callers.items():
            if total > 0.0:
                credit(caller, seconds * own / total, 0, seen | {function})

    for function, (_, calls, own, _, _) in entries.items():
        credit(function, own, calls, frozenset())
    return {name: (spent[0], int(spent[1])) for name, spent in found.items()}


if __name__ == "__main__":
    main()

"""How a step's cost grows with elements, full-mesh bodies, links, loops and modes: slopes on log-log axes, and a picture.

Slope 1 is growth in proportion. A full mesh may be a little steeper, for a factor has more than one entry a freedom the
larger the mesh; modes are steeper because their terms are dense.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chains import chain
from common.bars import BAR_STEP, cells_for, hinged_bars
from common.ours import Ours
from common.rod import rod
from common.tables import Table, micro
from common.timing import cpu_seconds, in_turn, median, wall_seconds
from four_bars import mechanism
from maggi.model.bodies import CraigBampton
from maggi.model.model import Model

Array = NDArray[np.float64]
PICTURE = Path(__file__).resolve().parent.parent / "out" / "growth.png"


@dataclass(frozen=True)
class Series:
    """Steps of a family of models: what is counted, its numbers, the model of each and its step (s)."""

    name: str
    unit: str
    numbers: tuple[int, ...]
    model: Callable[[int], Model]
    step: float
    threads: bool = False  # whether several of them may work: then wall time counts


def series(long: bool) -> tuple[Series, ...]:
    """All families."""

    def meshed(freedoms: int) -> Model:
        return hinged_bars(cells_for(freedoms, "tet10"), "tet10")

    def several(count: int) -> Model:
        return hinged_bars(cells_for(3_000, "tet10"), "tet10", count)

    def reduced(modes: int) -> Model:
        return rod((40, 2, 2), "hex20", 1e-4, CraigBampton(modes))

    meshes = (3_000, 10_000, 30_000, 100_000) if long else (1_000, 3_000, 10_000, 30_000)
    return (
        Series("mesh of one body", "freedoms", meshes, meshed, BAR_STEP, threads=True),
        Series("full-mesh bodies", "bodies of 3,000 freedoms", (1, 2, 4, 8), several, BAR_STEP, threads=True),
        Series("open chain", "links", (1, 2, 5, 10, 20, 50, 100, 200), chain, 1e-3),
        Series("four-bars", "loops", (1, 2, 5, 10, 20, 40), mechanism, 1e-3),
        Series("reduced body", "modes", (4, 8, 16, 32, 64), reduced, 1e-4),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="up to 100,000 freedoms, nine rounds")
    parser.add_argument("--picture", type=Path, default=PICTURE)
    given = parser.parse_args()
    table = Table("Growth of a step's cost", "what grows", "numbers", "µs a step", "slope", "slope of the upper half")
    measured = []
    for family in series(given.long):
        cost = measure(family, 9 if given.long else 3)
        measured.append((family, cost))
        half = len(cost) // 2
        table.row(
            f"{family.name}: {family.unit}",
            ", ".join(f"{number:,}" for number in family.numbers),
            ", ".join(micro(seconds) for seconds in cost),
            f"{slope(family.numbers, cost):.2f}",
            f"{slope(family.numbers[half:], cost[half:]):.2f}" if len(cost) - half > 1 else "-",
        )
    table.note(f"Slopes by least squares on logarithms. Picture: {given.picture.name}.")
    table.show()
    draw(measured, given.picture)


def measure(family: Series, rounds: int) -> Array:
    """Seconds of a step of each model (k,), measured in turn."""
    clock = wall_seconds if family.threads else cpu_seconds
    models = {number: Ours(family.model(number), family.step, clock) for number in family.numbers}
    runs = {}
    for number, ours in models.items():
        # about as long for each: of the order of 50 ms
        first = ours.advance(3)
        steps = int(np.clip(0.05 / first, 3, 300))
        runs[str(number)] = lambda ours=ours, steps=steps: ours.advance(steps)
    taken = in_turn(runs, rounds)
    return np.array([median(taken[str(number)]) for number in family.numbers])


def slope(numbers: tuple[int, ...], cost: Array) -> float:
    """Of the line through the logarithms."""
    return float(np.polyfit(np.log(numbers), np.log(cost), 1)[0])


def draw(measured: list[tuple[Series, Array]], path: Path) -> None:
    """A log-log plot of each family with the line through its points."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullFormatter, NullLocator

    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    panels = figure.subplots(1, len(measured), sharex=False)
    for axes, (family, cost) in zip(panels, measured, strict=True):
        numbers = np.array(family.numbers, dtype=float)
        fitted = np.polyfit(np.log(numbers), np.log(cost), 1)
        axes.loglog(numbers, 1e6 * np.exp(np.polyval(fitted, np.log(numbers))), "-", color="0.6", linewidth=1.0)
        axes.loglog(numbers, 1e6 * cost, "o", markersize=4)
        axes.set_title(f"{family.name}\nslope {fitted[0]:.2f}", fontsize=9)
        axes.set_xlabel(family.unit, fontsize=8)
        axes.set_xticks(numbers, [f"{number:,}" for number in family.numbers], rotation=60)
        axes.xaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.tick_params(labelsize=7)
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(True, which="major", linewidth=0.3)
    panels[0].set_ylabel("µs a step", fontsize=8)
    path.parent.mkdir(parents=True, exist_ok=True)
    FigureCanvasAgg(figure).print_figure(path, dpi=150)


if __name__ == "__main__":
    main()

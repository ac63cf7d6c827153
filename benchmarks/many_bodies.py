"""Several identical full-mesh bodies: a step's cost over that of one, and what their solves could cost together."""

from __future__ import annotations

import argparse

import numpy as np

from common.bars import BAR_STEP, cells_for, hinged_bars
from common.ours import Ours
from common.tables import Table, milli, times
from common.targets import Target
from common.timing import each, in_turn, median, ratio, wall_seconds

COUNTS = (1, 2, 4, 8)
CHUNK = 10  # steps, and as many of what bounds them
# the cost per step is linear in the bodies: none of them dearer than a single one
LINEAR = Target(1.1, at_most=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="100,000 freedoms a body, nine rounds")
    parser.add_argument("--freedoms", type=int)
    given = parser.parse_args()
    size = given.freedoms or (100_000 if given.long else 10_000)
    rounds = 9 if given.long else 5
    cells = cells_for(size, "tet10")
    bars = {count: Ours(hinged_bars(cells, "tet10", count), BAR_STEP, wall_seconds) for count in COUNTS}
    mesh = bars[1].stepper.meshes[0]
    random = np.random.default_rng(0)
    columns = {count: random.standard_normal((mesh.body.size, count)) for count in COUNTS}
    vector, out = random.standard_normal(mesh.body.size), np.zeros(mesh.body.size)
    factor, product = mesh.constants.factor, mesh.body.K.product(vector, out)
    runs = {f"{count} bars": (lambda ours=ours: ours.advance(CHUNK)) for count, ours in bars.items()}
    runs |= {f"{count} sides": (lambda B=B: each(CHUNK, lambda: factor.solve_many(B))) for count, B in columns.items()}
    runs["side"] = lambda: each(CHUNK, lambda: factor.solve(vector))
    runs["product"] = lambda: each(CHUNK, product.add)
    for ours in bars.values():
        ours.advance(10)
    taken = in_turn(runs, rounds)
    table = Table(
        f"Identical hinged bars of {mesh.body.size:,} freedoms (tet10): ms a step",
        *("bars", "ours", "a bar", "a bar over one alone", "target", "reached", "solves together", "solves over one"),
        *("limit", "ratio", "factorisations", "solves a bar and step"),
    )
    for count, ours in bars.items():
        step = taken[f"{count} bars"]
        together = taken[f"{count} sides"]
        alone = count * taken["side"]
        solves = together if median(together) < median(alone) else alone
        limit = solves + 2 * count * taken["product"]
        dearer = ratio(step, count * taken["1 bars"])
        table.row(
            count,
            milli(median(step)),
            milli(median(step) / count),
            times(dearer),
            *LINEAR.cells(f"{count} bodies: cost of each over one alone", dearer),
            milli(median(together)),
            times(ratio(together, taken["side"])),
            milli(median(limit)),
            times(ratio(step, limit)),
            ours.stepper.counts.factorisations,
            f"{ours.stepper.counts.back_substitutions / ours.stepper.counts.steps:.2f}",
        )
    table.note("Solves together: as many right sides with one factor. Over one: which is solved by itself. Limit: the")
    table.note("quicker of solving together and one by one, and two products with K a bar.")
    table.show()


if __name__ == "__main__":
    main()

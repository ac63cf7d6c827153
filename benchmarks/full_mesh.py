"""A step of full-mesh bodies against the least that an implicit step can cost: one solve and two products with K.

Both are measured in this process between chunks of steps. The hinged bar falls at h = 1 ms, the slider-crank turns with
3000 rpm at h = 40 µs; each with quadratic tetrahedra and hexahedra.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from common.bars import BAR_STEP, CRANK_STEP, cells_for, hinged_bars, slider_crank
from common.ours import Ours
from common.tables import Table, error, milli, times
from common.targets import Target
from common.timing import each, median, ratio, wall_seconds
from maggi.model.model import Model

Array = NDArray[np.float64]
TARGET = Target(1.3, at_most=True)
CELLS = ("tet10", "hex20")
STEPS = 200_000  # times freedoms in a chunk, about, and five steps at least


@dataclass(frozen=True)
class Case:
    """A mechanism: model by cells and kind of cell, step (s), and the attachment whose path is compared."""

    name: str
    model: Callable[[tuple[int, int, int], str], Model]
    step: float
    point: tuple[str, str]


CASES = (
    Case("hinged bar", hinged_bars, BAR_STEP, ("bar0", "tip")),
    Case("slider-crank", slider_crank, CRANK_STEP, ("rod", "small")),
)


@dataclass(frozen=True)
class Outcome:
    """What a run showed: seconds (k,) a step, a solve, a product, and a solve and two products in turn; solves a step;
    residuals (3,); the point's path (k, 3).
    """

    freedoms: int
    step: Array
    solve: Array
    product: Array
    limit: Array
    substitutions: float
    residuals: Array
    path: Array


def simulate(
    case: Case, cells: tuple[int, int, int], cell: str, chunks: int, chunk: int, *, exact: bool = False
) -> Outcome:
    """Run, timing chunks of steps and, in between, what bounds them."""
    ours = Ours(case.model(cells, cell), case.step, wall_seconds, exact=exact)
    mesh, counts = ours.stepper.meshes[0], ours.stepper.counts
    vector = np.random.default_rng(0).standard_normal(mesh.body.size)
    out = np.zeros_like(vector)
    once = mesh.body.K.product(vector, out)  # the quickest there is: every block is read once
    ours.advance(20)  # the first steps, in which the prediction finds its way, and whatever is still to be loaded
    counted = counts.back_substitutions
    step, solve, product, limit, path, residuals = [], [], [], [], [], np.zeros(3)

    def least() -> None:
        mesh.constants.factor.solve(vector)
        once.add()
        once.add()

    for _ in range(chunks):
        # as many of each, so that whatever else the machine does disturbs them alike
        step.append(ours.advance(chunk))
        solve.append(each(chunk, lambda: mesh.constants.factor.solve(vector)))
        product.append(each(chunk, once.add))
        limit.append(each(chunk, least))
        path.append(ours.position(*case.point))
        residuals = np.maximum(residuals, ours.stepper.state.residuals)
    substitutions = (counts.back_substitutions - counted) / (chunks * chunk)
    return Outcome(
        mesh.body.size, *(np.array(x) for x in (step, solve, product, limit)), substitutions, residuals, np.array(path)
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="up to 300,000 freedoms, fifty chunks of steps")
    parser.add_argument("--freedoms", type=int, nargs="+")
    given = parser.parse_args()
    sizes = given.freedoms or ((10_000, 30_000, 100_000, 300_000) if given.long else (10_000, 30_000))
    whole = given.long or given.freedoms
    chunks = 50 if given.long else 20
    table = Table(
        "Full meshes: ms a step",
        *("mechanism", "cells", "freedoms", "ours", "one solve", "one product", "limit", "ratio", "target", "reached"),
        *("solves a step", "residuals x, v, a", "error of stopping early"),
    )
    for case in CASES:
        for cell in CELLS:
            for size in sizes if whole or case is CASES[0] else sizes[:1]:
                measure(case, cell, size, chunks, max(5, STEPS // size), table, checked=size == sizes[0])
    table.note(
        "Limit: one solve and two products with K, in turn, as a step makes them: what one leaves in the caches the next"
    )
    table.note("throws out. One solve, one product: each by itself, again and again.")
    table.note("Residuals of the liaisons, scaled; the largest after any chunk.")
    table.note("Error of stopping early: of the followed point, over the length it has travelled, against the same run")
    table.note("iterated to round-off in every step.")
    table.show()


def measure(case: Case, cell: str, size: int, chunks: int, chunk: int, table: Table, *, checked: bool) -> None:
    """One line of the table. checked : run again without stopping early."""
    cells = cells_for(size, cell)
    run = simulate(case, cells, cell, chunks, chunk)
    quotient = ratio(run.step, run.limit)
    apart = None
    if checked:
        exact = simulate(case, cells, cell, chunks, chunk, exact=True)
        travelled = np.linalg.norm(np.diff(exact.path, axis=0), axis=1).sum()
        apart = float(np.linalg.norm(run.path - exact.path, axis=1).max() / travelled)
    table.row(
        case.name,
        cell,
        f"{run.freedoms:,}",
        *(milli(median(values)) for values in (run.step, run.solve, run.product, run.limit)),
        times(quotient),
        *TARGET.cells(f"{case.name}, {cell}, {run.freedoms:,} freedoms: step over solve + 2 products", quotient),
        f"{run.substitutions:.2f}",
        ", ".join(error(float(value)) for value in run.residuals),
        error(apart),
    )


if __name__ == "__main__":
    main()

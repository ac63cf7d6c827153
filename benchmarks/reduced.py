"""A hinged steel rod by Craig–Bampton modes: a step beside Exudyn's reduced body on the same mesh, shapes and step.

Exudyn gets our mass, stiffness and shapes, so that both integrate the same equations in the same number of coordinates,
and differ by their time integration alone: the paths of the tip are compared, at this step and at a refined one.
"""

from __future__ import annotations

import argparse

import numpy as np
from numpy.typing import NDArray

from common.ours import Ours
from common.rod import LENGTH, exported, rod, tip_of
from common.tables import MISSING, Table, error, micro, times
from common.targets import Target
from common.timing import in_turn, median, ratio
from maggi.model.bodies import CraigBampton
from peers import exudyn_runs
from peers.exudyn_fem import reduced_rod

Array = NDArray[np.float64]
STEP = 1e-4
MODES = (8, 20, 50)
TARGET = 5.0
POINTS = 20  # of the path that are compared


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="20,000 steps, nine rounds")
    parser.add_argument("--modes", type=int, nargs="+", default=MODES)
    given = parser.parse_args()
    steps, rounds = (20_000, 9) if given.long else (2_000, 3)
    table = Table(
        f"Hinged steel rod, Craig–Bampton modes, h = {STEP:g} s: µs a step",
        *("modes", "ours", "iterations", "peer", "iterations", "ratio", "target", "reached"),
        *("tip: ours to peer", "error: ours", "error: peer"),
    )
    used = []
    for modes in given.modes:
        measure(modes, steps, rounds, table, used)
    table.note(
        f"Tip: largest difference of the paths over the length, {POINTS} points in {steps:,} steps. Errors: the same"
    )
    table.note(f"against our own run with steps of {STEP / 8:g} s. The peer runs as: " + "; ".join(used) + ".")
    table.show()


def measure(modes: int, steps: int, rounds: int, table: Table, used: list[str]) -> None:
    """One line of the table."""
    model = rod((40, 2, 2), "hex20", STEP, CraigBampton(modes))
    ours = Ours(model, STEP)
    timed = min(steps, 2_000)
    runs = {"ours": lambda: ours.run(timed, 3)}
    peer = None
    if exudyn_runs.load():
        mesh, shapes = exported(ours.stepper.system)
        nodes = ("RotationRxyz", "RotationEulerParameters")
        rods = [reduced_rod(mesh, shapes, node) for node in nodes]
        peer = exudyn_runs.quickest(rods, exudyn_runs.KEPT, STEP, 100)
        runs["peer"] = lambda: peer.run(STEP, timed)
        used.append(f"{peer.name}, {peer.settings}")
    taken = in_turn(runs, rounds)
    quotient = ratio(taken["peer"], taken["ours"]) if peer else None
    target = Target(TARGET).cells(f"reduced body, {modes} modes", quotient) if modes in MODES else (MISSING,) * 2
    path = follow(ours, steps)
    truth = follow(Ours(model, STEP / 8), 8 * steps)
    other = None
    if peer:
        peer.run(STEP, steps, every=steps // POINTS)
        other = peer.path()[1:]
    table.row(
        modes,
        micro(median(taken["ours"])),
        f"{ours.iterations:.1f}",
        micro(median(taken["peer"])) if peer else MISSING,
        f"{peer.iterations:.1f}" if peer else MISSING,
        times(quotient),
        *target,
        error(apart(path, other)),
        error(apart(path, truth)),
        error(apart(other, truth)),
    )


def follow(ours: Ours, steps: int) -> Array:
    """The tip's path (POINTS, 3)."""
    ours.restart()
    path = []
    for _ in range(POINTS):
        ours.advance(steps // POINTS)
        path.append(tip_of(ours))
    return np.array(path)


def apart(one: Array | None, other: Array | None) -> float | None:
    """The largest distance of two paths over the rod's length."""
    if one is None or other is None:
        return None
    return float(np.linalg.norm(one - other, axis=1).max()) / LENGTH


if __name__ == "__main__":
    main()

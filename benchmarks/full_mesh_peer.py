"""The full-mesh rod of 3,075 freedoms beside Exudyn's `ObjectFFRF` on the same mesh, mass, stiffness and step.

Exudyn takes seconds a step, and more for every Jacobian; what is compared with is the step without one, the difference of
a long and a short run. Where the tip is at the end is compared at the step and at half of it.
"""

from __future__ import annotations

import argparse

import numpy as np

from common.ours import Ours
from common.rod import LENGTH, exported, rod_on_two_balls, tip_of
from common.tables import MISSING, Table, error, milli, times
from common.targets import Target
from common.timing import median, process_seconds
from peers import exudyn_runs
from peers.exudyn_fem import full_rod

CELLS = (40, 4, 4)
STEP = 1e-3
SHORT = 1  # steps of the run whose time is subtracted
FASTER, SAME = Target(400.0), Target(1e-4, "", at_most=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="50 steps instead of 4")
    given = parser.parse_args()
    steps = 50 if given.long else 4
    ours = Ours(rod_on_two_balls(CELLS, "hex8", STEP), STEP, process_seconds)
    half = Ours(rod_on_two_balls(CELLS, "hex8", STEP), STEP / 2)
    times_ours = [ours.advance(steps)]
    tips = {"ours": tip_of(ours)}
    times_ours += [ours.advance(50) for _ in range(7)]
    half.advance(2 * steps)
    tips["ours, half"] = tip_of(half)
    quotient = difference = fine = jacobian = peer_step = None
    if exudyn_runs.load():
        mesh, _ = exported(ours.stepper.system)
        peer = full_rod(mesh)  # sparse, modified Newton: its quickest
        start = SHORT * peer.run(STEP, SHORT)
        times_ours += [ours.advance(50) for _ in range(7)]
        whole = steps * peer.run(STEP, steps)
        tips["peer"] = peer.point()
        peer_step = (whole - start) / (steps - SHORT)
        jacobian = start - SHORT * peer_step
        peer.run(STEP / 2, 2 * steps)
        tips["peer, half"] = peer.point()
        quotient = peer_step / median(np.array(times_ours))
        difference = float(np.linalg.norm(tips["ours"] - tips["peer"])) / LENGTH
        fine = float(np.linalg.norm(tips["ours, half"] - tips["peer, half"])) / LENGTH
    table = Table(
        f"Full-mesh rod, {ours.stepper.meshes[0].body.size:,} freedoms, hex8, h = {STEP:g} s: ms a step",
        *("ours", "peer", "its Jacobian", "ratio", "target", "reached"),
        *("tip: ours to peer", "at h/2", "target ", "reached ", "tip: h to h/2, ours"),
    )
    table.row(
        milli(median(np.array(times_ours))),
        milli(peer_step) if peer_step else MISSING,
        milli(jacobian) if jacobian else MISSING,
        times(quotient),
        *FASTER.cells("full mesh of 3,075 freedoms against ObjectFFRF", quotient),
        error(difference),
        error(fine),
        *SAME.cells("the same, tip at h/2: difference over the length", fine),
        error(float(np.linalg.norm(tips["ours"] - tips["ours, half"])) / LENGTH),
    )
    table.note(f"Tips after {1e3 * steps * STEP:g} ms, over the rod's length.")
    table.show()


if __name__ == "__main__":
    main()

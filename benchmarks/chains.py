"""Open 3-D chains of rigid links on revolute joints: the compiled step beside Exudyn's two 3-D ways, and both errors.

The motion is planar, so that the chain's own equations, one angle a link, integrated to 1e-11 by an explicit method of
order eight, tell what is true.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from common.ours import Ours
from common.tables import MISSING, Table, error, micro, times
from common.targets import Target
from common.timing import in_turn, median, ratio
from maggi.model.attachments import Attachment
from maggi.model.bodies import RigidBody
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from peers import exudyn_runs
from peers.exudyn_chains import redundant, tree

Array = NDArray[np.float64]
STEP = 1e-3
LENGTH, MASS, GRAVITY = 0.1, 1.0, 9.81
INERTIA = MASS * LENGTH**2 / 12.0
TARGETS = {10: 6.0, 50: 20.0, 200: 25.0}
STEPS = {10: 500, 50: 300, 200: 100}  # a run; the short form
WAYS = ("redundant", "tree", "tree, RK44")  # of the peer; the last, explicit, is shown but not compared with


def chain(links: int) -> Model:
    """An open chain along x, 0.1 m and 1 kg a link, hinged about z, released from rest under gravity along −y."""
    bodies = {
        f"link{i}": RigidBody(
            MASS,
            (LENGTH / 2.0, 0.0, 0.0),
            ((INERTIA / 10.0, 0.0, 0.0), (0.0, INERTIA, 0.0), (0.0, 0.0, INERTIA)),
            pose=Pose((i * LENGTH, 0.0, 0.0)),
            attachments={"end": Attachment(at=(LENGTH, 0.0, 0.0))},
        )
        for i in range(links)
    }
    joints = {
        f"joint{i}": Joint(
            "revolute",
            End("ground") if i == 0 else End(f"link{i - 1}"),
            End(f"link{i}"),
            at=(i * LENGTH, 0.0, 0.0),
            axis=(0.0, 0.0, 1.0),
        )
        for i in range(links)
    }
    return Model(bodies=bodies, joints=joints, gravity=(0.0, -GRAVITY, 0.0), simulation=Simulation(1.0, STEP))


def reference_tip(links: int, t: float) -> Array:
    """The tip (3,) after t seconds: Lagrange's equations in the links' absolute angles, DOP853."""
    beyond = np.arange(links)[::-1].astype(float)  # links that hang on each one
    smaller = np.minimum.outer(beyond, beyond)
    # ∫ of the velocities of link i due to the angles of links j and k: half a length at its own, a whole one before it
    weights = MASS * LENGTH**2 * (smaller + 0.5)
    np.fill_diagonal(weights, MASS * LENGTH**2 * (beyond + 0.25) + INERTIA)
    moments = MASS * GRAVITY * LENGTH * (beyond + 0.5)

    def rates(_: float, state: Array) -> Array:
        angles, speeds = state[:links], state[links:]
        apart = angles[:, None] - angles
        accelerations = np.linalg.solve(
            weights * np.cos(apart), -(weights * np.sin(apart)) @ speeds**2 - moments * np.cos(angles)
        )
        return np.concatenate([speeds, accelerations])

    solution = solve_ivp(rates, (0.0, t), np.zeros(2 * links), method="DOP853", rtol=1e-11, atol=1e-12)
    angles = solution.y[:links, -1]
    return LENGTH * np.array([np.cos(angles).sum(), np.sin(angles).sum(), 0.0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="runs of 1000 steps, nine rounds")
    parser.add_argument("--links", type=int, nargs="+", default=tuple(STEPS))
    given = parser.parse_args()
    table = Table(
        f"Open chains of rigid links, 3-D revolutes, h = {STEP:g} s: µs a step",
        *("links", "ours", "iterations", *(f"peer: {way}" for way in WAYS), "ratio", "target"),
        *("reached", "error: ours", *(f"error: {way}" for way in WAYS)),
    )
    used = []
    for links in given.links:
        steps = 1000 if given.long else STEPS.get(links, max(50, 10_000 // links))
        measure(links, steps, 9 if given.long else 3, table, used)
    table.note("Ratio: the better of the peer's two implicit ways over ours. Errors: of the tip at the end of the run,")
    table.note("over the chain's length. The peer runs as: " + "; ".join(used) + ".")
    table.show()


def measure(links: int, steps: int, rounds: int, table: Table, used: list[str]) -> None:
    """One line of the table."""
    ours = Ours(chain(links), STEP)
    runs = {"ours": lambda: ours.run(steps, 3)}
    peers = {}
    if exudyn_runs.load():
        trial = max(10, 1000 // links)
        implicit = exudyn_runs.IMPLICIT if links < 30 else exudyn_runs.SPARSE
        peers["redundant"] = exudyn_runs.quickest(redundant(links), implicit, STEP, trial)
        peers["tree"] = tree(links).tuned(exudyn_runs.DENSE, STEP, trial)
        peers["tree, RK44"] = replace(tree(links), settings=exudyn_runs.Settings(method="RK44"))
        for name, peer in peers.items():
            runs[name] = lambda peer=peer: peer.run(STEP, steps)
        used.append(
            f"{links} links: {peers['redundant'].name} ({peers['redundant'].settings}), {peers['tree'].settings}"
        )
    taken = in_turn(runs, rounds)
    better = min(WAYS[:2], key=lambda name: median(taken[name])) if peers else None
    quotient = ratio(taken[better], taken["ours"]) if better else None
    tip = reference_tip(links, steps * STEP)
    size = links * LENGTH
    wrong = {name: float(np.linalg.norm(peer.point() - tip)) / size for name, peer in peers.items()}
    target = (MISSING, MISSING)
    if links in TARGETS:
        target = Target(TARGETS[links]).cells(f"chain of {links} links", quotient)
    table.row(
        links,
        micro(median(taken["ours"])),
        f"{ours.iterations:.1f}",
        *(micro(median(taken[name])) if peers else MISSING for name in WAYS),
        times(quotient),
        *target,
        error(float(np.linalg.norm(ours.position(f"link{links - 1}", "end") - tip)) / size),
        *(error(wrong.get(name)) for name in WAYS),
    )


if __name__ == "__main__":
    main()

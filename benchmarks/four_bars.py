"""N four-bars in a row (IFToMM A02), all joints 3-D revolutes: the step beside Exudyn, the error, and the branch kept.

Where the rods are horizontal the constraints lose N ranks and the mechanism could fold. All links stay parallel in the
right motion, which then is one pendulum's: (I) θ'' = −G cos θ, I = (N + 1)/3 + N, G = g ((N + 1)/2 + N).
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
from maggi.model.geometry import Pose, Velocity
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from peers import exudyn_runs
from peers.exudyn_four_bars import FourBars, four_bars

Array = NDArray[np.float64]
STEP = 1e-3
GRAVITY = 9.81
TARGETS = {1: 7.0, 2: 8.0, 10: 10.0, 40: 12.0}
INERTIA = ((1.0 / 120.0, 0.0, 0.0), (0.0, 1.0 / 12.0, 0.0), (0.0, 0.0, 1.0 / 12.0))
UPRIGHT = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
PUBLISHED = {1: (0.4783850577609706, 0.8781501787912093), 2: (0.3284581115408154, 0.9445185381786010)}  # B0 at 10 s
WAYS = ("3-D revolutes", "rows removed by hand")


def mechanism(windows: int) -> Model:
    """Rods upright on ground pins one metre apart, their tops joined by couplers; B0 moves at 1 m/s."""
    bodies, joints = {}, {}
    for i in range(windows + 1):
        spin = Velocity(None, (0.0, 0.0, -1.0))
        top = {"top": Attachment(at=(1.0, 0.0, 0.0))}
        pose = Pose((float(i), 0.0, 0.0), UPRIGHT)
        bodies[f"rod{i}"] = RigidBody(1.0, (0.5, 0.0, 0.0), INERTIA, pose, spin, attachments=top)
    for i in range(windows):
        bodies[f"coupler{i}"] = RigidBody(1.0, (0.5, 0.0, 0.0), INERTIA, Pose((float(i), 1.0, 0.0)))

    def revolute(name: str, first: str, second: str, x: float, y: float) -> None:
        joints[name] = Joint("revolute", End(first), End(second), at=(x, y, 0.0), axis=(0.0, 0.0, 1.0))

    for i in range(windows + 1):
        revolute(f"pin{i}", "ground", f"rod{i}", float(i), 0.0)
    for i in range(windows):
        revolute(f"left{i}", f"rod{i}", f"coupler{i}", float(i), 1.0)
        revolute(f"right{i}", f"coupler{i}", f"rod{i + 1}", i + 1.0, 1.0)
    return Model(bodies=bodies, joints=joints, gravity=(0.0, -GRAVITY, 0.0), simulation=Simulation(10.0, STEP))


def corner(windows: int, t: float) -> Array:
    """B0 (3,) at time t of the right motion: DOP853 on its one equation."""
    stiffness = GRAVITY * ((windows + 1) / 2 + windows) / ((windows + 1) / 3 + windows)

    def rates(_: float, state: Array) -> Array:
        return np.array([state[1], -stiffness * np.cos(state[0])])

    solution = solve_ivp(rates, (0.0, t), [0.5 * np.pi, -1.0], method="DOP853", rtol=1e-13, atol=1e-13)
    angle = solution.y[0, -1]
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def spread(ours: Ours, windows: int) -> float:
    """How far the rods are from parallel (rad)."""
    system, rotation = ours.stepper.system, ours.stepper.state.now.rotation
    along = np.array([rotation[system.body(f"rod{i}").index][:, 0] for i in range(windows + 1)])
    return float(np.linalg.norm(np.cross(along, along[0]), axis=1).max())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="10 s for every N; nine rounds")
    parser.add_argument("--windows", type=int, nargs="+", default=tuple(TARGETS))
    given = parser.parse_args()
    speed = Table(
        f"N four-bars, 3-D revolutes, h = {STEP:g} s: µs a step",
        *("N", "ours", "iterations", *(f"peer: {way}" for way in WAYS), "ratio", "target", "reached"),
    )
    truth = Table(
        "N four-bars: the motion",
        *("N", "end (s)", "error of B0: ours", *(f"peer: {way}" for way in WAYS)),
        *("rods not parallel (rad): ours", *(f"peer: {way}" for way in WAYS), "published B0 found"),
    )
    used = []
    for windows in given.windows:
        duration = 10.0 if given.long or windows <= 2 else 1.0
        measure(windows, duration, 9 if given.long else 3, speed, truth, used)
    speed.note(
        "Ratio: the better of the peer's two ways over ours. A 3-D revolute repeats three rows in every loop: there"
    )
    speed.note(
        "the peer has to be told to go on with a singular Jacobian, or one joint a loop to hold two rows only. It"
    )
    speed.note("runs as: " + "; ".join(used) + ".")
    truth.note(
        "Ours: the largest spread of the rods over the run; the peer's: at its end. The first singular position is"
    )
    truth.note(
        "passed after 0.71 s. Published: the closed equation agrees with the values of the case to this error (m)."
    )
    speed.show()
    truth.show()


def measure(windows: int, duration: float, rounds: int, speed: Table, truth: Table, used: list[str]) -> None:
    """One line of each table."""
    ours = Ours(mechanism(windows), STEP)
    timed = 1000 if windows <= 2 else 300
    runs = {"ours": lambda: ours.run(timed, 3)}
    peers: dict[str, FourBars] = {}
    if exudyn_runs.load():
        peers = found(windows)
        for way, bars in peers.items():
            runs[way] = lambda bars=bars: bars.peer.run(STEP, timed)
            used.append(f"N = {windows}, {way}: {bars.peer.name}, {bars.peer.settings}")
    taken = in_turn(runs, rounds)
    better = min(peers, key=lambda way: median(taken[way])) if peers else None
    quotient = ratio(taken[better], taken["ours"]) if better else None
    target = Target(TARGETS[windows]).cells(f"{windows} four-bars", quotient) if windows in TARGETS else (MISSING,) * 2
    speed.row(
        windows,
        micro(median(taken["ours"])),
        f"{ours.iterations:.1f}",
        *(micro(median(taken[way])) if way in taken else MISSING for way in WAYS),
        times(quotient),
        *target,
    )
    exact = corner(windows, duration)
    steps = round(duration / STEP)
    widest = follow(ours, windows, steps)
    wrong, parted = {}, {}
    for way, bars in peers.items():
        try:
            bars.peer.run(STEP, steps)
        except RuntimeError:
            continue
        wrong[way], parted[way] = float(np.linalg.norm(bars.peer.point() - exact)), bars.spread()
    published = None
    if windows in PUBLISHED:
        published = float(np.linalg.norm(corner(windows, 10.0)[:2] - PUBLISHED[windows]))
    truth.row(
        windows,
        f"{duration:g}",
        error(float(np.linalg.norm(ours.position("rod0", "top") - exact))),
        *(error(wrong.get(way)) for way in WAYS),
        error(widest),
        *(error(parted.get(way)) for way in WAYS),
        error(published),
    )


def found(windows: int) -> dict[str, FourBars]:
    """The peer's ways, each with its quickest coordinates and settings."""
    trial = 100 if windows <= 10 else 30
    dense = tuple(replace(settings, redundant=True) for settings in exudyn_runs.DENSE if settings.modified)
    usable = exudyn_runs.IMPLICIT if windows <= 2 else exudyn_runs.SPARSE
    result = {}
    for way, settings in zip(WAYS, (dense, usable), strict=True):
        if way == WAYS[0] and windows > 10:
            continue  # dense matrices of 800 unknowns: seconds a step
        models = four_bars(windows, full=way == WAYS[0])
        best = exudyn_runs.quickest([bars.peer for bars in models], settings, STEP, trial)
        bars = next(bars for bars in models if bars.peer.mbs is best.mbs)
        result[way] = replace(bars, peer=best)
    return result


def follow(ours: Ours, windows: int, steps: int) -> float:
    """Run to the end, looking every 50 steps how far the rods are from parallel; the largest of it (rad)."""
    ours.restart()
    widest = 0.0
    for _ in range(0, steps, 50):
        ours.advance(min(50, steps))
        widest = max(widest, spread(ours, windows))
    return widest


if __name__ == "__main__":
    main()

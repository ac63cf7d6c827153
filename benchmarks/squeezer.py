"""Andrews' squeezer (IVP test set "andrews") at equal accuracy: how long a run takes here and in Exudyn.

Both integrators are of second order; for each the number of steps is sought that leaves the same error of the seven
angles at the end. Ours: seven 3-D bodies on ten 3-D revolutes. The peer's: planar bodies, or 3-D bodies whose loops are
closed without redundant rows, whichever takes less.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from common import squeezer_data as data
from common.ours import Ours
from common.tables import MISSING, Table, error, milli, times
from common.targets import Target
from common.timing import in_turn, median, ratio
from maggi.model.attachments import Attachment
from maggi.model.bodies import RigidBody
from maggi.model.errors import SimulationError
from maggi.model.expression import expression
from maggi.model.forces import PointLoad, SpringDamper
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from peers import exudyn_runs
from peers.exudyn_squeezer import squeezers

LEVELS = (1e-4, 1e-5)  # errors
TARGET = 5.0
RADII = (0.9, 1.0)  # ρ∞ of either program: whichever needs less time


def model() -> Model:
    """The mechanism at rest."""
    bodies = {}
    for name, link in data.links().items():
        c, s = float(np.cos(link.angle)), float(np.sin(link.angle))
        J = link.inertia
        bodies[name] = RigidBody(
            link.mass,
            (*link.center, 0.0),
            ((J, 0.0, 0.0), (0.0, J, 0.0), (0.0, 0.0, J)),
            Pose((*link.at, 0.0), ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))),
            attachments={point: Attachment(at=(*place, 0.0)) for point, place in link.points.items()},
        )
    joints = {
        f"hinge{k}": Joint("revolute", End(h.first), End(h.second), at=(*h.at, 0.0), axis=(0.0, 0.0, 1.0))
        for k, h in enumerate(data.hinges())
    }
    zero = expression(0.0)
    stiffness, length = data.SPRING
    forces = {
        "motor": PointLoad(End("K1", "F"), "torque", (zero, zero, expression(data.MOTOR))),
        "spring": SpringDamper(End("K3", "D"), End("ground", point=(*data.ANCHOR, 0.0)), stiffness, 0.0, length),
    }
    return Model(bodies, joints, forces, simulation=Simulation(data.DURATION, data.DURATION))


@dataclass(frozen=True)
class Run:
    """A way to compute the motion in so many steps: seconds of the whole run, and its error."""

    name: str
    seconds: Callable[[int], float]
    error: Callable[[], float]


def ours() -> list[Run]:
    """With either spectral radius."""
    return [_ours(radius) for radius in RADII]


def _ours(radius: float) -> Run:
    last: list[Ours] = []

    def seconds(steps: int) -> float:
        start = model()
        assert start.simulation is not None
        start = replace(start, simulation=replace(start.simulation, rho_inf=radius))
        last[:] = [Ours(start, data.DURATION / steps)]
        return steps * last[0].advance(steps)

    def wrong() -> float:
        stepper = last[0].stepper
        rotation = stepper.state.now.rotation
        turned = [rotation[stepper.system.body(name).index] for name in data.NAMES]
        return data.error(np.array([np.arctan2(R[1, 0], R[0, 0]) for R in turned]))

    return Run(f"ρ∞ = {radius:g}", seconds, wrong)


def theirs() -> dict[str, list[Run]]:
    """Planar and 3-D, each with its quickest settings."""
    planar, *spatial = squeezers()
    step = data.DURATION / 3000
    settings = exudyn_runs.IMPLICIT
    found = {
        "planar": planar.tuned(settings, step, 300),
        "3-D": exudyn_runs.quickest(spatial, settings, step, 300),
    }
    return {way: [_theirs(peer, radius) for radius in RADII] for way, peer in found.items()}


def _theirs(peer: exudyn_runs.Peer, radius: float) -> Run:
    peer = replace(peer, settings=replace(peer.settings, rho_inf=radius))

    def seconds(steps: int) -> float:
        return steps * peer.run(data.DURATION / steps, steps)

    return Run(f"{peer.name}, {peer.settings}, ρ∞ = {radius:g}", seconds, lambda: data.error(peer.point()))


def steps_for(run: Run, level: float) -> int | None:
    """The number of steps that leaves an error just below the level, within a tenth; None where none is found."""
    steps = round(3000 * np.sqrt(1e-5 / level))
    for _ in range(12):
        try:
            run.seconds(steps)
        except (RuntimeError, SimulationError):  # too large a step
            steps = round(1.5 * steps)
            continue
        found = run.error()
        if 0.9 * level <= found <= level:
            return steps
        steps = round(steps * np.clip(np.sqrt(found / (0.95 * level)), 0.3, 3.0))
    return None


def quickest(runs: list[Run], level: float) -> tuple[Run, int] | None:
    """The run that takes least at an error, and its number of steps."""
    best = None
    for run in runs:
        steps = steps_for(run, level)
        if steps is None:
            continue
        seconds = min(run.seconds(steps) for _ in range(2))
        if best is None or seconds < best[0]:
            best = (seconds, run, steps)
    return None if best is None else best[1:]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="fifteen rounds")
    given = parser.parse_args()
    table = Table(
        f"Andrews' squeezer, {data.DURATION:g} s, at equal accuracy: ms a run",
        *("error", "ours", "peer: 3-D", "peer: planar", "ratio", "target", "reached"),
        *("steps: ours", "steps: 3-D", "steps: planar", "error: ours", "error: 3-D", "error: planar"),
    )
    used = []
    ways = theirs() if exudyn_runs.load() else {}
    for level in LEVELS:
        measure(level, ways, 15 if given.long else 5, table, used)
    table.note("Ratio: the better of the peer's two ways over ours. " + "; ".join(used) + ".")
    table.show()


def measure(level: float, ways: dict[str, list[Run]], rounds: int, table: Table, used: list[str]) -> None:
    """One line of the table."""
    found = {way: quickest(runs, level) for way, runs in {"ours": ours(), **ways}.items()}
    chosen = {way: pair for way, pair in found.items() if pair is not None}
    taken = in_turn(
        {way: (lambda run=run, steps=steps: run.seconds(steps)) for way, (run, steps) in chosen.items()}, rounds
    )
    peers = [way for way in ways if way in chosen]
    better = min(peers, key=lambda way: median(taken[way])) if peers else None
    quotient = ratio(taken[better], taken["ours"]) if better and "ours" in taken else None
    columns = ("ours", "3-D", "planar")
    table.row(
        f"{level:.0e}",
        *(milli(median(taken[way])) if way in taken else MISSING for way in columns),
        times(quotient),
        *Target(TARGET).cells(f"Andrews' squeezer at an error of {level:.0e}", quotient),
        *(chosen[way][1] if way in chosen else MISSING for way in columns),
        *(error(chosen[way][0].error()) if way in chosen else MISSING for way in columns),
    )
    used.append(f"{level:.0e}: " + ", ".join(f"{way} ({run.name})" for way, (run, _) in chosen.items()))


if __name__ == "__main__":
    main()

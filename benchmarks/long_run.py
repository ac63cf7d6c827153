"""Liaison residuals over 100,000 steps of a closed loop: a crank-rocker with 3-D revolutes, three of its rows redundant.

Prints the largest residual in ten windows of the run at each level, and the slope of a line through their logarithms;
with --picture FILE draws all of them. Without drift the slope is that of noise.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import maggi
from maggi.model import End, Joint, Model, Outputs, Pose, RigidBody, Simulation, Velocity

GROUND, CRANK, COUPLER, ROCKER = 0.4, 0.12, 0.38, 0.25  # m: a crank that turns fully (Grashof)
LEVELS = ("position", "velocity", "acceleration")


def crank_rocker(steps: int, step: float, every: int) -> Model:
    """The loop in the x-y plane, gravity along −y, crank along x at the start and turning at 30 rad/s."""
    a = np.array([CRANK, 0.0, 0.0])
    d = np.array([GROUND, 0.0, 0.0])
    # the coupler-rocker pin: intersection of two circles, above
    along = (COUPLER**2 - ROCKER**2 + (GROUND - CRANK) ** 2) / (2.0 * (GROUND - CRANK))
    b = a + [along, np.sqrt(COUPLER**2 - along**2), 0.0]
    bodies, joints = {}, {}
    for name, p, q in (("crank", np.zeros(3), a), ("coupler", a, b), ("rocker", d, b)):
        x = (q - p) / np.linalg.norm(q - p)
        length = float(np.linalg.norm(q - p))
        rotation = np.column_stack([x, [-x[1], x[0], 0.0], [0.0, 0.0, 1.0]])
        mass = 2.0 * length
        slender = mass * length**2 / 12.0
        bodies[name] = RigidBody(
            mass,
            (0.5 * length, 0.0, 0.0),
            ((0.01 * slender, 0.0, 0.0), (0.0, slender, 0.0), (0.0, 0.0, slender)),
            Pose(tuple(p), tuple(map(tuple, rotation))),
            Velocity(None, (0.0, 0.0, 30.0)) if name == "crank" else Velocity(),
        )
    places = {"a": ("ground", "crank", np.zeros(3)), "b": ("crank", "coupler", a), "c": ("coupler", "rocker", b)}
    places["d"] = ("rocker", "ground", d)
    for name, (first, second, at) in places.items():
        joints[name] = Joint("revolute", End(first), End(second), at=tuple(at), axis=(0.0, 0.0, 1.0))
    return Model(
        bodies,
        joints,
        gravity=(0.0, -9.81, 0.0),
        simulation=Simulation(steps * step, step, rho_inf=1.0),
        outputs=Outputs(every=every, quantities=("residuals", "energy")),
    )


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--steps", type=int, default=100_000)
    options.add_argument("--picture")
    given = options.parse_args()
    every = max(1, given.steps // 2000)
    began = time.perf_counter()
    results = maggi.run(crank_rocker(given.steps, 5e-4, every))
    print(f"closed loop, {given.steps:,} steps, {time.perf_counter() - began:.1f} s with the start")
    print(f"{'part of the run':<18}" + "".join(f"{level:>14}" for level in LEVELS))
    all_of = {level: getattr(results.residuals, level) for level in LEVELS}
    largest = {level: [float(part.max()) for part in np.array_split(all_of[level][1:], 10)] for level in LEVELS}
    for k in range(10):
        print(f"{10 * k:3d} … {10 * k + 10:3d} %      " + "".join(f"{largest[level][k]:14.1e}" for level in LEVELS))
    slopes = [np.polyfit(np.linspace(0, 1, 10), np.log10(largest[level]), 1)[0] for level in LEVELS]
    print("decades in a run  " + "".join(f"{slope:+14.2f}" for slope in slopes))
    energy = results.energy.kinetic + results.energy.gravity
    print(f"energy: {np.ptp(energy) / np.ptp(results.energy.kinetic):.1e} of what is exchanged")
    if given.picture:
        draw(results.time, all_of, given.picture)


def draw(t: np.ndarray, residuals: dict[str, np.ndarray], path: str) -> None:
    """All residuals over time, logarithmic."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 3.2), layout="constrained")
    axes = figure.add_subplot()
    for level, values in residuals.items():
        axes.semilogy(t[1:], np.maximum(values[1:], 1e-18), ".", markersize=1.5, label=level)
    axes.set_ylim(1e-18, 1e-9)
    axes.set_xlabel("t [s]")
    axes.set_ylabel("liaison residual, scaled")
    axes.legend(markerscale=6, loc="upper right", ncols=3, frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    FigureCanvasAgg(figure).print_figure(path, dpi=150)


if __name__ == "__main__":
    main()

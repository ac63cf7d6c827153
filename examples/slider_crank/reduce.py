"""The rod with its full mesh, and reduced to more and more modes.

python reduce.py    # six runs, half a minute once compiled; ../../docs/reduction.md shows the table and explains it
"""

import time
from pathlib import Path

import numpy as np

import maggi
from maggi.results.chord import chord

FOLDER = Path(__file__).parent
MODES = (0, 2, 4, 12, 30)


def measure(*overrides: str) -> tuple[dict[str, np.ndarray], float]:
    """Deflection of the rod from the line between its eyes (n, nodes, 3), pin force and piston's position; time, s."""
    rows = "outputs={every: 10, quantities: [bodies, attachments, displacement, joints]}"
    model = maggi.load(FOLDER / "slider_crank.yml", [rows, *overrides])
    began = time.perf_counter()
    results = maggi.run(model)
    seconds = time.perf_counter() - began
    rod = results.body("rod")
    line = chord(results, rod)
    assert line is not None
    measured = {
        "deflection": line.relative(rod.nodes, rod.displacement[:], slice(None)),
        "force": results.joint("wristpin").force,
        "piston": results.body("piston").origin,
    }
    return measured, seconds


def highest(modes: int) -> str:
    """The highest frequency kept, kHz."""
    model = maggi.load(FOLDER / "slider_crank.yml", [f"bodies.rod.reduction={{method: craig-bampton, modes: {modes}}}"])
    rod = next(body for body in maggi.check(model).bodies if body.name == "rod")
    assert rod.reduction is not None
    return "–" if rod.reduction.highest is None else f"{rod.reduction.highest / 1e3:.1f}"


def main() -> None:
    """One line for each number of modes: largest differences from the full mesh, relative to the largest values."""
    full, seconds = measure()
    print("| modes | up to, kHz | deflection | wrist-pin force | piston, nm | whole run, s |")
    print("|---|---|---|---|---|---|")
    for modes in MODES:
        reduced, spent = measure(f"bodies.rod.reduction={{method: craig-bampton, modes: {modes}}}")
        bent, force = (np.abs(reduced[k] - full[k]).max() / np.abs(full[k]).max() for k in ("deflection", "force"))
        piston = np.abs(reduced["piston"] - full["piston"]).max()
        print(f"| {modes} | {highest(modes)} | {bent:.1e} | {force:.1e} | {1e9 * piston:.2g} | {spent:.1f} |")
    print(
        f"| full mesh | | {1e6 * np.abs(full['deflection']).max():.4g} µm | {np.abs(full['force']).max():.5g} N | | {seconds:.1f} |"
    )


if __name__ == "__main__":
    main()

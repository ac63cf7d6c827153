"""One-way against fully coupled: the rod on the frame of a rigid run, and on its own floating frame.

python compare.py [PICTURE]    # four runs, a minute and a half; ../../docs/one-way.md explains what is seen
"""

import sys
from pathlib import Path

import numpy as np

import maggi
from maggi.results.chord import chord
from maggi.view.style import line_style, new_figure, save, style

FOLDER = Path(__file__).parent
ONE_WAY = "bodies.rod.frame={motion: rigid-run}"
RODS = {"steel": "210 GPa", "a tenth of steel's stiffness": "21 GPa"}
TURNS = 3
ROWS = "outputs={every: 5, quantities: [bodies, attachments, displacement, joints]}"


def measure(*overrides: str) -> dict[str, np.ndarray]:
    """Deflection of the shank's middle from the line between the eyes (m), piston's position (m), wrist-pin force (N)."""
    results = maggi.run(maggi.load(FOLDER / "slider_crank.yml", [ROWS, *overrides]))
    rod = results.body("rod")
    line = chord(results, rod)
    assert line is not None
    middle = np.abs(rod.nodes[:, 0] - 0.15) < 0.01
    bent = line.relative(rod.nodes[middle], rod.displacement[:][:, middle], slice(None))
    return {
        "time": results.time,
        "deflection": bent[:, :, 2].mean(axis=1),
        "piston": results.body("piston").origin[:, 0],
        "force": np.linalg.norm(results.joint("wristpin").force, axis=1),
    }


def main(picture: Path) -> None:
    """Runs, a table and a picture."""
    with style():
        plot = new_figure(7.5, 5.0, "One-way and coupled")
        axes = plot.subplots(2, 2, sharex=True)
        for (above, below), (name, young) in zip(axes.T, RODS.items(), strict=True):
            coupled, one_way = (
                measure(f"materials.steel.young={young}"),
                measure(f"materials.steel.young={young}", ONE_WAY),
            )
            print(f"rod of {name} ({young})")
            for key, unit in (("deflection", "m"), ("force", "N"), ("piston", "m")):
                largest = np.abs(coupled[key]).max()
                difference = np.abs(one_way[key] - coupled[key]).max() / largest
                print(f"  {key:10} up to {largest:.5g} {unit}; one-way differs by {difference:.1e} of that")
            turns = coupled["time"] / coupled["time"][-1] * TURNS
            above.plot(turns, 1e6 * coupled["deflection"], **line_style(0), label="coupled")
            above.plot(turns, 1e6 * one_way["deflection"], color="black", linestyle=":", label="one-way")
            above.set_title(f"Rod of {name}")
            below.plot(turns, 1e6 * (one_way["deflection"] - coupled["deflection"]), **line_style(1))
            below.set_xlabel("turns of the crank")
        axes[0, 0].set_ylabel("deflection, µm")
        axes[1, 0].set_ylabel("one-way less coupled, µm")
        axes[0, 0].legend()
        print(f"picture in {save(plot, picture)}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "one_way.png"))

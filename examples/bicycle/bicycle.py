"""The bicycle of ``bicycle.yml`` after a push to the side, from 4.6 m/s on.

python bicycle.py [picture.png]    # docs/pictures/bicycle.png; ten seconds once compiled

At this speed it stands by itself: the lean and steer that the push leaves die away.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

import maggi
from maggi.results.results import Results
from maggi.view.outlines import NOWHERE, outline_lines
from maggi.view.parts import RIGID_COLORS, draw_link
from maggi.view.projection import axonometric
from maggi.view.style import COLORS, FAINT, INK, new_figure, save, style

FOLDER = Path(__file__).parent
UP = np.array([0.0, 0.0, -1.0])  # z is down
INSTANTS = (0.0, 0.5, 1.0, 1.5)  # s


def lean(results: Results) -> np.ndarray:
    """Angle of the frame from the upright (n,), rad, positive to the right."""
    return np.arcsin(results.body("frame").rotation[:, 2, 1])


def steer(results: Results) -> np.ndarray:
    """Angle of the fork relative to the frame (n,), rad, positive to the right."""
    return results.joint("steering").coordinate[:, 0]


def draw(axes: Axes, results: Results) -> None:
    """The bicycle at some instants, and the tracks of its wheels."""
    camera = axonometric(azimuth=-72.0, elevation=16.0, vertical=UP)
    last = int(np.searchsorted(results.time, INSTANTS[-1] + 0.4))
    for name in ("rear", "front"):
        contact = results.body(f"{name}_wheel").origin * [1.0, 1.0, 0.0]
        flat = camera.flat(contact[:last])
        axes.plot(flat[:, 0], flat[:, 1], color=FAINT, linewidth=0.8)
    for t in INSTANTS:
        row = int(np.searchsorted(results.time, t))
        place = {name: results.body(name) for name in results.bodies}
        rear, head, front = (results.joint(name).position[row] for name in ("rear_hub", "steering", "front_hub"))
        rider = place["frame"].origin[row]
        for ends, color in (
            ((0.5 * (rear + head), rider), RIGID_COLORS[0]),
            ((rear, head), RIGID_COLORS[0]),
            ((head, front), RIGID_COLORS[1]),
        ):
            draw_link(axes, camera, np.stack(ends), np.eye(3), 1.0, color)
        for name in ("rear", "front"):
            wheel = place[f"{name}_wheel"]
            pose = wheel.origin[row], wheel.rotation[row]
            for line in outline_lines("rolling-disc", results.joint(f"{name}_contact").outline, NOWHERE, pose):
                flat = camera.flat(line)
                axes.plot(flat[:, 0], flat[:, 1], color=INK, linewidth=1.2, zorder=3.6)
        x, y = camera.flat(rear * [1.0, 1.0, 0.0])
        axes.annotate(f"{t:g} s", (x, y), xytext=(0, -14), textcoords="offset points", ha="center", fontsize=8)
        axes.scatter(*camera.flat(rider), s=90, facecolor=RIGID_COLORS[0], edgecolor=INK, zorder=3.5)
    axes.margins(0.03)
    axes.autoscale_view()
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.35)
    axes.set_aspect("equal")
    axes.set_axis_off()


def main(path: Path) -> None:
    """Run, and draw the motion beside lean and steer."""
    results = maggi.run(maggi.load(FOLDER / "bicycle.yml"))
    with style():
        figure = new_figure(9.0, 4.2, "Whipple bicycle, pushed to the right at 4.6 m/s")
        above, below = figure.subplots(2, 1, height_ratios=(1.15, 1.0))
        draw(above, results)
        for i, (name, angle) in enumerate((("lean", lean(results)), ("steer", steer(results)))):
            below.plot(results.time, np.degrees(angle), color=COLORS[i], label=name)
        below.axvspan(0.0, 0.1, color="#eceff2", zorder=0)
        below.annotate("push", (0.1, below.get_ylim()[1]), xytext=(4, -8), textcoords="offset points", fontsize=8)
        below.set_xlabel("time [s]")
        below.set_ylabel("angle [°], to the right")
        below.margins(x=0.0)
        below.legend(loc="upper right")
        save(figure, path)
    speed = results.body("rear_wheel").origin[:, 0]
    print(
        f"largest lean {np.degrees(np.abs(lean(results)).max()):.2f}°, steer {np.degrees(np.abs(steer(results)).max()):.2f}°"
    )
    print(
        f"after 5 s: lean {np.degrees(lean(results)[-1]):.3f}°, steer {np.degrees(steer(results)[-1]):.3f}°, {speed[-1]:.2f} m on"
    )


if __name__ == "__main__":
    default = FOLDER.parent.parent / "docs" / "pictures" / "bicycle.png"
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else default)

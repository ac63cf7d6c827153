"""Symbols of joints in a drawing, by kind."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path

from maggi.analyses.scene import SceneJoint
from maggi.model.joints import GROUND
from maggi.results.results import Array

from .outlines import COUPLERS
from .projection import Camera
from .style import INK, PAPER

AXIS_LENGTH = 0.11  # of the drawing's size
_RAIL = 0.032  # half the distance of the two rails of a slider
# Marker of a joint between two frames by its kind; all others are their outlines and a dot, relations a dashed line.
_MARKERS = {
    "revolute": "o",
    "prismatic": "",
    "cylindrical": "o",
    "screw": "o",
    "spherical": "o",
    "universal": "P",
    "constant-velocity": "P",
    "weld": "X",
    "planar": "s",
}
_SLIDING = ("prismatic", "cylindrical", "screw")
_FILLED = ("screw", "spherical", "constant-velocity", "weld")
_AXES_SHOWN = (*_MARKERS, "driver")

# Ground: a triangle that hangs from the joint on a hatched line. A driver: an arc with an arrow head.
_GROUND = Path(
    [(0, 0), (-0.6, -0.8), (0.6, -0.8), (0, 0), (-1, -0.8), (1, -0.8)]
    + [point for x in (-0.7, -0.2, 0.3, 0.8) for point in ((x, -0.8), (x - 0.25, -1.1))],
    [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.MOVETO, Path.LINETO] + [Path.MOVETO, Path.LINETO] * 4,
)
_ARC = Path.arc(-40.0, 220.0)
_DRIVER = Path.make_compound_path(
    _ARC, Path([(-0.93, -0.18), (-0.77, -0.64), (-0.47, -0.26)], [Path.MOVETO, Path.LINETO, Path.LINETO])
)


def draw_joint(axes: Axes, camera: Camera, joint: SceneJoint, size: float, color: str) -> None:
    """A joint's symbol: its marker, its axis where the view shows it, rails if it slides, and ground if it is there.

    size : the drawing's size, m.
    """
    if joint.kind in COUPLERS:
        return
    place = camera.flat(joint.position)
    x, y = float(place[0]), float(place[1])
    if GROUND in (joint.first, joint.second) and joint.kind in _MARKERS and joint.kind not in _SLIDING:
        draw_ground(axes, camera, joint.position)
    if joint.axis is not None and joint.kind in _AXES_SHOWN:
        _draw_axis(axes, place, camera.flat(joint.axis / np.linalg.norm(joint.axis)), joint.kind, size, color)
    if joint.kind == "driver":
        axes.scatter(x, y, s=230, marker=_DRIVER, facecolor="none", edgecolor=color, linewidth=1.5, zorder=5.1)
    elif joint.kind not in _MARKERS:
        axes.scatter(x, y, s=12, facecolor=color, edgecolor="none", zorder=5.0)
    elif _MARKERS[joint.kind]:
        fill = color if joint.kind in _FILLED else PAPER
        marker = _MARKERS[joint.kind]
        axes.scatter(x, y, s=34, marker=marker, facecolor=fill, edgecolor=color, linewidth=1.5, zorder=5.0)


def draw_ground(axes: Axes, camera: Camera, position: Array) -> None:
    """Ground below a point (3,)."""
    flat = camera.flat(position)
    axes.scatter(flat[0], flat[1], s=420, marker=_GROUND, facecolor="none", edgecolor=INK, linewidth=1.0, zorder=3.5)


def _draw_axis(axes: Axes, place: Array, direction: Array, kind: str, size: float, color: str) -> None:
    length = float(np.linalg.norm(direction))
    if length < 0.05:
        return  # it points at the viewer; the marker stands for it
    along = 0.5 * AXIS_LENGTH * size * direction
    if kind in _SLIDING:
        across = _RAIL * size * np.array([-direction[1], direction[0]]) / length
        for side in (across, -across):
            ends = np.stack([place + side - 1.4 * along, place + side + 1.4 * along])
            axes.plot(ends[:, 0], ends[:, 1], color=color, linewidth=1.6, zorder=4.8, solid_capstyle="round")
    else:
        ends = np.stack([place - along, place + along])
        dashes = (0, (7, 2, 1.5, 2))
        axes.plot(ends[:, 0], ends[:, 1], color=color, linewidth=1.1, linestyle=dashes, zorder=4.8)

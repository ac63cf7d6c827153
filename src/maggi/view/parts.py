"""The parts of a drawing of a mechanism: surfaces, links, points, axes, arrows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.text import OffsetFrom
from numpy.typing import NDArray

from .projection import Camera, surface
from .style import FAINT, INK, PAPER

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

LINK_WIDTH = 7.0  # points
RIGID_COLORS = ("#d3dbe2", "#ead9bf", "#d3e0c8", "#ddd2e4")
_GRAVITY = (0.93, 0.9)  # where its arrow starts, as fractions of the axes
GRAVITY_BOX = np.array([[[0.9, 0.55], [0.96, 0.93]]])  # what it covers
_AXIS_COLORS = ("#c0392b", "#1e8449", "#1f5fa8")


def prepare(axes: Axes, camera: Camera, low: Array, high: Array) -> None:
    """Equal scales and limits (2,) each with a margin; numbers only where the paper's axes are the global ones."""
    margin = 0.06 * float((high - low).max() or 1.0)
    axes.set_aspect("equal")
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    names = camera.axis_names()
    if names is None:
        axes.set_axis_off()
    else:
        axes.set_xlabel(f"{names[0]} [m]")
        axes.set_ylabel(f"{names[1]} [m]")
        axes.tick_params(labelsize=7.5)


def draw_surface(
    axes: Axes, camera: Camera, points: Array, triangles: IntArray, colors: Array, zorder: float = 2.0
) -> None:
    """A closed surface of points (n, 3) and triangles (t, 3) in colours (t, 3), shaded."""
    seen = surface(camera, points, triangles)
    is_line = seen.triangle < 0
    faces = np.empty((len(seen.corners), 4))
    faces[:, :3] = colors[seen.triangle] * seen.light[:, None]
    faces[:, 3] = 1.0
    borders = faces.copy()
    faces[is_line, 3] = 0.0
    borders[is_line] = (*to_rgb(INK), 0.75)
    # A border in the polygon's own colour closes the seams that smoothing leaves between neighbours.
    widths = np.where(is_line, 0.55, 0.5)
    axes.add_collection(
        PolyCollection(seen.corners, facecolors=faces, edgecolors=borders, linewidths=widths, zorder=zorder),
        autolim=False,
    )


def draw_beam(axes: Axes, camera: Camera, points: Array, cells: IntArray, colors: Array) -> None:
    """Beam cells (c, 2) between points (n, 3) as thick lines in colours (c, 3)."""
    lines = list(camera.flat(points[cells]))
    axes.add_collection(LineCollection(lines, colors=INK, linewidths=5.0, capstyle="round", zorder=2.0), autolim=False)
    axes.add_collection(
        LineCollection(lines, colors=colors, linewidths=3.6, capstyle="round", zorder=2.1), autolim=False
    )


def draw_link(axes: Axes, camera: Camera, points: Array, rotation: Array, size: float, color: str) -> None:
    """A rigid body as a link that joins its points (k, 3); a block in its axes `rotation` (3, 3) if they coincide.

    size : the drawing's size, m; the block is a small part of it.
    """
    hub = points.mean(axis=0)
    if np.abs(points - hub).max() < 1e-3 * size:
        _draw_block(axes, camera, hub, rotation, 0.024 * size, color)
        return
    spokes = [points] if len(points) == 2 else [np.stack([hub, point]) for point in points]
    lines = list(camera.flat(np.stack(spokes)))
    for width, ink, order in ((LINK_WIDTH, INK, 3.0), (LINK_WIDTH - 1.6, color, 3.1)):
        axes.add_collection(
            LineCollection(lines, colors=ink, linewidths=width, capstyle="round", zorder=order), autolim=False
        )


def draw_points(axes: Axes, camera: Camera, points: Array, size: float = 18.0) -> None:
    """Attachments: small white discs at points (k, 3)."""
    flat = camera.flat(points)
    axes.scatter(flat[:, 0], flat[:, 1], s=size, facecolor=PAPER, edgecolor=INK, linewidth=1.0, zorder=4.0)


def draw_paths(axes: Axes, camera: Camera, paths: Sequence[Array]) -> None:
    """Where points went, (n, 3) each: faint lines behind everything."""
    for path in paths:
        flat = camera.flat(path)
        axes.plot(flat[:, 0], flat[:, 1], color=FAINT, linewidth=0.7, alpha=0.8, zorder=1.0)


def draw_triad(axes: Axes, camera: Camera) -> None:
    """The global axes' directions, in the lower left corner, where the paper's axes do not show them."""
    if camera.axis_names() is not None:
        return
    _corner_arrows(axes, camera, (0.075, 0.12), dict(zip("xyz", np.eye(3), strict=True)), _AXIS_COLORS)


def draw_gravity(axes: Axes, camera: Camera, gravity: Array) -> None:
    """An arrow along gravity (3,), in the upper right corner; none without gravity."""
    strength = float(np.linalg.norm(gravity))
    if strength > 0.0:
        _corner_arrows(axes, camera, _GRAVITY, {"g": gravity / strength}, (INK,))


def _corner_arrows(
    axes: Axes, camera: Camera, place: tuple[float, float], arrows: Mapping[str, Array], colors: Sequence[str]
) -> None:
    for (name, direction), color in zip(arrows.items(), colors, strict=True):
        step = 24.0 * camera.flat(direction)
        if np.linalg.norm(step) < 4.0:
            continue  # it points at the viewer
        origin = OffsetFrom(axes, place)
        arrow = {"arrowstyle": "-|>", "color": color, "linewidth": 1.3, "shrinkA": 0, "shrinkB": 0}
        axes.annotate(
            "", tuple(step), xytext=(0.0, 0.0), xycoords=origin, textcoords=origin, arrowprops=arrow, zorder=6.0
        )
        style: dict[str, Any] = {
            "color": color,
            "fontsize": 8,
            "fontweight": "bold",
            "ha": "center",
            "va": "center",
            "zorder": 6.0,
        }
        axes.annotate(name, tuple(1.35 * step), xycoords=origin, **style)


def _draw_block(axes: Axes, camera: Camera, centre: Array, rotation: Array, half: float, color: str) -> None:
    signs = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
    points = centre + (half * signs) @ rotation.T
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    draw_surface(axes, camera, points, triangles, np.tile(to_rgb(color), (len(triangles), 1)), zorder=3.0)

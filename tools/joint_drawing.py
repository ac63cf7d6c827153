"""What the pictures of joints are drawn with: bars, wheels, boxes, balls, paths and labels on one sheet of paper."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from maggi.view.joint_symbols import draw_ground
from maggi.view.parts import RIGID_COLORS, draw_gravity, draw_surface, draw_triad
from maggi.view.projection import Camera
from maggi.view.style import COLORS, INK, PAPER

Array = NDArray[np.float64]
Color = str | tuple[float, float, float]

WIDTH, HIGHEST = 4.8, 3.3  # inches
DOTS_PER_INCH = 100
SHADES = 64  # of a picture's palette, which keeps it small
JOINT = "#a93226"
PATH = COLORS[0]
STEEL, SAND, GREEN, VIOLET = RIGID_COLORS
_AROUND = 60
X, Y, Z = np.eye(3)


def pale(color: Color, share: float) -> Color:
    """A colour mixed with the paper's; share 0: as it is, 1: paper."""
    mixed = (1.0 - share) * np.array(to_rgb(color)) + share * np.array(to_rgb(PAPER))
    return float(mixed[0]), float(mixed[1]), float(mixed[2])


def new_figure(height: float = HIGHEST) -> Figure:
    """An empty figure as wide as all of them."""
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def save(figure: Figure, path: Path) -> None:
    """Write a PNG file with a small palette."""
    figure.savefig(path, dpi=DOTS_PER_INCH, metadata={"Software": "maggi"})
    with Image.open(path) as image:
        image.convert("RGB").quantize(SHADES, dither=Image.Dither.NONE).save(path, optimize=True)


class Sheet:
    """A panel of a figure seen by a camera; what is drawn later covers what was drawn before."""

    def __init__(self, axes: Axes, camera: Camera, pale_by: float = 0.0) -> None:
        self.axes, self.camera = axes, camera
        self.pale_by = pale_by  # of everything drawn from now on
        self._low, self._high = np.full(2, np.inf), np.full(2, -np.inf)
        self._order = 2.0
        axes.set_aspect("equal")
        axes.set_axis_off()

    def line(self, points: ArrayLike, color: Color = INK, width: float = 1.3, dashed: bool = False) -> None:
        """A line through points (n, 3)."""
        flat = self._flat(points)
        style = (0, (5, 3)) if dashed else "-"
        self.axes.plot(
            flat[:, 0], flat[:, 1], color=pale(color, self.pale_by), linewidth=width, linestyle=style,
            zorder=self._next(), solid_capstyle="round",
        )  # fmt: skip

    def bar(self, points: ArrayLike, color: Color = STEEL, width: float = 6.5) -> None:
        """A link through points (n, 3), with a dark border; width in points of print."""
        self.line(points, INK, width)
        self.line(points, color, width - 1.6)

    def area(self, points: ArrayLike, color: Color, edge: Color | None = INK) -> None:
        """A filled polygon with corners (n, 3)."""
        flat = self._flat(points)
        border = "none" if edge is None else pale(edge, self.pale_by)
        self.axes.add_patch(
            Polygon(flat, facecolor=pale(color, self.pale_by), edgecolor=border, linewidth=1.0, zorder=self._next())
        )

    def circle(self, centre: ArrayLike, axis: ArrayLike, radius: float, color: Color = INK, width: float = 1.3) -> None:
        """A circle about an axis."""
        self.line(circle(centre, axis, radius), color, width)

    def cylinder(
        self, centre: ArrayLike, axis: ArrayLike, radius: float, length: float, color: Color = STEEL, hole: float = 0.0
    ) -> None:
        """A shaded cylinder, or a tube."""
        along = 0.5 * length * np.asarray(axis) / np.linalg.norm(axis)
        low, high = (circle(np.asarray(centre) + side * along, axis, radius)[:-1] for side in (-1, 1))
        if hole:
            low_in, high_in = (circle(np.asarray(centre) + side * along, axis, hole)[:-1] for side in (-1, 1))
            rings = [low, high, high_in, low_in]
        else:
            rings = [
                np.tile(np.asarray(centre) - along, (_AROUND, 1)),
                low,
                high,
                np.tile(centre + along, (_AROUND, 1)),
            ]
        closed = rings + rings[:1] if hole else rings
        self._surface(np.stack(closed), color)

    def ball(self, centre: ArrayLike, radius: float, color: Color = STEEL) -> None:
        """A shaded ball."""
        heights = np.linspace(-1.0, 1.0, 25)
        rings = [
            circle(
                np.asarray(centre) + radius * np.sin(0.5 * np.pi * h) * Z,
                Z,
                max(radius * np.cos(0.5 * np.pi * h), 1e-9 * radius),
            )[:-1]
            for h in heights
        ]
        self._surface(np.stack(rings), color)
        self.circle(centre, self.camera.toward, radius, INK, 0.8)

    def box(self, centre: ArrayLike, rotation: Array, size: Sequence[float], color: Color = STEEL) -> None:
        """A shaded box with edges of the given lengths along its axes, the columns of `rotation`."""
        signs = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
        points = np.asarray(centre) + (0.5 * np.asarray(size) * signs) @ rotation.T
        quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        self._triangles(points, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]), color)

    def dots(self, points: ArrayLike, color: Color = JOINT, size: float = 22.0, filled: bool = False) -> None:
        """Small discs at points (n, 3): joints."""
        flat = self._flat(np.atleast_2d(points))
        edge = pale(color, self.pale_by)
        face = edge if filled else PAPER
        self.axes.scatter(
            flat[:, 0], flat[:, 1], s=size, facecolor=face, edgecolor=edge, linewidth=1.4, zorder=self._next()
        )

    def path(self, points: ArrayLike, arrow: bool = True, color: Color = PATH) -> None:
        """Where a point went (n, 3), with an arrow head at the end."""
        flat = self._flat(points)
        self.axes.plot(flat[:, 0], flat[:, 1], color=color, linewidth=1.2, zorder=self._next())
        if arrow:
            self._head(flat, color)

    def arrow(self, points: ArrayLike, color: Color = INK, width: float = 1.2) -> None:
        """An arrow along points (n, 3)."""
        self.line(points, color, width)
        self._head(self._flat(points), color)

    def ground(self, point: ArrayLike) -> None:
        """The symbol of ground below a point."""
        draw_ground(self.axes, self.camera, np.asarray(point))

    def label(self, point: ArrayLike, text: str, right: float = 0.0, up: float = 0.0, color: Color = INK) -> None:
        """A text beside a point, moved by so many points of print."""
        flat = self.camera.flat(np.asarray(point, dtype=float))
        self.axes.annotate(
            text, (float(flat[0]), float(flat[1])), xytext=(right, up), textcoords="offset points", ha="center",
            va="center", fontsize=8.5, color=color, zorder=100.0,
        )  # fmt: skip

    def triad(self, gravity: Array | None = None) -> None:
        """The global axes in the lower left corner, and gravity in the upper right one."""
        draw_triad(self.axes, self.camera)
        if gravity is not None:
            draw_gravity(self.axes, self.camera, gravity)

    def room(self, points: ArrayLike) -> None:
        """Keep points (n, 3) in the picture, for labels."""
        self._flat(points)

    def finish(self, margin: float = 0.04, fit: bool = True) -> None:
        """Set the limits to what was drawn; with `fit` also the figure's height, for a figure of this panel alone."""
        size = self._high - self._low
        edge = margin * float(size.max())
        self.axes.set_xlim(self._low[0] - edge, self._high[0] + edge)
        self.axes.set_ylim(self._low[1] - edge, self._high[1] + edge)
        figure = self.axes.get_figure(root=True)
        if fit and figure is not None:
            height = WIDTH * float((size[1] + 2 * edge) / (size[0] + 2 * edge)) + 0.08
            figure.set_size_inches(WIDTH, min(height, HIGHEST))

    def _surface(self, rings: Array, color: Color) -> None:
        """Between rings (r, n, 3), one after the other, seen from outside."""
        r, n, _ = rings.shape
        place = np.arange(r * n).reshape(r, n)
        a, b = place[:-1], place[1:]
        c, d = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)
        triangles = np.concatenate([np.stack([a, c, d], axis=-1), np.stack([a, d, b], axis=-1)]).reshape(-1, 3)
        points = rings.reshape(-1, 3)
        # a ring that is one point: its copies become one, and triangles between them nothing
        size = float(np.ptp(points, axis=0).max())
        _, first, same = np.unique(np.round(points / size, 9), axis=0, return_index=True, return_inverse=True)
        triangles = same.reshape(-1)[triangles]
        solid = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
        self._triangles(points[first], triangles[solid], color)

    def _triangles(self, points: Array, triangles: NDArray[np.int64], color: Color) -> None:
        self._flat(points)
        colors = np.tile(to_rgb(pale(color, self.pale_by)), (len(triangles), 1))
        draw_surface(self.axes, self.camera, points, triangles, colors, zorder=self._next())

    def _head(self, flat: Array, color: Color) -> None:
        way = np.linalg.norm(np.diff(flat, axis=0), axis=1)[::-1].cumsum()
        back = int(np.searchsorted(way, 0.02 * max(float(np.ptp(flat, axis=0).max()), 1e-12))) + 2
        start = flat[max(len(flat) - back, 0)]
        self.axes.annotate(
            "", tuple(flat[-1]), xytext=tuple(start), zorder=self._next(),
            arrowprops={"arrowstyle": "-|>", "color": color, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip

    def _flat(self, points: ArrayLike) -> Array:
        flat = self.camera.flat(np.asarray(points, dtype=float))
        self._low = np.minimum(self._low, flat.reshape(-1, 2).min(axis=0))
        self._high = np.maximum(self._high, flat.reshape(-1, 2).max(axis=0))
        return flat

    def _next(self) -> float:
        self._order += 0.01
        return self._order


def circle(centre: ArrayLike, axis: ArrayLike, radius: float) -> Array:
    """Points (n, 3) of a circle, the last the first again, right-handed about its axis."""
    z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    x = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    angles = np.linspace(0.0, 2.0 * np.pi, _AROUND + 1)
    return np.asarray(centre + radius * (np.outer(np.cos(angles), x) + np.outer(np.sin(angles), np.cross(z, x))))


def gear_wheel(radius: float, teeth: int, inside: bool = False) -> Array:
    """The outline (n, 3) of a gear wheel in its x-z plane, a tooth on the x axis; of a ring gear a gap."""
    tooth = 2.0 * np.pi * radius / teeth
    high, low = radius + 0.28 * tooth, radius - 0.34 * tooth
    if inside:
        high, low = radius + 0.34 * tooth, radius - 0.28 * tooth
    steps = np.array([-0.29, -0.11, 0.11, 0.29]) * 2.0 * np.pi / teeth
    radii = np.array([low, high, high, low])
    angles = (2.0 * np.pi / teeth * np.arange(teeth)[:, None] + steps).ravel()
    reach = np.tile(radii, teeth)
    return np.column_stack([reach * np.cos(angles), 0.0 * angles, reach * np.sin(angles)])

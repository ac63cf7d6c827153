"""The mechanism at several instants of a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from maggi.results.extremes import deflection_history, elastic_bodies
from maggi.results.results import Array, Results

from .body_shape import BodyShape, body_shape, exaggeration, frame
from .instants import different_instants, distinct, distinct_points
from .outlines import COUPLERS, NOWHERE, ROLLING, bodies_at, coupled, draw_coupling, draw_outlines, outline_lines
from .parts import RIGID_COLORS, draw_beam, draw_link, draw_paths, draw_points, draw_surface, draw_triad, prepare
from .projection import Camera, axonometric, facing, plane_of, upwards
from .series import readable
from .style import new_figure

INSTANTS = 4
WIDTH = 10.6  # inches
_ROWS_LOOKED_AT = 400
_COLOR_MAP = "viridis"
_FAR = 6.0  # a way this long, relative to the mechanism's size, is not shown whole
_TIP = 0.03  # where a body turns without its points moving, how far out that is seen, relative to the drawing
_NEAR = 0.01  # points of a body this close to each other, relative to the drawing, are one


def mechanism_figure(results: Results) -> Figure | None:
    """Up to four instants, as different from each other as the run has them; None if positions were not kept."""
    if not (len(results.time) and results.bodies and results.has(f"bodies/{results.bodies[0]}/origin")):
        return None
    step = max(1, len(results.time) // _ROWS_LOOKED_AT)
    points = _points(results, step)
    middle = points.mean(axis=1) if _travels(results, points) else np.zeros((len(points), 3))
    points = points - middle[:, None]
    bent = _most_bent(results, step)
    chosen = different_instants(points, INSTANTS, bent)
    if len(chosen) < INSTANTS:  # no point moves
        tips = _tips(results, step, float(np.ptp(points.reshape(-1, 3), axis=0).max()))
        chosen = different_instants(np.concatenate([points, tips], axis=1), INSTANTS, bent)
    rows = chosen * step
    shapes = tuple(body_shape(results, name) for name in elastic_bodies(results))
    factor = exaggeration(shapes, rows)
    camera = camera_for(points, upwards(results.gravity))
    instants = [
        _Instant(
            results,
            int(row),
            {shape: shape.drawn(int(row), factor) for shape in shapes},
            _outlines(results, int(row)),
            camera.flat(middle[place]),
        )
        for place, row in zip(chosen, rows, strict=True)
    ]
    scale = Normalize(0.0, max((float(size.max()) for one in instants for _, size in one.drawn.values()), default=1.0))
    flat = np.concatenate([camera.flat(points).reshape(-1, 2), *(one.flat(camera) for one in instants)])
    low, high = flat.min(axis=0), flat.max(axis=0)
    if (high == low).all():  # one point that stays where it is
        low, high = low - 0.5, high + 0.5
    paths = distinct([*_paths(results, step), *(results.body(name).origin[::step] for name in _bare(results))])

    width, height = np.maximum(high - low, 0.05 * float((high - low).max()))
    columns = len(rows) if width < 0.7 * height else min(2, len(rows))
    lines = -(-len(rows) // columns)
    inches = lines * (0.92 * WIDTH / columns * float(height / width) + 0.6) + 0.5
    title = results.title or results.name
    if shapes:
        title += f" — elastic displacement drawn ×{factor:g}"
    if middle.any():
        title += " — the view goes along"
    figure = new_figure(WIDTH, min(max(inches, 3.0), 13.0), title)
    still = not middle.any()
    grid = figure.subplots(lines, columns, squeeze=False, sharex=still, sharey=still).ravel()
    for axes in grid[len(rows) :]:
        axes.set_axis_off()
    factor_t, unit_t = readable("s", results.time)
    for axes, instant in zip(grid, instants, strict=False):
        prepare(axes, camera, low + instant.middle, high + instant.middle)
        axes.set_title(f"t = {results.time[instant.row] * factor_t:.4g} {unit_t}")
        draw_paths(axes, camera, paths)
        instant.draw(axes, camera, scale, float((high - low).max()))
        draw_triad(axes, camera)
        if still:
            axes.label_outer()
    if shapes:
        _color_bar(figure, list(grid), scale, shapes)
    return figure


def camera_for(points: Array, up: Array) -> Camera:
    """In the plane of the motion if there is one, else from above one corner; points (n, k, 3), up: a global axis."""
    normal = plane_of((points - points[:1]).reshape(-1, 3))
    return axonometric(vertical=up) if normal is None else facing(normal, up)


@dataclass(frozen=True, eq=False)
class _Instant:
    """A row of the results, its elastic bodies and its joints' lines, ready to be drawn; middle: on paper (2,)."""

    results: Results
    row: int
    drawn: dict[BodyShape, tuple[Array, Array]]
    outlines: list[Array]
    middle: Array

    def flat(self, camera: Camera) -> Array:
        """On paper, from the middle, everything that has to be in the picture (n, 2)."""
        points = [*(nodes for nodes, _ in self.drawn.values()), *self.outlines]
        return np.concatenate([np.zeros((0, 2)), *(camera.flat(part) - self.middle for part in points)])

    def draw(self, axes: Axes, camera: Camera, scale: Normalize, size: float) -> None:
        color_map = colormaps[_COLOR_MAP]
        for shape, (nodes, displacement) in self.drawn.items():
            if len(shape.triangles):
                colors = color_map(scale(displacement[shape.triangles].mean(axis=1)))[:, :3]
                draw_surface(axes, camera, nodes, shape.triangles, colors)
            if len(shape.beams):
                colors = color_map(scale(displacement[shape.beams].mean(axis=1)))[:, :3]
                draw_beam(axes, camera, nodes, shape.beams, colors)
        elastic = {shape.name for shape in self.drawn}
        for i, name in enumerate(name for name in self.results.bodies if name not in elastic):
            origin, rotation = frame(self.results, name, self.row)
            points = distinct_points([*self._joined(name), *self._attached(name)], _NEAR * size)
            if len(points) < 2:
                points = distinct_points([*points, origin], _NEAR * size)
            if len(points) > 1 or name not in self._wheels():
                draw_link(axes, camera, np.stack(points), rotation, size, RIGID_COLORS[i % len(RIGID_COLORS)])
        draw_outlines(axes, camera, self.outlines)
        for joint in map(self.results.joint, self.results.joints):
            places = coupled(*joint.ends) if joint.kind in COUPLERS else []
            paths = [f"joints/{place}/position" for place in places]
            if paths and all(map(self.results.has, paths)):
                draw_coupling(axes, camera, [self.results.frames(path)[self.row] for path in paths])
        marks = [point for name in self.results.bodies for point in self._attached(name)]
        if marks:
            draw_points(axes, camera, np.stack(marks))

    def _wheels(self) -> set[str]:
        joints = map(self.results.joint, self.results.joints)
        return {joint.ends[1].partition(".")[0] for joint in joints if joint.kind in ROLLING}

    def _joined(self, name: str) -> list[Array]:
        """Points of the joints that hold a body, and the first ends of its rods."""
        points = []
        for joint in map(self.results.joint, self.results.joints):
            path = f"joints/{joint.name}/position"
            if name in bodies_at(joint.kind, *joint.ends) and self.results.has(path):
                points.append(self.results.frames(path)[self.row])
            if joint.kind == "distance" and name == joint.ends[0].partition(".")[0]:
                origin, rotation = frame(self.results, name, self.row)
                points += list(origin + joint.outline.first @ rotation.T)
        return points

    def _attached(self, name: str) -> list[Array]:
        return [self.results.frames(path)[self.row] for path in _position_paths(self.results, name)]


def _outlines(results: Results, row: int) -> list[Array]:
    """The lines of all joints at a row."""
    lines = []
    for joint in map(results.joint, results.joints):
        bodies = (end.partition(".")[0] for end in joint.ends)
        ends = (frame(results, name, row) if name in results.bodies else NOWHERE for name in bodies)
        lines += outline_lines(joint.kind, joint.outline, *ends)
    return lines


def _travels(results: Results, points: Array) -> bool:
    """Whether a mechanism of several bodies goes so far that it would be small in a picture of its whole way."""
    way = float(np.ptp(points.mean(axis=1), axis=0).max())
    return len(results.bodies) > 1 and way > _FAR * float(np.ptp(points, axis=1).max())


def _color_bar(figure: Figure, panels: list[Axes], scale: Normalize, shapes: tuple[BodyShape, ...]) -> None:
    largest = float(scale.vmax or 0.0)
    factor, unit = readable("m", np.array([largest]))
    bar = figure.colorbar(
        ScalarMappable(Normalize(0.0, largest * factor), _COLOR_MAP), ax=panels, shrink=0.8, aspect=28, pad=0.015
    )
    lined = all(shape.line is not None for shape in shapes)
    bar.set_label(f"displacement from the line between its ends [{unit}]" if lined else f"displacement [{unit}]")


def _most_bent(results: Results, step: int) -> int:
    """The row, of every `step`-th, at which an elastic body is bent most."""
    best, place = 0.0, 0
    for name in elastic_bodies(results):
        history = deflection_history(results, name, step)
        bent = history.displacement if history.deflection is None else history.deflection
        if bent.max() > best:
            best, place = float(bent.max()), int(np.argmax(bent))
    return place


def _points(results: Results, step: int) -> Array:
    """Origins and attachments of every `step`-th row, (m, k, 3)."""
    origins = [results.body(name).origin[::step] for name in results.bodies]
    return np.stack([*origins, *_paths(results, step)], axis=1)


def _bare(results: Results) -> list[str]:
    """Bodies without attachments whose positions were kept."""
    return [name for name in results.bodies if not _position_paths(results, name)]


def _tips(results: Results, step: int, size: float) -> Array:
    """The ends of axes of bodies without attachments (m, k, 3), relative to their origins: turning is motion too."""
    axes = [_TIP * (size or 1.0) * results.body(name).rotation[::step].swapaxes(1, 2) for name in _bare(results)]
    return np.concatenate([np.zeros((len(results.time[::step]), 0, 3)), *axes], axis=1)


def _paths(results: Results, step: int) -> list[Array]:
    return [results.series(path)[::step] for name in results.bodies for path in _position_paths(results, name)]


def _position_paths(results: Results, name: str) -> list[str]:
    paths = [f"bodies/{name}/attachments/{at}/position" for at in results.body(name).attachments]
    return [path for path in paths if results.has(path)]

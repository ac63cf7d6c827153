"""Positions of attachments, speeds, and joint coordinates over time."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from maggi.results.contract import AXES
from maggi.results.results import Array, Results

from .charts import draw_lines, moving, stacked

MOST_POINTS = 8
MOST_COORDINATES = 6


def motion_figure(results: Results) -> Figure | None:
    """Moving components of the attachments' positions, their speeds, joint coordinates; None if none were kept."""
    if not len(results.time):
        return None
    positions = _distinct(_positions(results))
    size = max((float(np.ptp(values, axis=0).max()) for values in positions.values()), default=0.0)
    charts: list[tuple[dict[str, Array], str, str, str]] = []
    for i, axis in enumerate(AXES):
        lines = {name: values[:, i] for name, values in positions.items()}
        if any(moving(values, 1e3 * size) for values in lines.values()):
            charts.append((lines, "m", axis, f"Attachments, {axis}"))
    speeds = {name: np.linalg.norm(_velocity(results, name), axis=1) for name in positions}
    if any(values.max() > 0.0 for values in speeds.values()):
        charts.append((speeds, "m/s", "|v|", "Attachments, speed"))
    coordinates = list(_coordinates(results).items())[:MOST_COORDINATES]
    for name, (values, unit) in coordinates:
        letter, what = ("s", "Displacement") if unit == "m" else ("φ", "Angle")
        charts.append(({name: values}, unit, letter, f"{what} of {name}"))
    if not charts:
        return None
    heights = [1.7] * (len(charts) - len(coordinates)) + [1.1] * len(coordinates)
    figure, panels = stacked(results, heights, "motion")
    for axes, (lines, unit, what, title) in zip(panels, charts, strict=True):
        draw_lines(axes, results, lines, unit, what)
        axes.set_title(title)
    return figure


def _positions(results: Results) -> dict[str, Array]:
    return {
        f"{name}.{at}": results.body(name).attachment(at).position
        for name in results.bodies
        for at in results.body(name).attachments
        if results.has(f"bodies/{name}/attachments/{at}/position")
    }


def _distinct(positions: dict[str, Array]) -> dict[str, Array]:
    """One of each group of attachments that a joint keeps together, and no more than a chart can show."""
    size = max((float(np.abs(values).max()) for values in positions.values()), default=0.0)
    kept: dict[str, Array] = {}
    for name, values in positions.items():
        if len(kept) < MOST_POINTS and all(np.abs(values - other).max() > 1e-6 * size for other in kept.values()):
            kept[name] = values
    return kept


def _without_repeats(named: dict[str, tuple[Array, str]]) -> dict[str, tuple[Array, str]]:
    """A driver has the coordinate of its joint: one of the two is enough."""
    kept: dict[str, tuple[Array, str]] = {}
    for name, (values, unit) in named.items():
        if not any(np.array_equal(values, other) for other, _ in kept.values()):
            kept[name] = values, unit
    return kept


def _velocity(results: Results, name: str) -> Array:
    body, _, attachment = name.rpartition(".")
    return results.body(body).attachment(attachment).velocity


def _coordinates(results: Results) -> dict[str, tuple[Array, str]]:
    """Coordinates that move, each with its unit, by joint."""
    named: dict[str, tuple[Array, str]] = {}
    for name in results.joints:
        joint = results.joint(name)
        for k, (values, unit) in enumerate(zip(joint.coordinate.T, joint.units, strict=False)):
            if moving(values, 1.0):
                named[name if len(joint.units) == 1 else f"{name} ({k + 1})"] = values, unit
    return _without_repeats(named)

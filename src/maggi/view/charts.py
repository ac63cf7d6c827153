"""What the charts over time have in common."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from maggi.results.results import Array, Results

from .series import readable, thin
from .style import legend_beside, line_style, new_figure, plain

WIDTH = 10.0  # inches


def stacked(results: Results, heights: list[float], what: str) -> tuple[Figure, list[Axes]]:
    """A figure of charts one above the other on one time axis; heights in inches."""
    figure = new_figure(WIDTH, sum(heights) + 0.8, f"{results.title or results.name} — {what}")
    grid = figure.subplots(len(heights), 1, squeeze=False, sharex=True, height_ratios=heights)
    panels = list(grid[:, 0])
    _, unit = readable("s", results.time)
    panels[-1].set_xlabel(f"time [{unit}]")
    return figure, panels


def draw_lines(
    axes: Axes, results: Results, lines: Mapping[str, Array], unit: str, what: str, order: tuple[str, ...] = ()
) -> None:
    """Lines (n,) each by name, in a unit that reads well, with a legend beside them if there are several.

    order : names that fix the lines' colours, where charts of the same lines should agree; by default their own.
    """
    time = results.time * readable("s", results.time)[0]
    factor, shown = readable(unit, *lines.values())
    places = {name: i for i, name in enumerate(order or lines)}
    for name, values in lines.items():
        axes.plot(*thin(time, values * factor), label=plain(name), **line_style(places[name]))
    axes.set_ylabel(f"{what} [{shown}]" if shown != "1" else what)
    axes.margins(x=0.0)
    _leave_noise_flat(axes, [values * factor for values in lines.values()])
    if len(lines) > 1:
        legend_beside(axes)


def moving(values: Array, size: float) -> bool:
    """Whether a series changes by more than noise, compared with the size of its like."""
    return bool(np.ptp(values) > 1e-9 * size) if len(values) else False


def _leave_noise_flat(axes: Axes, lines: list[Array]) -> None:
    """Keep lines that are constant but for round-off from being magnified into something."""
    low, high = min(float(line.min()) for line in lines), max(float(line.max()) for line in lines)
    size = max(abs(low), abs(high))
    if high - low < 1e-9 * size:
        axes.set_ylim(low - 0.5 * size, high + 0.5 * size)

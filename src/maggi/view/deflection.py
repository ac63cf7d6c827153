"""Elastic displacement and deflection over time."""

from __future__ import annotations

from matplotlib.figure import Figure

from maggi.results.extremes import DeflectionHistory, deflection_history, elastic_bodies
from maggi.results.results import Array, Results

from .charts import WIDTH
from .series import readable, thin
from .style import legend_beside, line_style, new_figure, plain

MOST_ROWS = 4000
MOST_BODIES = 8


def deflection_figure(results: Results) -> Figure | None:
    """The largest displacement and deflection of each elastic body; None if there is no such body.

    Of a long run about 4000 rows are looked at, for nodal displacements can be many.
    """
    names = elastic_bodies(results)[:MOST_BODIES]
    if not names or not len(results.time):
        return None
    step = -(-len(results.time) // MOST_ROWS)
    figure = new_figure(WIDTH, 2.4 * len(names) + 0.8, f"{results.title or results.name} — elastic deflection")
    grid = figure.subplots(len(names), 1, squeeze=False, sharex=True)[:, 0]
    factor_t, unit_t = readable("s", results.time)
    for axes, name in zip(grid, names, strict=True):
        history = deflection_history(results, name, step)
        lines = _lines(history)
        factor, unit = readable("m", *lines.values())
        for i, (text, values) in enumerate(lines.items()):
            axes.plot(*thin(history.time * factor_t, values * factor), label=text, **line_style(i))
        axes.set_title(plain(name))
        axes.set_ylabel(f"largest over the nodes [{unit}]")
        axes.set_ylim(bottom=0.0)
        axes.margins(x=0.0)
        legend_beside(axes)
    grid[-1].set_xlabel(f"time [{unit_t}]")
    return figure


def _lines(history: DeflectionHistory) -> dict[str, Array]:
    lines = {"displacement,\nbody frame": history.displacement}
    if history.ends is not None and history.deflection is not None:
        first, second = (plain(end) for end in history.ends)
        lines[f"deflection from the line\n{first} – {second}"] = history.deflection
    return lines

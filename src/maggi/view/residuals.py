"""Residuals of the liaisons and iterations over time."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from maggi.results.contract import RESIDUALS
from maggi.results.results import Results

from .charts import stacked
from .series import readable, thin
from .style import FAINT, legend_beside, line_style

ACCEPTED = 1e-9
_FLOOR = 1e-18  # stands for an exact zero on the logarithmic scale


def residuals_figure(results: Results) -> Figure | None:
    """Residuals at the three levels, on a logarithmic scale, and iterations; None if they were not kept."""
    if not (len(results.time) and results.has("residuals/position")):
        return None
    figure, (upper, lower) = stacked(results, [2.8, 1.0], "residuals of the liaisons")
    time = results.time * readable("s", results.time)[0]
    for i, name in enumerate(RESIDUALS):
        values = np.maximum(np.abs(results.series(f"residuals/{name}")), _FLOOR)
        upper.plot(*thin(time, values), label=f"{name}: at most {values.max():.1e}", **line_style(i))
    upper.axhline(ACCEPTED, color=FAINT, linewidth=0.9, linestyle=":")
    upper.set_yscale("log")
    upper.set_ylabel("residual, scaled")
    upper.set_title("Largest residual at each level, scaled by the mechanism's size and speed (dotted: 1e-9)")
    legend_beside(upper)
    lower.plot(*thin(time, results.iterations.astype(float)), drawstyle="steps-pre", **line_style(0))
    lower.set_ylim(bottom=0.0)
    lower.set_ylabel("iterations")
    lower.set_title("Iterations of the last step")
    lower.margins(x=0.0)
    return figure

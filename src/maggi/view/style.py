"""The look that all pictures share."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

INK = "#22303c"
FAINT = "#8a97a3"
PAPER = "#ffffff"
# Told apart by most colour-blind readers (after Okabe and Ito, darkened for lines on white).
COLORS = ("#0072b2", "#d55e00", "#009e73", "#b5478c", "#c79a00", "#3aa7dd", "#6b4fa0", "#7a7a7a")
DASHES = ("-", "--", ":", "-.")
DOTS_PER_INCH = 150

_SETTINGS: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.limits": (-4, 5),
    "axes.formatter.useoffset": False,
    "grid.color": "#e3e8ec",
    "grid.linewidth": 0.7,
    "xtick.color": INK,
    "ytick.color": INK,
    "text.color": INK,
    "lines.linewidth": 1.3,
    "lines.solid_joinstyle": "round",
    "agg.path.chunksize": 20000,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "figure.facecolor": PAPER,
    "savefig.facecolor": PAPER,
}


@contextmanager
def style() -> Iterator[None]:
    """The settings of matplotlib under which every picture is made."""
    with mpl.rc_context(_SETTINGS):
        yield


def new_figure(width: float, height: float, title: str) -> Figure:
    """An empty figure (inches) on the Agg canvas: no pyplot, no window, no state shared with the caller."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    if title:
        figure.suptitle(plain(title), x=0.01, ha="left", fontsize=11, fontweight="bold")
    return figure


def save(figure: Figure, path: Path) -> Path:
    """Write a PNG file."""
    figure.savefig(path, dpi=DOTS_PER_INCH, metadata={"Software": "maggi"})
    return path


def line_style(i: int) -> dict[str, Any]:
    """Colour and dashes of the i-th line of a chart."""
    return {"color": COLORS[i % len(COLORS)], "linestyle": DASHES[i // len(COLORS) % len(DASHES)]}


def legend_beside(axes: Axes) -> None:
    """A legend to the right of a chart, if it has any lines."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        axes.legend(handles, labels, loc="upper left", bbox_to_anchor=(1.01, 1.02), borderaxespad=0.0, handlelength=1.6)


def plain(text: str) -> str:
    """A user's name or title as it is: matplotlib would take dollar signs for mathematics."""
    return text.replace("$", r"\$")

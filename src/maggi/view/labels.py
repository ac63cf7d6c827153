"""Labels that keep out of each other's way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from maggi.results.results import Array

from .projection import Camera
from .style import INK, PAPER

_FONT = 7.8  # points
_LETTER = 0.62 * _FONT  # mean width
_DISTANCES = (16.0, 30.0, 48.0, 70.0)  # of a label from its point, in points
_DIRECTIONS = tuple(np.array([np.cos(a), np.sin(a)]) for a in np.radians(np.arange(90, 450, 30)))


@dataclass
class Label:
    """A label of one or more lines at a point (3,), global."""

    point: Array
    lines: list[str]
    color: str = INK
    bold: bool = False


def place_labels(axes: Axes, camera: Camera, labels: list[Label], clear: Array) -> None:
    """Write the labels beside their points, each where it covers no other label and as few points as possible.

    clear : (k, 2, 2) lowest and highest corners of what else is to be kept clear, as fractions of the axes. The axes must have their limits; the figure is laid out first, since distances are on paper.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()
    flat = np.stack([camera.flat(label.point) for label in labels]) if labels else np.zeros((0, 2))
    to_points = 72.0 / figure.dpi
    anchors = axes.transData.transform(flat) * to_points
    frame = axes.get_window_extent().get_points() * to_points
    taken: list[Array] = list(frame[0] + clear * (frame[1] - frame[0]))
    for label, anchor in zip(labels, anchors, strict=True):
        half = 0.5 * np.array([max(map(len, label.lines)) * _LETTER, len(label.lines) * 1.25 * _FONT]) + 2.0
        offset, box = min(
            (_candidate(anchor, half, direction, distance) for distance in _DISTANCES for direction in _DIRECTIONS),
            key=lambda candidate: _cost(candidate[1], candidate[0], taken, anchors, frame),
        )
        taken.append(box)
        axes.annotate(
            "\n".join(label.lines),
            (float(camera.flat(label.point)[0]), float(camera.flat(label.point)[1])),
            xytext=(float(offset[0]), float(offset[1])),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=_FONT,
            fontweight="bold" if label.bold else "normal",
            color=label.color,
            zorder=7.0,
            bbox={"boxstyle": "round,pad=0.15", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.75},
            arrowprops={"arrowstyle": "-", "color": label.color, "linewidth": 0.6, "shrinkA": 0, "shrinkB": 3},
        ).set_in_layout(False)


def _candidate(anchor: Array, half: Array, direction: Array, distance: float) -> tuple[Array, Array]:
    """Offset of a label's centre and its box (low, high), its nearest edge at a distance in a direction."""
    reach = 1.0 / np.max(np.abs(direction) / half)
    offset = direction * (reach + distance)
    return offset, np.stack([anchor + offset - half, anchor + offset + half])


def _cost(box: Array, offset: Array, taken: list[Array], anchors: Array, frame: Array) -> float:
    overlap = sum(float(np.prod(np.clip(np.minimum(box[1], t[1]) - np.maximum(box[0], t[0]), 0, None))) for t in taken)
    covered = int(((anchors > box[0] - 4.0) & (anchors < box[1] + 4.0)).all(axis=1).sum())
    outside = float(np.clip(frame[0] - box[0], 0, None).sum() + np.clip(box[1] - frame[1], 0, None).sum())
    return 50.0 * overlap + 2000.0 * covered + 30.0 * outside + float(np.linalg.norm(offset))

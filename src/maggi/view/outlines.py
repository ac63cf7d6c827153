"""Which lines to draw for joints that are more than a point, and which bodies a joint's point belongs to."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from maggi.analyses.outline import Outline
from maggi.model.joint_kinds import JOINT_COORDINATES
from maggi.results.results import Array

from .projection import Camera
from .style import FAINT, INK

COUPLERS = ("gear", "rack", "belt", "coupler")  # relations between joints: their ends are joints
ROLLING = ("rolling-disc", "rolling-sphere")
Pose = tuple[Array, Array]  # origin (3,) and rotation (3, 3), body to global
NOWHERE: Pose = (np.zeros(3), np.eye(3))  # of ground


def bodies_at(kind: str, first: str, second: str) -> tuple[str, ...]:
    """The bodies on which a joint's point lies: both bodies of a joint between two frames, else the second only."""
    if kind in COUPLERS:
        return ()
    both = kind == "driver" or (kind in JOINT_COORDINATES and kind != "free")
    return tuple(end.partition(".")[0] for end in ((first, second) if both else (second,)))


def coupled(first: str, second: str) -> list[str]:
    """Names of the joints that a relation couples, by its ends."""
    return [*first.split(", "), second]


def outline_lines(kind: str, outline: Outline, first: Pose, second: Pose) -> list[Array]:
    """The lines (n, 3) each, global, of a joint whose bodies are there."""
    parts = [pose[0] + points @ pose[1].T for points, pose in ((outline.first, first), (outline.second, second))]
    if kind == "distance":
        return [np.concatenate(parts)]
    return [part for part in parts if len(part) > 1]


def draw_outlines(axes: Axes, camera: Camera, lines: list[Array]) -> None:
    """Thin dark lines, above links and below attachments."""
    for line in lines:
        flat = camera.flat(line)
        axes.plot(flat[:, 0], flat[:, 1], color=INK, linewidth=1.3, zorder=3.6, solid_capstyle="round")


def draw_coupling(axes: Axes, camera: Camera, places: list[Array]) -> None:
    """A dashed line between the joints (3,) that a gear, a belt or another relation couples."""
    flat = camera.flat(np.stack(places))
    axes.plot(flat[:, 0], flat[:, 1], color=FAINT, linewidth=1.4, linestyle=(0, (4, 3)), zorder=3.7)

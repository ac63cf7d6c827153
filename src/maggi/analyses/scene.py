"""The mechanism as it stands before a run, for drawings: bodies, attachments, joint axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .outline import Outline

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SceneBody:
    """A body in its initial pose: origin (3,), rotation (3, 3), and its mesh in body frame where it has one."""

    name: str
    kind: str
    origin: Array
    rotation: Array
    center_of_mass: Array
    nodes: Array | None = None
    cells: dict[str, IntArray] | None = None


@dataclass(frozen=True, eq=False)
class SceneAttachment:
    """An attachment: its body and its position (3,), global."""

    body: str
    name: str
    position: Array


@dataclass(frozen=True, eq=False)
class SceneJoint:
    """A joint: kind, point (3,) and axis (3,) or None, global; the two ends' names; its outline."""

    name: str
    kind: str
    first: str
    second: str
    position: Array
    axis: Array | None
    outline: Outline | None = None


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything a drawing of the mechanism needs."""

    title: str
    gravity: Array
    bodies: tuple[SceneBody, ...]
    attachments: tuple[SceneAttachment, ...]
    joints: tuple[SceneJoint, ...]

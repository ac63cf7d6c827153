"""Axes of joints from the directions that the model gives."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from maggi.liaisons.registry import JointKind
from maggi.model.errors import ModelError
from maggi.model.joints import Joint

Array = NDArray[np.float64]


def unit(direction: Sequence[float], path: str) -> Array:
    """A direction of length one. Raises ModelError where it has none."""
    result = np.array(direction, dtype=np.float64)
    length = float(np.linalg.norm(result))
    if length == 0.0 or not np.isfinite(length):
        raise ModelError(f"{list(direction)} is no direction", path=path, remedy="give a vector that is not zero")
    return np.asarray(result / length)


def around(z: Array) -> Array:
    """Axes (3, 3), columns, with the third along the unit vector z."""
    x = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def joint_frames(kind: JointKind, joint: Joint, path: str) -> tuple[Array, Array]:
    """A joint's axes on first and on second, as columns, global, in the initial pose."""
    if kind.placed_by == "axes":
        if joint.axes is None:
            raise ModelError("the joint has no axes", path=path, remedy="give `axes: [on first, on second]`")
        x, y = (unit(axis, f"{path}.axes") for axis in joint.axes)
        if abs(x @ y) > 1e-9:
            raise ModelError(
                f"the two axes are not at right angles (cosine {x @ y:.3g})",
                path=f"{path}.axes",
                remedy="a universal joint's cross has perpendicular pins",
            )
        frame = np.column_stack([x, y, np.cross(x, y)])
        return frame, frame
    if kind.placed_by == "":
        return np.eye(3), np.eye(3)
    if kind.placed_by == "shafts" and joint.axes is not None:
        first, second = (unit(axis, f"{path}.axes") for axis in joint.axes)
        return _shafts(first, second, path)
    if joint.axis is None:
        raise ModelError("the joint has no axis", path=path, remedy="give `axis: [x, y, z]`, global")
    frame = around(unit(joint.axis, f"{path}.axis"))
    return frame, frame


def _shafts(first: Array, second: Array, path: str) -> tuple[Array, Array]:
    """Axes with z along each of two shafts that make an angle: the second's are the first's, turned the short way."""
    cosine = float(first @ second)
    if cosine < -0.5:
        raise ModelError(
            f"the shafts make an angle of {np.degrees(np.arccos(max(cosine, -1.0))):.0f} degrees",
            path=f"{path}.axes",
            remedy="give both shafts' directions the same way along the drive, at most 120 degrees apart",
        )
    frame = around(first)
    cross = np.cross(first, second)
    skew = np.array([[0, -cross[2], cross[1]], [cross[2], 0, -cross[0]], [-cross[1], cross[0], 0]])
    turn = np.eye(3) + skew + skew @ skew / (1.0 + cosine)
    return frame, turn @ frame

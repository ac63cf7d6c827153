"""How bodies lie at t = 0."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..model.bodies import Body, GivenMotion
from ..model.expression import value_at
from ..model.geometry import Vector, axis_rotation


def initial_rotation(body: Body | None) -> NDArray[np.float64]:
    """The rotation (3, 3) from the body's axes to the global ones at t = 0; None: ground."""
    if body is None:
        return np.eye(3)
    rotation = np.array(body.pose.rotation)
    motion = body.motion
    if isinstance(motion, GivenMotion) and motion.axis is not None and motion.angle is not None:
        rotation = rotation @ np.array(axis_rotation(motion.axis, value_at(motion.angle, [0.0])[0]))
    return rotation


def to_body_axes(direction: Vector, body: Body | None) -> Vector:
    """A global direction in the axes of a body (None: ground) at t = 0."""
    x, y, z = (initial_rotation(body).T @ np.array(direction)).tolist()
    return x, y, z

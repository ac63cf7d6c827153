"""Where prescribed frames that follow a rigid run are at t = 0, for whoever looks at a mechanism without running it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from maggi.model.bodies import ElasticBody
from maggi.model.errors import ModelError
from maggi.model.model import Model
from maggi.system.build import RecordedMotion, build_system, has_recorded_motion

from .initial import initial_motion


def frames_at_rest(model: Model) -> dict[str, RecordedMotion]:
    """The frames in their initial poses, by body; empty where none follows a rigid run."""
    frames = {}
    for name in has_recorded_motion(model):
        pose = model.bodies[name].pose
        still = np.zeros((1, 6))
        frames[name] = RecordedMotion(1.0, np.array([pose.origin]), np.array([pose.rotation]), still, still)
    return frames


def frames_at_start(model: Model, announce: Callable[[str], None]) -> dict[str, RecordedMotion]:
    """The frames with their initial velocities: those of the mechanism with all its elastic bodies rigid.

    At rest where that mechanism has no consistent initial state; whoever looks for one will be told why.
    """
    following = has_recorded_motion(model)
    if not following:
        return {}
    elastic = frozenset(name for name, body in model.bodies.items() if isinstance(body, ElasticBody))
    system = build_system(model, rigid=elastic, announce=announce)
    try:
        motion = initial_motion(system, [])
    except ModelError:
        return frames_at_rest(model)
    frames = {}
    for name in following:
        b = system.body(name).index
        twist = motion.v[system.bodies.offset[b] :][:6]
        frames[name] = RecordedMotion(
            1.0, motion.origin[b][None], motion.rotation[b][None], twist[None].copy(), np.zeros((1, 6))
        )
    return frames

"""What can be checked only once it is known how the bodies lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..model.curves import Curve, SplineCurve
from ..model.errors import ModelError
from ..model.joints import Cam
from ..model.model import Model
from ..model.operations import evaluate
from .frames import to_body_axes

OUT_OF_PLANE = 1e-6
"""How far from a plane normal to the axis a cam's profile may be, as a share of its size."""

SAMPLES = 201


def check_placement(model: Model) -> list[ModelError]:
    """Profiles of cams that do not lie in a plane normal to the cam's axis."""
    errors = []
    for name, joint in model.joints.items():
        if isinstance(joint, Cam):
            axis = to_body_axes(joint.axis, model.bodies.get(joint.first.body))
            points = _points(joint.profile)
            size = float(np.linalg.norm(np.ptp(points, axis=0)))
            out = float(np.ptp(points @ np.array(axis)))
            if out > OUT_OF_PLANE * size:
                shown = [round(component, 4) + 0.0 for component in axis]
                errors.append(
                    ModelError(
                        f"the profile leaves the plane normal to the axis, {shown} in its body's frame, by {out:.4g} m",
                        path=f"joints.{name}.profile",
                        remedy="the axis is global, the profile in the body's frame: check both, and the body's pose",
                    )
                )
    return errors


def _points(curve: Curve) -> NDArray[np.float64]:
    """Points (n, 3) of a curve in its body's frame."""
    if isinstance(curve, SplineCurve):
        return np.array(curve.points)
    s = np.linspace(*curve.interval, SAMPLES)
    return np.stack([evaluate(f.codes, f.values, [s]) for f in (curve.x, curve.y, curve.z)], axis=1)

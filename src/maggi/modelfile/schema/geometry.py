"""Poses, velocities and inertia tensors."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from ...model import geometry
from ...model.geometry import IDENTITY, Matrix, axis_rotation
from .fields import Angle, AngularVelocityVector, Direction, Inertia, Matrix3, Point, Section, VelocityVector
from .mistakes import mistake, shown

ORTHOGONAL = 1e-6
"""How far a given rotation matrix may be from orthogonal; it is then replaced by the nearest rotation."""


class AxisAngleSection(Section):
    """A rotation about an axis by an angle."""

    axis: Direction = Field(description="axis of the rotation, global; any length")
    angle: Angle = Field(description='angle (rad), or a text such as "30 deg"; right-handed')

    def build(self) -> Matrix:
        """The rotation matrix."""
        return axis_rotation(self.axis, self.angle)


def _proper(matrix: Matrix) -> Matrix:
    given = np.array(matrix)
    if not np.abs(given).max() < 10.0 or np.abs(given @ given.T - np.eye(3)).max() > ORTHOGONAL:
        raise mistake("not a rotation matrix: its rows are not unit vectors at right angles", "or give axis and angle")
    left, _, right = np.linalg.svd(given)
    nearest = left @ right
    if np.linalg.det(nearest) < 0.0:
        raise mistake("not a rotation but a reflection: the determinant is -1", "use right-handed axes")
    return to_matrix(nearest)


def to_matrix(array: Any) -> Matrix:
    """A (3, 3) array as tuples."""
    (a, b, c), (d, e, f), (g, h, i) = np.asarray(array, dtype=float).tolist()
    return (a, b, c), (d, e, f), (g, h, i)


def _rotation_kind(value: Any) -> Any:
    if not isinstance(value, (list, dict)):
        raise mistake(f"expected {{axis, angle}} or a 3x3 matrix, found {shown(value)}")
    return value


AnyRotation = Annotated[
    Annotated[AxisAngleSection, Tag("<axis>")]
    | Annotated[Annotated[Matrix3, AfterValidator(_proper)], Tag("<matrix>")],
    Discriminator(lambda value: "<matrix>" if isinstance(value, list) else "<axis>"),
    BeforeValidator(_rotation_kind),
]


class PoseSection(Section):
    """Where a body's frame is at t = 0."""

    origin: Point | None = Field(None, description="origin of the body frame, global (m); default [0, 0, 0]")
    rotation: AnyRotation | None = Field(
        None, description="{axis, angle}, or the 3x3 matrix from body to global components; default none"
    )

    def build(self) -> geometry.Pose:
        """The frozen description."""
        rotation = self.rotation.build() if isinstance(self.rotation, AxisAngleSection) else self.rotation
        return geometry.Pose(self.origin or (0.0, 0.0, 0.0), rotation or IDENTITY)


class VelocitySection(Section):
    """Given velocity of a body's frame at t = 0, global components; what is left out is free."""

    linear: VelocityVector | None = Field(None, description="velocity of the frame's origin (m/s)")
    angular: AngularVelocityVector | None = Field(None, description="angular velocity (rad/s)")

    def build(self) -> geometry.Velocity:
        """The frozen description."""
        return geometry.Velocity(self.linear, self.angular)


_Row = tuple[Inertia, Inertia, Inertia]


def _tensor(value: Any) -> Any:
    """Three numbers are the diagonal."""
    if not isinstance(value, list) or len(value) != 3:
        raise mistake(f"expected 3 principal moments or a 3x3 tensor, found {shown(value)}")
    rows = [isinstance(row, list) for row in value]
    if any(rows) and not all(isinstance(row, list) and len(row) == 3 for row in value):
        raise mistake("expected 3 principal moments or a 3x3 tensor")
    return value


def _physical(value: Any) -> Matrix:
    """A tensor of inertia that some body has: symmetric, not negative, each principal moment at most the others' sum."""
    given = np.array(value)
    tensor = np.diag(given) if given.ndim == 1 else given
    size = float(np.abs(tensor).max())
    if size > 1e100:
        raise mistake(f"the tensor of inertia is too large: {size:.6g} kg m²")
    skew = np.abs(tensor - tensor.T)
    if skew.max() > 1e-9 * size:
        i, j = divmod(int(skew.argmax()), 3)
        raise mistake(
            f"the tensor of inertia is not symmetric: {tensor[i, j]:.6g} and {tensor[j, i]:.6g} stand opposite",
            "entries off the diagonal are I_xy = -∫xy dm, and so on",
        )
    tensor = 0.5 * (tensor + tensor.T)
    low, middle, high = np.linalg.eigvalsh(tensor)
    principal = f"principal moments {low:.6g}, {middle:.6g}, {high:.6g} kg m²"
    if low < -1e-9 * size:
        raise mistake(f"the tensor of inertia is not positive: {principal}", "check the signs")
    # A zero moment stands for one that does not matter, as in a planar mechanism.
    if low > 1e-9 * size and high > (low + middle) * (1.0 + 1e-6):
        raise mistake(
            f"no body has this tensor of inertia: {principal}; the largest exceeds the sum of the others",
            "check the values, and that they are about the centre of mass",
        )
    return to_matrix(tensor)


InertiaTensor = Annotated[
    Annotated[_Row, Tag("<diagonal>")] | Annotated[tuple[_Row, _Row, _Row], Tag("<tensor>")],
    Discriminator(lambda value: "<tensor>" if isinstance(value[0], list) else "<diagonal>"),
    BeforeValidator(_tensor),
    AfterValidator(_physical),
]

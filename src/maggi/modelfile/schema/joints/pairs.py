"""Joints proper: lower pairs, universal and constant-velocity joints, screws."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from ....model.geometry import Vector
from ....model.joints import Joint
from ..ends import BetweenSection
from ..fields import Direction, Length
from ..mistakes import mistake, shown

PARALLEL = 1.0 - 5e-7
"""Cosine of the angle (1e-3 rad) between two directions from which they count as parallel."""

MOST_BENT = -0.5
"""Cosine of the largest angle (120°) between the shafts of a constant-velocity joint."""


def cosine(one: Vector, other: Vector) -> float:
    """Of the angle between two unit vectors."""
    return sum(a * b for a, b in zip(one, other, strict=True))


def _two_axes(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 2:
        raise mistake(f"expected two axes, found {shown(value)}", "write axes: [on first, on second]")
    return value


def _not_parallel(axes: tuple[Vector, Vector]) -> Any:
    if abs(cosine(*axes)) > PARALLEL:
        raise mistake("the axes of a universal joint cannot be parallel", "give the axis on first and that on second")
    return axes


def _along_the_drive(axes: tuple[Vector, Vector]) -> Any:
    if cosine(*axes) < MOST_BENT:
        raise mistake(
            f"the shafts make an angle of {math.degrees(math.acos(max(cosine(*axes), -1.0))):.0f}°",
            "give both directions the same way along the drive, at most 120° apart",
        )
    return axes


class JointSection(BetweenSection):
    """What all joints with coordinates have."""

    @property
    def kind(self) -> str:
        """The joint's type; every concrete joint has one."""
        kind: str = self.type  # type: ignore[attr-defined]
        return kind


class PointJointSection(JointSection):
    """A joint without axis; free only measures."""

    type: Literal["spherical", "weld", "free"] = Field(description="spherical, weld, free")

    def build(self) -> Joint:
        """The frozen description."""
        return Joint(self.type, *self.ends(), self.at)


class AxisJointSection(JointSection):
    """A joint with an axis."""

    type: Literal["revolute", "prismatic", "cylindrical", "planar"] = Field(
        description="revolute, prismatic, cylindrical, planar"
    )
    axis: Direction = Field(description="axis, global, at t = 0, any length; of a planar joint the normal")

    def build(self) -> Joint:
        """The frozen description."""
        return Joint(self.type, *self.ends(), self.at, self.axis)


class ScrewSection(JointSection):
    """A nut on a screw: sliding along the axis goes with turning about it."""

    type: Literal["screw"] = Field(description="screw")
    axis: Direction = Field(description="axis, global, at t = 0, any length")
    pitch: Length = Field(description="displacement for one turn (m); negative: left-handed")

    @model_validator(mode="after")
    def _moves(self) -> ScrewSection:
        if self.pitch == 0.0:
            raise mistake("a screw needs a pitch, found 0", "without one it is a revolute joint", ("pitch",))
        return self

    def build(self) -> Joint:
        """The frozen description."""
        return Joint(self.type, *self.ends(), self.at, self.axis, pitch=self.pitch)


class UniversalSection(JointSection):
    """A universal joint: two revolutes that share a point."""

    type: Literal["universal"] = Field(description="universal")
    axes: Annotated[tuple[Direction, Direction], AfterValidator(_not_parallel), BeforeValidator(_two_axes)] = Field(
        description="[axis on first, axis on second], global, at t = 0"
    )

    def build(self) -> Joint:
        """The frozen description."""
        return Joint(self.type, *self.ends(), self.at, axes=self.axes)


class ConstantVelocitySection(JointSection):
    """A constant-velocity joint: two shafts turn at one speed, however they are bent."""

    type: Literal["constant-velocity"] = Field(description="constant-velocity")
    axis: Direction | None = Field(None, description="both shafts' direction where they are in line, global, at t = 0")
    axes: (
        Annotated[tuple[Direction, Direction], AfterValidator(_along_the_drive), BeforeValidator(_two_axes)] | None
    ) = Field(None, description="[shaft of first, shaft of second] where they are not, global, at t = 0")

    @model_validator(mode="after")
    def _one_of_both(self) -> ConstantVelocitySection:
        if (self.axis is None) == (self.axes is None):
            found = "none" if self.axis is None else "both"
            raise mistake(
                f"a constant-velocity joint has either axis or axes, found {found}",
                "axis for shafts in line, axes: [shaft of first, shaft of second] for others",
                () if self.axis is None else ("axes",),
            )
        return self

    def build(self) -> Joint:
        """The frozen description."""
        return Joint(self.type, *self.ends(), self.at, self.axis, self.axes)

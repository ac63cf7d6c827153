"""Joints and drivers of the model file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator

from ...model.functions import TimeFunction
from .fields import (
    AngleFunction,
    Direction,
    LengthFunction,
    Name,
    Point,
    Section,
    SpeedFunction,
    by_value,
)
from .mistakes import mistake, shown


@dataclass(frozen=True)
class Coordinates:
    """Which coordinates of a joint a driver can prescribe."""

    angle: bool = False
    displacement: bool = False


COORDINATES = {
    "revolute": Coordinates(angle=True),
    "prismatic": Coordinates(displacement=True),
    "cylindrical": Coordinates(angle=True, displacement=True),
    "spherical": Coordinates(),
    "planar": Coordinates(),
    "universal": Coordinates(),
    "weld": Coordinates(),
}
LATER = ("rolling-disc", "knife-edge", "gear", "screw", "free")


def _two(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 2:
        raise mistake(f"expected two ends, found {shown(value)}", "write between: [first, second]")
    return value


def _not_parallel(axes: tuple[tuple[float, ...], tuple[float, ...]]) -> Any:
    if abs(sum(a * b for a, b in zip(*axes, strict=True))) > 0.999:
        raise mistake("the axes of a universal joint cannot be parallel", "give the axis on first and that on second")
    return axes


Between = Annotated[tuple[str, str], BeforeValidator(_two)]


class JointSection(Section):
    """What all joints have."""

    between: Between = Field(description="[first, second]: ground, a body, or body.attachment")
    at: Point | None = Field(
        None,
        description="the joint's point, global, at t = 0 (m); needed if no attachment is named, refused with two",
    )


class PointJointSection(JointSection):
    """A joint without axis."""

    type: Literal["spherical", "weld"] = Field(description="spherical, weld")


class AxisJointSection(JointSection):
    """A joint with an axis."""

    type: Literal["revolute", "prismatic", "cylindrical", "planar"] = Field(
        description="revolute, prismatic, cylindrical, planar"
    )
    axis: Direction = Field(description="axis, global, at t = 0, any length; of a planar joint the normal")


class UniversalJointSection(JointSection):
    """A universal joint: two revolutes that share a point."""

    type: Literal["universal"] = Field(description="universal")
    axes: Annotated[tuple[Direction, Direction], AfterValidator(_not_parallel), BeforeValidator(_two)] = Field(
        description="[axis on first, axis on second], global, at t = 0"
    )


class DriverSection(Section):
    """Prescribes a joint's coordinate as a function of time."""

    type: Literal["driver"] = Field(description="driver")
    joint: Name = Field(description="the joint that it drives")
    angle: AngleFunction | None = Field(None, description="angle (rad) as a function of t, 0 at t = 0")
    displacement: LengthFunction | None = Field(None, description="displacement (m) as a function of t, 0 at t = 0")
    speed: SpeedFunction | None = Field(None, description="speed (rad/s or m/s) as a function of t")

    @model_validator(mode="after")
    def _exactly_one(self) -> DriverSection:
        given = [key for key in ("angle", "displacement", "speed") if getattr(self, key) is not None]
        if len(given) != 1:
            raise mistake(
                f"a driver has exactly one of angle, displacement and speed, found {' and '.join(given) or 'none'}",
                "keep one of them" if given else "",
                tuple(given[1:2]),
            )
        return self

    @property
    def quantity(self) -> str:
        """``angle``, ``displacement`` or ``speed``."""
        return "angle" if self.angle else "displacement" if self.displacement else "speed"

    @property
    def function(self) -> TimeFunction:
        """The prescribed function."""
        function = self.angle or self.displacement or self.speed
        assert function is not None
        return function


_POINT, _AXIS = ("spherical", "weld"), ("revolute", "prismatic", "cylindrical", "planar")
_check_type, _ = by_value("type", (*_AXIS, *_POINT, "universal", "driver"), LATER)


def _tag(value: Any) -> str:
    kind = value["type"]
    return "<point>" if kind in _POINT else "<axis>" if kind in _AXIS else f"<{kind}>"


AnyJoint = Annotated[
    Annotated[AxisJointSection, Tag("<axis>")]
    | Annotated[PointJointSection, Tag("<point>")]
    | Annotated[UniversalJointSection, Tag("<universal>")]
    | Annotated[DriverSection, Tag("<driver>")],
    Discriminator(_tag),
    _check_type,
]

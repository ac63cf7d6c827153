"""Couplers of two joint coordinates in a fixed ratio: gears, racks, belts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    Field,
    StrictBool,
    model_validator,
)

from ....model import units
from ....model.couplers import belt, gear, rack
from ....model.joints import Coupler, JointCoordinate
from ..fields import Number, PositiveLength, Section
from ..mistakes import mistake, shown

Place = tuple[str | int, ...]


def to_coordinate(value: Any) -> JointCoordinate:
    """``crank``, ``crank.angle`` or ``slider.displacement``; whether there is such a joint is checked later."""
    if not isinstance(value, str):
        raise mistake(f"expected the name of a joint, found {shown(value)}", "write joint or joint.angle")
    joint, dot, quantity = value.partition(".")
    if quantity == "angle":
        return JointCoordinate(joint, "angle")
    if quantity == "displacement":
        return JointCoordinate(joint, "displacement")
    if dot:
        raise mistake(
            f"'{value[:80]}' names no coordinate of a joint",
            f"write {joint[:40]}.angle, {joint[:40]}.displacement, or {joint[:40]} alone where it has one of the two",
        )
    return JointCoordinate(joint)


def _two_joints(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 2:
        raise mistake(f"expected two joints, found {shown(value)}", "write joints: [a, b]")
    return value


def _two_radii(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 2:
        raise mistake(f"expected two radii, found {shown(value)}", "write radii: [of a, of b]")
    return value


CoordinateName = Annotated[
    JointCoordinate, BeforeValidator(to_coordinate, json_schema_input_type=str), Field(description="joint, joint.angle")
]
TwoCoordinates = Annotated[tuple[CoordinateName, CoordinateName], BeforeValidator(_two_joints)]


class CouplerSection(Section):
    """What all couplers have."""

    @property
    def coordinates(self) -> Mapping[Place, JointCoordinate]:
        """The coupled coordinates by the keys that name them."""
        raise NotImplementedError


class _PairSection(CouplerSection):
    """A coupler of two coordinates."""

    joints: TwoCoordinates = Field(description="[a, b]: two joints; of one with two coordinates joint.angle")

    @property
    def coordinates(self) -> Mapping[Place, JointCoordinate]:
        """The coupled coordinates by the keys that name them."""
        return {("joints", place): coordinate for place, coordinate in enumerate(self.joints)}

    def _only(self, *quantities: str) -> None:
        """Refuse a coordinate other than the one that this kind of coupler takes."""
        for place, (coordinate, wanted) in enumerate(zip(self.joints, quantities, strict=True)):
            if coordinate.quantity not in (None, wanted):
                raise mistake(
                    f"expected the {wanted} of a joint, found its {coordinate.quantity}",
                    f"write {coordinate.joint}",
                    ("joints", place),
                )


class GearSection(_PairSection):
    """Two coordinates in a fixed ratio."""

    type: Literal["gear"] = Field(description="gear")
    ratio: Annotated[float, Number(units.NUMBER)] = Field(
        description="coordinate of b = ratio · coordinate of a (rad, m); negative for two external gears"
    )

    @model_validator(mode="after")
    def _not_zero(self) -> GearSection:
        if self.ratio == 0.0:
            raise mistake("the ratio of a gear cannot be 0", "it is the speed of b over that of a", ("ratio",))
        return self

    def build(self) -> Coupler:
        """The frozen description."""
        return gear(*self.joints, self.ratio)


class RackSection(_PairSection):
    """A pinion on a rack."""

    type: Literal["rack"] = Field(description="rack")
    radius: PositiveLength = Field(description="pitch radius of the pinion (m): displacement = radius · angle")

    @model_validator(mode="after")
    def _turns_and_slides(self) -> RackSection:
        self._only("angle", "displacement")
        return self

    @property
    def coordinates(self) -> Mapping[Place, JointCoordinate]:
        """The coupled coordinates by the keys that name them."""
        pinion, bar = (coordinate.joint for coordinate in self.joints)
        return {
            ("joints", 0): JointCoordinate(pinion, "angle"),
            ("joints", 1): JointCoordinate(bar, "displacement"),
        }

    def build(self) -> Coupler:
        """The frozen description."""
        return rack(self.joints[0].joint, self.joints[1].joint, self.radius)


class BeltSection(_PairSection):
    """Two pulleys that a belt or chain holds together without slip."""

    type: Literal["belt"] = Field(description="belt")
    radii: Annotated[tuple[PositiveLength, PositiveLength], BeforeValidator(_two_radii)] = Field(
        description="[radius of a's pulley, radius of b's] (m)"
    )
    crossed: StrictBool = Field(False, description="true: they turn against each other")

    @model_validator(mode="after")
    def _turn(self) -> BeltSection:
        self._only("angle", "angle")
        return self

    @property
    def coordinates(self) -> Mapping[Place, JointCoordinate]:
        """The coupled coordinates by the keys that name them."""
        return {("joints", k): JointCoordinate(one.joint, "angle") for k, one in enumerate(self.joints)}

    def build(self) -> Coupler:
        """The frozen description."""
        return belt(self.joints[0].joint, self.joints[1].joint, self.radii, self.crossed)

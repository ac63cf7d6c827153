"""Relations between joint coordinates: gears, racks, belts, any relation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    StrictBool,
    ValidationInfo,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from ....model import units
from ....model.couplers import belt, gear, linear_coupler, rack, relation
from ....model.errors import ModelError
from ....model.expression import check_variable_name
from ....model.functions import Formula
from ....model.joints import Coupler, JointCoordinate
from ....model.linear import linear_parts
from ....model.operations import Operation
from ..fields import Number, PositiveLength, Section, context_of, mistake_of, read_number
from ..mistakes import KEY, mistake, shown

Place = tuple[str | int, ...]


def _coordinate(value: Any) -> JointCoordinate:
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
    JointCoordinate, BeforeValidator(_coordinate, json_schema_input_type=str), Field(description="joint, joint.angle")
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


def _names(value: Any) -> Any:
    for name in value if isinstance(value, dict) else ():
        try:
            check_variable_name(str(name), "a coordinate")
        except ModelError as error:
            raise mistake_of(error, (name, KEY)) from None
    return value


def _some(value: dict[str, Any]) -> dict[str, Any]:
    if not value:
        raise mistake("a coupler needs joints", "write joints: {a: joint, b: joint.angle}")
    return value


@dataclass(frozen=True)
class _Relation:
    """Marks the `Formula` of a coupler, in ``t`` and the names that the key `joints` before it gives."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"type": "string", "description": "expression in t, the names under joints and the parameters"}

    def _read(self, value: Any, info: ValidationInfo) -> Formula:
        names = info.data.get("joints", {})
        if not isinstance(value, str):
            raise mistake(f"expected an expression, found {shown(value)}", 'such as "2*a - b", kept at 0')
        if not names:  # what is wrong with them has been said
            return relation("0", {})
        try:
            return relation(value, names, context_of(info).values)
        except ModelError as error:
            raise mistake_of(error) from None


class RelationCouplerSection(CouplerSection):
    """Any relation between coordinates."""

    type: Literal["coupler"] = Field(description="coupler")
    joints: Annotated[dict[str, CoordinateName], AfterValidator(_some), BeforeValidator(_names)] = Field(
        description="the coordinates by the names that stand for them: {a: crank, b: rocker.angle}"
    )
    rates: StrictBool = Field(
        False, description="true: the relation is between the coordinates' speeds, linear in them"
    )
    relation: Annotated[Formula, _Relation()] = Field(
        description="an expression in t and those names (m, rad; speeds m/s, rad/s) that is kept at 0"
    )

    @model_validator(mode="after")
    def _relates(self) -> RelationCouplerSection:
        steps = zip(self.relation.codes, self.relation.values, strict=True)
        used = {self.relation.variables[int(value)] for code, value in steps if code == Operation.VARIABLE}
        for name in self.joints:
            if name not in used:
                raise mistake(
                    f"'{name}' does not occur in the relation '{self.relation.text}'",
                    "use it, or remove it",
                    ("joints", name, KEY),
                )
        if self.rates:
            try:
                linear_parts(self.relation, self.joints)
            except ModelError as error:
                raise mistake_of(error, ("relation",)) from None
        return self

    @property
    def coordinates(self) -> Mapping[Place, JointCoordinate]:
        """The coupled coordinates by the keys that name them."""
        return {("joints", name): coordinate for name, coordinate in self.joints.items()}

    def build(self) -> Coupler:
        """The frozen description."""
        return Coupler("coupler", self.joints, self.relation, self.rates)


def _coefficients(value: Any) -> Any:
    if not isinstance(value, dict) or len(value) < 2:
        raise mistake(
            f"expected two or more joints with their coefficients, found {shown(value)}",
            "write joints: {a: 2, b: -1}, or give a relation between names",
        )
    for joint in value:
        try:
            _coordinate(joint)
        except PydanticCustomError as error:
            raise mistake(error.message(), "", (joint, KEY)) from None
    return value


def _coefficient(value: Any, info: ValidationInfo) -> float:
    try:
        number = read_number(value, units.NUMBER, context_of(info))
    except PydanticCustomError as error:
        remedy = "without a relation the values are coefficients; with a relation they name joints"
        raise mistake(error.message(), remedy) from None
    if number == 0.0:
        raise mistake("a coefficient cannot be 0", "remove the joint")
    return number


Coefficient = Annotated[float, BeforeValidator(_coefficient, json_schema_input_type=float | str)]


class LinearCouplerSection(CouplerSection):
    """A linear relation between coordinates."""

    type: Literal["coupler"] = Field(description="coupler")
    joints: Annotated[dict[str, Coefficient], BeforeValidator(_coefficients)] = Field(
        description="the coefficient of each joint's coordinate: {crank: 2, rocker.angle: -1}; their sum is kept at 0"
    )
    rates: StrictBool = Field(False, description="true: the relation is between the coordinates' speeds")

    @property
    def coordinates(self) -> Mapping[Place, JointCoordinate]:
        """The coupled coordinates by the keys that name them."""
        return {("joints", key): _coordinate(key) for key in self.joints}

    def build(self) -> Coupler:
        """The frozen description."""
        return linear_coupler({_coordinate(key): factor for key, factor in self.joints.items()}, self.rates)

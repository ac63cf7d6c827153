"""Relations between joint coordinates: any formula, or coefficients."""

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
from ....model.couplers import linear_coupler, relation
from ....model.errors import ModelError
from ....model.expression import check_variable_name
from ....model.functions import Formula
from ....model.joints import Coupler, JointCoordinate
from ....model.linear import linear_parts
from ....model.operations import Operation
from ..fields import context_of, mistake_of, read_number
from ..mistakes import KEY, mistake, shown
from .couplers import CoordinateName, CouplerSection, Place, to_coordinate


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
            to_coordinate(joint)
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
        return {("joints", key): to_coordinate(key) for key in self.joints}

    def build(self) -> Coupler:
        """The frozen description."""
        return linear_coupler({to_coordinate(key): factor for key, factor in self.joints.items()}, self.rates)

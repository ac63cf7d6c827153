"""The kinds of values that keys of a model file may have: quantities, functions of time, vectors, names."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationInfo,
    model_validator,
)
from pydantic.functional_validators import AfterValidator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from ...model import units
from ...model.errors import ModelError
from ...model.expression import RESERVED, Program, compile_program, constant, time_function
from ...model.functions import TimeFunction
from ...model.units import Dimension
from .mistakes import Context, mistake, shown, suggestion


class Section(BaseModel):
    """A mapping of the model file: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    @model_validator(mode="before")
    @classmethod
    def _note_keys(cls, data: Any, info: ValidationInfo) -> Any:
        """Remember which keys this mapping may have, for the message about one it may not have."""
        if not isinstance(data, dict):
            raise mistake(f"expected keys and values, found {shown(data)}", f"keys are {', '.join(cls.model_fields)}")
        context_of(info).sections[id(data)] = cls
        return data


def context_of(info: ValidationInfo) -> Context:
    """What the validation knows."""
    assert isinstance(info.context, Context)
    return info.context


def mistake_of(error: ModelError, at: tuple[str | int, ...] = ()) -> Exception:
    """An error of another part of the program, to raise inside a validator; `at` as for `mistake`."""
    return mistake(error.message, error.remedy, at, error.file, error.line)


def read_number(value: Any, dimension: Dimension, context: Context, also: tuple[Dimension, ...] = ()) -> float:
    """A number, ``number unit`` or expression as SI value of a dimension, or of one of `also`."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise mistake(f"expected {dimension.article}, found {shown(value)}", _how(dimension))
    try:
        if isinstance(value, str):
            check_dimension(value, (dimension, *also), context)
        return constant(value, context.values)
    except ModelError as error:
        raise mistake_of(error) from None


def check_dimension(text: str, wanted: tuple[Dimension, ...], context: Context) -> None:
    """Refuse a unit, or a bare parameter given with a unit, of another dimension."""
    quantity = units.parse_quantity(text)
    bare = context.parameters.get(text.strip())
    given = quantity.dimension if quantity else bare.dimension if bare else None
    if given is None or any(dimension.accepts(given) for dimension in wanted):
        return
    expected = " or ".join(dimension.article for dimension in wanted)
    unit = text.strip().lstrip("+-.0123456789 ")
    remedy = _how(wanted[0])
    if quantity and (unit in context.parameters or unit in RESERVED):
        remedy = f"for a product write {text.strip()[: -len(unit)].strip()}*{unit}"
    elif given == units.PER_TIME and units.ANGULAR_VELOCITY in wanted:
        remedy = "write turns as rev/s or rpm, radians as rad/s"
    raise ModelError(f"expected {expected}, got {given.article}: {text.strip()[:80]}", remedy=remedy)


_EXAMPLES = {
    units.LENGTH: "70 mm",
    units.MASS: "0.4 kg",
    units.TIME: "1 ms",
    units.ANGLE: "30 deg",
    units.VELOCITY: "2 m/s",
    units.ACCELERATION: "9.81 m/s^2",
    units.ANGULAR_VELOCITY: "1500 rpm",
    units.PER_TIME: "1 Hz",
    units.FORCE: "10 N",
    units.TORQUE: "10 N m",
    units.PRESSURE: "210 GPa",
    units.DENSITY: "7850 kg/m^3",
    units.INERTIA: "1e-4 kg m^2",
    units.STIFFNESS: "1e4 N/m",
    units.DAMPING: "10 N s/m",
    units.TORSION_STIFFNESS: "5 N m/rad",
    units.TORSION_DAMPING: "0.1 N m s/rad",
    units.AREA: "100 mm^2",
    units.SECOND_MOMENT_OF_AREA: "500 mm^4",
}


def _how(dimension: Dimension) -> str:
    example = _EXAMPLES.get(dimension)
    return f'write a number in SI units, a text such as "{example}", or an expression' if example else ""


@dataclass(frozen=True)
class Number:
    """Marks a float that may be written as number (SI), ``number unit`` of a dimension, or expression."""

    dimension: Dimension
    also: tuple[Dimension, ...] = ()

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_before_validator_function(self._read, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"anyOf": [handler(schema), text_schema(self.dimension)]}

    def _read(self, value: Any, info: ValidationInfo) -> float:
        return read_number(value, self.dimension, context_of(info), self.also)


@dataclass(frozen=True)
class Function:
    """Marks a `TimeFunction` written as number, ``number unit`` or expression in t and the parameters."""

    dimensions: tuple[Dimension, ...]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"anyOf": [{"type": "number"}, text_schema(self.dimensions[0], "expression in t and the parameters")]}

    def _read(self, value: Any, info: ValidationInfo) -> TimeFunction:
        context = context_of(info)
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            raise mistake(f"expected a number or an expression in t, found {shown(value)}")
        try:
            if isinstance(value, str):
                check_dimension(value, self.dimensions, context)
            return time_function(value, context.values)
        except ModelError as error:
            raise mistake_of(error) from None


@dataclass(frozen=True)
class Coordinates:
    """Marks a compiled `Program` in the body's coordinates x, y, z (m)."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"anyOf": [{"type": "number"}, {"type": "string", "description": "expression in x, y, z (m)"}]}

    def _read(self, value: Any, info: ValidationInfo) -> Program:
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            raise mistake(f"expected a number or an expression in x, y, z, found {shown(value)}")
        try:
            return compile_program(str(value), context_of(info).values, ("x", "y", "z"))
        except ModelError as error:
            raise mistake_of(error) from None


@dataclass(frozen=True)
class ArrayOf:
    """Marks a numpy array written as nested lists of numbers (SI), with this many axes."""

    axes: int

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        result: JsonSchemaValue = {"anyOf": [{"type": "number"}, text_schema(units.NUMBER)]}
        for _ in range(self.axes):
            result = {"type": "array", "items": result}
        return result

    def _read(self, value: Any, info: ValidationInfo) -> NDArray[np.float64]:
        if not isinstance(value, list):
            raise mistake(
                f"expected nested lists of numbers, found {shown(value)}", "files of numbers are not read here"
            )
        shape: list[int] = []
        level: Any = value
        while isinstance(level, list):
            shape.append(len(level))
            level = level[0] if level else None
        if len(shape) != self.axes or 0 in shape:
            raise mistake(f"expected lists nested {self.axes} deep, found {len(shape)}")
        array = np.empty(shape)
        self._fill(value, array, (), context_of(info))
        return array

    def _fill(self, value: Any, array: NDArray[np.float64], at: tuple[int, ...], context: Context) -> None:
        if len(at) == self.axes:
            array[at] = value if isinstance(value, float) else self._number(value, at, context)
            return
        wanted = array.shape[len(at)]
        if not isinstance(value, list) or len(value) != wanted:
            raise mistake(f"expected a list of {wanted} as in the first row, found {shown(value)}", at=at)
        for place, part in enumerate(value):
            self._fill(part, array, (*at, place), context)

    def _number(self, value: Any, at: tuple[int, ...], context: Context) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, str)):
            raise mistake(f"expected a number, found {shown(value)}", at=at)
        try:
            return constant(value, context.values)
        except ModelError as error:
            raise mistake(error.message, error.remedy, at) from None


def text_schema(dimension: Dimension, what: str = "expression in the parameters") -> JsonSchemaValue:
    """JSON Schema of a quantity written as text."""
    example = _EXAMPLES.get(dimension)
    return {"type": "string", "description": f'"{example}", or an {what}' if example else f"an {what}"}


def _three(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 3:
        raise mistake(f"expected a list of 3 components, found {shown(value)}", "write it as [x, y, z]")
    return value


def _normalised(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    largest = max(map(abs, vector))
    if largest < 1e-300:
        raise mistake(f"a direction cannot be zero, found {list(vector)}", "give a direction such as [0, 0, 1]")
    x, y, z = (component / largest for component in vector)
    size = math.sqrt(x * x + y * y + z * z)
    return x / size, y / size, z / size


def not_built_unless(accepted: str | bool, what: str, remedy: str) -> BeforeValidator:
    """Accept one value; refuse every other as something that the program does not do yet (it is never ignored)."""

    def check(value: Any) -> Any:
        if type(value) is not type(accepted) or value != accepted:
            raise mistake(f"{what} is not built yet, found {shown(value)}", remedy)
        return value

    return BeforeValidator(check)


def empty_is_none(value: Any) -> Any:
    """A section whose key stands there with nothing under it is an empty section."""
    return {} if value is None else value


def by_value(key: str, known: tuple[str, ...]) -> tuple[BeforeValidator, Callable[[Any], Any]]:
    """For a mapping whose kind is said by the value of one key: the check, and the function that gives the tag."""

    def check(value: Any) -> Any:
        if not isinstance(value, dict):
            raise mistake(f"expected keys and values, found {shown(value)}", f"begin with {key}: {known[0]}")
        if key not in value:
            raise mistake(f"missing key '{key}'", f"write {key}: {', '.join(known[:-1])} or {known[-1]}", (key,))
        found = value[key]
        if not isinstance(found, str) or found not in known:
            raise mistake(f"unknown {key} {shown(found)}", suggestion(str(found), known, f"known {key}s"), (key,))
        return value

    return BeforeValidator(check), lambda value: f"<{value[key]}>"


def by_key(*known: str, otherwise: str | None = None) -> tuple[BeforeValidator, Callable[[Any], Any]]:
    """For a mapping whose kind is said by which key it has: the check, and the function that gives the tag.

    otherwise : the kind of a mapping with none of the keys (None: refused).
    """

    def check(value: Any) -> Any:
        if not isinstance(value, dict):
            raise mistake(f"expected keys and values, found {shown(value)}", f"give one of {', '.join(known)}")
        present = [key for key in known if key in value]
        if len(present) > 1:
            raise mistake(f"{' and '.join(present)} exclude each other", "keep one of them", (present[1],))
        if not present and otherwise is None:
            raise mistake(f"expected one of the keys {', '.join(known)}, found {', '.join(map(str, value)) or 'none'}")
        return value

    def tag(value: Any) -> str:
        return next((f"<{key}>" for key in known if key in value), f"<{otherwise}>")

    return BeforeValidator(check), tag


_NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")


def _name(value: str) -> str:
    if not _NAME.fullmatch(value):
        raise mistake(f"'{value[:80]}' cannot be a name", "use 1 to 64 letters, digits, _ and -")
    return value


Name = Annotated[str, AfterValidator(_name)]


def _printable(value: str) -> str:
    for character in value:
        if character < " " and character not in "\n\t":
            raise mistake(f"the text holds the control character {character!r}", "remove it")
    return value


Text = Annotated[str, AfterValidator(_printable), Field(max_length=2000)]

Length = Annotated[float, Number(units.LENGTH)]
PositiveLength = Annotated[float, Field(gt=0), Number(units.LENGTH)]
PositiveArea = Annotated[float, Field(gt=0), Number(units.AREA)]
PositiveMoment = Annotated[float, Field(gt=0), Number(units.SECOND_MOMENT_OF_AREA)]
Positive = Annotated[float, Field(gt=0), Number(units.NUMBER)]
PlainNumber = Annotated[float, Number(units.NUMBER)]
Angle = Annotated[float, Number(units.ANGLE)]
PositiveMass = Annotated[float, Field(gt=0), Number(units.MASS)]
PositiveTime = Annotated[float, Field(gt=0), Number(units.TIME)]
PositiveDensity = Annotated[float, Field(gt=0), Number(units.DENSITY)]
Inertia = Annotated[float, Number(units.INERTIA)]

_VELOCITY = Annotated[float, Number(units.VELOCITY)]
_ANGULAR = Annotated[float, Number(units.ANGULAR_VELOCITY)]
_ACCELERATION = Annotated[float, Number(units.ACCELERATION)]

Vector = Annotated[tuple[PlainNumber, PlainNumber, PlainNumber], BeforeValidator(_three)]
Direction = Annotated[
    tuple[PlainNumber, PlainNumber, PlainNumber], AfterValidator(_normalised), BeforeValidator(_three)
]
Point = Annotated[tuple[Length, Length, Length], BeforeValidator(_three)]
Size = Annotated[tuple[PositiveLength, PositiveLength, PositiveLength], BeforeValidator(_three)]
VelocityVector = Annotated[tuple[_VELOCITY, _VELOCITY, _VELOCITY], BeforeValidator(_three)]
AngularVelocityVector = Annotated[tuple[_ANGULAR, _ANGULAR, _ANGULAR], BeforeValidator(_three)]
AccelerationVector = Annotated[tuple[_ACCELERATION, _ACCELERATION, _ACCELERATION], BeforeValidator(_three)]
Matrix3 = Annotated[tuple[Vector, Vector, Vector], BeforeValidator(_three)]

AngleFunction = Annotated[TimeFunction, Function((units.ANGLE,))]
LengthFunction = Annotated[TimeFunction, Function((units.LENGTH,))]
SpeedFunction = Annotated[TimeFunction, Function((units.ANGULAR_VELOCITY, units.VELOCITY))]
PointFunction = Annotated[tuple[LengthFunction, LengthFunction, LengthFunction], BeforeValidator(_three)]
_Load = Annotated[TimeFunction, Function((units.FORCE, units.TORQUE))]
LoadFunction = Annotated[tuple[_Load, _Load, _Load], BeforeValidator(_three)]


def count_up_to(largest: int, least: int = 1) -> Any:
    """A whole number from `least`, written as number or expression."""
    return Annotated[int, _Count(largest, least)]


@dataclass(frozen=True)
class _Count:
    largest: int
    least: int

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        number = {"type": "integer", "minimum": self.least, "maximum": self.largest}
        return {"anyOf": [number, text_schema(units.NUMBER)]}

    def _read(self, value: Any, info: ValidationInfo) -> int:
        number = read_number(value, units.NUMBER, context_of(info))
        if not self.least <= number <= self.largest or number != round(number):
            raise mistake(f"expected a whole number from {self.least} to {self.largest}, found {number:.12g}")
        return int(number)

"""Curves that bodies carry: by points, by formulas, by a polar radius."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    StrictBool,
    Tag,
    ValidationInfo,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from ...model import units
from ...model.curves import Curve, ExpressionCurve, SplineCurve
from ...model.errors import ModelError
from ...model.functions import Formula
from ...model.geometry import Vector
from ...model.operations import Operation, evaluate
from ..points_file import read_points
from .fields import Length, Number, Section, by_key, context_of, mistake_of
from .formulas import FormulaIn
from .meshes import FileUnit
from .mistakes import mistake, shown

Place = tuple[str | int, ...]

SAMPLES = 201
"""Parameters at which a curve by formulas is tried."""

SAME = 1e-9
"""Distance of two points, as a share of the curve's size, below which they are one."""

CLOSES = 1e-9
"""Gap between end and start, as a share of the curve's size, that a closed curve by formulas may have."""

LARGEST = 1e100

LengthInS = Annotated[Formula, FormulaIn(("s",), units.LENGTH)]
_Parameter = Annotated[float, Number(units.NUMBER, (units.ANGLE, units.LENGTH))]
_ZERO = Formula("0", ("s",), (int(Operation.CONSTANT),), (0.0,))


def _two_or_three(value: Any) -> Any:
    if not isinstance(value, list) or len(value) not in (2, 3):
        raise mistake(f"expected a point, found {shown(value)}", "write it as [x, y] or [x, y, z]")
    return value if len(value) == 3 else [*value, 0.0]


def _list(value: Any) -> Any:
    if not isinstance(value, list):
        raise mistake(f"expected a list of points, found {shown(value)}", "write [[x, y, z], …]")
    return value


def _interval(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 2:
        raise mistake(f"expected an interval, found {shown(value)}", "write s: [from, to]")
    return value


def _increasing(value: tuple[float, float]) -> tuple[float, float]:
    if not value[0] < value[1]:
        raise mistake(f"the interval from {value[0]:.6g} to {value[1]:.6g} is empty", "write s: [from, to]")
    return value


_Written = Annotated[list[Length], Field(min_length=2, max_length=3)]
CurvePoint = Annotated[tuple[Length, Length, Length], BeforeValidator(_two_or_three, json_schema_input_type=_Written)]


class PointsCurveSection(Section):
    """A smooth curve through points."""

    points: Annotated[tuple[CurvePoint, ...], BeforeValidator(_list)] = Field(
        description="points [x, y] or [x, y, z] of a cubic spline, in the frame of the body that carries it (m)"
    )
    closed: StrictBool = Field(False, description="true: the last point is followed by the first")

    def check(self, at: Place, closed: bool) -> None:
        """Refuse points through which no curve goes."""
        _check_points(self.points, closed, [(*at, "points", place) for place in range(len(self.points))], at)

    def build(self, closed: bool) -> Curve:
        """The frozen description; `closed` whatever the section says."""
        return SplineCurve(self.points, closed)


@dataclass(frozen=True)
class PointsFile:
    """A file's points (m) and their lines in it."""

    name: str
    points: tuple[Vector, ...]
    lines: tuple[int, ...]


@dataclass(frozen=True)
class _ReadPoints:
    """Marks a `PointsFile` written as path from the model file's folder; the key `unit` stands before it."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"type": "string"}

    def _read(self, value: Any, info: ValidationInfo) -> PointsFile:
        if not isinstance(value, str):
            raise mistake(f"expected the path of a file, found {shown(value)}")
        path = Path(context_of(info).folder, value)
        try:
            return PointsFile(str(path), *read_points(path, info.data.get("unit", 1.0)))
        except ModelError as error:
            raise mistake_of(error) from None


class FileCurveSection(Section):
    """A smooth curve through the points of a file."""

    unit: FileUnit = Field(1.0, description='length of one unit of the file: "mm", "in", or a number in metres')
    file: Annotated[PointsFile, _ReadPoints()] = Field(
        description="CSV file with columns x, y and perhaps z of points in the frame of the body that carries the curve"
    )
    closed: StrictBool = Field(False, description="true: the last point is followed by the first")

    def check(self, at: Place, closed: bool) -> None:
        """Refuse points through which no curve goes, with their lines in the file."""
        _check_points(self.file.points, closed, [(*at, "file")] * len(self.file.points), (*at, "file"), self.file)

    def build(self, closed: bool) -> Curve:
        """The frozen description; `closed` whatever the section says."""
        return SplineCurve(self.file.points, closed)


class ExpressionCurveSection(Section):
    """A curve by formulas in a parameter."""

    x: LengthInS = Field(description="x of its points (m) as expression in s, frame of the body that carries it")
    y: LengthInS = Field(description="y of its points (m) as expression in s")
    z: LengthInS | None = Field(None, description="z of its points (m) as expression in s; default 0")
    s: Annotated[tuple[_Parameter, _Parameter], AfterValidator(_increasing), BeforeValidator(_interval)] = Field(
        description="[from, to]: where the parameter s runs"
    )
    closed: StrictBool = Field(False, description="true: its end is its start")

    def check(self, at: Place, closed: bool) -> None:
        """Refuse formulas without value somewhere, curves that stand still, closed ones with a gap."""
        parameters = np.linspace(*self.s, SAMPLES)
        points = sampled((self.x, self.y, self.z or _ZERO), parameters, [(*at, key) for key in "xyz"])
        size = float(np.ptp(points, axis=0).max())
        still = np.linalg.norm(np.diff(points, axis=0), axis=1) <= SAME / SAMPLES * size
        if still.any():
            where = parameters[int(np.argmax(still))]
            raise mistake(f"the curve stands still near s = {where:.6g}", "each s must give another point", at)
        gap = float(np.linalg.norm(points[-1] - points[0]))
        if closed and gap > CLOSES * size:
            remedy = "let s run once around"
            raise mistake(f"the curve is closed, but its end is {gap:.6g} m from its start", remedy, (*at, "s"))

    def build(self, closed: bool) -> Curve:
        """The frozen description; `closed` whatever the section says."""
        return ExpressionCurve(self.x, self.y, self.z or _ZERO, self.s, closed)


class PolarProfileSection(Section):
    """A closed profile by its distance from the body's origin, in the plane normal to the cam's axis."""

    radius: LengthInS = Field(
        description="distance from the body's origin (m) as expression in s, the angle (rad) about the cam's axis from "
        "the body's x axis (from y where x is the axis); it must have the period 2 pi"
    )

    def check(self, at: Place) -> None:
        """Refuse radii that are not positive and do not close."""
        parameters = np.linspace(0.0, 2.0 * math.pi, SAMPLES)
        radii = sampled((self.radius,), parameters, [(*at, "radius")])[:, 0]
        if radii.min() <= 0.0:
            where = parameters[int(np.argmin(radii))]
            raise mistake(f"the radius is {radii.min():.6g} m at s = {where:.6g}", "", (*at, "radius"))
        if abs(radii[-1] - radii[0]) > CLOSES * radii.max():
            raise mistake(
                f"the profile does not close: the radius is {radii[0]:.6g} m at s = 0, {radii[-1]:.6g} m at s = 2 pi",
                "use functions of period 2 pi, such as cos(s)",
                (*at, "radius"),
            )


def sampled(
    formulas: Sequence[Formula], parameters: NDArray[np.float64], places: Sequence[Place]
) -> NDArray[np.float64]:
    """Values (n, k) of k formulas in s at n parameters; those without a finite value are refused at their places."""
    columns = []
    for formula, at in zip(formulas, places, strict=True):
        values = evaluate(formula.codes, formula.values, [parameters])
        wrong = ~(np.abs(values) < LARGEST)
        if wrong.any():
            where = parameters[int(np.argmax(wrong))]
            remedy = "keep the expression inside the domain of its functions"
            raise mistake(f"'{formula.text}' has no finite value at s = {where:.6g}", remedy, at)
        columns.append(values)
    return np.stack(columns, axis=1)


def _check_points(
    points: Sequence[Vector], closed: bool, places: Sequence[Place], whole: Place, file: PointsFile | None = None
) -> None:
    """Refuse too few points, and neighbours that coincide. places : of every point in the model file."""
    least = 3 if closed else 2
    name = file.name if file else ""

    def where(place: int) -> tuple[Place, str, int]:
        return places[place], name, file.lines[place] if file else 0

    if len(points) < least:
        kind = "a closed curve" if closed else "a curve"
        remedy = f"give {least} or more"
        raise mistake(f"{kind} needs at least {least} points, found {len(points)}", remedy, whole, name)
    array = np.array(points)
    near = SAME * float(np.ptp(array, axis=0).max())
    same = np.linalg.norm(np.diff(array, axis=0), axis=1) <= near
    if same.any():
        second = int(np.argmax(same)) + 1
        raise mistake(f"points {second} and {second + 1} are the same", "remove one of them", *where(second))
    if closed and float(np.linalg.norm(array[-1] - array[0])) <= near:
        remedy = "leave it out: a closed curve returns by itself"
        raise mistake("the last point is the first again", remedy, *where(len(points) - 1))


_check_curve, _curve_tag = by_key("points", "file", "x")
_check_profile, _profile_tag = by_key("points", "file", "radius", "x")
AnyCurve = Annotated[
    Annotated[PointsCurveSection, Tag("<points>")]
    | Annotated[FileCurveSection, Tag("<file>")]
    | Annotated[ExpressionCurveSection, Tag("<x>")],
    Discriminator(_curve_tag),
    _check_curve,
]
AnyProfile = Annotated[
    Annotated[PointsCurveSection, Tag("<points>")]
    | Annotated[FileCurveSection, Tag("<file>")]
    | Annotated[PolarProfileSection, Tag("<radius>")]
    | Annotated[ExpressionCurveSection, Tag("<x>")],
    Discriminator(_profile_tag),
    _check_profile,
]

"""Surfaces that bodies carry."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from ...model import units
from ...model.curves import ExpressionSurface, SplineSurface
from ...model.functions import Formula
from ...model.operations import Operation
from ...model.profiles import height_surface
from .fields import Length, Section, by_key
from .formulas import FormulaIn
from .mistakes import mistake, shown


class HeightSurfaceSection(Section):
    """A surface by its height over the x-y plane."""

    z: Annotated[Formula, FormulaIn(("x", "y"), units.LENGTH)] = Field(
        description="height z (m) as expression in x and y (m), in the frame of the body that carries it"
    )

    def build(self) -> ExpressionSurface:
        """The frozen description."""
        return height_surface(self.z)


class ImplicitSurfaceSection(Section):
    """The points at which an expression is zero."""

    implicit: Annotated[Formula, FormulaIn(("x", "y", "z"), units.NUMBER)] = Field(
        description="expression in x, y and z (m, frame of the body that carries it) that is 0 on the surface"
    )

    @model_validator(mode="after")
    def _depends_on_place(self) -> ImplicitSurfaceSection:
        if Operation.VARIABLE not in self.implicit.codes:
            raise mistake(
                f"'{self.implicit.text}' is the same everywhere", "write an expression in x, y, z", ("implicit",)
            )
        return self

    def build(self) -> ExpressionSurface:
        """The frozen description."""
        return ExpressionSurface(self.implicit)


def _list(value: Any) -> Any:
    if not isinstance(value, list):
        raise mistake(f"expected a list, found {shown(value)}")
    return value


_Lengths = Annotated[tuple[Length, ...], BeforeValidator(_list)]


class GridSurfaceSection(Section):
    """A smooth surface through heights over a grid."""

    x: _Lengths = Field(description="increasing x of the grid (m), in the frame of the body that carries it")
    y: _Lengths = Field(description="increasing y of the grid (m)")
    z: Annotated[tuple[_Lengths, ...], BeforeValidator(_list)] = Field(
        description="heights (m): a row for each x, with a height for each y"
    )

    @model_validator(mode="after")
    def _is_a_grid(self) -> GridSurfaceSection:
        for key, values in (("x", self.x), ("y", self.y)):
            if len(values) < 2:
                raise mistake(f"a grid needs two or more values of {key}, found {len(values)}", at=(key,))
            for place, (low, high) in enumerate(pairwise(values), start=1):
                if not low < high:
                    raise mistake(f"{key} must increase, found {high:.6g} after {low:.6g}", at=(key, place))
        if len(self.z) != len(self.x):
            raise mistake(f"{len(self.z)} rows of heights for {len(self.x)} values of x", at=("z",))
        for place, row in enumerate(self.z):
            if len(row) != len(self.y):
                raise mistake(f"{len(row)} heights for {len(self.y)} values of y", at=("z", place))
        return self

    def build(self) -> SplineSurface:
        """The frozen description."""
        return SplineSurface(self.x, self.y, self.z)


_check_surface, _surface_tag = by_key("implicit", "x", otherwise="height")
AnySurface = Annotated[
    Annotated[ImplicitSurfaceSection, Tag("<implicit>")]
    | Annotated[GridSurfaceSection, Tag("<x>")]
    | Annotated[HeightSurfaceSection, Tag("<height>")],
    Discriminator(_surface_tag),
    _check_surface,
]

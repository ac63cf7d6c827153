"""Formulas in named variables as values of keys."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from ...model.errors import ModelError
from ...model.expression import named_formula
from ...model.functions import Formula
from ...model.units import Dimension
from .fields import check_dimension, context_of, mistake_of, text_schema
from .mistakes import mistake, shown


@dataclass(frozen=True)
class FormulaIn:
    """Marks a `Formula` in some variables and the parameters, written as number, ``number unit`` or expression."""

    variables: tuple[str, ...]
    dimension: Dimension

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        what = f"expression in {', '.join(self.variables)} and the parameters"
        return {"anyOf": [{"type": "number"}, text_schema(self.dimension, what)]}

    def _read(self, value: Any, info: ValidationInfo) -> Formula:
        check_text(value, self.variables)
        context = context_of(info)
        try:
            if isinstance(value, str):
                check_dimension(value, (self.dimension,), context)
            return named_formula(value, self.variables, context.values)
        except ModelError as error:
            raise mistake_of(error) from None


def check_text(value: Any, variables: tuple[str, ...], at: tuple[str | int, ...] = ()) -> None:
    """Refuse what is neither a number nor a text."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise mistake(f"expected a number or an expression in {', '.join(variables)}, found {shown(value)}", at=at)

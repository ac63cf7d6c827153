"""The user's own rows, linear in velocities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from ....model import joints
from ....model.errors import ModelError
from ....model.expression import check_variable_name
from ....model.pfaffian import check_key, pfaffian_row
from ..ends import to_end
from ..fields import Section, context_of, mistake_of
from ..mistakes import KEY, mistake, shown

NUMBERED = ("first", "second", "third", "fourth", "fifth", "sixth")


def _ends(value: Any) -> Any:
    """Ends by name; those of a list are called first, second, …"""
    if isinstance(value, list) and 0 < len(value) <= len(NUMBERED):
        return dict(zip(NUMBERED, value, strict=False))
    if not isinstance(value, dict) or not value:
        raise mistake(
            f"expected named ends, found {shown(value)}",
            f"write between: {{blade: sled.front, g: ground}}, or a list of up to {len(NUMBERED)}",
        )
    for name in value:
        try:
            check_variable_name(name, "an end")
        except ModelError as error:
            raise mistake_of(error, (name, KEY)) from None
    return value


@dataclass(frozen=True)
class _Row:
    """Marks a `PfaffianRow`, whose ends the key `between` before it names."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        term = {"anyOf": [{"type": "number"}, {"type": "string", "description": "expression in t and the ends' poses"}]}
        return {
            "anyOf": [
                {"type": "object", "additionalProperties": term},
                {"type": "string", "description": "expression that is kept at 0, linear in the velocities"},
            ]
        }

    def _read(self, value: Any, info: ValidationInfo) -> joints.PfaffianRow:
        if not isinstance(value, (str, dict)):
            raise mistake(
                f"expected a row, found {shown(value)}", 'write {"first.v.x": 1, …} or "first.v.x - second.v.x"'
            )
        for key, factor in value.items() if isinstance(value, dict) else ():
            if isinstance(factor, bool) or not isinstance(factor, (int, float, str)):
                raise mistake(f"expected a number or an expression, found {shown(factor)}", at=(key,))
        ends = info.data.get("between")
        if ends is None:  # what is wrong with them has been said
            return joints.PfaffianRow({})
        for key in value if isinstance(value, dict) else ():
            try:
                check_key(key, ends)
            except ModelError as error:
                raise mistake_of(error, (key, KEY)) from None
        try:
            return pfaffian_row(value, ends, context_of(info).values)
        except ModelError as error:
            raise mistake_of(error, (error.path,) if error.path else ()) from None


def _some(value: Any) -> Any:
    if not isinstance(value, list) or not value:
        raise mistake(f"expected a list of rows, found {shown(value)}", "write rows: [{…}, …]")
    return value


class PfaffianSection(Section):
    """Rows that are linear in velocities and hold no position."""

    type: Literal["pfaffian"] = Field(description="pfaffian")
    between: Annotated[dict[str, str], BeforeValidator(_ends, json_schema_input_type=dict[str, str] | list[str])] = (
        Field(description="ends by name, {blade: sled.front, g: ground}, or a list: first, second, …")
    )
    rows: Annotated[tuple[Annotated[joints.PfaffianRow, _Row()], ...], BeforeValidator(_some)] = Field(
        description='rows kept at 0: {"blade.v.x": coefficient, …, constant: …} or "expression"; velocities v.x v.y v.z '
        "w.x w.y w.z, poses x y z r11 … r33 of the ends, global"
    )

    def build(self) -> joints.Pfaffian:
        """The frozen description."""
        return joints.Pfaffian({name: to_end(end) for name, end in self.between.items()}, self.rows)

"""Ends of joints, contacts, rods and springs."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Discriminator, Field, Tag

from ...model.geometry import Vector
from ...model.joints import GROUND, End
from .fields import Point, Section
from .mistakes import mistake, shown


def two(value: Any) -> Any:
    """A list of two ends."""
    if not isinstance(value, list) or len(value) != 2:
        raise mistake(f"expected two ends, found {shown(value)}", "write between: [first, second]")
    return value


def _end_kind(value: Any) -> Any:
    if not isinstance(value, (str, list)):
        raise mistake(f"expected body.attachment or a point [x, y, z], found {shown(value)}")
    return value


AnyEnd = Annotated[
    Annotated[str, Tag("<name>")] | Annotated[Point, Tag("<point>")],
    Discriminator(lambda value: "<name>" if isinstance(value, str) else "<point>"),
    BeforeValidator(_end_kind),
]
Bodies = Annotated[tuple[str, str], BeforeValidator(two)]
Points = Annotated[tuple[AnyEnd, AnyEnd], BeforeValidator(two)]


class BetweenSection(Section):
    """What holds two bodies at a point."""

    between: Bodies = Field(description="[first, second]: ground, a body, or body.attachment")
    at: Point | None = Field(
        None,
        description="the point, global, at t = 0 (m); needed if no attachment is named, refused with two",
    )

    def ends(self) -> tuple[End, End]:
        """The frozen descriptions of both."""
        return to_end(self.between[0]), to_end(self.between[1])


def to_end(end: str | Vector) -> End:
    """The frozen description of an end by name, or of a global point."""
    if not isinstance(end, str):
        return End(GROUND, point=end)
    body, _, attachment = end.partition(".")
    return End(body, attachment or None)

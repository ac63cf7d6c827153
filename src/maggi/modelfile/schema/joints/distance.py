"""Massless rods."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ....model.joints import Distance
from ..ends import Points, to_end
from ..fields import LengthFunction, Section


class DistanceSection(Section):
    """A massless rod with ball joints between two points."""

    type: Literal["distance"] = Field(description="distance")
    between: Points = Field(description="two ends: a body, body.attachment, or a global point [x, y, z]")
    length: LengthFunction | None = Field(None, description="length (m), may depend on t; left out: the initial one")

    def build(self) -> Distance:
        """The frozen description."""
        first, second = map(to_end, self.between)
        return Distance(first, second, self.length)

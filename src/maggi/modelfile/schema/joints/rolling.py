"""Rolling without slip, blades."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ....model.joints import KnifeEdge, Plane, RollingDisc, RollingSphere
from ..ends import BetweenSection
from ..fields import Direction, Point, PositiveLength, Section
from ..mistakes import mistake
from .pairs import PARALLEL, cosine

UP = (0.0, 0.0, 1.0)


class PlaneSection(Section):
    """A plane that the first body carries."""

    point: Point = Field((0.0, 0.0, 0.0), description="a point of it, global, at t = 0 (m); default the origin")
    normal: Direction = Field(UP, description="its normal, global, at t = 0; default [0, 0, 1]")

    def build(self) -> Plane:
        """The frozen description."""
        return Plane(self.point, self.normal)


class RollingSection(BetweenSection):
    """Something on the second body that rolls or slides on the first; `at` is by default the second's origin."""


class RollingDiscSection(RollingSection):
    """A thin disc rolls without slip on a plane, two-sided."""

    type: Literal["rolling-disc"] = Field(description="rolling-disc")
    radius: PositiveLength = Field(description="radius of the disc (m)")
    axis: Direction = Field(description="the disc's axis of revolution, global, at t = 0")
    plane: PlaneSection = Field(
        PlaneSection.model_construct(), description="{point, normal}, carried by the first body; default z = 0"
    )

    @model_validator(mode="after")
    def _stands(self) -> RollingDiscSection:
        if abs(cosine(self.axis, self.plane.normal)) > PARALLEL:
            raise mistake(
                "the disc lies flat: its axis is the plane's normal",
                "give the axis of revolution, not the direction it rolls in",
                ("axis",),
            )
        return self

    def build(self) -> RollingDisc:
        """The frozen description."""
        return RollingDisc(*self.ends(), self.radius, self.axis, self.plane.build(), self.at)


class RollingSphereSection(RollingSection):
    """A sphere rolls without slip on a plane, two-sided."""

    type: Literal["rolling-sphere"] = Field(description="rolling-sphere")
    radius: PositiveLength = Field(description="radius of the sphere (m)")
    plane: PlaneSection = Field(
        PlaneSection.model_construct(), description="{point, normal}, carried by the first body; default z = 0"
    )

    def build(self) -> RollingSphere:
        """The frozen description."""
        return RollingSphere(*self.ends(), self.radius, self.plane.build(), self.at)


class KnifeEdgeSection(RollingSection):
    """A blade, skate or wheel that moves along its direction only, not sideways."""

    type: Literal["knife-edge"] = Field(description="knife-edge")
    direction: Direction = Field(description="the permitted motion, global, at t = 0; fixed in the second body")
    normal: Direction = Field(UP, description="normal of the surface under it, global, at t = 0; default [0, 0, 1]")

    @model_validator(mode="after")
    def _has_sides(self) -> KnifeEdgeSection:
        if abs(cosine(self.direction, self.normal)) > PARALLEL:
            raise mistake(
                "direction and normal are parallel, so that there is no sideways",
                "direction lies in the surface, normal stands on it",
                ("direction",),
            )
        return self

    def build(self) -> KnifeEdge:
        """The frozen description."""
        return KnifeEdge(*self.ends(), self.direction, self.normal, self.at)

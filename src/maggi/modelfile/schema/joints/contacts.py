"""Points on curves and surfaces, cams."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from pydantic import Field, model_validator

from ....model.bodies import Body
from ....model.curves import Curve
from ....model.joints import Cam, PointOnCurve, PointOnSurface
from ....model.profiles import polar_profile
from ...frames import to_body_axes
from ..curves import AnyCurve, AnyProfile, PolarProfileSection
from ..ends import BetweenSection
from ..fields import Direction, PositiveLength
from ..mistakes import mistake
from ..surfaces import AnySurface
from .pairs import cosine

SQUARE = 1e-6
"""Cosine of the angle between two directions up to which they count as being at right angles."""


class ContactSection(BetweenSection):
    """A point of the second body, on something that the first carries."""


class PointOnCurveSection(ContactSection):
    """A point of the second body stays on a curve of the first."""

    type: Literal["point-on-curve"] = Field(description="point-on-curve")
    curve: AnyCurve = Field(
        description="curve in the frame of the first body: {points, closed}, {file, unit, closed} or {x, y, z, s, closed}"
    )

    @model_validator(mode="after")
    def _is_a_curve(self) -> PointOnCurveSection:
        self.curve.check(("curve",), self.curve.closed)
        return self

    def build(self) -> PointOnCurve:
        """The frozen description."""
        return PointOnCurve(*self.ends(), self.curve.build(self.curve.closed), self.at)


class PointOnSurfaceSection(ContactSection):
    """A point of the second body stays on a surface of the first."""

    type: Literal["point-on-surface"] = Field(description="point-on-surface")
    surface: AnySurface = Field(
        description="surface in the frame of the first body: {z} by its height, {implicit}, or heights {x, y, z} on a grid"
    )

    def build(self) -> PointOnSurface:
        """The frozen description."""
        return PointOnSurface(*self.ends(), self.surface.build(), self.at)


class CamSection(ContactSection):
    """A follower on a cam's profile, two-sided: it does not lift off."""

    type: Literal["cam"] = Field(description="cam")
    axis: Direction = Field(description="normal of the profile's plane, global, at t = 0")
    profile: AnyProfile = Field(
        description="closed curve in the frame of the first body: {radius} as expression in the angle s, {points}, "
        "{file, unit} or {x, y, z, s}"
    )
    roller: PositiveLength | None = Field(
        None, description="radius of the follower's roller (m); without roller and face it is a point"
    )
    face: Direction | None = Field(None, description="normal of the follower's flat face, global, at t = 0")

    @model_validator(mode="after")
    def _fits(self) -> CamSection:
        if self.roller is not None and self.face is not None:
            raise mistake("roller and face exclude each other", "keep one of them", ("face",))
        if self.face is not None and abs(cosine(self.face, self.axis)) > SQUARE:
            raise mistake(
                f"the face's normal must be at right angles to the axis, the cosine is {cosine(self.face, self.axis):.6g}",
                "the face touches the edge of the cam",
                ("face",),
            )
        if isinstance(self.profile, PolarProfileSection):
            self.profile.check(("profile",))
        elif "closed" in self.profile.model_fields_set and not self.profile.closed:
            raise mistake("a cam's profile is closed", "remove closed", ("profile", "closed"))
        else:
            self.profile.check(("profile",), closed=True)
        return self

    def build(self, bodies: Mapping[str, Body]) -> Cam:
        """The frozen description; of the bodies it needs how the cam lies at t = 0."""
        first, second = self.ends()
        profile: Curve
        if isinstance(self.profile, PolarProfileSection):
            profile = polar_profile(self.profile.radius, to_body_axes(self.axis, bodies.get(first.body)))
        else:
            profile = self.profile.build(closed=True)
        return Cam(first, second, profile, self.axis, self.roller or 0.0, self.face, self.at)

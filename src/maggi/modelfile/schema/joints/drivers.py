"""Drivers of joint coordinates."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ....model.functions import TimeFunction
from ....model.joints import Driver
from ..fields import AngleFunction, LengthFunction, Name, Section, SpeedFunction
from ..mistakes import mistake


class DriverSection(Section):
    """Prescribes a joint's coordinate as a function of time."""

    type: Literal["driver"] = Field(description="driver")
    joint: Name = Field(description="the joint that it drives")
    angle: AngleFunction | None = Field(None, description="angle (rad) as a function of t, 0 at t = 0")
    displacement: LengthFunction | None = Field(None, description="displacement (m) as a function of t, 0 at t = 0")
    speed: SpeedFunction | None = Field(None, description="speed (rad/s or m/s) as a function of t")

    @model_validator(mode="after")
    def _exactly_one(self) -> DriverSection:
        given = [key for key in ("angle", "displacement", "speed") if getattr(self, key) is not None]
        if len(given) != 1:
            raise mistake(
                f"a driver has exactly one of angle, displacement and speed, found {' and '.join(given) or 'none'}",
                "keep one of them" if given else "",
                tuple(given[1:2]),
            )
        return self

    @property
    def quantity(self) -> str:
        """``angle``, ``displacement`` or ``speed``."""
        return "angle" if self.angle else "displacement" if self.displacement else "speed"

    @property
    def function(self) -> TimeFunction:
        """The prescribed function."""
        function = self.angle or self.displacement or self.speed
        assert function is not None
        return function

    def build(self) -> Driver:
        """The frozen description."""
        return Driver(self.joint, self.quantity, self.function)

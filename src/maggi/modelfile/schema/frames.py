"""Prescribed frames, and what all bodies of the model file have."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from ...model.bodies import GivenMotion, RigidRunMotion
from ...model.expression import value_at
from ...model.geometry import Pose, Velocity
from .fields import AngleFunction, Direction, Name, PointFunction, Section, by_key
from .geometry import PoseSection, VelocitySection
from .mistakes import mistake

Held = tuple[Name, ...]

ORIGIN_GAP = 1e-9
"""Largest difference (m) of a pose's origin and where the prescribed frame's functions begin."""


class GivenFrameSection(Section):
    """A frame that moves as given functions of time say."""

    origin: PointFunction | None = Field(None, description="origin as 3 functions of t, global (m)")
    axis: Direction | None = Field(None, description="axis of the turn, body axes")
    angle: AngleFunction | None = Field(None, description="angle of the turn as a function of t (rad)")
    held: Held = Field((), description="attachments clamped to the frame")

    @model_validator(mode="after")
    def _complete(self) -> GivenFrameSection:
        if (self.axis is None) != (self.angle is None):
            missing = "axis" if self.axis is None else "angle"
            raise mistake(f"axis and angle belong together; {missing} is missing", f"give {missing} too")
        if self.origin is None and self.angle is None:
            raise mistake("a prescribed frame needs origin, or axis and angle", "or leave frame out: the body is free")
        return self

    def build(self) -> GivenMotion:
        """The frozen description."""
        return GivenMotion(self.origin, self.axis, self.angle, self.held)


class RigidRunFrameSection(Section):
    """A frame that moves as the body does in a run with all bodies rigid."""

    motion: Literal["rigid-run"] = Field(description="rigid-run")
    held: Held = Field((), description="attachments clamped to the frame")

    def build(self) -> RigidRunMotion:
        """The frozen description."""
        return RigidRunMotion(self.held)


_check_frame, _frame_tag = by_key("motion", otherwise="given")
AnyFrame = Annotated[
    Annotated[RigidRunFrameSection, Tag("<motion>")] | Annotated[GivenFrameSection, Tag("<given>")],
    Discriminator(_frame_tag),
    _check_frame,
]


class BodySection(Section):
    """What all bodies have."""

    pose: PoseSection | None = Field(None, description="the body frame at t = 0; default: the global frame")
    velocity: VelocitySection | None = Field(
        None, description="given velocity at t = 0; a body without is free to start as its joints let it"
    )

    def _placed(self, frame: AnyFrame | None) -> tuple[Pose, Velocity]:
        """Pose and velocity; a frame whose origin is given as functions starts at their values."""
        pose = self.pose.build() if self.pose else Pose()
        if frame is not None and self.velocity is not None:
            raise mistake("a body on a prescribed frame has its velocity from it", "remove velocity", ("velocity",))
        if isinstance(frame, GivenFrameSection) and frame.origin is not None:
            x, y, z = (value_at(component, [0.0])[0] for component in frame.origin)
            given = self.pose.origin if self.pose else None
            if given is not None and not max(abs(a - b) for a, b in zip(given, (x, y, z), strict=True)) <= ORIGIN_GAP:
                start = [float(f"{value:.9g}") for value in (x, y, z)]
                raise mistake(
                    f"pose.origin is {list(given)}, but the frame's origin begins at {start}",
                    "remove pose.origin",
                    ("pose", "origin"),
                )
            pose = Pose((x, y, z), pose.rotation)
        return pose, self.velocity.build() if self.velocity else Velocity()

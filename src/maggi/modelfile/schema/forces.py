"""Forces of the model file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from ...model import units
from .ends import Points
from .fields import Angle, LoadFunction, Name, Number, PositiveLength, Section, by_value


class LoadSection(Section):
    """A force or a torque on an attachment."""

    type: Literal["force", "torque"] = Field(description="force, torque")
    on: str = Field(description="body.attachment; a rigid body alone stands for its frame's origin")
    value: LoadFunction = Field(description="3 components (N or N m), numbers or functions of t")
    frame: Literal["global", "body"] = Field("global", description="body: the components turn with the body")


class SpringDamperSection(Section):
    """A linear spring-damper between two points."""

    type: Literal["spring-damper"] = Field(description="spring-damper")
    between: Points = Field(description="two ends: body.attachment, or a global point [x, y, z]")
    stiffness: Annotated[float, Field(ge=0), Number(units.STIFFNESS)] = Field(0.0, description="stiffness (N/m)")
    damping: Annotated[float, Field(ge=0), Number(units.DAMPING)] = Field(0.0, description="damping (N s/m)")
    length: PositiveLength | None = Field(None, description="free length (m); left out: the initial one")


class TorsionSpringSection(Section):
    """A spring-damper on a joint's rotation."""

    type: Literal["torsion-spring"] = Field(description="torsion-spring")
    joint: Name = Field(description="a joint with an angle: revolute, cylindrical, screw or planar")
    stiffness: Annotated[float, Field(ge=0), Number(units.TORSION_STIFFNESS)] = Field(
        0.0, description="stiffness (N m/rad)"
    )
    damping: Annotated[float, Field(ge=0), Number(units.TORSION_DAMPING)] = Field(
        0.0, description="damping (N m s/rad)"
    )
    angle: Angle | None = Field(None, description="free angle (rad); left out: the initial one")


_check_type, _ = by_value("type", ("force", "torque", "spring-damper", "torsion-spring"))


def _tag(value: Any) -> str:
    return "<load>" if value["type"] in ("force", "torque") else f"<{value['type']}>"


AnyForce = Annotated[
    Annotated[LoadSection, Tag("<load>")]
    | Annotated[SpringDamperSection, Tag("<spring-damper>")]
    | Annotated[TorsionSpringSection, Tag("<torsion-spring>")],
    Discriminator(_tag),
    _check_type,
]

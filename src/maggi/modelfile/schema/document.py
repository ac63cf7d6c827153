"""A whole model file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from ...model.joints import GROUND
from .bodies import AnyBody
from .fields import AccelerationVector, Name, Section, Text, empty_is_none
from .forces import AnyForce
from .joints import AnyJoint
from .materials import MaterialSection
from .mistakes import KEY, mistake, shown
from .simulation import OutputsSection, SimulationSection


def _version(value: Any) -> Any:
    if type(value) is not int or value != 1:
        raise mistake(f"unknown version of the format: {shown(value)}", "write maggi: 1")
    return value


def _no_ground(value: Any) -> Any:
    if isinstance(value, dict) and GROUND in value:
        raise mistake("'ground' is reserved for the global frame", "rename the body", (GROUND, KEY))
    return value


def _some(value: Any) -> Any:
    if isinstance(value, dict) and not value:
        raise mistake("a model needs at least one body")
    return value


class Document(Section):
    """A mechanism: bodies, joints and drivers, forces, and what to compute. Numbers are SI units and radians."""

    maggi: Annotated[Literal[1], BeforeValidator(_version)] = Field(description="version of the format: 1")
    title: Text = Field("", description="a title for plots and results")
    gravity: AccelerationVector = Field((0.0, 0.0, 0.0), description="acceleration of gravity, global (m/s²)")
    parameters: Annotated[dict[str, float | int | str], BeforeValidator(empty_is_none)] = Field(
        default_factory=dict,
        description='named values for expressions: a number (SI), a text such as "1500 rpm", or an expression',
    )
    materials: Annotated[dict[Name, MaterialSection], BeforeValidator(empty_is_none)] = Field(
        default_factory=dict, description="named materials"
    )
    bodies: Annotated[dict[Name, AnyBody], BeforeValidator(_some), BeforeValidator(_no_ground)] = Field(
        description="named bodies"
    )
    joints: Annotated[dict[Name, AnyJoint], BeforeValidator(empty_is_none)] = Field(
        default_factory=dict, description="named joints and drivers"
    )
    forces: Annotated[dict[Name, AnyForce], BeforeValidator(empty_is_none)] = Field(
        default_factory=dict, description="named loads, springs and dampers; gravity has its own key"
    )
    outputs: OutputsSection | None = Field(None, description="what the result file keeps")
    simulation: SimulationSection | None = Field(None, description="a run in time")

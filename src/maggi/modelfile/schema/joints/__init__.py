"""Everything that stands under `joints`: joints proper, drivers, couplers, rods, contacts, rolling, rows."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Discriminator, Tag

from ..fields import by_value
from .contacts import CamSection, ContactSection, PointOnCurveSection, PointOnSurfaceSection
from .couplers import BeltSection, CouplerSection, GearSection, RackSection
from .distance import DistanceSection
from .drivers import DriverSection
from .pairs import (
    AxisJointSection,
    ConstantVelocitySection,
    JointSection,
    PointJointSection,
    ScrewSection,
    UniversalSection,
)
from .pfaffian import PfaffianSection
from .relations import LinearCouplerSection, RelationCouplerSection
from .rolling import KnifeEdgeSection, RollingDiscSection, RollingSection, RollingSphereSection

__all__ = [
    "AnyJoint",
    "CamSection",
    "ContactSection",
    "CouplerSection",
    "DistanceSection",
    "DriverSection",
    "JointSection",
    "PfaffianSection",
    "RelationCouplerSection",
    "RollingSection",
]

_POINT = ("spherical", "weld", "free")
_AXIS = ("revolute", "prismatic", "cylindrical", "planar")
_OTHERS = (
    ("screw", "universal", "constant-velocity", "driver", "gear", "rack", "belt", "coupler", "distance")
    + ("point-on-curve", "point-on-surface", "cam", "rolling-disc", "rolling-sphere", "knife-edge", "pfaffian")
)  # fmt: skip
_check_type, _ = by_value("type", (*_AXIS, *_POINT, *_OTHERS))


def _tag(value: Any) -> str:
    kind = value["type"]
    if kind == "coupler":
        return "<relation>" if "relation" in value else "<coefficients>"
    return "<point>" if kind in _POINT else "<axis>" if kind in _AXIS else f"<{kind}>"


AnyJoint = Annotated[
    Annotated[AxisJointSection, Tag("<axis>")]
    | Annotated[PointJointSection, Tag("<point>")]
    | Annotated[ScrewSection, Tag("<screw>")]
    | Annotated[UniversalSection, Tag("<universal>")]
    | Annotated[ConstantVelocitySection, Tag("<constant-velocity>")]
    | Annotated[DriverSection, Tag("<driver>")]
    | Annotated[GearSection, Tag("<gear>")]
    | Annotated[RackSection, Tag("<rack>")]
    | Annotated[BeltSection, Tag("<belt>")]
    | Annotated[RelationCouplerSection, Tag("<relation>")]
    | Annotated[LinearCouplerSection, Tag("<coefficients>")]
    | Annotated[DistanceSection, Tag("<distance>")]
    | Annotated[PointOnCurveSection, Tag("<point-on-curve>")]
    | Annotated[PointOnSurfaceSection, Tag("<point-on-surface>")]
    | Annotated[CamSection, Tag("<cam>")]
    | Annotated[RollingDiscSection, Tag("<rolling-disc>")]
    | Annotated[RollingSphereSection, Tag("<rolling-sphere>")]
    | Annotated[KnifeEdgeSection, Tag("<knife-edge>")]
    | Annotated[PfaffianSection, Tag("<pfaffian>")],
    Discriminator(_tag),
    _check_type,
]

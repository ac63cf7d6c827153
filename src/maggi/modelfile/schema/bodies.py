"""Bodies of the model file: rigid, elastic, Ritz."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from ...model.bodies import Body, CraigBampton, ElasticBody, FrameMotion, RigidBody
from ...model.materials import Material
from .attachments import NodesAttachmentSection, PointAttachmentSection
from .fields import (
    Name,
    Point,
    PositiveMass,
    Section,
    Text,
    by_value,
    count_up_to,
    empty_is_none,
    not_built_unless,
)
from .frames import AnyFrame, BodySection, GivenFrameSection
from .geometry import InertiaTensor
from .materials import MaterialSection
from .meshes import AnyMesh
from .mistakes import mistake, shown
from .ritz import RitzBodySection

Materials = Mapping[str, Material]


class RigidBodySection(BodySection):
    """A rigid body."""

    kind: Literal["rigid"] = Field(description="rigid")
    mass: PositiveMass = Field(description="mass (kg)")
    center_of_mass: Point = Field((0.0, 0.0, 0.0), description="centre of mass, body frame (m)")
    inertia: InertiaTensor | None = Field(
        None, description="inertia about the centre of mass, body axes (kg m²): diagonal or 3x3; default zero"
    )
    attachments: Annotated[dict[Name, PointAttachmentSection], BeforeValidator(empty_is_none)] = Field(
        default_factory=dict, description="named frames that joints and forces hold"
    )
    frame: GivenFrameSection | None = Field(None, description="a prescribed motion of the body")

    @model_validator(mode="after")
    def _starts_on_its_frame(self) -> RigidBodySection:
        self._placed(self.frame)
        if self.frame is not None and self.frame.held:
            raise mistake("a rigid body moves with its frame and holds nothing", "remove held", ("frame", "held"))
        return self

    def build(self, materials: Materials) -> Body:
        """The frozen description."""
        pose, velocity = self._placed(self.frame)
        given: dict[str, Any] = {} if self.inertia is None else {"inertia": self.inertia}
        return RigidBody(
            self.mass,
            self.center_of_mass,
            pose=pose,
            velocity=velocity,
            attachments={name: attachment.build() for name, attachment in self.attachments.items()},
            motion=self.frame.build() if self.frame else None,
            **given,
        )


def _material_kind(value: Any) -> Any:
    if not isinstance(value, (str, dict)):
        raise mistake(f"expected the name of a material or its keys, found {shown(value)}")
    return value


AnyMaterial = Annotated[
    Annotated[Text, Tag("<name>")] | Annotated[MaterialSection, Tag("<keys>")],
    Discriminator(lambda value: "<name>" if isinstance(value, str) else "<keys>"),
    BeforeValidator(_material_kind),
]


MOST_MODES = 1000


class CraigBamptonSection(Section):
    """A reduction to modes with the attachments held and the static shapes of the attachments' motions."""

    method: Literal["craig-bampton"] = Field(description="craig-bampton")
    modes: count_up_to(MOST_MODES, least=0) = Field(  # type: ignore[valid-type]
        description="how many of the lowest modes with all attachments held; 0: static shapes alone"
    )

    def build(self) -> CraigBampton:
        """The frozen description."""
        return CraigBampton(self.modes)


def _reduction_kind(value: Any) -> Any:
    remedy = "write none, or {method: craig-bampton, modes: 12}"
    if value == "none" and isinstance(value, str):
        return value
    if not isinstance(value, dict):
        raise mistake(f"unknown reduction {shown(value)}", remedy)
    if "method" not in value:
        raise mistake("missing key 'method'", remedy, ("method",))
    if value["method"] != "craig-bampton":
        raise mistake(f"unknown method {shown(value['method'])}", "the method is craig-bampton", ("method",))
    return value


AnyReduction = Annotated[
    Annotated[Literal["none"], Tag("<none>")] | Annotated[CraigBamptonSection, Tag("<keys>")],
    Discriminator(lambda value: "<none>" if isinstance(value, str) else "<keys>"),
    BeforeValidator(_reduction_kind),
]


class ElasticBodySection(BodySection):
    """An elastic body from a mesh, on a floating or a prescribed frame."""

    kind: Literal["elastic"] = Field(description="elastic")
    mesh: AnyMesh = Field(description="{file, unit}, {box: …} or {beam: …}")
    material: AnyMaterial | None = Field(
        None, description="a material's name or its keys; left out: the mesh file's own material"
    )
    reduction: AnyReduction = Field(
        "none", description="none: the full mesh moves; {method: craig-bampton, modes}: it moves in a few shapes"
    )
    geometric_stiffening: Annotated[
        Literal[False],
        not_built_unless(False, "geometric stiffening", "write geometric_stiffening: false, or leave the key out"),
    ] = Field(False, description="false")
    attachments: Annotated[dict[Name, NodesAttachmentSection], BeforeValidator(empty_is_none)] = Field(
        default_factory=dict, description="named frames on sets of nodes, that joints and forces hold"
    )
    frame: AnyFrame | None = Field(
        None,
        description="a prescribed frame: {motion: rigid-run, held} or {origin, axis, angle, held}; default floating",
    )

    @model_validator(mode="after")
    def _starts_on_its_frame(self) -> ElasticBodySection:
        self._placed(self.frame)
        return self

    def build(self, materials: Materials) -> Body:
        """The frozen description; a material that is not there counts as none."""
        pose, velocity = self._placed(self.frame)
        material = self.material.build() if isinstance(self.material, MaterialSection) else None
        if isinstance(self.material, str):
            material = materials.get(self.material)
        motion: FrameMotion | None = self.frame.build() if self.frame else None
        attachments = {name: attachment.build() for name, attachment in self.attachments.items()}
        reduction = self.reduction.build() if isinstance(self.reduction, CraigBamptonSection) else None
        return ElasticBody(self.mesh.build(), material, pose, velocity, attachments, motion, reduction)


_check_kind, _kind_tag = by_value("kind", ("rigid", "elastic", "ritz"))
AnyBody = Annotated[
    Annotated[RigidBodySection, Tag("<rigid>")]
    | Annotated[ElasticBodySection, Tag("<elastic>")]
    | Annotated[RitzBodySection, Tag("<ritz>")],
    Discriminator(_kind_tag),
    _check_kind,
]

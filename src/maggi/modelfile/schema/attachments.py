"""Attachments, point masses and selections of nodes."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from ...model.attachments import ZERO, Attachment, BoxSet, NamedSet, NodeSelection, PlaneSet, PointMass
from ...model.geometry import Matrix
from .fields import Direction, Point, PositiveLength, PositiveMass, Section, Text
from .geometry import InertiaTensor
from .mistakes import mistake, shown


class PointMassSection(Section):
    """A rigid mass on an attachment."""

    mass: PositiveMass = Field(description="mass (kg)")
    offset: Point = Field((0.0, 0.0, 0.0), description="its centre from the attachment's point, body axes (m)")
    inertia: InertiaTensor | None = Field(
        None, description="inertia about its centre, body axes (kg m²): diagonal or 3x3"
    )

    def build(self) -> PointMass:
        """The frozen description."""
        tensor: Matrix = self.inertia or ZERO  # type: ignore[assignment]  # the validator gives a Matrix
        return PointMass(self.mass, self.offset, tensor)


class PointAttachmentSection(Section):
    """An attachment at a point of a rigid or Ritz body."""

    at: Point = Field(description="its point, body frame (m)")
    point_masses: tuple[PointMassSection, ...] = Field((), description="rigid masses fixed to it")

    def build(self) -> Attachment:
        """The frozen description."""
        return Attachment(at=self.at, point_masses=tuple(mass.build() for mass in self.point_masses))


def _two_points(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 2:
        raise mistake(f"expected two corners, found {shown(value)}", "write [[x0, y0, z0], [x1, y1, z1]]")
    return value


def _ordered(value: tuple[tuple[float, ...], tuple[float, ...]]) -> Any:
    if any(low > high for low, high in zip(*value, strict=True)):
        raise mistake("the first corner must be the lower one in x, y and z", "exchange the coordinates")
    return value


class BoxSelection(Section):
    """The nodes in a box."""

    box: Annotated[tuple[Point, Point], AfterValidator(_ordered), BeforeValidator(_two_points)] = Field(
        description="two corners [[x0, y0, z0], [x1, y1, z1]], body frame (m); faces included"
    )

    def build(self) -> NodeSelection:
        """The frozen description."""
        return BoxSet(*self.box)


class PlaneKeys(Section):
    """A plane."""

    point: Point = Field(description="a point of the plane, body frame (m)")
    normal: Direction = Field(description="its normal, body axes; any length")
    tolerance: PositiveLength = Field(1e-6, description="largest distance of a selected node (m)")


class PlaneSelection(Section):
    """The nodes on a plane."""

    plane: PlaneKeys = Field(description="the plane")

    def build(self) -> NodeSelection:
        """The frozen description."""
        return PlaneSet(self.plane.point, self.plane.normal, self.plane.tolerance)


def _selection_kind(value: Any) -> Any:
    if isinstance(value, str) or (isinstance(value, dict) and len({"box", "plane"} & value.keys()) == 1):
        return value
    raise mistake(
        f"expected the name of a node set, {{box: …}} or {{plane: …}}, found {shown(value)}",
    )


def _selection_tag(value: Any) -> str:
    return "<set>" if isinstance(value, str) else "<box>" if "box" in value else "<plane>"


AnySelection = Annotated[
    Annotated[Text, Tag("<set>")] | Annotated[BoxSelection, Tag("<box>")] | Annotated[PlaneSelection, Tag("<plane>")],
    Discriminator(_selection_tag),
    BeforeValidator(_selection_kind),
]


class NodesAttachmentSection(Section):
    """An attachment held by nodes of a mesh; its frame is at their centroid, body axes."""

    nodes: AnySelection = Field(description="a node set's name, {box: [[…], […]]} or {plane: {point, normal}}")
    coupling: Literal["rigid", "average"] = Field(
        "rigid", description="rigid: the nodes move as one piece (RBE2); average: they stay free (RBE3)"
    )
    point_masses: tuple[PointMassSection, ...] = Field((), description="rigid masses fixed to it")

    def build(self) -> Attachment:
        """The frozen description."""
        nodes = NamedSet(self.nodes) if isinstance(self.nodes, str) else self.nodes.build()
        return Attachment(None, nodes, self.coupling, tuple(mass.build() for mass in self.point_masses))

"""Where a body's mesh comes from."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, model_validator

from ...model import units
from ...model.meshes import BeamMesh, BoxMesh, FileMesh, MeshSource
from ...model.meshes import Section as BeamSection
from .fields import (
    Number,
    PositiveArea,
    PositiveLength,
    PositiveMoment,
    Section,
    Size,
    Text,
    by_key,
    count_up_to,
)
from .mistakes import mistake

MAX_BOX_CELLS = 2_000_000


def _unit_name(value: Any, info: ValidationInfo) -> Any:
    """``mm`` alone means 1 mm."""
    return f"1 {value}" if isinstance(value, str) and re.fullmatch(r"\s*[A-Za-zµμ]+\s*", value) else value


FileUnit = Annotated[float, Field(gt=0), Number(units.LENGTH), BeforeValidator(_unit_name)]


class FileMeshSection(Section):
    """A mesh file: Gmsh .msh, Abaqus or CalculiX .inp."""

    file: Text = Field(description="path of the mesh file, from the model file's folder")
    unit: FileUnit = Field(1.0, description='length of one unit of the file: "mm", "in", or a number in metres')

    def build(self) -> MeshSource:
        """The frozen description."""
        return FileMesh(self.file, self.unit)


class BoxKeys(Section):
    """A box of equal cells from the body's origin to `size`; node sets x_min, x_max, y_min, y_max, z_min, z_max."""

    size: Size = Field(description="edge lengths along x, y, z (m)")
    cells: tuple[count_up_to(100_000), count_up_to(100_000), count_up_to(100_000)] = Field(  # type: ignore[valid-type]
        description="number of cells along x, y, z"
    )
    cell: Literal["hex8", "hex20", "tet4", "tet10", "wedge6"] = Field("hex8", description="type of the cells")

    @model_validator(mode="after")
    def _bounded(self) -> BoxKeys:
        count = self.cells[0] * self.cells[1] * self.cells[2]
        if count > MAX_BOX_CELLS:
            raise mistake(f"{count} cells are more than {MAX_BOX_CELLS}", "use fewer cells", ("cells",))
        return self


class BoxMeshSection(Section):
    """A box of solid cells."""

    box: BoxKeys = Field(description="a box of solid cells")

    def build(self) -> MeshSource:
        """The frozen description."""
        return BoxMesh(self.box.size, self.box.cells, self.box.cell)


class CircleKeys(Section):
    """A solid circle."""

    diameter: PositiveLength = Field(description="diameter (m)")


class RectangleKeys(Section):
    """A solid rectangle."""

    y: PositiveLength = Field(description="width along the beam's y axis (m)")
    z: PositiveLength = Field(description="height along the beam's z axis (m)")


class CircularSection(Section):
    """A solid circular cross-section."""

    circle: CircleKeys = Field(description="a solid circle")

    def build(self) -> BeamSection:
        """The frozen description."""
        return BeamSection.circle(self.circle.diameter)


class RectangularSection(Section):
    """A solid rectangular cross-section."""

    rectangle: RectangleKeys = Field(description="a solid rectangle")

    def build(self) -> BeamSection:
        """The frozen description."""
        return BeamSection.rectangle(self.rectangle.y, self.rectangle.z)


class GeneralSection(Section):
    """A cross-section by its constants, principal axes y and z."""

    area: PositiveArea = Field(description="area (m²)")
    Iy: PositiveMoment = Field(description="second moment ∫z² dA (m⁴)")
    Iz: PositiveMoment = Field(description="second moment ∫y² dA (m⁴)")
    J: PositiveMoment = Field(description="torsion constant (m⁴)")
    ky: Annotated[float, Field(ge=0, le=1.5), Number(units.NUMBER)] = Field(
        0.0, description="shear factor along y; 0: no shear flexibility"
    )
    kz: Annotated[float, Field(ge=0, le=1.5), Number(units.NUMBER)] = Field(
        0.0, description="shear factor along z; 0: no shear flexibility"
    )

    def build(self) -> BeamSection:
        """The frozen description."""
        return BeamSection(self.area, self.Iy, self.Iz, self.J, self.ky, self.kz)


_check_section, _section_tag = by_key("circle", "rectangle", "area")
AnySection = Annotated[
    Annotated[CircularSection, Tag("<circle>")]
    | Annotated[RectangularSection, Tag("<rectangle>")]
    | Annotated[GeneralSection, Tag("<area>")],
    Discriminator(_section_tag),
    _check_section,
]


class BeamKeys(Section):
    """A straight beam along x from 0 to `length`; node sets start and end."""

    length: PositiveLength = Field(description="length (m)")
    section: AnySection = Field(description="cross-section: circle, rectangle, or area, Iy, Iz, J, ky, kz")
    elements: count_up_to(100_000) = Field(description="number of beam elements")  # type: ignore[valid-type]


class BeamMeshSection(Section):
    """A straight beam."""

    beam: BeamKeys = Field(description="a straight beam of equal elements")

    def build(self) -> MeshSource:
        """The frozen description."""
        return BeamMesh(self.beam.length, self.beam.section.build(), self.beam.elements)


_check_mesh, _mesh_tag = by_key("file", "box", "beam")
AnyMesh = Annotated[
    Annotated[FileMeshSection, Tag("<file>")]
    | Annotated[BoxMeshSection, Tag("<box>")]
    | Annotated[BeamMeshSection, Tag("<beam>")],
    Discriminator(_mesh_tag),
    _check_mesh,
]

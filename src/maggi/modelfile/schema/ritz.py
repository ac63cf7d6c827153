"""Ritz bodies: the paper's general element, given by shape functions and constants."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from ...model.bodies import Body, RitzBody, RitzTerms
from ...model.expression import Program
from ...model.materials import Material
from ...model.shapes import BoxQuadrature, ExpressionShapes, LineQuadrature, RitzIntegrals
from .attachments import PointAttachmentSection
from .fields import (
    ArrayOf,
    Coordinates,
    Name,
    Point,
    PositiveArea,
    PositiveDensity,
    PositiveLength,
    PositiveMass,
    Section,
    count_up_to,
    empty_is_none,
)
from .frames import BodySection, GivenFrameSection
from .geometry import InertiaTensor, to_matrix
from .mistakes import mistake

MAX_SHAPES = 200

Array = NDArray[np.float64]
Array1 = Annotated[np.ndarray[Any, Any], ArrayOf(1)]
Array2 = Annotated[np.ndarray[Any, Any], ArrayOf(2)]
Array3 = Annotated[np.ndarray[Any, Any], ArrayOf(3)]
Array4 = Annotated[np.ndarray[Any, Any], ArrayOf(4)]
Row = tuple[Annotated[Program, Coordinates()], ...]


class ShapesSection(Section):
    """Shape functions as expressions in x, y, z (body frame, m): one list of n for each displacement component."""

    x: Row = Field(description="n expressions: displacement along x")
    y: Row = Field(description="n expressions: displacement along y")
    z: Row = Field(description="n expressions: displacement along z")

    @model_validator(mode="after")
    def _same_number(self) -> ShapesSection:
        n = len(self.x)
        for key, row in (("x", self.x), ("y", self.y), ("z", self.z)):
            if len(row) != n or not 1 <= n <= MAX_SHAPES:
                raise mistake(
                    f"x, y and z need the same number of expressions, 1 to {MAX_SHAPES}; found {n} and {len(row)}",
                    "write 0 where a shape function has no such component",
                    (key,),
                )
        return self

    def build(self) -> ExpressionShapes:
        """The frozen description."""
        return ExpressionShapes((self.x, self.y, self.z))


class ConstantsSection(Section):
    """The constants of a Ritz body with n shape functions, SI units, body axes."""

    mass: PositiveMass = Field(description="mass (kg)")
    S0: Point = Field(description="first moment of the undeformed body about the frame's origin (kg m), 3 numbers")
    J0: InertiaTensor = Field(description="inertia of the undeformed body about the frame's origin (kg m²)")
    m: Array2 = Field(description="mass matrix (n, n): ∫ρ Nᵀ N dV")
    k: Array2 = Field(description="stiffness matrix (n, n)")
    D: Array2 | None = Field(None, description="damping matrix (n, n); default none")
    m_O: Array2 = Field(description="∫ρ Nᵀ dV (n, 3)")
    G: Array3 = Field(description="∫ρ Nᵀ ẽ_k N dV (3, n, n), each skew")
    H: Array4 = Field(description="∫ρ Nᵀ ẽ_k ẽ_l N dV (3, 3, n, n), H_lk = H_klᵀ")
    s: Array2 = Field(description="∫ρ Nᵀ ẽ_k r dV (3, n)")
    s2: Array3 = Field(description="∫ρ Nᵀ ẽ_k ẽ_l r dV (3, 3, n)")

    def check(self, n: int) -> None:
        """Shapes and symmetries that every such body has."""
        shapes = {"m": (n, n), "k": (n, n), "D": (n, n), "m_O": (n, 3), "G": (3, n, n), "H": (3, 3, n, n)}
        for key, wanted in {**shapes, "s": (3, n), "s2": (3, 3, n)}.items():
            array: Array | None = getattr(self, key)
            if array is not None and array.shape != wanted:
                raise mistake(
                    f"{key} has the shape {array.shape}, but {n} shape functions need {wanted}", at=("constants", key)
                )
        for key in ("m", "k", "D"):
            array = getattr(self, key)
            if array is not None:
                check_matrix(array, key, ("constants", key), strictly=key == "m")
        for k in range(3):
            _mirrored(self.G[k], -self.G[k].T, f"G[{k}] is not skew", ("constants", "G", k))
            for j in range(k + 1):
                _mirrored(
                    self.H[k, j], self.H[j, k].T, f"H[{k}][{j}] is not the transpose of H[{j}][{k}]", ("constants", "H")
                )

    def build(self, n: int) -> RitzTerms:
        """The frozen description."""
        D = np.zeros((n, n)) if self.D is None else self.D
        J0 = np.array(self.J0)
        return RitzTerms(self.mass, np.array(self.S0), J0, self.m, self.k, D, self.m_O, self.G, self.H, self.s, self.s2)


def _mirrored(one: Array, other: Array, message: str, at: tuple[str | int, ...]) -> None:
    if np.abs(one - other).max() > 1e-9 * np.abs(one).max():
        raise mistake(message, "check the values", at)


def check_matrix(array: Array, name: str, at: tuple[str | int, ...], *, strictly: bool = False) -> None:
    """Refuse a matrix that is not symmetric or not positive (strictly: positive definite)."""
    _mirrored(array, array.T, f"{name} is not symmetric", at)
    size = float(np.abs(array).max())
    if size == 0.0 and not strictly:
        return
    scaled = array / size if size > 0.0 else array
    lowest = float(np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[0])
    if lowest < -1e-9 or (strictly and lowest <= 0.0):
        raise mistake(f"{name} is not positive: its lowest eigenvalue is {lowest * size:.6g}", "check the values", at)


class LineSection(Section):
    """Gauss points along x."""

    length: PositiveLength = Field(description="the line runs from x = 0 to here (m)")
    area: PositiveArea = Field(description="area of the cross-section (m²)")
    order: count_up_to(64) = Field(12, description="number of Gauss points")  # type: ignore[valid-type]


class VolumeSection(Section):
    """Gauss points in a box."""

    low: Point = Field(description="lower corner, body frame (m)")
    high: Point = Field(description="upper corner, body frame (m)")
    order: count_up_to(32) = Field(8, description="number of Gauss points along each axis")  # type: ignore[valid-type]

    @model_validator(mode="after")
    def _has_volume(self) -> VolumeSection:
        if any(low >= high for low, high in zip(self.low, self.high, strict=True)):
            raise mistake("the box has no volume: low must be below high in x, y and z", at=("high",))
        return self


class IntegralsSection(Section):
    """What is needed to integrate the constants from the shape functions."""

    density: PositiveDensity = Field(description="density (kg/m³)")
    line: LineSection | None = Field(None, description="integrate along x: {length, area, order}")
    box: VolumeSection | None = Field(None, description="integrate over a box: {low, high, order}")
    stiffness: Array2 = Field(description="stiffness matrix (n, n)")
    damping: Array2 | None = Field(None, description="damping matrix (n, n); default none")
    J0: InertiaTensor | None = Field(
        None,
        description="inertia of the undeformed body about the frame's origin (kg m²), where the quadrature does not "
        "see all of it (a line has no extent of section); default: the integral",
    )

    @model_validator(mode="after")
    def _one_domain(self) -> IntegralsSection:
        if (self.line is None) == (self.box is None):
            raise mistake("expected exactly one of line and box", "line: along x with an area; box: over a volume")
        return self

    def check(self, n: int) -> None:
        """Shapes and symmetries."""
        for key, matrix in (("stiffness", self.stiffness), ("damping", self.damping)):
            at = ("integrals", key)
            if matrix is not None and matrix.shape != (n, n):
                raise mistake(f"{key} has the shape {matrix.shape}, but {n} shape functions need {(n, n)}", at=at)
            if matrix is not None:
                check_matrix(matrix, key, at)

    def build(self, n: int) -> RitzIntegrals:
        """The frozen description."""
        domain: LineQuadrature | BoxQuadrature
        if self.line is not None:
            domain = LineQuadrature(self.line.length, self.line.area, self.line.order)
        else:
            assert self.box is not None
            domain = BoxQuadrature(self.box.low, self.box.high, self.box.order)
        J0 = None if self.J0 is None else to_matrix(self.J0)
        return RitzIntegrals(self.density, domain, self.stiffness, self.damping, J0)


class InitialSection(Section):
    """Coordinates of the shape functions at t = 0."""

    coordinates: Array1 | None = Field(None, description="n coordinates; default zero")
    rates: Array1 | None = Field(None, description="n rates of the coordinates (1/s); default zero")


class RitzBodySection(BodySection):
    """An elastic body given by shape functions N(x) and constants, or what is needed to integrate them."""

    kind: Literal["ritz"] = Field(description="ritz")
    shapes: ShapesSection = Field(description="shape functions: expressions in x, y, z for each component")
    rotations: ShapesSection | None = Field(
        None, description="rotation of the material by each shape function, as shapes; default none"
    )
    constants: ConstantsSection | None = Field(None, description="the constants, given directly")
    integrals: IntegralsSection | None = Field(None, description="or integrated: density, line or box, stiffness")
    initial: InitialSection | None = Field(None, description="coordinates and rates at t = 0; default zero")
    attachments: Annotated[dict[Name, PointAttachmentSection], BeforeValidator(empty_is_none)] = Field(
        default_factory=dict, description="named frames that joints and forces hold; each moves with the shapes at it"
    )
    frame: GivenFrameSection | None = Field(None, description="a prescribed frame: {origin, axis, angle}")

    @model_validator(mode="after")
    def _consistent(self) -> RitzBodySection:
        n = len(self.shapes.x)
        if (self.constants is None) == (self.integrals is None):
            raise mistake("expected exactly one of constants and integrals", "see the description of Ritz bodies")
        if self.rotations is not None and len(self.rotations.x) != n:
            raise mistake(f"{len(self.rotations.x)} rotations for {n} shape functions", at=("rotations",))
        if self.constants is not None:
            self.constants.check(n)
        if self.integrals is not None:
            self.integrals.check(n)
        if self.initial is not None:
            for key, values in (("coordinates", self.initial.coordinates), ("rates", self.initial.rates)):
                if values is not None and values.shape != (n,):
                    raise mistake(f"{len(values)} {key} for {n} shape functions", at=("initial", key))
        if self.frame is not None and self.frame.held:
            raise mistake("shape functions carry their own supports", "remove held", ("frame", "held"))
        self._placed(self.frame)
        self._check_points()
        return self

    def _check_points(self) -> None:
        """Shape functions must have values at the attachments."""
        for name, attachment in self.attachments.items():
            for key, given in (("shapes", self.shapes), ("rotations", self.rotations)):
                if given is not None and not np.isfinite(given.build()(np.array([attachment.at]))).all():
                    raise mistake(
                        f"the {key} have no finite value at attachment '{name}' ({list(attachment.at)})",
                        "keep the expressions inside the domain of their functions",
                        (key,),
                    )

    def build(self, materials: dict[str, Material]) -> Body:
        """The frozen description."""
        n = len(self.shapes.x)
        pose, velocity = self._placed(self.frame)
        initial = None
        if self.initial is not None:
            start, rate = (
                tuple(np.zeros(n).tolist() if values is None else values.tolist())
                for values in (self.initial.coordinates, self.initial.rates)
            )
            initial = (start, rate)
        section = self.constants or self.integrals
        assert section is not None
        return RitzBody(
            section.build(n),
            self.shapes.build(),
            self.rotations.build() if self.rotations else None,
            initial,
            pose,
            velocity,
            {name: attachment.build() for name, attachment in self.attachments.items()},
            self.frame.build() if self.frame else None,
        )

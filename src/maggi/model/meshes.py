"""Where a body's mesh comes from: a file, a parametric box, or a parametric beam."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .geometry import Vector


@dataclass(frozen=True)
class FileMesh:
    """A mesh file; `unit` is the length of one file unit in metres (``mm`` is 1e-3)."""

    path: str
    unit: float = 1.0


@dataclass(frozen=True)
class BoxMesh:
    """A box from the body's origin to `size` (m), `cells` per axis; node sets ``x_min`` … ``z_max``."""

    size: Vector
    cells: tuple[int, int, int]
    cell: str = "hex8"


@dataclass(frozen=True)
class Section:
    """A beam's cross-section about its centroid, in the beam's own axes (x along the beam).

    area (m²), second moments Iy = ∫z² dA and Iz = ∫y² dA (m⁴), torsion constant J (m⁴), shear factors
    ky, kz (0: no shear flexibility, the Euler–Bernoulli beam). Principal axes; for others turn the body.
    """

    area: float
    Iy: float
    Iz: float
    J: float
    ky: float = 0.0
    kz: float = 0.0

    @staticmethod
    def circle(diameter: float) -> Section:
        """Solid circle; shear factors 0.9 (Timoshenko's value for ν = 0.3, rounded)."""
        area = math.pi * diameter**2 / 4.0
        inertia = math.pi * diameter**4 / 64.0
        return Section(area, inertia, inertia, 2.0 * inertia, 0.9, 0.9)

    @staticmethod
    def rectangle(y: float, z: float) -> Section:
        """Solid rectangle of width `y` and height `z`; shear factors 5/6, torsion by Saint-Venant's series."""
        long, short = max(y, z), min(y, z)
        series = sum(math.tanh(n * math.pi * long / (2.0 * short)) / n**5 for n in range(1, 40, 2))
        torsion = long * short**3 * (1.0 - 192.0 * short / (math.pi**5 * long) * series) / 3.0
        return Section(y * z, y * z**3 / 12.0, z * y**3 / 12.0, torsion, 5.0 / 6.0, 5.0 / 6.0)


@dataclass(frozen=True)
class BeamMesh:
    """A straight beam along the body's x axis from 0 to `length`; node sets ``start`` and ``end``."""

    length: float
    section: Section
    elements: int


MeshSource = FileMesh | BoxMesh | BeamMesh

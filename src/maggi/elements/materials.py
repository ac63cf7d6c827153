"""Isotropic elastic constants per cell, checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.model.errors import ModelError
from maggi.model.materials import Material

Array = NDArray[np.float64]
# No coordinate, density or modulus in SI units is larger; their products then stay finite.
LARGEST = 1e30
Labels = Mapping[str, Sequence[object] | NDArray[np.generic]]


@dataclass(frozen=True, eq=False)
class CellMaterials:
    """Density (kg/m³), Young's modulus (Pa) and Poisson's ratio of the c cells of one type, (c,) each."""

    density: Array
    young: Array
    poisson: Array

    @staticmethod
    def uniform(material: Material, count: int) -> CellMaterials:
        """The same material in `count` cells."""
        return CellMaterials(
            np.full(count, material.density), np.full(count, material.young), np.full(count, material.poisson)
        )

    @staticmethod
    def chosen(materials: Sequence[Material], index: NDArray[np.int64]) -> CellMaterials:
        """Material ``materials[index[c]]`` in cell c, index (c,)."""
        columns = np.array([[m.density, m.young, m.poisson] for m in materials])[index].T
        return CellMaterials(*(np.ascontiguousarray(column) for column in columns))

    @property
    def lame(self) -> Array:
        """Lamé's first constant λ (Pa), (c,)."""
        return self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson))

    @property
    def shear(self) -> Array:
        """Shear modulus (Pa), (c,)."""
        return self.young / (2.0 * (1.0 + self.poisson))


def check_materials(name: str, count: int, materials: CellMaterials, labels: Labels | None = None) -> None:
    """Refuse constants that no elastic solid has.

    Raises ModelError naming the cell and the value if density or Young's modulus is not positive and below 1e30, if
    Poisson's ratio lies outside (-1, 0.5), or if an array has not one entry per cell.
    """
    checks = (
        ("density", materials.density, 0.0, LARGEST, "give a positive density in kg/m³"),
        ("young", materials.young, 0.0, LARGEST, "give a positive Young's modulus in Pa"),
        ("poisson", materials.poisson, -1.0, 0.5, "Poisson's ratio of an elastic solid lies between -1 and 0.5"),
    )
    for key, values, low, high, remedy in checks:
        if values.shape != (count,):
            raise ModelError(f"{key} has shape {values.shape} for {count} {name} cells", remedy="give one per cell")
        wrong = np.flatnonzero(~((values > low) & (values < high)))
        if wrong.size:
            raise ModelError(
                f"{name} cell {cell_label(name, int(wrong[0]), labels)} has {key} {values[wrong[0]]:g}", remedy=remedy
            )


def cell_label(name: str, row: int, labels: Labels | None) -> str:
    """The label of a cell in its mesh file, or its row where there are no labels."""
    if labels is None or name not in labels:
        return f"at row {row}"
    return str(labels[name][row])

"""Materials and sections of an input file."""

from __future__ import annotations

import numpy as np

from maggi.model.materials import Material

from .inp_blocks import Block
from .inp_sets import NamedSets
from .mesh import IntArray
from .text import shorten


class MaterialReader:
    """Reads *MATERIAL, *ELASTIC, *DENSITY and *SOLID SECTION. Names are compared without regard to case."""

    def __init__(self) -> None:
        self._current = ""
        self._names: dict[str, str] = {}
        self._elastic: dict[str, tuple[float, float]] = {}
        self._density: dict[str, float] = {}

    def material(self, block: Block) -> None:
        """*MATERIAL: what follows belongs to it."""
        name = block.required("NAME")
        self._current = name.upper()
        self._names.setdefault(self._current, name)

    def elastic(self, block: Block) -> None:
        """*ELASTIC, isotropic: Young's modulus, Poisson's ratio."""
        kind = block.parameters.get("TYPE", "ISO").upper()
        if kind not in ("ISO", "ISOTROPIC"):
            block.fail(f"*ELASTIC, TYPE={shorten(kind)} is not read", "use an isotropic material")
        values = self._values(block)
        if len(values) < 2 or values[0] <= 0.0 or not -1.0 < values[1] < 0.5:
            remedy = "give Young's modulus > 0 and Poisson's ratio between -1 and 0.5"
            block.fail(f"*ELASTIC cannot be {values[:2]}", remedy, 0)
        self._elastic[self._current] = (values[0], values[1])

    def density(self, block: Block) -> None:
        """*DENSITY."""
        values = self._values(block)
        if not values or values[0] <= 0.0:
            block.fail(f"the density must be positive, found {values[:1]}", "correct the line", 0)
        self._density[self._current] = values[0]

    def _values(self, block: Block) -> list[float]:
        if not self._current:
            block.fail(f"{block.title} before any *MATERIAL", "put it after the *MATERIAL it belongs to")
        if len(block.rows) != 1:
            remedy = "give one line: properties that depend on temperature are not read"
            block.fail(f"{block.title} with {len(block.rows)} data lines", remedy)
        row, words = next(block.words())
        return block.floats(row, words)

    def complete(self, notes: list[str]) -> dict[str, Material]:
        """The materials with both stiffness and density; the others are noted."""
        materials: dict[str, Material] = {}
        for key, name in self._names.items():
            if key in self._elastic and key in self._density:
                materials[name] = Material(self._density[key], *self._elastic[key])
            else:
                missing = "*DENSITY" if key in self._elastic else "*ELASTIC"
                notes.append(f"material '{name}' has no {missing} and was passed over")
        return materials

    def sections(self, blocks: list[Block], sets: NamedSets, elements: int, materials: dict[str, Material]) -> IntArray:
        """For each element the index of its material in ``list(materials)``, −1 where it has none, (elements,)."""
        result = np.full(elements, -1, dtype=np.int64)
        index = {name: i for i, name in enumerate(materials)}
        for block in blocks:
            members = sets.require(block.required("ELSET"), block)
            name = self._names.get(block.required("MATERIAL").upper())
            if name is None:
                found = shorten(block.parameters["MATERIAL"])
                block.fail(f"there is no material '{found}'", "define it with *MATERIAL")
            if name not in index:
                continue
            if np.any((result[members] >= 0) & (result[members] != index[name])):
                remedy = "let every element be in one section only"
                block.fail("elements of this section already have another material", remedy)
            result[members] = index[name]
        return result

"""Named sets of an input file: labels, ranges, other sets and faces become indices."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .cells import CELL_TYPES
from .inp_blocks import Block
from .labels import LabelTable
from .mesh import ElementSet, IntArray
from .surface import free_faces
from .text import shorten


def _union(parts: Iterable[IntArray]) -> IntArray:
    return np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *parts]))


class NamedSets:
    """Sets of indices by name; names compared without regard to case, the first spelling kept."""

    def __init__(self, what: str) -> None:
        self.what = what
        self._members: dict[str, list[IntArray]] = {}
        self._names: dict[str, str] = {}

    def __contains__(self, name: str) -> bool:
        return name.upper() in self._members

    def add(self, name: str, members: IntArray) -> None:
        """Add to the set of this name."""
        key = name.upper()
        self._names.setdefault(key, name)
        self._members.setdefault(key, []).append(members)

    def require(self, name: str, block: Block, row: int | None = None) -> IntArray:
        """The members of a set, sorted; MeshError at the block's line if there is none of this name."""
        parts = self._members.get(name.upper())
        if parts is None:
            remedy = "define it before it is used, or correct the name"
            block.fail(f"there is no {self.what} set '{shorten(name)}'", remedy, row)
        if len(parts) > 1:  # joined once, however often it is asked for
            parts[:] = [_union(parts)]
        return parts[0]

    def all(self) -> dict[str, IntArray]:
        """Every set, sorted, under its name."""
        return {name: _union(self._members[key]) for key, name in self._names.items()}


class Numbering:
    """Elements counted through the whole file, and their places in the arrays of their types.

    cells : connectivity by type. kinds : for each element the index of its type in ``list(cells)``, (e,).
    """

    def __init__(self, cells: dict[str, IntArray], kinds: IntArray) -> None:
        self.cells = cells
        self.kinds = kinds
        self._places = np.zeros(len(kinds), dtype=np.int64)
        for i, connectivity in enumerate(cells.values()):
            self._places[kinds == i] = np.arange(len(connectivity))

    def by_type(self, elements: IntArray) -> ElementSet:
        """Elements as sorted indices into ``cells[type]``."""
        result: ElementSet = {}
        for i, kind in enumerate(self.cells):
            places = self._places[elements[self.kinds[elements] == i]]
            if len(places):
                result[kind] = np.sort(places)
        return result

    def nodes(self, elements: IntArray) -> IntArray:
        """All nodes of these elements."""
        return _union(self.cells[kind][places].ravel() for kind, places in self.by_type(elements).items())

    def face_nodes(self, elements: IntArray, face: str, block: Block, row: int) -> IntArray:
        """Nodes of one face, S1, S2, …, of each of these elements."""
        parts: list[IntArray] = []
        for kind, places in self.by_type(elements).items():
            faces = CELL_TYPES[kind].face_nodes
            names = [f"S{i}" for i in range(1, len(faces) + 1)]
            if face not in names:
                remedy = f"use one of {', '.join(names)}" if names else "name node sets on beams"
                block.fail(f"{kind} has no face '{shorten(face)}'", remedy, row)
            parts.append(self.cells[kind][places][:, faces[names.index(face)]].ravel())
        return _union(parts)

    def free_nodes(self, elements: IntArray) -> IntArray:
        """Nodes of the faces of these elements that lie on the surface of the whole mesh."""
        chosen = self.by_type(elements)
        parts: list[IntArray] = []
        for kind, pairs in free_faces(self.cells).items():
            mine = pairs[np.isin(pairs[:, 0], chosen.get(kind, np.zeros(0, np.int64)))]
            for j, face in enumerate(CELL_TYPES[kind].face_nodes):
                parts.append(self.cells[kind][mine[mine[:, 1] == j, 0]][:, face].ravel())
        return _union(parts)


class SetReader:
    """Reads *NSET, *ELSET and *SURFACE, in the order of the file."""

    def __init__(self, nodes: LabelTable, elements: LabelTable, numbering: Numbering) -> None:
        self._tables = {"node": nodes, "element": elements}
        self._numbering = numbering
        self.node_sets = NamedSets("node")
        self.element_sets = NamedSets("element")
        self.surfaces = NamedSets("surface")

    def node_set(self, block: Block) -> None:
        """*NSET, by labels, sets, GENERATE, or all nodes of an element set."""
        name = block.required("NSET")
        if elements := block.parameters.get("ELSET"):
            self.node_sets.add(name, self._numbering.nodes(self.element_sets.require(elements, block)))
        else:
            self.node_sets.add(name, self._members(block, self.node_sets))

    def element_set(self, block: Block) -> None:
        """*ELSET, by labels, sets or GENERATE."""
        self.element_sets.add(block.required("ELSET"), self._members(block, self.element_sets))

    def surface(self, block: Block) -> None:
        """*SURFACE: the nodes of element faces, of an element set's free faces, or nodes themselves."""
        name = block.required("NAME")
        kind = block.parameters.get("TYPE", "ELEMENT").upper()
        if kind not in ("ELEMENT", "NODE"):
            block.fail(f"*SURFACE, TYPE={shorten(kind)} is not read", "use TYPE=ELEMENT or TYPE=NODE")
        self.surfaces.add(name, np.zeros(0, dtype=np.int64))
        for row, words in block.words():
            if not words:
                continue
            if kind == "NODE":
                self.surfaces.add(name, self._one(block, row, words[0], self.node_sets))
                continue
            elements = self._one(block, row, words[0], self.element_sets)
            if len(words) > 1:
                self.surfaces.add(name, self._numbering.face_nodes(elements, words[1].upper(), block, row))
            else:
                self.surfaces.add(name, self._numbering.free_nodes(elements))

    def all_node_sets(self, notes: list[str]) -> dict[str, IntArray]:
        """Node sets and surfaces; a surface that shares a node set's name is called ``<name>_surface``."""
        sets = self.node_sets.all()
        for name, members in self.surfaces.all().items():
            if name not in self.node_sets:
                sets[name] = members
                continue
            sets[f"{name}_surface"] = members
            notes.append(f"a node set and a surface are called '{name}': the surface is called '{name}_surface' here")
        return sets

    def _members(self, block: Block, sets: NamedSets) -> IntArray:
        table = self._tables[sets.what]
        if "GENERATE" in block.parameters:
            return _union(self._range(block, row, words, sets.what) for row, words in block.words() if words)
        parts: list[IntArray] = []
        labels: list[int] = []
        rows: list[int] = []
        for row, words in block.words():
            for word in words:
                if word.isdecimal():
                    labels.append(block.integer(row, word))
                    rows.append(row)
                else:
                    parts.append(sets.require(word.strip("\"'"), block, row))
        indices, found = table.find(np.array(labels, dtype=np.int64))
        if not found.all():
            wrong = int(np.argmin(found))
            block.fail(
                f"there is no {sets.what} {labels[wrong]}", "correct the set, or define what it names", rows[wrong]
            )
        return _union([*parts, indices])

    def _range(self, block: Block, row: int, words: list[str], what: str) -> IntArray:
        numbers = [block.integer(row, word) for word in words]
        if len(numbers) == 2:
            numbers.append(1)
        if len(numbers) != 3 or numbers[2] < 1 or numbers[1] < numbers[0]:
            found = shorten(", ".join(words))
            block.fail(f"cannot generate from '{found}'", "GENERATE takes: first, last, step", row)
        members = self._tables[what].within(*numbers)
        if len(members) == 0:
            block.fail(f"no {what} from {numbers[0]} to {numbers[1]} exists", "correct the line", row)
        return members

    def _one(self, block: Block, row: int, word: str, sets: NamedSets) -> IntArray:
        """Indices of a label or of a set."""
        if not word.isdecimal():
            return sets.require(word.strip("\"'"), block, row)
        indices, found = self._tables[sets.what].find(np.array([block.integer(row, word)], dtype=np.int64))
        if not found[0]:
            block.fail(f"there is no {sets.what} {word}", "correct the line", row)
        return indices

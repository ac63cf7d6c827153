"""Reader of Abaqus and CalculiX input files (``.inp``) without parts and instances.

Read are *NODE, *ELEMENT, *NSET, *ELSET, *SURFACE, *MATERIAL with *ELASTIC and *DENSITY, *SOLID SECTION.
Surfaces become sets of their faces' nodes. What would change the mesh or the mechanics if it were passed over
(includes, instances, generated nodes, ties, constraints) is refused; other keywords, and everything from
*STEP on, are passed over with a note. C3D8R, C3D8I, C3D20R and C3D10M are read as the fully integrated hex8,
hex20 and tet10. Names of sets keep their spelling and are compared without regard to case within the file.
Every node must belong to an element.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from maggi.model.errors import MeshError

from .cells import CELL_TYPES
from .inp_blocks import Block, read_blocks
from .inp_materials import MaterialReader
from .inp_sets import Numbering, SetReader
from .labels import LabelTable, sample
from .mesh import Array, IntArray, Mesh
from .text import read_bytes, shorten

_TYPES: Mapping[str, str] = MappingProxyType(
    {
        "C3D4": "tet4",
        "C3D10": "tet10",
        "C3D10M": "tet10",
        "C3D6": "wedge6",
        "B31": "beam2",
        "C3D8": "hex8",
        "C3D8R": "hex8",
        "C3D8I": "hex8",
        "C3D20": "hex20",
        "C3D20R": "hex20",
    }
)
_FULLY_INTEGRATED = frozenset({"C3D10M", "C3D8R", "C3D8I", "C3D20R"})
_FLAT = ("S", "M3D", "CP", "CAX", "T3D", "T2D", "R3D", "DS")
_FLATTEN = "write the model flat: without parts, instances and assembly, all in one file"
_TIE = "model it in the mechanism, or merge the nodes of the mesh"
_GENERATE = "write all nodes and elements out"
_REFUSED: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("INCLUDE", "PART", "INSTANCE", "ASSEMBLY", "ENDPART", "ENDINSTANCE", "ENDASSEMBLY"), _FLATTEN),
        **dict.fromkeys(("EQUATION", "MPC", "TIE", "RIGIDBODY", "COUPLING", "KINEMATIC", "DISTRIBUTING"), _TIE),
        **dict.fromkeys(("KINEMATICCOUPLING", "DISTRIBUTINGCOUPLING", "EMBEDDEDELEMENT", "CYCLICSYMMETRYMODEL"), _TIE),
        **dict.fromkeys(("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBMODEL"), _GENERATE),
    }
)
_SILENT = frozenset({"HEADING", "PREPRINT", "RESTART"})


def read_abaqus(path: str) -> Mesh:
    """Read an ``.inp`` file; coordinates in the file's own unit.

    Raises MeshError, with the line, for what is refused (see above), unknown nodes, elements and sets, and
    numbers that are none.
    """
    blocks = read_blocks(read_bytes(path), path)
    return _Reader(path, blocks).mesh()


@dataclass(frozen=True)
class _Elements:
    """One *ELEMENT block: labels (n,), labels of the nodes (n, k), the data row where each begins."""

    block: Block
    kind: str
    labels: IntArray
    node_labels: IntArray
    rows: list[int]


class _Reader:
    """Sorts the blocks of a file, then resolves labels when all nodes and elements are known."""

    def __init__(self, file: str, blocks: list[Block]) -> None:
        self._file = file
        self._notes: list[str] = []
        self._nodes: list[tuple[Block, IntArray, Array]] = []
        self._elements: list[_Elements] = []
        self._sets: list[Block] = []
        self._sections: list[Block] = []
        self._materials = MaterialReader()
        actions = {
            "NODE": self._accept_nodes,
            "ELEMENT": self._accept_elements,
            "NSET": self._sets.append,
            "ELSET": self._sets.append,
            "SURFACE": self._sets.append,
            "SOLIDSECTION": self._sections.append,
            "MATERIAL": self._materials.material,
            "ELASTIC": self._materials.elastic,
            "DENSITY": self._materials.density,
        }
        for block in blocks:
            if block.keyword in _REFUSED:
                block.fail(f"{block.title} is not read", _REFUSED[block.keyword])
            if block.keyword == "STEP":
                self._notes.append(f"line {block.line}: everything from *STEP on was passed over")
                break
            if block.keyword in actions:
                actions[block.keyword](block)
            elif block.keyword not in _SILENT:
                self._notes.append(f"line {block.line}: {shorten(block.title)} was passed over")

    def _accept_nodes(self, block: Block) -> None:
        if "INPUT" in block.parameters or block.parameters.get("SYSTEM", "R").upper() != "R":
            block.fail("*NODE with INPUT= or with SYSTEM= other than R is not read", _GENERATE)
        if block.rows:
            self._nodes.append((block, *block.node_table()))

    def _accept_elements(self, block: Block) -> None:
        if "INPUT" in block.parameters:
            block.fail("*ELEMENT with INPUT= is not read", _GENERATE)
        name = block.required("TYPE").upper()
        if name not in _TYPES:
            flat = "shell, plane or truss " if name.startswith(_FLAT) else ""
            remedy = "export only the solid (or B31) elements"
            block.fail(f"{flat}elements of type {shorten(name)} are not read, only {', '.join(_TYPES)}", remedy)
        kind = _TYPES[name]
        if name in _FULLY_INTEGRATED:
            self._notes.append(f"line {block.line}: {name} is read as the fully integrated {kind}")
        if block.rows:
            table, rows = block.integer_table(1 + CELL_TYPES[kind].nodes)
            self._elements.append(_Elements(block, kind, table[:, 0], table[:, 1:], rows))

    def mesh(self) -> Mesh:
        """Everything together."""
        for what, found in (("*NODE", self._nodes), ("*ELEMENT", self._elements)):
            if not found:
                raise MeshError(f"the file has no {what} data", file=self._file, remedy="write the mesh into this file")
        node_labels = np.concatenate([labels for _, labels, _ in self._nodes])
        element_labels = np.concatenate([elements.labels for elements in self._elements])
        self._require_distinct(node_labels, "node")
        self._require_distinct(element_labels, "element")
        node_table = LabelTable(node_labels)

        kinds = list(dict.fromkeys(elements.kind for elements in self._elements))
        cells: dict[str, IntArray] = {}
        for kind in kinds:
            parts = [_connectivity(elements, node_table) for elements in self._elements if elements.kind == kind]
            cells[kind] = np.concatenate(parts)
        kind_of = np.concatenate([np.full(len(e.labels), kinds.index(e.kind)) for e in self._elements])
        sets = SetReader(node_table, LabelTable(element_labels), numbering := Numbering(cells, kind_of))
        self._read_sets(sets)
        materials = self._materials.complete(self._notes)
        material_of = self._materials.sections(self._sections, sets.element_sets, len(kind_of), materials)
        return Mesh(
            nodes=np.concatenate([points for _, _, points in self._nodes]),
            cells=cells,
            node_labels=node_labels,
            cell_labels={kind: element_labels[kind_of == i] for i, kind in enumerate(kinds)},
            node_sets=sets.all_node_sets(self._notes),
            element_sets={name: numbering.by_type(members) for name, members in sets.element_sets.all().items()},
            materials=materials,
            cell_materials={kind: material_of[kind_of == i] for i, kind in enumerate(kinds)},
            source=self._file,
            notes=tuple(self._notes),
        )

    def _read_sets(self, sets: SetReader) -> None:
        """First the sets named on *NODE and *ELEMENT themselves, then the others, in order."""
        first = 0
        for block, labels, _ in self._nodes:
            if name := block.parameters.get("NSET"):
                sets.node_sets.add(name, np.arange(first, first + len(labels), dtype=np.int64))
            first += len(labels)
        first = 0
        for elements in self._elements:
            if name := elements.block.parameters.get("ELSET"):
                sets.element_sets.add(name, np.arange(first, first + len(elements.labels), dtype=np.int64))
            first += len(elements.labels)
        actions = {"NSET": sets.node_set, "ELSET": sets.element_set, "SURFACE": sets.surface}
        for block in self._sets:
            actions[block.keyword](block)

    def _require_distinct(self, labels: IntArray, what: str) -> None:
        values, counts = np.unique(labels, return_counts=True)
        if len(values) < len(labels):
            twice = values[counts > 1]
            raise MeshError(
                f"{len(twice)} {what} numbers are defined more than once: {sample(twice)}",
                file=self._file,
                remedy=f"give every {what} its own number",
            )


def _connectivity(elements: _Elements, table: LabelTable) -> IntArray:
    """Node indices (n, k) of a block's elements."""
    indices, found = table.find(elements.node_labels)
    if not found.all():
        row, column = (int(i) for i in np.argwhere(~found)[0])
        node = elements.node_labels[row, column]
        message = f"element {elements.labels[row]} has node {node}, which no *NODE defines"
        elements.block.fail(message, "define the node or correct the element", elements.rows[row])
    return indices

"""The sections of a Gmsh file of format 4.1, ASCII or binary, as plain arrays of labels and coordinates."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NoReturn

import numpy as np

from maggi.model.errors import MeshError

from .gmsh_streams import REMEDY, AsciiStream, BinaryStream, Stream
from .mesh import Array, IntArray
from .text import shorten

Key = tuple[int, int]  # dimension and tag of a geometrical entity or of a physical group

# Gmsh's numbers of the solid cells that are read, and for each of our nodes the place Gmsh has it at. Gmsh
# numbers the edges of tet10 01 12 20 03 23 13, those of hex20 01 03 04 12 15 23 26 37 45 47 56 67.
SOLIDS: Mapping[int, tuple[str, tuple[int, ...]]] = MappingProxyType(
    {
        4: ("tet4", tuple(range(4))),
        5: ("hex8", tuple(range(8))),
        6: ("wedge6", tuple(range(6))),
        11: ("tet10", (0, 1, 2, 3, 4, 5, 6, 7, 9, 8)),
        17: ("hex20", (0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15)),
    }
)
SOLID_NAMES = ", ".join(name for name, _ in SOLIDS.values())
_POINTS = {15: 1}
_LINES = {1: 2, 8: 3, 26: 4, 27: 5, 28: 6}
_TRIANGLES = {2: 3, 9: 6, 20: 9, 21: 10, 22: 12, 23: 15, 24: 15, 25: 21}
_QUADRANGLES = {3: 4, 10: 9, 16: 8, 36: 16, 37: 25, 38: 36, 39: 12}
_LOWER: Mapping[int, tuple[int, int]] = MappingProxyType(  # dimension and nodes of the elements that make sets only
    {
        code: (dimension, nodes)
        for dimension, kinds in ((0, _POINTS), (1, _LINES), (2, _TRIANGLES), (2, _QUADRANGLES))
        for code, nodes in kinds.items()
    }
)
_REFUSED: Mapping[int, tuple[str, str]] = MappingProxyType(
    {
        **dict.fromkeys((7, 14, 19), ("pyramids", "mesh with tetrahedra only, or with hexahedra and wedges")),
        **{code: (f"{n}-node wedges", "use first-order wedges or tet10") for code, n in ((13, 18), (18, 15))},
        **{code: (f"{n}-node tetrahedra", "set Mesh.ElementOrder = 2") for code, n in ((29, 20), (30, 35), (31, 56))},
        12: ("27-node hexahedra", "set Mesh.SecondOrderIncomplete = 1 to get 20-node hexahedra"),
        92: ("64-node hexahedra", "set Mesh.ElementOrder = 1"),
    }
)
_GROUPS_PER_ENTITY = 100  # no real file comes near; bounds the work an absurd one can ask for
_OPENING = re.compile(rb"\s*\$(\w{1,40})[ \t]*\r?\n")


@dataclass
class NodeBlock:
    """Nodes of one geometrical entity: labels (n,), coordinates (n, 3)."""

    dimension: int
    labels: IntArray
    points: Array


@dataclass
class ElementBlock:
    """Elements of one geometrical entity and one type: labels (n,), labels of their nodes (n, k)."""

    entity: Key
    code: int
    labels: IntArray
    node_labels: IntArray
    stream: Stream
    position: int

    def fail(self, row: int, message: str, remedy: str) -> NoReturn:
        """Raise MeshError at the element of this row."""
        width = self.node_labels.shape[1] + 1
        self.stream.fail(message, at=self.position + row * width * self.stream.size_step, remedy=remedy)


@dataclass
class Content:
    """What the sections say: names of physical groups, groups of each entity, blocks of nodes and elements."""

    names: dict[Key, str] = field(default_factory=dict)
    groups: dict[Key, list[Key]] = field(default_factory=dict)
    nodes: list[NodeBlock] = field(default_factory=list)
    elements: list[ElementBlock] = field(default_factory=list)


@dataclass(frozen=True)
class _Header:
    binary: bool
    order: str = ""
    size_bytes: int = 0


class _Lines:
    """Line numbers at growing positions, each byte counted once."""

    def __init__(self, data: bytes) -> None:
        self._data, self._position, self._line = data, 0, 1

    def at(self, position: int) -> int:
        self._line += self._data.count(b"\n", self._position, position)
        self._position = position
        return self._line


def read_sections(data: bytes, file: str) -> Content:
    """The content of a ``.msh`` file; MeshError for other formats and damaged files."""
    content = Content()
    header: _Header | None = None
    seen: set[str] = set()
    lines = _Lines(data)
    start = 0
    while (opening := _OPENING.match(data, start)) is not None:
        name = opening[1].decode("ascii")
        start = opening.end()
        line = lines.at(start)
        if header is None and name not in ("MeshFormat", "Comments"):
            break
        if name in seen and name in _READERS:
            raise MeshError(f"there is a second ${name}", file=file, line=line - 1, remedy=REMEDY)
        seen.add(name)
        if name == "PartitionedEntities":
            raise MeshError("the mesh is partitioned", file=file, line=line - 1, remedy="save it unpartitioned")
        if header is not None and header.binary and name in _READERS:
            binary = BinaryStream(data, file, name, start, header.order, header.size_bytes)
            _READERS[name](binary, content)
            closing = re.compile(rb"\s*\$End" + name.encode()).match(data, binary.position)
            if closing is None:
                binary.fail(f"${name} holds more than its counts announce")
            start = closing.end()
            continue
        end = data.find(b"$End" + name.encode(), start)
        if end < 0:
            raise MeshError(f"${name} is not closed by $End{name}", file=file, line=line - 1, remedy=REMEDY)
        text = data[start:end]
        if name == "MeshFormat":
            header = _header(text, file, line)
        elif name == "PhysicalNames":
            content.names = _physical_names(text, file, line)
        elif name in _READERS:
            stream = AsciiStream(text, file, name, line)
            _READERS[name](stream, content)
            stream.finish()
        start = end + len(name) + 4
    if header is None:
        remedy = "write it with Gmsh 4 as format 4.1"
        raise MeshError("this is not a Gmsh mesh: it does not begin with $MeshFormat", file=file, line=1, remedy=remedy)
    rest = re.compile(rb"\s*").match(data, start)
    if rest is not None and rest.end() < len(data):
        start = rest.end()
        what = shorten(data[start : start + 100].split(b"\n")[0].decode("latin-1"))
        raise MeshError(f"a section was expected, found '{what}'", file=file, line=lines.at(start), remedy=REMEDY)
    for name in ("Nodes", "Elements"):
        if name not in seen:
            raise MeshError(f"there is no ${name} section", file=file, remedy=REMEDY)
    return content


def _header(text: bytes, file: str, line: int) -> _Header:
    first, _, rest = text.partition(b"\n")
    words = first.decode("latin-1").split()
    if len(words) != 3 or words[1] not in ("0", "1") or words[2] not in ("4", "8"):
        what = shorten(first.decode("latin-1"))
        raise MeshError(f"$MeshFormat: cannot understand '{what}'", file=file, line=line, remedy=REMEDY)
    if words[0] != "4.1":
        message = f"Gmsh format {shorten(words[0])} is not read, only 4.1"
        remedy = "convert it: gmsh old.msh -save -format msh41 -o new.msh"
        raise MeshError(message, file=file, line=line, remedy=remedy)
    if words[1] == "0":
        return _Header(binary=False)
    for order in "<>":
        if rest[:4] == np.array(1, dtype=order + "i4").tobytes():
            return _Header(binary=True, order=order, size_bytes=int(words[2]))
    raise MeshError("$MeshFormat: the file's byte order cannot be told", file=file, line=line, remedy=REMEDY)


def _physical_names(text: bytes, file: str, line: int) -> dict[Key, str]:
    names: dict[Key, str] = {}
    for number, row in enumerate(text.decode("utf-8", "replace").split("\n")[1:], line + 1):
        if not row.strip():
            continue
        match = re.fullmatch(r'\s*([0-3])\s+(\d{1,10})\s+"(.*)"\s*', row)
        if match is None:
            message = f"$PhysicalNames: cannot understand '{shorten(row)}'"
            raise MeshError(message, file=file, line=number, remedy='a line is: dimension tag "name"')
        names[int(match[1]), int(match[2])] = match[3]
    return names


def _read_entities(stream: Stream, content: Content) -> None:
    for dimension, count in enumerate(stream.sizes(4).tolist()):
        for _ in range(count):
            tag = int(stream.ints(1)[0])
            stream.doubles(6 if dimension else 3)
            groups = stream.ints(int(stream.sizes(1)[0]))
            if len(groups) > _GROUPS_PER_ENTITY:
                stream.fail(f"entity {tag} of dimension {dimension} is in {len(groups)} physical groups")
            if dimension:
                stream.ints(int(stream.sizes(1)[0]))
            # Gmsh marks an entity that enters a group with reversed orientation by a negative tag
            content.groups[dimension, tag] = [(dimension, group) for group in sorted({abs(g) for g in groups.tolist()})]


def _read_nodes(stream: Stream, content: Content) -> None:
    first = stream.position
    blocks, total, _, _ = stream.sizes(4).tolist()
    for _ in range(blocks):
        start = stream.position
        dimension, _, parametric = stream.ints(3).tolist()
        count = int(stream.sizes(1)[0])
        if dimension not in range(4) or parametric not in (0, 1):
            stream.fail(f"$Nodes: a block of dimension {dimension}, parametric {parametric}", at=start)
        labels = stream.sizes(count)
        width = 3 + parametric * dimension
        points = stream.doubles(count * width).reshape(count, width)[:, :3]
        content.nodes.append(NodeBlock(dimension, labels, points))
    found = sum(len(block.labels) for block in content.nodes)
    if found != total:
        stream.fail(f"$Nodes announces {total} nodes and holds {found}", at=first)


def _read_elements(stream: Stream, content: Content) -> None:
    first = stream.position
    blocks, total, _, _ = stream.sizes(4).tolist()
    for _ in range(blocks):
        start = stream.position
        dimension, tag, code = stream.ints(3).tolist()
        count = int(stream.sizes(1)[0])
        if code in _REFUSED:
            kind, remedy = _REFUSED[code]
            stream.fail(f"{kind} (Gmsh type {code}) are not read, only {SOLID_NAMES}", at=start, remedy=remedy)
        if code not in SOLIDS and code not in _LOWER:
            remedy = "mesh with one of the types that are read"
            stream.fail(f"Gmsh element type {code} is not read, only {SOLID_NAMES}", at=start, remedy=remedy)
        expected, width = (3, len(SOLIDS[code][1])) if code in SOLIDS else _LOWER[code]
        if dimension != expected:
            stream.fail(f"$Elements: type {code} in an entity of dimension {dimension}", at=start)
        position = stream.position
        rows = stream.sizes(count * (width + 1)).reshape(count, width + 1)
        content.elements.append(ElementBlock((dimension, tag), code, rows[:, 0], rows[:, 1:], stream, position))
    found = sum(len(block.labels) for block in content.elements)
    if found != total:
        stream.fail(f"$Elements announces {total} elements and holds {found}", at=first)


_READERS: Mapping[str, Callable[[Stream, Content], None]] = MappingProxyType(
    {"Entities": _read_entities, "Nodes": _read_nodes, "Elements": _read_elements}
)

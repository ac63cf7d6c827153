"""Reader of Gmsh mesh files, format 4.1, ASCII and binary.

Every physical group, of any dimension, gives a node set; groups of volumes give element sets too. A group
without a name is called ``physical_<dimension>_<tag>``. Where groups of different dimensions share a name,
each gets its dimension as suffix (``pin_2d``, ``pin_3d``), so that none can be taken for another.

Lines and surfaces, of any order, only define sets: the body is made of the solid cells. Nodes that belong to
points, curves or surfaces of the geometry and to no solid cell (construction points, say) are left out, with a
note; an unused node inside a volume is an error.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.model.errors import MeshError

from .gmsh_sections import SOLID_NAMES, SOLIDS, Content, ElementBlock, Key, read_sections
from .labels import LabelTable, sample
from .mesh import ElementSet, IntArray, Mesh
from .text import read_bytes


def read_gmsh(path: str) -> Mesh:
    """Read a ``.msh`` file of format 4.1; coordinates in the file's own unit.

    Raises MeshError for other formats, cells that are not read, and damaged files, with the line where the
    file is ASCII.
    """
    content = read_sections(read_bytes(path), path)
    empty = np.zeros(0, np.int64)
    labels = np.concatenate([empty, *(block.labels for block in content.nodes)])
    points = np.concatenate([np.zeros((0, 3)), *(block.points for block in content.nodes)])
    table = LabelTable(labels)
    indices = [_indices(block, table) for block in content.elements]
    cells, cell_labels, cell_places = _cells(content, indices)
    if not cells:
        remedy = "mesh in 3-D (gmsh -3) and put the volume into a physical group"
        raise MeshError(f"there are no solid cells ({SOLID_NAMES}) in the file", file=path, remedy=remedy)

    notes: list[str] = []
    used = _used(content, labels, cells, path, notes)
    renumbered = np.cumsum(used) - 1
    blocks_of = _blocks_of_groups(content)
    node_sets: dict[str, IntArray] = {}
    element_sets: dict[str, ElementSet] = {}
    for name, keys in _named_groups(content, notes).items():
        blocks = [block for key in keys for block in blocks_of.get(key, ())]
        mentioned = np.unique(np.concatenate([empty, *(indices[i].ravel() for i in blocks)]))
        node_sets[name] = renumbered[mentioned[used[mentioned]]]
        if len(node_sets[name]) == 0:
            notes.append(f"physical group '{name}' has no nodes of the solid cells")
        members: dict[str, list[IntArray]] = {}
        for i in blocks:
            if i in cell_places:
                kind, places = cell_places[i]
                members.setdefault(kind, []).append(places)
        if members:
            element_sets[name] = {kind: np.unique(np.concatenate(parts)) for kind, parts in members.items()}
    return Mesh(
        nodes=points[used],
        cells={name: renumbered[connectivity] for name, connectivity in cells.items()},
        node_labels=labels[used],
        cell_labels=cell_labels,
        node_sets=node_sets,
        element_sets=element_sets,
        source=path,
        notes=tuple(notes),
    )


def _indices(block: ElementBlock, table: LabelTable) -> IntArray:
    """Node indices (n, k) of a block's elements."""
    indices, found = table.find(block.node_labels)
    if not found.all():
        row, column = (int(i) for i in np.argwhere(~found)[0])
        node = block.node_labels[row, column]
        message = f"element {block.labels[row]} has node {node}, which $Nodes does not define"
        block.fail(row, message, "write the mesh again with all its nodes")
    return indices


def _cells(
    content: Content, indices: list[IntArray]
) -> tuple[dict[str, IntArray], dict[str, IntArray], dict[int, tuple[str, IntArray]]]:
    """Solid cells in our numbering and their labels, by type; for each block its type and its cells' places there."""
    cells: dict[str, IntArray] = {}
    labels: dict[str, IntArray] = {}
    places: dict[int, tuple[str, IntArray]] = {}
    for code, (name, order) in SOLIDS.items():
        members = [i for i, block in enumerate(content.elements) if block.code == code and len(block.labels)]
        if not members:
            continue
        cells[name] = np.concatenate([indices[i] for i in members])[:, order]
        labels[name] = np.concatenate([content.elements[i].labels for i in members])
        ends = np.cumsum([len(indices[i]) for i in members])
        for i, end in zip(members, ends, strict=True):
            places[i] = (name, np.arange(end - len(indices[i]), end, dtype=np.int64))
    return cells, labels, places


def _used(
    content: Content, labels: IntArray, cells: dict[str, IntArray], file: str, notes: list[str]
) -> NDArray[np.bool_]:
    """Which nodes belong to a solid cell, (n,)."""
    dimensions = np.concatenate(
        [np.zeros(0, np.int64), *(np.full(len(block.labels), block.dimension) for block in content.nodes)]
    )
    used = np.zeros(len(labels), dtype=np.bool_)
    for connectivity in cells.values():
        used[connectivity] = True
    inside = ~used & (dimensions == 3)
    if inside.any():
        message = f"{inside.sum()} nodes inside volumes belong to no solid cell: {sample(labels[inside])}"
        raise MeshError(message, file=file, remedy="delete these nodes, or mesh again")
    if not used.all():
        notes.append(
            f"{(~used).sum()} nodes of points, curves or surfaces that no solid cell uses were left out: "
            f"{sample(labels[~used])}"
        )
    return used


def _blocks_of_groups(content: Content) -> dict[Key, list[int]]:
    """The blocks of elements of each physical group."""
    blocks: dict[Key, list[int]] = {}
    for i, block in enumerate(content.elements):
        for key in content.groups.get(block.entity, ()):
            blocks.setdefault(key, []).append(i)
    return blocks


def _named_groups(content: Content, notes: list[str]) -> dict[str, list[Key]]:
    """The physical groups under each name."""
    keys = sorted({*content.names, *(key for keys in content.groups.values() for key in keys)})
    by_name: dict[str, list[Key]] = {}
    for key in keys:
        by_name.setdefault(content.names.get(key) or f"physical_{key[0]}_{key[1]}", []).append(key)
    result: dict[str, list[Key]] = {}
    for name, members in by_name.items():
        dimensions = sorted({dimension for dimension, _ in members})
        if len(dimensions) == 1:
            result[name] = members
            continue
        for dimension in dimensions:
            result[f"{name}_{dimension}d"] = [key for key in members if key[0] == dimension]
        notes.append(
            f"physical groups of several dimensions share the name '{name}': they are called "
            f"{', '.join(f'{name}_{dimension}d' for dimension in dimensions)}"
        )
    return result

"""A mesh: nodes, cells, named sets, and the labels by which messages speak of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from maggi.model.materials import Material

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
ElementSet = dict[str, IntArray]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Nodes and cells of one body, in its body frame.

    nodes : (n, 3) coordinates, m.
    cells : for each type present, node indices (c, k) in the numbering of `cells.py`.
    node_labels, cell_labels : the numbers of the source file, (n,) and (c,) for each type.
    node_sets : sorted node indices by name.
    element_sets : for each name, sorted indices into ``cells[type]`` by type.
    materials : the materials the file itself defines, by name; empty where it defines none. Their numbers are
        taken as SI whatever the file's unit of length is.
    cell_materials : for each type index of a cell's material in ``list(materials)``, (c,); −1 where the file
        gives it none.
    source : file name or description, for messages.
    notes : what the reader left out or decided, one sentence each.
    """

    nodes: Array
    cells: dict[str, IntArray]
    node_labels: IntArray
    cell_labels: dict[str, IntArray]
    node_sets: dict[str, IntArray] = field(default_factory=dict)
    element_sets: dict[str, ElementSet] = field(default_factory=dict)
    materials: dict[str, Material] = field(default_factory=dict)
    cell_materials: dict[str, IntArray] = field(default_factory=dict)
    source: str = ""
    notes: tuple[str, ...] = ()

    @property
    def n_nodes(self) -> int:
        return len(self.nodes)

    @property
    def n_cells(self) -> int:
        return sum(len(cells) for cells in self.cells.values())

    def bounding_box(self) -> tuple[Array, Array]:
        """Lowest and highest coordinates, (3,) and (3,), m."""
        return self.nodes.min(axis=0), self.nodes.max(axis=0)


def consecutive_labels(nodes: Array, cells: dict[str, IntArray]) -> tuple[IntArray, dict[str, IntArray]]:
    """Labels 1, 2, … for a mesh without numbers of its own: node labels (n,), cell labels through all types."""
    cell_labels: dict[str, IntArray] = {}
    first = 1
    for name, connectivity in cells.items():
        cell_labels[name] = np.arange(first, first + len(connectivity), dtype=np.int64)
        first += len(connectivity)
    return np.arange(1, len(nodes) + 1, dtype=np.int64), cell_labels

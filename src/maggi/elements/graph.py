"""The node graph of a mesh: the sparsity pattern that μ, K (3×3 blocks) and κ share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.compiling import part_kernel
from maggi.linalg.threads import in_parts
from maggi.model.errors import MeshError

IntArray = NDArray[np.int32]
LARGEST = np.iinfo(np.int32).max


@dataclass(frozen=True, eq=False)
class NodeGraph:
    """Which nodes share a cell, as a CSR pattern with sorted columns, and where each cell's entries stand in it.

    indptr (n+1,), indices (nnz,): int32. cells[type] (c, k) int32. slots[type] (c, k, k) int32: the place in
    `indices` of the entry (a, b) of a cell.
    """

    node_count: int
    indptr: IntArray
    indices: IntArray
    cells: Mapping[str, IntArray]
    slots: Mapping[str, IntArray]


def node_graph(node_count: int, cells: Mapping[str, NDArray[np.int64]]) -> NodeGraph:
    """Build the graph of a mesh of one or several types of cells.

    Raises MeshError if a cell names a node that does not exist, or if the graph is too large for int32 indices.
    """
    total = 0
    for name, nodes_of in cells.items():
        if nodes_of.size and (nodes_of.min() < 0 or nodes_of.max() >= node_count):
            row, column = np.argwhere((nodes_of < 0) | (nodes_of >= node_count))[0]
            raise MeshError(
                f"{name} cell at row {row} names node index {nodes_of[row, column]}; the mesh has {node_count} nodes",
                remedy="indices count from 0; check the mesh's connectivity",
            )
        total += nodes_of.shape[0] * nodes_of.shape[1] ** 2
    if total > LARGEST:
        raise MeshError(f"the mesh has {total} cell entries, more than {LARGEST}", remedy="use a coarser mesh")
    small = {name: np.ascontiguousarray(nodes_of, dtype=np.int32) for name, nodes_of in cells.items()}
    members = np.concatenate([c.ravel() for c in small.values()]) if small else np.empty(0, np.int32)
    widths = [np.full(len(c), c.shape[1], dtype=np.int32) for c in small.values()]
    starts = np.concatenate([[0], np.cumsum(np.concatenate(widths) if widths else [])]).astype(np.int32)
    indptr, indices = _pattern(node_count, starts, members)
    slots = {name: np.empty((*c.shape, c.shape[1]), np.int32) for name, c in small.items()}
    for name, c in small.items():
        in_parts(_find_slots, c, indptr, indices, slots[name])
    return NodeGraph(node_count, indptr, indices, small, slots)


def _pattern(node_count: int, starts: IntArray, members: IntArray) -> tuple[IntArray, IntArray]:
    """CSR pattern of the node graph; cells are runs of `members`, from starts[c] to starts[c + 1]."""
    first = np.concatenate([[0], np.cumsum(np.bincount(members, minlength=node_count))]).astype(np.int32)
    cells = np.repeat(np.arange(starts.size - 1, dtype=np.int32), np.diff(starts))
    cell_of = cells[np.argsort(members, kind="stable")]
    indptr, none = np.zeros(node_count + 1, np.int32), np.empty(0, np.int32)
    in_parts(_find_neighbours, first, cell_of, starts, members, indptr, none)
    indptr = np.cumsum(indptr, dtype=np.int32)
    indices = np.empty(indptr[-1], np.int32)
    in_parts(_find_neighbours, first, cell_of, starts, members, indptr, indices)
    return indptr, indices


@part_kernel
def _find_neighbours(
    part: int,
    parts: int,
    first: IntArray,
    cell_of: IntArray,
    starts: IntArray,
    members: IntArray,
    indptr: IntArray,
    indices: IntArray,
) -> None:
    """Where `indices` is empty, the number of neighbours of node n to indptr[n + 1]; else they themselves, in order.

    Cells of node n: cell_of[first[n]] … cell_of[first[n + 1] − 1].
    """
    node_count = first.size - 1
    counting = indices.size == 0
    marker = np.full(node_count, -1, np.int32)
    for n in range(node_count * part // parts, node_count * (part + 1) // parts):
        count = 0
        for j in range(first[n], first[n + 1]):
            for i in range(starts[cell_of[j]], starts[cell_of[j] + 1]):
                m = members[i]
                if marker[m] == n:
                    continue
                marker[m] = n
                if not counting:
                    place = indptr[n] + count
                    while place > indptr[n] and indices[place - 1] > m:
                        indices[place] = indices[place - 1]
                        place -= 1
                    indices[place] = m
                count += 1
        if counting:
            indptr[n + 1] = count


@part_kernel
def _find_slots(part: int, parts: int, cells: IntArray, indptr: IntArray, indices: IntArray, slots: IntArray) -> None:
    """Place of every cell entry (a, b) in the pattern, by bisection in the sorted rows."""
    count, width = cells.shape
    for c in range(count * part // parts, count * (part + 1) // parts):
        for a in range(width):
            for b in range(width):
                column = cells[c, b]
                low, high = indptr[cells[c, a]], indptr[cells[c, a] + 1] - 1
                while low < high:
                    middle = (low + high) // 2
                    if indices[middle] < column:
                        low = middle + 1
                    else:
                        high = middle
                slots[c, a, b] = low

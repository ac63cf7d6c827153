"""The node graph of a mesh: the sparsity pattern that μ, K (3×3 blocks) and κ share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

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
    indptr, indices = _pattern(node_count, starts, members, numba.get_num_threads())
    slots = {name: _slots(c, indptr, indices) for name, c in small.items()}
    return NodeGraph(node_count, indptr, indices, small, slots)


@numba.njit(cache=True, parallel=True)
def _pattern(node_count: int, starts: IntArray, members: IntArray, parts: int) -> tuple[IntArray, IntArray]:
    """CSR pattern of the node graph; each part owns a range of rows, so the result does not depend on `parts`."""
    first = np.zeros(node_count + 1, np.int32)
    for i in range(members.size):
        first[members[i] + 1] += 1
    for n in range(node_count):
        first[n + 1] += first[n]
    cell_of = np.empty(members.size, np.int32)
    filled = first[:-1].copy()
    for c in range(starts.size - 1):
        for i in range(starts[c], starts[c + 1]):
            cell_of[filled[members[i]]] = c
            filled[members[i]] += 1

    indptr = np.zeros(node_count + 1, np.int32)
    for part in numba.prange(parts):
        marker = np.full(node_count, -1, np.int32)
        for n in range(node_count * part // parts, node_count * (part + 1) // parts):
            count = 0
            for j in range(first[n], first[n + 1]):
                for i in range(starts[cell_of[j]], starts[cell_of[j] + 1]):
                    if marker[members[i]] != n:
                        marker[members[i]] = n
                        count += 1
            indptr[n + 1] = count
    for n in range(node_count):
        indptr[n + 1] += indptr[n]

    indices = np.empty(indptr[node_count], np.int32)
    for part in numba.prange(parts):
        marker = np.full(node_count, -1, np.int32)
        for n in range(node_count * part // parts, node_count * (part + 1) // parts):
            end = indptr[n]
            for j in range(first[n], first[n + 1]):
                for i in range(starts[cell_of[j]], starts[cell_of[j] + 1]):
                    if marker[members[i]] != n:
                        marker[members[i]] = n
                        indices[end] = members[i]
                        end += 1
            indices[indptr[n] : end].sort()
    return indptr, indices


@numba.njit(cache=True, parallel=True)
def _slots(cells: IntArray, indptr: IntArray, indices: IntArray) -> IntArray:
    """Place of every cell entry (a, b) in the pattern, by bisection in the sorted rows."""
    count, width = cells.shape
    slots = np.empty((count, width, width), np.int32)
    for c in numba.prange(count):
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
    return slots

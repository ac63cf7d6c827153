"""Meshes from a few numbers: a box of solid cells, a straight beam."""

from __future__ import annotations

import itertools
import math

import numpy as np

from maggi.model.errors import MeshError
from maggi.model.geometry import Vector

from .cells import CELL_TYPES, SOLID_TYPES
from .mesh import Array, IntArray, Mesh, consecutive_labels

NODE_LIMIT = 10_000_000
_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def box(size: Vector, cells: tuple[int, int, int], cell: str = "hex8", path: str = "") -> Mesh:
    """A box from the origin to `size` (m) with `cells` blocks along x, y and z.

    cell : ``hex8`` and ``hex20``: a block is one cell; ``wedge6``: two, cut along z; ``tet4`` and ``tet10``: six
    around the block's diagonal, which fit their neighbours'.
    Node sets ``x_min``, ``x_max``, ``y_min`` … ``z_max``: the nodes of the six sides.
    path : where in the model, for messages. Raises MeshError for sizes that are not positive, counts below 1,
    unknown cells, and more than `NODE_LIMIT` nodes.
    """
    if cell not in SOLID_TYPES:
        raise MeshError(f"unknown cell '{cell}'", path=_join(path, "cell"), remedy=f"use {', '.join(SOLID_TYPES)}")
    if not all(math.isfinite(length) and length > 0.0 for length in size):
        message = f"the size must be three positive lengths, found {list(size)}"
        raise MeshError(message, path=_join(path, "size"), remedy="give lengths in metres")
    if any(count < 1 or count != int(count) for count in cells):
        message = f"the cells must be three whole numbers from 1 on, found {list(cells)}"
        raise MeshError(message, path=_join(path, "cells"), remedy="give the number of cells along x, y and z")
    kind = CELL_TYPES[cell]
    # Coordinates on a lattice of half cells, so that mid-edge nodes are whole numbers too and the sides are exact.
    per_block = (3 if kind.second_order else 1) + (4 if cell == "tet10" else 0)
    _limit(per_block * math.prod(count + 1 for count in cells), _join(path, "cells"))
    nx, ny, nz = cells
    k, j, i = np.meshgrid(np.arange(nz + 1), np.arange(ny + 1), np.arange(nx + 1), indexing="ij")
    lattice = 2 * np.column_stack([i.ravel(), j.ravel(), k.ravel()]).astype(np.int64)
    corner = (np.array(_CORNERS) * [1, nx + 1, (nx + 1) * (ny + 1)]).sum(axis=1)
    first = np.flatnonzero((i < nx).ravel() & (j < ny).ravel() & (k < nz).ravel())
    blocks = first[:, None] + corner[None, :]
    connectivity = blocks[:, _SPLIT[cell]].reshape(-1, kind.corners)
    if kind.second_order:
        lattice, connectivity = _add_middles(lattice, connectivity, kind.edges)
    ends = 2 * np.array(cells)
    nodes = lattice / ends * np.array(size, dtype=np.float64)
    sets = {
        f"{axis}_{side}": np.flatnonzero(lattice[:, a] == end)
        for a, axis in enumerate("xyz")
        for side, end in (("min", 0), ("max", ends[a]))
    }
    text = f"box {size[0]:g} x {size[1]:g} x {size[2]:g} m, {nx} x {ny} x {nz} {cell}"
    return _labelled(nodes, {cell: connectivity}, sets, text)


def beam(length: float, elements: int, path: str = "") -> Mesh:
    """A straight beam along x from 0 to `length` (m) with `elements` cells; node sets ``start`` and ``end``.

    Raises MeshError for a length that is not positive and for fewer than 1 or too many elements.
    """
    if not (math.isfinite(length) and length > 0.0):
        message = f"the length must be positive, found {length}"
        raise MeshError(message, path=_join(path, "length"), remedy="give a length in metres")
    if elements < 1 or elements != int(elements):
        message = f"the number of elements must be a whole number from 1 on, found {elements}"
        raise MeshError(message, path=_join(path, "elements"), remedy="give at least 1")
    _limit(elements + 1, _join(path, "elements"))
    nodes = np.zeros((elements + 1, 3))
    nodes[:, 0] = np.arange(elements + 1) / elements * length
    first = np.arange(elements, dtype=np.int64)
    sets = {"start": np.array([0], dtype=np.int64), "end": np.array([elements], dtype=np.int64)}
    text = f"beam {length:g} m, {elements} elements"
    return _labelled(nodes, {"beam2": np.column_stack([first, first + 1])}, sets, text)


def _tetrahedra() -> tuple[tuple[int, ...], ...]:
    """The six tetrahedra of a block around the diagonal 0–6, one for each order of the axes (Kuhn's split)."""
    number = {corner: i for i, corner in enumerate(_CORNERS)}
    result = []
    for axes in itertools.permutations(range(3)):
        point = [0, 0, 0]
        chain = [0]
        for axis in axes:
            point[axis] = 1
            chain.append(number[point[0], point[1], point[2]])
        odd = axes in ((0, 2, 1), (1, 0, 2), (2, 1, 0))
        result.append((chain[0], chain[2], chain[1], chain[3]) if odd else tuple(chain))
    return tuple(result)


_SPLIT: dict[str, tuple[tuple[int, ...], ...]] = {
    **dict.fromkeys(("hex8", "hex20"), (tuple(range(8)),)),
    **dict.fromkeys(("tet4", "tet10"), _tetrahedra()),
    "wedge6": ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)),
}


def _add_middles(
    lattice: IntArray, connectivity: IntArray, edges: tuple[tuple[int, int], ...]
) -> tuple[IntArray, IntArray]:
    """Nodes with one more in the middle of each edge, and cells that have them."""
    pairs = np.sort(connectivity[:, edges].reshape(-1, 2), axis=1)
    keys, place = np.unique(pairs[:, 0] * len(lattice) + pairs[:, 1], return_inverse=True)
    middles = (lattice[keys // len(lattice)] + lattice[keys % len(lattice)]) // 2
    numbers = len(lattice) + place.reshape(len(connectivity), len(edges))
    return np.vstack([lattice, middles]), np.hstack([connectivity, numbers])


def _labelled(nodes: Array, cells: dict[str, IntArray], sets: dict[str, IntArray], source: str) -> Mesh:
    node_labels, cell_labels = consecutive_labels(nodes, cells)
    return Mesh(nodes, cells, node_labels, cell_labels, sets, source=source)


def _limit(nodes: int, path: str) -> None:
    if nodes > NODE_LIMIT:
        message = f"about {nodes:.3g} nodes are more than the limit of {NODE_LIMIT:.0e}"
        raise MeshError(message, path=path, remedy="use fewer cells")


def _join(path: str, key: str) -> str:
    return f"{path}.{key}" if path else key

"""The boundary of the solid cells."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .cells import CELL_TYPES, SOLID_TYPES
from .mesh import IntArray

# How the nodes of a face (its corners, then the middles of its edges) make triangles of the same sense.
_TRIANGLES: Mapping[int, tuple[tuple[int, int, int], ...]] = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2), (0, 2, 3)),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    8: ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
}


def free_faces(cells: Mapping[str, IntArray]) -> dict[str, IntArray]:
    """The faces that belong to one cell only: for each solid type pairs (cell, face), (f, 2), in order.

    Two faces are the same if their corners are. Faces of a quadrangle against two triangles never are.
    """
    kinds = [kind for kind in SOLID_TYPES if len(cells.get(kind, ()))]
    corners: list[IntArray] = []  # (f, 4), sorted; a triangle's fourth entry is −1
    owners: list[IntArray] = []  # (f, 3): kind, cell, face
    for i, kind in enumerate(kinds):
        for j, face in enumerate(CELL_TYPES[kind].faces):
            of_face = np.full((len(cells[kind]), 4), -1, dtype=np.int64)
            of_face[:, : len(face)] = cells[kind][:, face]
            corners.append(np.sort(of_face, axis=1))
            number = np.arange(len(cells[kind]), dtype=np.int64)
            owners.append(np.column_stack([np.full_like(number, i), number, np.full_like(number, j)]))
    if not kinds:
        return {}
    every = np.concatenate(corners)
    owner = np.concatenate(owners)
    order = np.lexsort(every.T)
    same = (every[order[1:]] == every[order[:-1]]).all(axis=1)
    shared = np.zeros(len(every), dtype=np.bool_)
    shared[order[1:][same]] = True
    shared[order[:-1][same]] = True
    free = owner[~shared]
    free = free[np.lexsort((free[:, 2], free[:, 1], free[:, 0]))]
    return {kind: free[free[:, 0] == i, 1:] for i, kind in enumerate(kinds)}


def surface_triangles(cells: Mapping[str, IntArray]) -> IntArray:
    """The boundary of the solid cells as triangles of nodes, (t, 3), counter-clockwise seen from outside.

    Faces of second-order cells are split at their middle nodes: a 6-node triangle into 4, an 8-node
    quadrangle into 6. Beams have no surface.
    """
    parts: list[IntArray] = [np.zeros((0, 3), dtype=np.int64)]
    for kind, pairs in free_faces(cells).items():
        for j, face in enumerate(CELL_TYPES[kind].face_nodes):
            chosen = cells[kind][pairs[pairs[:, 1] == j, 0]]
            for triangle in _TRIANGLES[len(face)]:
                parts.append(chosen[:, [face[corner] for corner in triangle]])
    return np.concatenate(parts)

"""Parts of a system that liaisons tie together, ground and prescribed frames left out: each moves by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import FIXED
from maggi.liaisons.tables import END_ATTACHMENT
from maggi.system.system import System

IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Part:
    """bodies: rows of the body table. columns: their unknown small coordinates. rows: the liaison rows that act on them."""

    bodies: IntArray
    columns: IntArray
    rows: IntArray


def unknown_velocities(system: System, *, elastic: bool = True) -> IntArray:
    """Which small coordinates are unknown velocities: of floating frames and, if `elastic`, of elastic coordinates."""
    parts = [_columns(system, b, elastic) for b in range(system.bodies.kind.size)]
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])


def parts(system: System) -> list[Part]:
    """The parts that liaisons hold together, in the order of their first bodies; rows on prescribed frames alone are in none."""
    import scipy.sparse as sp  # slow to load, and most runs ask for no parts
    from scipy.sparse.csgraph import connected_components

    table, bodies = system.liaisons, system.bodies
    moving = np.array([_columns(system, b, True).size > 0 for b in range(bodies.kind.size)], dtype=np.bool_)
    of_row = [
        sorted({int(b) for b in bodies.attachment_body[table.end[start:end, END_ATTACHMENT]] if moving[b]})
        for start, end in zip(table.end_start[:-1], table.end_start[1:], strict=True)
    ]
    pairs = np.array([(acted[0], b) for acted in of_row for b in acted], dtype=np.int64).reshape(-1, 2)
    count = bodies.kind.size
    graph = sp.coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    found = []
    for one in dict.fromkeys(label[moving].tolist()):
        members = np.flatnonzero(moving & (label == one))
        columns = np.concatenate([_columns(system, int(b), True) for b in members])
        rows = [i for i, acted in enumerate(of_row) if acted and label[acted[0]] == one]
        found.append(Part(members, columns, np.array(rows, dtype=np.int64)))
    return found


def _columns(system: System, body: int, elastic: bool) -> IntArray:
    bodies = system.bodies
    start, end = int(bodies.offset[body]), int(bodies.offset[body + 1])
    if bodies.kind[body] == FIXED:
        return np.empty(0, dtype=np.int64)
    first = start if bodies.floating[body] == 1 else start + 6
    return np.arange(first, end if elastic else max(first, start + 6), dtype=np.int64)

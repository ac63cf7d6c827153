"""Closures over a tree: their order, the nodes that each acts on, and where its coefficients stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import BodyTable
from maggi.liaisons.tables import (
    CAM,
    CAM_FACE,
    CURVE,
    RATE_RELATION,
    RELATION,
    ROW_FIRST,
    ROW_KIND,
    ROW_SECOND,
    LiaisonTable,
)
from maggi.linalg.ordering import skyline_order
from maggi.system.system import System

from .tree_tables import NODE

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def ends_of_row(system: System, row: int) -> list[int]:
    """The attachments that a row acts on."""
    table = system.liaisons
    return [int(a) for a in table.end[table.end_start[row] : table.end_start[row + 1], 0]]


def path_of(bodies: Sequence[int], node: dict[int, int], parent: Sequence[int]) -> list[int]:
    """The nodes that forces on these bodies pass through: tree bodies inwards, then blocks."""
    tree: set[int] = set()
    blocks: set[int] = set()
    for b in bodies:
        x = node[b]
        if x >= len(parent):
            blocks.add(x)
            continue
        while x >= 0 and x not in tree:
            tree.add(x)
            x = parent[x]
    return sorted(tree, reverse=True) + sorted(blocks)


def ordered_rows(system: System, rows: list[int], paths: dict[int, list[int]]) -> list[int]:
    """Liaisons by reverse Cuthill–McKee on the nodes that they share; rows of one liaison stay together."""
    owners: dict[int, list[int]] = {}
    for row in rows:
        owners.setdefault(int(system.liaisons.row[row, 4]), []).append(row)
    names = list(owners)
    by_node: dict[int, list[int]] = {}
    for k, owner in enumerate(names):
        for x in sorted({x for row in owners[owner] for x in paths[row]}):
            by_node.setdefault(x, []).append(k)
    pairs = [(a, b) for members in by_node.values() for a, b in pairwise(members)]
    order = skyline_order(len(names), pairs)
    return [row for k in order for row in owners[names[k]]]


def restricted(system: System, rows: list[int], ends_of: dict[int, list[int]]) -> tuple[LiaisonTable, int]:
    """The liaison table of these rows alone, and the number of their coefficients on bodies."""
    bodies, table = system.bodies, system.liaisons
    end: list[tuple[int, int]] = []
    incidence: list[list[tuple[int, int]]] = [[] for _ in range(bodies.kind.size)]
    cursor = 0
    for i, row in enumerate(rows):
        for a in ends_of[row]:
            b = int(bodies.attachment_body[a])
            end.append((a, cursor))
            incidence[b].append((i, cursor))
            cursor += int(bodies.offset[b + 1] - bodies.offset[b])
    none = np.zeros(0, dtype=np.int64)
    restricted = replace(
        table,
        row=np.ascontiguousarray(table.row[rows].reshape(-1, table.row.shape[1])),
        end_start=starts([len(ends_of[row]) for row in rows]),
        end=integers(end).reshape(-1, 2),
        incidence_start=starts([len(x) for x in incidence]),
        incidence=integers([pair for x in incidence for pair in x]).reshape(-1, 2),
        skyline_first=none,
        skyline_start=none,
    )
    return restricted, cursor


def closure_paths(
    closure_ends: Sequence[Sequence[tuple[int, int]]],
    bodies: BodyTable,
    node: dict[int, int],
    parent: Sequence[int],
    width: Sequence[int],
) -> tuple[IntArray, IntArray, IntArray]:
    """path, path_start and end of `Tree`."""
    path: list[tuple[int, int, int]] = []
    ends: list[tuple[int, int]] = []
    lengths: list[int] = []
    columns = 0
    for closure in closure_ends:
        on = [int(bodies.attachment_body[a]) for a, _ in closure]
        nodes = path_of(on, node, parent)
        at = {x: len(path) + k for k, x in enumerate(nodes)}
        for x in nodes:
            up = at.get(parent[x], -1) if x < len(parent) else -1
            path.append((x, columns, up))
            columns += width[x]
        lengths.append(len(nodes))
        ends += [(start, at.get(node[b], -1)) for b, (_, start) in zip(on, closure, strict=True)]
    return (
        integers(path).reshape(-1, 3),
        starts(lengths),
        integers(ends).reshape(-1, 2),
    )


def column_velocities(path: IntArray, path_start: IntArray, width: Sequence[int]) -> tuple[IntArray, IntArray]:
    """column_start, column_velocity of `Tree`."""
    first = starts(width)
    velocities = [
        [int(first[x]) + i for x in path[p:e, NODE] for i in range(width[x])] for p, e in pairwise(path_start)
    ]
    return starts([len(part) for part in velocities]), integers([i for part in velocities for i in part])


def node_incidence(path: IntArray, path_start: IntArray, nodes: int) -> tuple[IntArray, IntArray]:
    """incidence_start, incidence of `Tree`."""
    found: list[list[tuple[int, int]]] = [[] for _ in range(nodes)]
    for q in range(len(path_start) - 1):
        for x, start, _ in path[path_start[q] : path_start[q + 1]]:
            found[x].append((q, int(start)))
    return starts([len(x) for x in found]), integers([pair for x in found for pair in x]).reshape(-1, 2)


def skyline(path: IntArray, path_start: IntArray) -> IntArray:
    """skyline_first of `Tree`: of every row, the earliest one that has a node in common with it."""
    earliest: dict[int, int] = {}
    first = []
    for q in range(len(path_start) - 1):
        nodes = [int(x) for x in path[path_start[q] : path_start[q + 1], 0]]
        first.append(min([q, *(earliest.get(x, q) for x in nodes)]))
        for x in nodes:
            earliest.setdefault(x, q)
    return integers(first)


def measured_coordinates(system: System, rows: list[int]) -> IntArray:
    """Coordinates that rows and torsion springs need."""
    needed = {int(c) for c in system.forces.torsion_coordinate}
    for row in rows:
        needed |= set(coordinates_of(system, row))
    return integers(sorted(needed))


def coordinates_of(system: System, row: int) -> list[int]:
    """The joint coordinates that a row is a function of."""
    table = system.liaisons
    kind = table.row[row, ROW_KIND]
    if kind in (RELATION, RATE_RELATION):
        o, n = int(table.row[row, ROW_FIRST]), int(table.row[row, ROW_SECOND])
        return [int(c) for c in table.integers[o + 1 : o + 1 + n]]
    if kind in (CURVE, CAM, CAM_FACE):
        return [int(table.row[row, ROW_SECOND])]
    return []


def starts(counts: Sequence[int]) -> IntArray:
    """Where parts of these sizes begin in a row, and where the last ends (n + 1,)."""
    return np.concatenate([[0], np.cumsum(np.array(counts, dtype=np.int64))]).astype(np.int64)


def integers(values: Sequence[object]) -> IntArray:
    """As a contiguous array."""
    return np.ascontiguousarray(np.array(values, dtype=np.int64))

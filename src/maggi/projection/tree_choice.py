"""Which joints carry which bodies.

Every lower pair between rigid bodies, or one and the ground, may carry a body; of all trees one with as many rows as
possible in its joints is taken, and as shallow as that allows. A body that nothing carries is free.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import FIXED, RIGID
from maggi.liaisons.registry import JOINTS
from maggi.liaisons.tables import OFFSET, PRODUCT, ROTATION, ROTATION_VECTOR, ROW_JOINT, TRANSLATION
from maggi.system.system import LiaisonEntry, System

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

FREE = (0, 1, 2, 3, 4, 5)
CARRIED = (OFFSET, PRODUCT)  # rows that a joint of the tree makes needless
_OF_SUBGROUPS = (TRANSLATION, ROTATION, ROTATION_VECTOR)


@dataclass(frozen=True, eq=False)
class Branch:
    """A tree body and what carries it.

    body, carrier: rows in the body table, the carrier 0 for ground. free: components of the twist in the joint's frame.
    liaison: its number, −1 for a free body; second: whether the body is the joint's second end. rotation (3, 3),
    position (3,): the joint's frame in the body's; out_rotation, out_position: in the carrier's, in the model's frames.
    """

    body: int
    carrier: int
    free: tuple[int, ...]
    liaison: int
    second: bool
    rotation: Array
    position: Array
    out_rotation: Array
    out_position: Array


def free_motions(entry: LiaisonEntry, system: System) -> tuple[int, ...] | None:
    """Components of the relative twist, in the joint's frame, that a lower pair leaves free; None for other joints."""
    kind = JOINTS.get(entry.kind)
    if kind is None or any(what not in CARRIED for what, _, _ in kind.rows):
        return None
    if any(what not in _OF_SUBGROUPS for what, _ in kind.coordinates):
        return None
    return tuple(sorted(axis if what == TRANSLATION else 3 + axis for what, axis in kind.coordinates))


def branches(system: System) -> list[Branch]:
    """The tree's bodies outwards from the roots."""
    bodies, table = system.bodies, system.liaisons
    rigid = {b for b in range(bodies.kind.size) if bodies.kind[b] == RIGID and bodies.floating[b] == 1}
    edges: dict[int, list[tuple[int, int, int, tuple[int, ...]]]] = {}  # body: locked rows, liaison, other, free
    for number, entry in enumerate(system.liaison_entries):
        free = free_motions(entry, system)
        if free is None or len(free) == 6:
            continue
        ends = table.joint[table.row[entry.rows[0], ROW_JOINT]]
        first, second = (int(bodies.attachment_body[end]) for end in ends)
        if first == second or not {first, second} <= rigid | {0} or bodies.kind[0] != FIXED:
            continue
        for a, b in ((first, second), (second, first)):
            edges.setdefault(a, []).append((6 - len(free), number, b, free))
    depth = {0: 0}
    found: list[Branch] = []
    frontier = {0}
    waiting = set(rigid)
    while waiting:
        # of the joints that reach a new body the one with most rows, then the one closest to the root
        best = None
        for a in sorted(frontier):
            fresh = [edge for edge in edges.get(a, []) if edge[2] in waiting]
            if not fresh:
                frontier.discard(a)
            for locked, number, b, free in fresh:
                key = (-locked, depth[a], len(found), number)
                if best is None or key < best[0]:
                    best = (key, a, b, number, free)
        if best is None:
            root = max(waiting, key=lambda b: (len(edges.get(b, [])), -b))
            found.append(Branch(root, 0, FREE, -1, True, np.eye(3), np.zeros(3), np.eye(3), np.zeros(3)))
            depth[root] = 1
            waiting.discard(root)
            frontier.add(root)
            continue
        _, a, b, number, free = best
        found.append(_branch(system, a, b, number, free))
        depth[b] = depth[a] + 1
        waiting.discard(b)
        frontier.add(b)
    return found


def _branch(system: System, carrier: int, body: int, number: int, free: tuple[int, ...]) -> Branch:
    bodies, table = system.bodies, system.liaisons
    joint = int(table.row[system.liaison_entries[number].rows[0], ROW_JOINT])
    ends = table.joint[joint]
    second = int(bodies.attachment_body[ends[1]]) == body
    inner, outer = (1, 0) if second else (0, 1)
    return Branch(
        body,
        carrier,
        free,
        number,
        second,
        table.frame[joint, inner],
        bodies.attachment_point[ends[inner]],
        table.frame[joint, outer],
        bodies.attachment_point[ends[outer]],
    )

"""A spanning tree of the bodies and the velocities of its joints: the first stage of the double velocity transformation.

Going from the roots outwards, the velocities of every body are those of the body before it, as if the joint were
locked, and the joint's own free motion: the null space of the joint's rows. Nothing is solved for but one joint at a
time. The rows that are no joints of the tree, drivers, couplers, contacts and the joints that close loops, are left.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import FIXED, MotionState
from maggi.system.system import System

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

FULL = 1e-8  # singular values of a joint's rows on its outer body, scaled, that do not count


@dataclass(frozen=True, eq=False)
class Branch:
    """A body on the tree: its columns among the unknown velocities and the joint that it hangs on.

    body, before: rows in the tables, `before` −1 where nothing that moves unprescribed carries it. columns (6 + n_e,)
    or, on a prescribed frame, (n_e,). rows (k,): of the joint; empty where the body is free.
    """

    body: int
    before: int
    columns: IntArray
    floating: bool
    rows: IntArray


@dataclass(frozen=True, eq=False)
class Tree:
    """Bodies from the roots outwards, and the rows that are not joints of the tree."""

    branches: tuple[Branch, ...]
    loop_rows: IntArray

    def among(self, rows: IntArray) -> Tree:
        """The same tree for a system of these rows alone, which are renumbered; it has all rows of the tree's joints."""
        number = {int(row): k for k, row in enumerate(rows)}
        branches = tuple(
            replace(branch, rows=np.array([number[int(row)] for row in branch.rows], dtype=np.int64))
            for branch in self.branches
        )
        loops = np.array([number[int(row)] for row in self.loop_rows if int(row) in number], dtype=np.int64)
        return Tree(branches, loops)


def spanning_tree(system: System, A: Array, unknown: IntArray) -> Tree:
    """A tree of the bodies, every joint taken that reaches a new body, those nearest to ground first.

    A (r, u): rows at a state, on the unknown velocities; a joint enters if its rows are independent on the outer body.
    A body that no joint holds to ground is a root: of those that hang together the one with most joints.
    """
    bodies = system.bodies
    slot = np.full(system.coordinates, -1)
    slot[unknown] = np.arange(len(unknown))
    columns = {
        b: np.array([s for s in slot[bodies.offset[b] : bodies.offset[b + 1]] if s >= 0], dtype=np.int64)
        for b in range(bodies.kind.size)
        if bodies.kind[b] != FIXED
    }
    columns = {b: c for b, c in columns.items() if len(c)}
    touched: dict[int, list[int]] = {}  # liaison: the unknown bodies that its rows touch
    for number, entry in enumerate(system.liaison_entries):
        ends = [b for b, c in columns.items() if np.abs(A[np.ix_(entry.rows, c)]).max(initial=0.0) > 0.0]
        joint = entry.kind != "driver" and len(entry.rows) > 0 and bool(system.holonomic[entry.rows].all())
        if joint and len(ends) in (1, 2):
            touched[number] = ends
    count = {b: sum(b in ends for ends in touched.values()) for b in columns}
    reached: list[Branch] = []
    done: set[int] = set()
    used: set[int] = set()

    def hang(b: int, before: int, rows: IntArray) -> None:
        reached.append(Branch(b, before, columns[b], bool(bodies.floating[b]), rows))
        done.add(b)

    free = np.empty(0, dtype=np.int64)
    for b in columns:
        if not bodies.floating[b]:
            hang(b, -1, free)
    while len(done) < len(columns):
        for number, ends in touched.items():
            new = [b for b in ends if b not in done]
            if number in used or len(new) != 1:
                continue
            rows = system.liaison_entries[number].rows
            if _independent(A[np.ix_(rows, columns[new[0]][:6])]):
                before = next((b for b in ends if b != new[0]), -1)
                hang(new[0], before, rows)
                used.add(number)
                break
        else:
            hang(max((b for b in columns if b not in done), key=lambda b: (count[b], -b)), -1, free)
    tree_rows = np.concatenate([free, *(branch.rows for branch in reached)])
    return Tree(tuple(reached), np.setdiff1d(np.arange(system.rows), tree_rows))


def tree_velocities(tree: Tree, motion: MotionState, A: Array, scale: Array) -> tuple[Array, Array, Array]:
    """All velocities from those of the tree's joints, and these from all velocities.

    A (r, u), scale (u,). Returns B (u, z) with v = B q̇, the rates (z, u) with q̇ = rates v for every v = B q̇, and the
    size (z,) of one unit of each q̇: of all velocities that it makes the largest, scaled.
    """
    u = A.shape[1]
    count = u - sum(len(branch.rows) for branch in tree.branches)
    B, rates = np.zeros((u, count)), np.zeros((count, u))
    columns = {branch.body: branch.columns for branch in tree.branches}
    floating = {branch.body: branch.floating for branch in tree.branches}
    done = 0
    for branch in tree.branches:
        c = branch.columns
        if not len(branch.rows):
            new = np.arange(done, done + len(c))
            B[c, new] = rates[new, c] = 1.0
            done += len(c)
            continue
        frame, elastic = c[:6], c[6:]
        on_frame = A[np.ix_(branch.rows, frame)] / scale[frame]
        # what the frame's velocities are where others act on the joint's rows, and what they are free to be (6, ·)
        answer = -np.linalg.pinv(on_frame) / scale[frame, None]
        free = np.linalg.svd(on_frame)[2][len(branch.rows) :].T / scale[frame, None]
        free, read = _natural(free, float(scale[frame[3]]))
        carried = np.zeros((6, u))
        if branch.before >= 0:
            p = columns[branch.before]
            if floating[branch.before]:
                carried[:, p[:6]] = _as_one_body(motion, branch.before, branch.body)
            carried[:, p] += answer @ (A[np.ix_(branch.rows, p)] + A[np.ix_(branch.rows, frame)] @ carried[:, p])
        carried[:, elastic] += answer @ A[np.ix_(branch.rows, elastic)]
        new = np.arange(done, done + free.shape[1])
        shapes = np.arange(done + free.shape[1], done + free.shape[1] + len(elastic))
        B[elastic, shapes] = rates[shapes, elastic] = 1.0
        B[frame] = carried @ B
        B[np.ix_(frame, new)] = free
        rates[np.ix_(new, frame)] = read
        rates[new] -= read @ carried
        done += free.shape[1] + len(elastic)
    size = np.abs(B * scale[:, None]).max(axis=0, initial=0.0)
    return B, rates, size


def _natural(free: Array, length: float) -> tuple[Array, Array]:
    """Directions (6, k) of the same span, and the matrix (k, 6) that reads their speeds off a twist.

    free: orthonormal where angular velocities are scaled by `length` (m).

    They are turns of 1 rad/s about axes at right angles, read off the angular velocity, and travels of 1 m/s.
    """
    axes, turns, V = np.linalg.svd(free[3:])
    count = int(np.sum(turns * length > FULL))
    directions = free @ V.T
    directions[:, :count] /= turns[:count]
    directions[:, count:] /= np.linalg.norm(directions[:3, count:], axis=0)
    read = np.zeros((free.shape[1], 6))
    read[:count, 3:] = axes[:, :count].T
    read[count:, :3] = np.linalg.pinv(directions[:3, count:])
    read[count:] -= read[count:] @ directions[:, :count] @ read[:count]
    return directions, read


def _as_one_body(motion: MotionState, before: int, after: int) -> Array:
    """The twist (6, 6) of one body's frame from that of another's, as if they were one rigid body; body axes each."""
    R = motion.rotation[after].T @ motion.rotation[before]
    arm = motion.rotation[before].T @ (motion.origin[after] - motion.origin[before])
    turned = np.array([[0.0, arm[2], -arm[1]], [-arm[2], 0.0, arm[0]], [arm[1], -arm[0], 0.0]])  # −skew(arm)
    return np.block([[R, R @ turned], [np.zeros((3, 3)), R]])


def _independent(rows: Array) -> bool:
    """Whether rows (k, 6) have rank k."""
    k = len(rows)
    if k > rows.shape[1]:
        return False
    size = np.linalg.norm(rows, axis=1)
    if not (size > 0.0).all():
        return False
    return bool(np.linalg.svd(rows / size[:, None], compute_uv=False)[-1] > FULL)

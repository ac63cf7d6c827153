"""System ─► tree and closures: which joints carry which bodies, frames in the joints, and the paths of closures.

Every lower pair between rigid bodies, or one and the ground, may carry a body; of all trees one with as many rows as
possible in its joints is taken, and as shallow as that allows. A body that nothing carries is free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import reverse_cuthill_mckee

from maggi.bodies.tables import FIXED, RIGID, BodyTable, MotionState
from maggi.liaisons.registry import JOINTS
from maggi.liaisons.tables import (
    CAM,
    CAM_FACE,
    COORDINATE_JOINT,
    COORDINATE_KIND,
    CURVE,
    OFFSET,
    PRODUCT,
    RATE_RELATION,
    RELATION,
    ROTATION,
    ROTATION_VECTOR,
    ROW_FIRST,
    ROW_JOINT,
    ROW_KIND,
    ROW_SECOND,
    TRANSLATION,
    LiaisonTable,
)
from maggi.linalg.rotations import rotation_vector
from maggi.system.system import LiaisonEntry, System

from .tree_tables import GENERAL, PRISMATIC, REVOLUTE, JointPoses, Tree, TreeWork

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

FREE = (0, 1, 2, 3, 4, 5)
_CARRIED = (OFFSET, PRODUCT)  # rows that a joint of the tree makes needless
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


@dataclass(frozen=True, eq=False)
class RelativeSystem:
    """A system in relative coordinates: constants of its step.

    bodies: the body table with frames in the joints; frame_rotation (b, 3, 3), frame_position (b, 3): those frames in the
    model's. closures: the rows that are no joints of the tree. joint_row_start, joint_row, joint_end, closure_row,
    joint_turn: see `stepping.tables.SmallSystem`. coefficients: how many `LiaisonState.A` is to hold.
    """

    tree: Tree
    bodies: BodyTable
    frame_rotation: Array
    frame_position: Array
    closures: LiaisonTable
    joint_row_start: IntArray
    joint_row: IntArray
    joint_end: IntArray
    closure_row: IntArray
    joint_turn: IntArray
    coefficients: int

    def place(self, body: int) -> int:
        """Where a block's velocities start in ν."""
        block = int(np.flatnonzero(self.tree.block == body)[0])
        return int(self.tree.node_start[len(self.tree.body) + block])


def free_motions(entry: LiaisonEntry, system: System) -> tuple[int, ...] | None:
    """Components of the relative twist, in the joint's frame, that a lower pair leaves free; None for other joints."""
    kind = JOINTS.get(entry.kind)
    if kind is None or any(what not in _CARRIED for what, _, _ in kind.rows):
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


def relative_system(system: System) -> RelativeSystem:
    """Everything that a step in relative coordinates needs of a system and that does not change."""
    found = branches(system)
    bodies = system.bodies
    place = {branch.body: x for x, branch in enumerate(found)}
    blocks = [b for b in range(1, bodies.kind.size) if b not in place]
    turned, rotation, position = _turned(system, found)
    free_start = _starts([len(branch.free) for branch in found])
    width = [len(branch.free) for branch in found] + [int(bodies.offset[b + 1] - bodies.offset[b]) for b in blocks]
    node = {0: -1} | place | {b: len(found) + k for k, b in enumerate(blocks)}
    parent = [node[branch.carrier] if branch.carrier else -1 for branch in found]

    # rows that are no joints of the tree, in an order with a short skyline
    in_joints = {
        int(row): x
        for x, branch in enumerate(found)
        if branch.liaison >= 0
        for row in system.liaison_entries[branch.liaison].rows
        if system.liaisons.row[row, ROW_KIND] in _CARRIED
    }
    left = [row for row in range(system.rows) if row not in in_joints]
    ends_of = {row: _ends(system, row) for row in left}
    paths = {row: _path([int(bodies.attachment_body[a]) for a in ends_of[row]], node, parent) for row in left}
    left = _ordered(system, left, paths)
    closures, cursor = _restricted(system, left, ends_of)

    dof = {}  # coordinates of the tree's joints that are single free motions or turns
    joint_turn: list[tuple[int, int, int]] = []
    for x, branch in enumerate(found):
        if branch.liaison < 0:
            continue
        for c in system.liaison_entries[branch.liaison].coordinates:
            if system.liaisons.coordinate[c, COORDINATE_KIND] == ROTATION:
                joint_turn.append((int(c), x, 1 if branch.second else -1))
                dof[int(c)] = int(free_start[x]) + branch.free.index(5)
    forces = system.forces
    on_joint = [(s, dof[int(c)]) for s, c in enumerate(forces.torsion_coordinate) if int(c) in dof]
    torsions = [s for s, c in enumerate(forces.torsion_coordinate) if int(c) not in dof]
    springs = [(0, s) for s in range(len(forces.spring_ends))] + [(1, s) for s in torsions]
    spring_end: list[tuple[int, int]] = []
    for kind, s in springs:
        joint = system.liaisons.coordinate[forces.torsion_coordinate[s], COORDINATE_JOINT] if kind else 0
        for a in system.liaisons.joint[joint] if kind else forces.spring_ends[s]:
            spring_end.append((int(a), cursor))
            b = int(bodies.attachment_body[a])
            cursor += int(bodies.offset[b + 1] - bodies.offset[b])

    closure_ends = [
        [(int(a), int(start)) for a, start in closures.end[closures.end_start[i] : closures.end_start[i + 1]]]
        for i in range(len(left))
    ] + [spring_end[2 * s : 2 * s + 2] for s in range(len(springs))]
    path_rows, path_start, ends = _paths(closure_ends, bodies, node, parent, width)
    incidence_start, incidence = _incidence(path_rows, path_start, len(width))
    first = _skyline(path_rows, path_start)

    measured = _measured(system, left)
    closures = replace(closures, measured=measured)
    tracked = [
        int(c)
        for number, entry in enumerate(system.liaison_entries)
        for c in entry.coordinates
        if entry.kind != "driver"
        and int(c) not in {t[0] for t in joint_turn}
        and int(c) not in set(measured.tolist())
        and system.liaisons.coordinate[c, COORDINATE_KIND] not in (TRANSLATION, ROTATION_VECTOR)
    ]
    needed = {a for x in closure_ends for a, _ in x} | {int(a) for a in forces.load_attachment}
    needed |= {int(a) for c in (*measured, *tracked) for a in system.liaisons.joint[system.liaisons.coordinate[c, 0]]}
    size = np.zeros(sum(width))
    for x, branch in enumerate(found):
        for d, c in enumerate(branch.free):
            size[free_start[x] + d] = 1.0 if c < 3 else system.size
    starts = _starts(width)
    for k in range(len(blocks)):
        s = starts[len(found) + k]
        size[s : s + 3], size[s + 3 : s + 6] = 1.0, system.size
    M = np.array([_spatial(turned, branch.body, system) for branch in found]).reshape(-1, 6, 6)
    tree = Tree(
        body=_integers([branch.body for branch in found]),
        block=_integers(blocks),
        parent=_integers(parent),
        pair=_integers([_pair(branch) for branch in found]),
        free_start=free_start,
        free=_integers([c for branch in found for c in branch.free]),
        out_rotation=_stack([_out(branch, rotation, position)[0] for branch in found], (3, 3)),
        out_position=_stack([_out(branch, rotation, position)[1] for branch in found], (3,)),
        mass=turned.mass[[branch.body for branch in found]] if found else np.zeros(0),
        S=_stack([turned.S0[branch.body] for branch in found], (3,)),
        J=_stack([turned.J0[branch.body] for branch in found], (3, 3)),
        M=M,
        W=np.linalg.inv(M) if len(M) else M,
        metric=np.tile(np.repeat([1.0, system.size**2], 3), (len(found), 1)).reshape(-1, 6),
        size=size,
        node_start=starts,
        path_start=path_start,
        path=path_rows,
        end_start=_starts([len(x) for x in closure_ends]),
        end=ends,
        incidence_start=incidence_start,
        incidence=incidence,
        skyline_first=first,
        skyline_start=_starts((np.arange(len(first)) - first + 1).tolist()),
        spring=_integers(springs).reshape(-1, 2),
        spring_end=_integers(spring_end).reshape(-1, 2),
        on_joint=_integers(on_joint).reshape(-1, 2),
        needed=_integers(sorted(needed)),
        tracked=_integers(sorted(tracked)),
    )
    rows_of: list[list[int]] = [[] for _ in found]
    for row, x in in_joints.items():
        rows_of[x].append(row)
    joint_row = [row for part in rows_of for row in part]
    joint_end = [
        int(system.liaisons.end_start[row]) + (1 if found[x].second else 0)
        for x, part in enumerate(rows_of)
        for row in part
    ]
    return RelativeSystem(
        tree,
        turned,
        rotation,
        position,
        closures,
        _starts([len(part) for part in rows_of]),
        _integers(joint_row),
        _integers(joint_end),
        _integers(left),
        _integers(joint_turn).reshape(-1, 3),
        cursor,
    )


def new_tree_work(tree: Tree) -> TreeWork:
    """Scratch arrays of a tree; its factor is made before it is used."""
    x, d = len(tree.body), len(tree.free)
    longest = int(np.diff(tree.path_start).max(initial=1))
    columns = 0
    if len(tree.path):
        width = np.diff(tree.node_start)[tree.path[:, 0]]
        columns = int((tree.path[:, 1] + width).max())
    return TreeWork(
        rotation=np.tile(np.eye(3), (x, 1, 1)).reshape(x, 3, 3),
        arm=np.zeros((x, 3)),
        inertia=np.zeros((x, 6, 6)),
        column=np.zeros((d, 6)),
        inverse=np.zeros(d),
        force=np.zeros((x, 6)),
        twist=np.zeros((x, 6)),
        columns=np.zeros(columns),
        path_force=np.zeros((longest, 6)),
    )


def new_joint_poses(count: int) -> JointPoses:
    """Joints in their zero positions."""
    return JointPoses(np.zeros(count), np.tile(np.eye(3), (count, 1, 1)).reshape(count, 3, 3), np.zeros((count, 3)))


def relative_motion(
    relative: RelativeSystem, motion: MotionState, joints: JointPoses, accepted: MotionState, nu: Array, nud: Array
) -> None:
    """Set the tree's joints, the blocks, and ν, ν̇ from a motion in the model's frames that meets the tree's joints."""
    tree, bodies = relative.tree, relative.bodies
    F, f = relative.frame_rotation, relative.frame_position
    for target, source in zip(accepted, motion, strict=True):
        target[:] = source
    R = motion.rotation @ F
    r = motion.origin + np.einsum("bij,bj->bi", motion.rotation, f)
    twists, rates = np.zeros((len(R), 6)), np.zeros((len(R), 6))
    for b in range(1, len(R)):
        o = int(bodies.offset[b])
        for target, source in ((twists, motion.v), (rates, motion.vd)):
            v, w = source[o : o + 3], source[o + 3 : o + 6]
            target[b, :3] = F[b].T @ (v + np.cross(w, f[b]))
            target[b, 3:] = F[b].T @ w
    for x, b in enumerate(tree.body):
        p = int(tree.parent[x])
        c = int(tree.body[p]) if p >= 0 else 0
        out, at = tree.out_rotation[x], tree.out_position[x]
        Q = out.T @ R[c].T @ R[b]
        shift = out.T @ (R[c].T @ (r[b] - r[c]) - at)
        if tree.pair[x] == REVOLUTE:
            joints.value[x] = np.arctan2(Q[1, 0] - Q[0, 1], Q[0, 0] + Q[1, 1])
        elif tree.pair[x] == PRISMATIC:
            joints.value[x] = shift[2]
        else:
            joints.rotation[x], joints.position[x] = Q, shift
            joints.value[x] = rotation_vector(Q)[2]
        X = R[b].T @ R[c]
        arm = R[c].T @ (r[b] - r[c])
        carried = np.concatenate([X @ (twists[c, :3] + np.cross(twists[c, 3:], arm)), X @ twists[c, 3:]])
        turned = np.concatenate([X @ (rates[c, :3] + np.cross(rates[c, 3:], arm)), X @ rates[c, 3:]])
        own = np.zeros(6)
        part = slice(int(tree.free_start[x]), int(tree.free_start[x + 1]))
        free = tree.free[part]
        own[free] = (twists[b] - carried)[free]
        nu[part] = own[free]
        v, w = twists[b, :3], twists[b, 3:]
        bend = np.concatenate([np.cross(w, own[:3]) + np.cross(v, own[3:]), np.cross(w, own[3:])])
        nud[part] = (rates[b] - turned - bend)[free]
    count = len(tree.body)
    for k, b in enumerate(tree.block):
        s, e = int(tree.node_start[count + k]), int(tree.node_start[count + k + 1])
        o = int(bodies.offset[b])
        nu[s:e], nud[s:e] = motion.v[o : o + e - s], motion.vd[o : o + e - s]


def _turned(system: System, found: Sequence[Branch]) -> tuple[BodyTable, Array, Array]:
    """The body table with the tree's bodies on frames in their joints, and those frames in the bodies' own."""
    bodies = system.bodies
    rotation = np.tile(np.eye(3), (bodies.kind.size, 1, 1))
    position = np.zeros((bodies.kind.size, 3))
    for branch in found:
        rotation[branch.body], position[branch.body] = branch.rotation, branch.position
    S0, J0 = bodies.S0.copy(), bodies.J0.copy()
    for branch in found:
        b, F, f = branch.body, branch.rotation, branch.position
        m, S = bodies.mass[b], bodies.S0[b]
        # about the joint, still in the body's axes: S − m f, J − [(2 S·f − m f·f) I − (S fᵀ + f Sᵀ − m f fᵀ)]
        J = J0[b] - (2.0 * S @ f - m * f @ f) * np.eye(3)
        J += np.outer(S, f) + np.outer(f, S) - m * np.outer(f, f)
        S0[b] = F.T @ (S - m * f)
        J0[b] = F.T @ J @ F
    point, axes = bodies.attachment_point.copy(), bodies.attachment_axes.copy()
    turned = bodies.attachment_turned.copy()
    for a, b in enumerate(bodies.attachment_body):
        F = rotation[b]
        point[a] = F.T @ (point[a] - position[b])
        axes[a] = F.T
        turned[a] = int(not np.array_equal(F, np.eye(3)))
    changed = replace(bodies, S0=S0, J0=J0, attachment_point=point, attachment_axes=axes, attachment_turned=turned)
    return changed, rotation, position


def _out(branch: Branch, rotation: Array, position: Array) -> tuple[Array, Array]:
    """The joint on its carrier, in the carrier's frame of the tree."""
    F, f = rotation[branch.carrier], position[branch.carrier]
    return F.T @ branch.out_rotation, F.T @ (branch.out_position - f)


def _pair(branch: Branch) -> int:
    if branch.free == (5,):
        return REVOLUTE
    return PRISMATIC if branch.free == (2,) else GENERAL


def _spatial(bodies: BodyTable, b: int, system: System) -> Array:
    """The inertia on twists (6, 6), [m, −S̃; S̃, J], with the floor."""
    S = bodies.S0[b]
    skew = np.array([[0.0, -S[2], S[1]], [S[2], 0.0, -S[0]], [-S[1], S[0], 0.0]])
    J = bodies.J0[b] + system.inertia_floor[b] * np.eye(3)
    return np.block([[bodies.mass[b] * np.eye(3), -skew], [skew, J]])


def _ends(system: System, row: int) -> list[int]:
    table = system.liaisons
    return [int(a) for a in table.end[table.end_start[row] : table.end_start[row + 1], 0]]


def _path(bodies: Sequence[int], node: dict[int, int], parent: Sequence[int]) -> list[int]:
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


def _ordered(system: System, rows: list[int], paths: dict[int, list[int]]) -> list[int]:
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
    pairs += [(b, a) for a, b in pairs]
    if not names:
        return []
    graph = sp.coo_matrix(
        (np.ones(len(pairs)), ([a for a, _ in pairs], [b for _, b in pairs])), shape=(len(names), len(names))
    )
    order = reverse_cuthill_mckee(graph.tocsr(), symmetric_mode=True)
    return [row for k in order for row in owners[names[int(k)]]]


def _restricted(system: System, rows: list[int], ends_of: dict[int, list[int]]) -> tuple[LiaisonTable, int]:
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
        end_start=_starts([len(ends_of[row]) for row in rows]),
        end=_integers(end).reshape(-1, 2),
        incidence_start=_starts([len(x) for x in incidence]),
        incidence=_integers([pair for x in incidence for pair in x]).reshape(-1, 2),
        skyline_first=none,
        skyline_start=none,
    )
    return restricted, cursor


def _paths(
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
        nodes = _path(on, node, parent)
        at = {x: len(path) + k for k, x in enumerate(nodes)}
        for x in nodes:
            up = at.get(parent[x], -1) if x < len(parent) else -1
            path.append((x, columns, up))
            columns += width[x]
        lengths.append(len(nodes))
        ends += [(start, at.get(node[b], -1)) for b, (_, start) in zip(on, closure, strict=True)]
    return (
        _integers(path).reshape(-1, 3),
        _starts(lengths),
        _integers(ends).reshape(-1, 2),
    )


def _incidence(path: IntArray, path_start: IntArray, nodes: int) -> tuple[IntArray, IntArray]:
    found: list[list[tuple[int, int]]] = [[] for _ in range(nodes)]
    for q in range(len(path_start) - 1):
        for x, start, _ in path[path_start[q] : path_start[q + 1]]:
            found[x].append((q, int(start)))
    return _starts([len(x) for x in found]), _integers([pair for x in found for pair in x]).reshape(-1, 2)


def _skyline(path: IntArray, path_start: IntArray) -> IntArray:
    earliest: dict[int, int] = {}
    first = []
    for q in range(len(path_start) - 1):
        nodes = [int(x) for x in path[path_start[q] : path_start[q + 1], 0]]
        first.append(min([q, *(earliest.get(x, q) for x in nodes)]))
        for x in nodes:
            earliest.setdefault(x, q)
    return _integers(first)


def _measured(system: System, rows: list[int]) -> IntArray:
    """Coordinates that rows and torsion springs need."""
    needed = {int(c) for c in system.forces.torsion_coordinate}
    for row in rows:
        needed |= set(coordinates_of(system, row))
    return _integers(sorted(needed))


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


def _starts(counts: Sequence[int]) -> IntArray:
    return np.concatenate([[0], np.cumsum(np.array(counts, dtype=np.int64))]).astype(np.int64)


def _integers(values: Sequence[object]) -> IntArray:
    return np.ascontiguousarray(np.array(values, dtype=np.int64))


def _stack(parts: Sequence[Array], shape: tuple[int, ...]) -> Array:
    return np.ascontiguousarray(np.array(parts, dtype=np.float64).reshape(-1, *shape))

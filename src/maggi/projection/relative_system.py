"""System ─► tree and closures: frames in the joints, and all constants of a step in relative coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import BodyTable
from maggi.liaisons.tables import (
    COORDINATE_JOINT,
    COORDINATE_KIND,
    ROTATION,
    ROTATION_VECTOR,
    ROW_KIND,
    TRANSLATION,
    LiaisonTable,
)
from maggi.system.system import System

from .closure_paths import (
    closure_paths,
    column_velocities,
    ends_of_row,
    integers,
    measured_coordinates,
    node_incidence,
    ordered_rows,
    path_of,
    restricted,
    skyline,
    starts,
)
from .tree_choice import CARRIED, Branch, branches
from .tree_tables import GENERAL, PRISMATIC, REVOLUTE, Tree

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


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


def relative_system(system: System) -> RelativeSystem:
    """Everything that a step in relative coordinates needs of a system and that does not change."""
    found = branches(system)
    bodies = system.bodies
    place = {branch.body: x for x, branch in enumerate(found)}
    blocks = [b for b in range(1, bodies.kind.size) if b not in place]
    turned, rotation, position = _turned(system, found)
    free_start = starts([len(branch.free) for branch in found])
    width = [len(branch.free) for branch in found] + [int(bodies.offset[b + 1] - bodies.offset[b]) for b in blocks]
    node = {0: -1} | place | {b: len(found) + k for k, b in enumerate(blocks)}
    parent = [node[branch.carrier] if branch.carrier else -1 for branch in found]

    # rows that are no joints of the tree, in an order with a short skyline
    in_joints = {
        int(row): x
        for x, branch in enumerate(found)
        if branch.liaison >= 0
        for row in system.liaison_entries[branch.liaison].rows
        if system.liaisons.row[row, ROW_KIND] in CARRIED
    }
    left = [row for row in range(system.rows) if row not in in_joints]
    ends_of = {row: ends_of_row(system, row) for row in left}
    paths = {row: path_of([int(bodies.attachment_body[a]) for a in ends_of[row]], node, parent) for row in left}
    left = ordered_rows(system, left, paths)
    closures, cursor = restricted(system, left, ends_of)

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
    path_rows, path_start, ends = closure_paths(closure_ends, bodies, node, parent, width)
    column_start, column_velocity = column_velocities(path_rows, path_start, width)
    incidence_start, incidence = node_incidence(path_rows, path_start, len(width))
    first = skyline(path_rows, path_start)

    measured = measured_coordinates(system, left)
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
    node_start = starts(width)
    for k in range(len(blocks)):
        s = node_start[len(found) + k]
        size[s : s + 3], size[s + 3 : s + 6] = 1.0, system.size
    M = np.array([_spatial(turned, branch.body, system) for branch in found]).reshape(-1, 6, 6)
    metric = np.diag(np.repeat([1.0, system.size**2], 3))
    tree = Tree(
        body=integers([branch.body for branch in found]),
        block=integers(blocks),
        parent=integers(parent),
        pair=integers([_pair(branch) for branch in found]),
        free_start=free_start,
        free=integers([c for branch in found for c in branch.free]),
        out_rotation=_stack([_out(branch, rotation, position)[0] for branch in found], (3, 3)),
        out_position=_stack([_out(branch, rotation, position)[1] for branch in found], (3,)),
        mass=turned.mass[[branch.body for branch in found]] if found else np.zeros(0),
        S=_stack([turned.S0[branch.body] for branch in found], (3,)),
        J=_stack([turned.J0[branch.body] for branch in found], (3, 3)),
        M=M,
        W=np.linalg.inv(M) if len(M) else M,
        metric=np.tile(metric, (len(found), 1, 1)),
        metric_W=np.tile(np.linalg.inv(metric), (len(found), 1, 1)),
        size=size,
        node_start=node_start,
        path_start=path_start,
        path=path_rows,
        column_start=column_start,
        column_velocity=column_velocity,
        end_start=starts([len(x) for x in closure_ends]),
        end=ends,
        incidence_start=incidence_start,
        incidence=incidence,
        skyline_first=first,
        skyline_start=starts((np.arange(len(first)) - first + 1).tolist()),
        spring=integers(springs).reshape(-1, 2),
        spring_end=integers(spring_end).reshape(-1, 2),
        on_joint=integers(on_joint).reshape(-1, 2),
        needed=integers(sorted(needed)),
        tracked=integers(sorted(tracked)),
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
        starts([len(part) for part in rows_of]),
        integers(joint_row),
        integers(joint_end),
        integers(left),
        integers(joint_turn).reshape(-1, 3),
        cursor,
    )


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


def _stack(parts: Sequence[Array], shape: tuple[int, ...]) -> Array:
    return np.ascontiguousarray(np.array(parts, dtype=np.float64).reshape(-1, *shape))

"""Motions in the model's frames ─► relative coordinates, and room for them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import MotionState
from maggi.linalg.rotations import rotation_vector

from .relative_system import RelativeSystem
from .tree_tables import PRISMATIC, REVOLUTE, JointPoses, Tree, TreeWork

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def new_tree_work(tree: Tree) -> TreeWork:
    """Scratch arrays of a tree; its factor is made before it is used."""
    x, d = len(tree.body), len(tree.free)
    longest = int(np.diff(tree.path_start).max(initial=1))
    return TreeWork(
        rotation=np.tile(np.eye(3), (x, 1, 1)).reshape(x, 3, 3),
        arm=np.zeros((x, 3)),
        inertia=np.zeros((x, 6, 6)),
        column=np.zeros((d, 6)),
        inverse=np.zeros(d),
        force=np.zeros((x, 6)),
        twist=np.zeros((x, 6)),
        columns=np.zeros(len(tree.column_velocity)),
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

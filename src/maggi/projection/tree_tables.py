"""A mechanism in relative coordinates as flat arrays: joints of a tree first, closures second.

The *tree* has rigid bodies hanging on lower pairs, each with its frame in the joint that carries it, so that the joint's
free motions are components of the body's twist. Elastic and prescribed bodies are *blocks* with velocities of their own.
Rows that are no joints of the tree, and springs, are *closures*.
"""

from __future__ import annotations

from dataclasses import dataclass

from maggi.bodies.tables import Array, IntArray
from maggi.linalg.table import Table

REVOLUTE, PRISMATIC, GENERAL = 0, 1, 2  # how a joint's pose follows from its free motions

# Columns of Tree.path.
NODE, START, UP = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Tree(Table):
    """Constants of a mechanism in relative coordinates.

    x tree bodies, outwards from the roots; d free motions of their joints; k blocks; m = d + the blocks' small coordinates
    is the number of velocities ν. Nodes are tree bodies, then blocks.

    body (x,), block (k,): rows in the body table. parent (x,): tree body, −1 for ground. pair (x,): REVOLUTE, PRISMATIC,
        GENERAL. free_start (x + 1,), free (d,): components of the twist, 0 … 5, that the joint leaves free.
    out_rotation (x, 3, 3), out_position (x, 3): the joint on its carrying body, in that body's frame.
    mass (x,), S (x, 3), J (x, 3, 3): first moment and inertia about the joint; M (x, 6, 6): those as a matrix on twists,
        with the floor of bodies without inertia (`System.inertia_floor`); W (x, 6, 6): its inverse.
    metric (x, 6, 6): a matrix on twists that knows no masses, see `range_space`; metric_W (x, 6, 6): its inverse.
    size (m,): m of one unit of each velocity: 1, the mechanism's size for an angle, 0 for elastic coordinates.
    node_start (x + k + 1,): where a node's velocities start in ν.
    rows r, springs s as rows behind them: path_start (r + s + 1,), path (p, 3): the nodes that a row acts on, tree bodies
        inwards: node, start of its coefficients in `TreeWork.columns`, the carrying body's place in `path` or −1.
        column_start (r + s + 1,), column_velocity (c,): where a row's coefficients start in `columns`, and which velocity ν
        each of them is of.
    end_start (r + s + 1,), end (e, 2): where coefficients on a body start in `LiaisonState.A`, and its place in `path` or
        −1; incidence_start (x + k + 1,), incidence (p, 2): row and start in `columns` of every row on a node.
    skyline_first (r + s,), skyline_start (r + s + 1,): as in `LiaisonTable`.
    spring (s, 2): 0 and spring, 1 and torsion spring; spring_end (2 s, 2): attachment and start in `LiaisonState.A`.
    on_joint (z, 2): torsion spring and free motion of those that act on a joint of the tree alone.
    needed (a,): attachments that closures and forces look at. tracked (c,): coordinates that only have their turns counted.
    """

    body: IntArray
    block: IntArray
    parent: IntArray
    pair: IntArray
    free_start: IntArray
    free: IntArray
    out_rotation: Array
    out_position: Array
    mass: Array
    S: Array
    J: Array
    M: Array
    W: Array
    metric: Array
    metric_W: Array
    size: Array
    node_start: IntArray
    path_start: IntArray
    path: IntArray
    column_start: IntArray
    column_velocity: IntArray
    end_start: IntArray
    end: IntArray
    incidence_start: IntArray
    incidence: IntArray
    skyline_first: IntArray
    skyline_start: IntArray
    spring: IntArray
    spring_end: IntArray
    on_joint: IntArray
    needed: IntArray
    tracked: IntArray


@dataclass(frozen=True, eq=False)
class JointPoses(Table):
    """Poses of the tree's joints. value (x,): angle (rad) or displacement (m) of REVOLUTE and PRISMATIC; for the others
    rotation (x, 3, 3), position (x, 3) on the carrying body's side, and in `value` the turn about z (rad), counted.
    """

    value: Array
    rotation: Array
    position: Array


@dataclass(frozen=True, eq=False)
class TreeWork(Table):
    """The tree at one state and its factor.

    rotation (x, 3, 3), arm (x, 3): a body's frame in its carrier's. inertia (x, 6, 6): articulated, Ŝ of a body and all
    that hangs on it. column (d, 6): L; inverse (d,): D⁻¹. force (x, 6), twist (x, 6): passes inwards and outwards.
    columns (flat): L⁻¹Aᵀ of closures on tree bodies, Aᵀ on blocks. path_force (longest path, 6).
    """

    rotation: Array
    arm: Array
    inertia: Array
    column: Array
    inverse: Array
    force: Array
    twist: Array
    columns: Array
    path_force: Array

"""Strategies for choosing independent velocities: different pivots, the same admitted velocities (Theory §4).

| name | ν | |
|---|---|---|
| ``lu`` | some of the velocities | coordinate partitioning by LU with complete pivoting |
| ``qr`` | some of the velocities | by QR with column pivoting |
| ``svd`` | combinations, S orthonormal at the base | singular values |
| ``tree`` | joint velocities of a spanning tree | the loops closed by ``lu``: double velocity transformation |

A strategy is chosen by structure where none is asked for (`default_strategy`): ``tree`` if all bodies hang on
ground or on one another by joints without any loop to close, so that ν are all joint velocities; ``lu`` otherwise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from maggi.bodies.tables import MotionState

from .spanning_tree import Tree, tree_velocities
from .splitting import (
    Splitting,
    decided_rank,
    gap_at,
    independent_rows,
    null_directions,
    scaled_rows,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

Strategy = Callable[[MotionState, Array, Array, "int | None"], Splitting]
"""strategy(motion, A, scale, previous): the splitting at a state, where the rows are A (m, n), for velocities of the
given sizes (n,); previous: the rank that the rows had before, or None, see `decided_rank`."""

KEEP = 5.0
"""A choice is kept while the condition of S is at most this many times what it was when chosen."""


def by_lu(
    motion: MotionState, A: Array, scale: Array, previous: int | None = None, size: Array | None = None
) -> Splitting:
    """Coordinate partitioning by LU with complete pivoting: dependent are the velocities of the pivots' columns.

    size (m,): of the rows, where some are nothing but round-off.
    """
    work = scaled_rows(A, scale, size)
    m, n = work.shape
    row_order, order = np.arange(m), np.arange(n)
    pivots = np.zeros(min(m, n))
    for k in range(min(m, n)):
        p, q = np.unravel_index(np.argmax(np.abs(work[k:, k:])), (m - k, n - k))
        if work[k + p, k + q] == 0.0:
            break
        _swap(work, row_order, k, k + int(p))
        _swap(work.T, order, k, k + int(q))
        pivots[k] = abs(work[k, k])
        work[k + 1 :, k] /= work[k, k]
        work[k + 1 :, k + 1 :] -= np.outer(work[k + 1 :, k], work[k, k + 1 :])
    rank = decided_rank(pivots, A.shape[1], previous)
    splitting = _partition("lu", A, scale, np.sort(order[rank:]), np.sort(order[:rank]), gap_at(pivots, rank))
    return replace(splitting, rows=np.sort(row_order[:rank]), redundant=np.sort(row_order[rank:]))


def by_qr(motion: MotionState, A: Array, scale: Array, previous: int | None = None) -> Splitting:
    """Coordinate partitioning by QR with column pivoting, as in `maggi.project`."""
    _, R, order = qr(scaled_rows(A, scale), mode="economic", pivoting=True) if len(A) else (0, np.zeros((0, 0)), None)
    order = np.arange(A.shape[1]) if order is None else order.astype(np.int64)
    pivots = np.abs(np.diag(R))
    rank = decided_rank(pivots, A.shape[1], previous)
    return _partition("qr", A, scale, np.sort(order[rank:]), np.sort(order[:rank]), gap_at(pivots, rank))


def by_svd(motion: MotionState, A: Array, scale: Array, previous: int | None = None) -> Splitting:
    """S orthonormal in scaled velocities: the right singular vectors of the rows that belong to no singular value."""
    n = A.shape[1]
    _, values, V = np.linalg.svd(scaled_rows(A, scale))
    rank = decided_rank(values, n, previous)
    N = V[:rank].T / scale[:, None]
    rows, redundant = independent_rows(scaled_rows(A, scale) @ V[:rank].T)
    return _conditioned(
        Splitting(
            "svd",
            V[rank:].T / scale[:, None],
            N,
            V[rank:] * scale,
            np.empty(0, dtype=np.int64),
            rows,
            redundant,
            gap_at(values, rank),
            scale,
        ),
        A,
    )


def by_tree(tree: Tree) -> Strategy:
    """The double velocity transformation: joint velocities of a spanning tree, then its loops closed by LU.

    The tree's joints are removed body by body from the root (`tree_velocities`); what they leave are velocities z of
    the joints, on which the other rows act as ``A B z + b = 0``, fewer and better scaled than all.
    """

    def choose(motion: MotionState, A: Array, scale: Array, previous: int | None = None) -> Splitting:
        B, joint_rates, size = tree_velocities(tree, motion, A, scale)
        taken = A.shape[1] - B.shape[1]
        closing = A[tree.loop_rows]
        weights = np.linalg.norm(closing / scale, axis=1)
        loops = by_lu(motion, closing @ B, size, None if previous is None else previous - taken, weights)
        S = B @ loops.at(closing @ B).S
        read = joint_rates[loops.velocities]
        P = np.asarray(np.linalg.solve(read @ S, read))
        N = null_directions(P, scale)
        rows, redundant = independent_rows(scaled_rows(A, scale) @ (N * scale[:, None]))
        return _conditioned(
            Splitting("tree", S, N, P, np.empty(0, dtype=np.int64), rows, redundant, loops.gap, scale), A
        )

    return choose


def default_strategy(tree: Tree) -> Strategy:
    """By structure; see the module's table."""
    return by_lu if len(tree.loop_rows) else by_tree(tree)


def named_strategy(name: str | None, tree: Tree) -> Strategy:
    """A strategy by its name, None: the default. Raises ValueError for a name that there is not."""
    if name is None:
        return default_strategy(tree)
    strategies = {"lu": by_lu, "qr": by_qr, "svd": by_svd, "tree": by_tree(tree)}
    if name not in strategies:
        raise ValueError(f"there is no strategy {name!r}; use one of {', '.join(strategies)}")
    return strategies[name]


def kept_or_renewed(splitting: Splitting, strategy: Strategy, motion: MotionState, A: Array) -> Splitting:
    """The same choice while it is well conditioned at the present rows, a new one otherwise.

    Where rows lose rank for an instant, at a singular position, it is kept too: the number of freedoms of a mechanism
    is that of its general position, and there the old choice goes on to describe the same branch of motion.
    """
    if splitting.at(A).condition <= KEEP * splitting.condition:
        return splitting
    renewed = strategy(motion, A, splitting.scale, splitting.rank)
    return renewed if renewed.rank >= splitting.rank else splitting


def _partition(name: str, A: Array, scale: Array, independent: IntArray, dependent: IntArray, gap: float) -> Splitting:
    n = A.shape[1]
    E, N = np.zeros((n, len(independent))), np.zeros((n, len(dependent)))
    E[independent, np.arange(len(independent))] = 1.0
    N[dependent, np.arange(len(dependent))] = 1.0 / scale[dependent]
    rows, redundant = independent_rows(scaled_rows(A, scale) @ (N * scale[:, None]))
    return _conditioned(Splitting(name, E, N, E.T.copy(), independent, rows, redundant, gap, scale), A)


def _conditioned(splitting: Splitting, A: Array) -> Splitting:
    return replace(splitting, condition=splitting.at(A).condition)


def _swap(rows: Array, order: IntArray, i: int, j: int) -> None:
    rows[[i, j]] = rows[[j, i]]
    order[[i, j]] = order[[j, i]]

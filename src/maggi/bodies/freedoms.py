"""The freedoms of a meshed body: its free nodes', and those of the attachments that make nodes rigid (RBE2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Freedoms:
    """How nodal displacements (n, 3) follow from the freedoms, in blocks of three: ``u_n = d + θ × (X_n − X_a)``.

    The tie is linear, so it is one more of Maggi's projections: forces and matrices go by its transpose.

    node_block (n,): the block that is node n's displacement, or −1 for tied nodes. tied (k,): tied nodes; master
    (k,): block of d, followed by the block of θ; arm (k, 3): X_n − X_a. blocks: number of blocks.
    """

    node_block: IntArray
    tied: IntArray
    master: IntArray
    arm: Array
    blocks: int

    @staticmethod
    def of(nodes: Array, rigid: list[tuple[IntArray, Array]]) -> Freedoms:
        """Freedoms of `nodes` (n, 3) with rigid sets, each (node indices, point X_a), which must not overlap."""
        free = np.ones(len(nodes), dtype=bool)
        for members, _ in rigid:
            free[members] = False
        node_block = np.where(free, np.cumsum(free) - 1, -1)
        first = int(free.sum())
        tied = [members for members, _ in rigid]
        master = [np.full(len(members), first + 2 * k) for k, (members, _) in enumerate(rigid)]
        arm = [nodes[members] - point for members, point in rigid]
        return Freedoms(
            node_block.astype(np.int64),
            np.concatenate([*tied, np.empty(0, dtype=np.int64)]).astype(np.int64),
            np.concatenate([*master, np.empty(0, dtype=np.int64)]).astype(np.int64),
            np.concatenate([*arm, np.empty((0, 3))]),
            first + 2 * len(rigid),
        )

    @property
    def size(self) -> int:
        """Number of freedoms."""
        return 3 * self.blocks

    def expand(self, x: Array, out: Array) -> Array:
        """Nodal field (n, 3) of the freedoms x; x itself, reshaped, where no node is tied."""
        if self.tied.size == 0:
            return x.reshape(-1, 3)
        _expand(self.node_block, self.tied, self.master, self.arm, x.reshape(-1, 3), out)
        return out

    def expand_many(self, columns: Array) -> Array:
        """Nodal fields (n, 3, k) of k columns of freedoms (3 · blocks, k)."""
        fields = columns if self.tied.size == 0 else self.matrix() @ columns
        return np.ascontiguousarray(fields).reshape(-1, 3, columns.shape[1])

    def reduce(self, force: Array, out: Array) -> None:
        """Generalised forces (3 · blocks,) of nodal forces (n, 3): the transpose of `expand`."""
        _reduce(self.node_block, self.tied, self.master, self.arm, force, out.reshape(-1, 3))

    def matrix(self) -> sp.csr_matrix:
        """The tie T as a matrix, (3n, 3 · blocks)."""
        free = np.flatnonzero(self.node_block >= 0)
        component = np.arange(3)
        rows = [(3 * free[:, None] + component).ravel(), (3 * self.tied[:, None] + component).ravel()]
        columns = [
            (3 * self.node_block[free][:, None] + component).ravel(),
            (3 * self.master[:, None] + component).ravel(),
        ]
        values = [np.ones(rows[0].size), np.ones(rows[1].size)]
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            # (θ × a)_i = θ_j a_k − θ_k a_j
            for column, sign, part in ((j, 1.0, k), (k, -1.0, j)):
                rows.append(3 * self.tied + i)
                columns.append(3 * (self.master + 1) + column)
                values.append(sign * self.arm[:, part])
        entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        return sp.coo_matrix(entries, shape=(3 * len(self.node_block), self.size)).tocsr()

    def reduce_matrix(self, matrix: sp.bsr_matrix) -> sp.bsr_matrix:
        """Tᵀ (matrix) T with 3×3 blocks; exactly symmetric where `matrix` is."""
        if self.tied.size == 0:
            return matrix
        T = self.matrix()
        reduced = (T.T @ matrix.tocsr() @ T).tocsr()
        reduced = (0.5 * (reduced + reduced.T)).tobsr((3, 3))
        reduced.sort_indices()
        return reduced


@njit(cache=True)
def _expand(node_block, tied, master, arm, x, out):  # type: ignore[no-untyped-def]
    for n in range(node_block.size):
        b = node_block[n]
        if b >= 0:
            for i in range(3):
                out[n, i] = x[b, i]
    for k in range(tied.size):
        b = master[k]
        t0, t1, t2 = x[b + 1, 0], x[b + 1, 1], x[b + 1, 2]
        out[tied[k], 0] = x[b, 0] + t1 * arm[k, 2] - t2 * arm[k, 1]
        out[tied[k], 1] = x[b, 1] + t2 * arm[k, 0] - t0 * arm[k, 2]
        out[tied[k], 2] = x[b, 2] + t0 * arm[k, 1] - t1 * arm[k, 0]


@njit(cache=True)
def _reduce(node_block, tied, master, arm, force, out):  # type: ignore[no-untyped-def]
    for n in range(node_block.size):
        b = node_block[n]
        if b >= 0:
            for i in range(3):
                out[b, i] = force[n, i]
    for k in range(tied.size):
        out[master[k], :] = 0.0
        out[master[k] + 1, :] = 0.0
    for k in range(tied.size):
        b = master[k]
        x, y, z = force[tied[k], 0], force[tied[k], 1], force[tied[k], 2]
        out[b, 0] += x
        out[b, 1] += y
        out[b, 2] += z
        out[b + 1, 0] += arm[k, 1] * z - arm[k, 2] * y
        out[b + 1, 1] += arm[k, 2] * x - arm[k, 0] * z
        out[b + 1, 2] += arm[k, 0] * y - arm[k, 1] * x

"""The freedoms of a meshed body: its free nodes', and those of the attachments that make nodes rigid (RBE2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.linalg.compiling import kernel

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
        ordered = self.with_tied(columns.reshape(self.blocks, 3, -1))
        if self.tied.size == 0:
            return ordered
        fields = np.empty_like(ordered)
        fields[self.order()] = ordered
        return fields

    def with_tied(self, fields: Array) -> Array:
        """Nodal fields (n, 3, k), nodes in `order`, of fields (blocks, 3, k) on the freedoms."""
        if self.tied.size == 0:
            return np.ascontiguousarray(fields)
        tied = fields[self.master] + np.cross(fields[self.master + 1], self.arm[:, :, None], axis=1)
        return np.concatenate((fields[: len(self.node_block) - self.tied.size], tied))

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

    def order(self) -> IntArray:
        """Nodes (n,): the free ones, in the order of their blocks, then the tied ones."""
        return np.concatenate([np.flatnonzero(self.node_block >= 0), self.tied])

    def reduce_matrix(self, matrix: sp.bsr_matrix) -> sp.bsr_matrix:
        """Tᵀ (matrix) T with 3×3 blocks, for a symmetric matrix whose rows are sorted; exactly symmetric."""
        if self.tied.size == 0:
            return matrix
        number = np.full(len(self.node_block), -1, dtype=np.int64)
        number[self.tied] = np.arange(self.tied.size)
        free = int((self.node_block >= 0).sum())
        attachment = (self.master - free) // 2
        indptr, indices, blocks = _reduced(
            matrix.indptr, matrix.indices, matrix.data, self.node_block, number, attachment, self.arm, self.blocks, free
        )
        return sp.bsr_matrix((blocks, indices, indptr), shape=(self.size, self.size))


@kernel
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


@kernel
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


@kernel
def _reduced(indptr, indices, data, node_block, number, attachment, arm, size, free):  # type: ignore[no-untyped-def]
    """The rows of Tᵀ A T: free nodes keep their blocks; those of a tied node go to its attachment's two by [I, −ã]."""
    count = (size - free) // 2
    side = np.zeros((free, count, 3, 6))  # free nodes' rows, attachments' columns
    touched = np.zeros((free, count), np.bool_)
    corner = np.zeros((count, count, 6, 6))
    coupled = np.zeros((count, count), np.bool_)
    first = np.zeros(size + 1, np.int32)
    turned = np.empty((3, 6))
    for n in range(node_block.size):
        i = node_block[n]
        for p in range(indptr[n], indptr[n + 1]):
            m = indices[p]
            if node_block[m] >= 0:
                if i >= 0:
                    first[i + 1] += 1
                continue
            b, arm_m = attachment[number[m]], arm[number[m]]
            for k in range(3):
                x, y, z = data[p, k, 0], data[p, k, 1], data[p, k, 2]
                turned[k, 0], turned[k, 1], turned[k, 2] = x, y, z
                turned[k, 3] = z * arm_m[1] - y * arm_m[2]
                turned[k, 4] = x * arm_m[2] - z * arm_m[0]
                turned[k, 5] = y * arm_m[0] - x * arm_m[1]
            if i >= 0:
                touched[i, b] = True
                for k in range(3):
                    for j in range(6):
                        side[i, b, k, j] += turned[k, j]
            else:
                a, arm_n = attachment[number[n]], arm[number[n]]
                coupled[a, b] = True
                for j in range(6):
                    x, y, z = turned[0, j], turned[1, j], turned[2, j]
                    corner[a, b, 0, j] += x
                    corner[a, b, 1, j] += y
                    corner[a, b, 2, j] += z
                    corner[a, b, 3, j] += arm_n[1] * z - arm_n[2] * y
                    corner[a, b, 4, j] += arm_n[2] * x - arm_n[0] * z
                    corner[a, b, 5, j] += arm_n[0] * y - arm_n[1] * x
    for i in range(free):
        for a in range(count):
            if touched[i, a]:
                first[i + 1] += 2
                first[free + 2 * a + 1] += 1
                first[free + 2 * a + 2] += 1
    for a in range(count):
        for b in range(count):
            if coupled[a, b]:
                first[free + 2 * a + 1] += 2
                first[free + 2 * a + 2] += 2
    for i in range(size):
        first[i + 1] += first[i]
    columns = np.empty(first[size], np.int32)
    blocks = np.empty((first[size], 3, 3))
    filled = first[:size].copy()
    for n in range(node_block.size):
        i = node_block[n]
        if i < 0:
            continue
        for p in range(indptr[n], indptr[n + 1]):
            if node_block[indices[p]] >= 0:
                columns[filled[i]] = node_block[indices[p]]
                for k in range(3):
                    for j in range(3):
                        blocks[filled[i], k, j] = data[p, k, j]
                filled[i] += 1
        for a in range(count):
            if not touched[i, a]:
                continue
            for part in range(2):
                row = free + 2 * a + part
                columns[filled[i]] = row
                columns[filled[row]] = i
                for k in range(3):
                    for j in range(3):
                        value = side[i, a, k, 3 * part + j]
                        blocks[filled[i], k, j] = value
                        blocks[filled[row], j, k] = value
                filled[i] += 1
                filled[row] += 1
    for a in range(count):
        for b in range(count):
            if not coupled[a, b]:
                continue
            for k in range(2):
                row = free + 2 * a + k
                for l in range(2):
                    columns[filled[row]] = free + 2 * b + l
                    for i in range(3):
                        for j in range(3):
                            x, y = corner[a, b, 3 * k + i, 3 * l + j], corner[b, a, 3 * l + j, 3 * k + i]
                            blocks[filled[row], i, j] = 0.5 * (x + y)
                    filled[row] += 1
    return first, columns, blocks

"""Compiled element matrices and their summation into the sparse matrices of a mesh.

Cells are taken in chunks. In a chunk, threads first share the cells (element matrices), then the rows of the sum: a row
has one owner and receives its cells in their order, so that the result is bitwise the same for any number of threads.
See `linalg.threads`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.compiling import inner_kernel, part_kernel

Array = NDArray[np.float64]
IntArray = NDArray[np.int32]


@inner_kernel
def _jacobian(nodes: Array, cell: IntArray, gradients: Array, J: Array) -> float:
    """``J_ij = ∂x_i/∂ξ_j`` at one point, gradients (3, k); returns det J."""
    for i in range(3):
        for j in range(3):
            total = 0.0
            for a in range(cell.size):
                total += nodes[cell[a], i] * gradients[j, a]
            J[i, j] = total
    det: float = (
        J[0, 0] * (J[1, 1] * J[2, 2] - J[1, 2] * J[2, 1])
        - J[0, 1] * (J[1, 0] * J[2, 2] - J[1, 2] * J[2, 0])
        + J[0, 2] * (J[1, 0] * J[2, 1] - J[1, 1] * J[2, 0])
    )
    return det


@part_kernel
def masses(
    part: int,
    parts: int,
    nodes: Array,
    cells: IntArray,
    density: Array,
    gradients: Array,
    products: Array,
    base: int,
    top: int,
    out: Array,
    smallest: Array,
) -> None:
    """Scalar masses of a part of the cells base…top-1 into out[c - base] (k, k, 1); `smallest` keeps their least determinant."""
    width = cells.shape[1]
    J = np.empty((3, 3))
    upper = np.empty(products.shape[1])
    for c in range(base + (top - base) * part // parts, base + (top - base) * (part + 1) // parts):
        upper[:] = 0.0
        least = np.inf
        for q in range(gradients.shape[0]):
            det = _jacobian(nodes, cells[c], gradients[q], J)
            least = min(least, det)
            for p in range(upper.size):
                upper[p] += det * products[q, p]
        smallest[c] = least
        p = 0
        for a in range(width):
            for b in range(a, width):
                value = density[c] * upper[p]
                out[c - base, a, b, 0] = value
                out[c - base, b, a, 0] = value
                p += 1


@part_kernel
def stiffnesses(
    part: int,
    parts: int,
    nodes: Array,
    cells: IntArray,
    lame: Array,
    shear: Array,
    gradients: Array,
    weights: Array,
    base: int,
    top: int,
    out: Array,
    smallest: Array,
) -> None:
    """Stiffness of a part of the cells base…top-1 into out[c - base] (k, k, 9); `smallest` keeps their least determinant.

    For an isotropic law the block (a, b) needs only ``T = ∫ ∇N_a ∇N_bᵀ dV``: ``K_ab = λT + G(Tᵀ + tr T I)``.
    """
    width = cells.shape[1]
    points = weights.size
    size = 3 * width
    J = np.empty((3, 3))
    inverse = np.empty((3, 3))
    spatial = np.empty((points, size))
    volume = np.empty(points)
    T = np.empty((size, size))
    for c in range(base + (top - base) * part // parts, base + (top - base) * (part + 1) // parts):
        least = np.inf
        for q in range(points):
            det = _jacobian(nodes, cells[c], gradients[q], J)
            least = min(least, det)
            volume[q] = weights[q] * det
            for i in range(3):
                for j in range(3):
                    j1, j2, i1, i2 = (j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3
                    inverse[i, j] = (J[j1, i1] * J[j2, i2] - J[j1, i2] * J[j2, i1]) / det
            for a in range(width):
                for i in range(3):
                    spatial[q, 3 * a + i] = (
                        gradients[q, 0, a] * inverse[0, i]
                        + gradients[q, 1, a] * inverse[1, i]
                        + gradients[q, 2, a] * inverse[2, i]
                    )
        smallest[c] = least
        for row in range(size):
            T[row, row:] = 0.0
            for q in range(points):
                factor = volume[q] * spatial[q, row]
                for column in range(row, size):
                    T[row, column] += factor * spatial[q, column]
        for row in range(size):
            for column in range(row):
                T[row, column] = T[column, row]
        for a in range(width):
            for b in range(width):
                trace = shear[c] * (T[3 * a, 3 * b] + T[3 * a + 1, 3 * b + 1] + T[3 * a + 2, 3 * b + 2])
                for i in range(3):
                    for j in range(3):
                        value = lame[c] * T[3 * a + i, 3 * b + j] + shear[c] * T[3 * a + j, 3 * b + i]
                        out[c - base, a, b, 3 * i + j] = value + trace if i == j else value


@part_kernel
def add_cells(
    part: int, parts: int, base: int, top: int, cells: IntArray, slots: IntArray, matrices: Array, data: Array
) -> None:
    """Add the matrices (…, k, k, w) of cells base…top-1 to data (nnz, w): a part of its rows."""
    width = cells.shape[1]
    for c in range(base, top):
        for a in range(width):
            if cells[c, a] % parts == part:
                for b in range(width):
                    slot = slots[c, a, b]
                    for i in range(data.shape[1]):
                        data[slot, i] += matrices[c - base, a, b, i]

"""Shape functions of the solid cells and their gradients, in reference coordinates.

Reference cells: tetrahedra ``r, s, t ≥ 0, r + s + t ≤ 1``; hexahedra ``[-1, 1]³``; the wedge is the triangle
``r, s ≥ 0, r + s ≤ 1`` times ``t ∈ [-1, 1]``. Nodes are numbered as in VTK and Abaqus. Every function takes
points (p, 3) and returns values (p, k) or gradients (p, k, 3) for the k nodes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TET_CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float64)
TET_EDGES = np.array([[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]])
HEX_CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    dtype=np.float64,
)
HEX_EDGES = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]])
WEDGE_CORNERS = np.array([[0, 0, -1], [1, 0, -1], [0, 1, -1], [0, 0, 1], [1, 0, 1], [0, 1, 1]], dtype=np.float64)

TET10_NODES = np.vstack([TET_CORNERS, TET_CORNERS[TET_EDGES].mean(axis=1)])
HEX20_NODES = np.vstack([HEX_CORNERS, HEX_CORNERS[HEX_EDGES].mean(axis=1)])

# Gradients of the barycentric coordinates 1 - r - s - t, r, s, t.
_BARYCENTRIC = np.array([[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float64)


def _barycentric(points: Array) -> Array:
    return np.column_stack([1.0 - points.sum(axis=1), points])


def tet4(points: Array) -> Array:
    """Linear tetrahedron: the barycentric coordinates."""
    return _barycentric(points)


def tet4_gradients(points: Array) -> Array:
    """Gradients of `tet4`."""
    return np.broadcast_to(_BARYCENTRIC, (len(points), 4, 3)).copy()


def tet10(points: Array) -> Array:
    """Quadratic tetrahedron: ``L(2L - 1)`` at corners, ``4 L L'`` at edge midpoints."""
    L = _barycentric(points)
    first, second = TET_EDGES.T
    return np.hstack([L * (2.0 * L - 1.0), 4.0 * L[:, first] * L[:, second]])


def tet10_gradients(points: Array) -> Array:
    """Gradients of `tet10`."""
    L = _barycentric(points)
    first, second = TET_EDGES.T
    corners = (4.0 * L - 1.0)[:, :, None] * _BARYCENTRIC
    edges = 4.0 * (L[:, first, None] * _BARYCENTRIC[second] + L[:, second, None] * _BARYCENTRIC[first])
    return np.concatenate([corners, edges], axis=1)


def hex8(points: Array) -> Array:
    """Trilinear hexahedron."""
    return np.asarray(np.prod(1.0 + points[:, None, :] * HEX_CORNERS, axis=2) / 8.0)


def hex8_gradients(points: Array) -> Array:
    """Gradients of `hex8`."""
    factors = 1.0 + points[:, None, :] * HEX_CORNERS
    return np.stack(
        [HEX_CORNERS[:, i] * factors[:, :, (i + 1) % 3] * factors[:, :, (i + 2) % 3] / 8.0 for i in range(3)],
        axis=2,
    )


def hex20(points: Array) -> Array:
    """Quadratic serendipity hexahedron: 8 corners, 12 edge midpoints."""
    factors = 1.0 + points[:, None, :] * HEX_CORNERS
    corners = factors.prod(axis=2) * (factors.sum(axis=2) - 5.0) / 8.0
    return np.hstack([corners, _edge_factors(points).prod(axis=2) / 4.0])


def hex20_gradients(points: Array) -> Array:
    """Gradients of `hex20`."""
    factors = 1.0 + points[:, None, :] * HEX_CORNERS
    total = factors.sum(axis=2) - 5.0
    edge = _edge_factors(points)
    midpoints = HEX20_NODES[8:]
    # The factor of an edge is 1 - x² along it, 1 + x x_a across.
    slope = np.where(midpoints == 0.0, -2.0 * points[:, None, :], midpoints)
    columns = []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        corners = HEX_CORNERS[:, i] * factors[:, :, j] * factors[:, :, k] * (total + factors[:, :, i]) / 8.0
        edges = slope[:, :, i] * edge[:, :, j] * edge[:, :, k] / 4.0
        columns.append(np.hstack([corners, edges]))
    return np.stack(columns, axis=2)


def _edge_factors(points: Array) -> Array:
    midpoints = HEX20_NODES[8:]
    x = points[:, None, :]
    return np.where(midpoints == 0.0, 1.0 - x * x, 1.0 + x * midpoints)


def wedge6(points: Array) -> Array:
    """Linear wedge: barycentric coordinates of the triangle times a linear function along the prism."""
    r, s, t = points.T
    triangle = np.column_stack([1.0 - r - s, r, s])
    return np.hstack([triangle * (1.0 - t[:, None]) / 2.0, triangle * (1.0 + t[:, None]) / 2.0])


def wedge6_gradients(points: Array) -> Array:
    """Gradients of `wedge6`."""
    r, s, t = points.T
    triangle = np.column_stack([1.0 - r - s, r, s])
    slopes = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    result = np.empty((len(points), 6, 3))
    for half, sign in ((slice(0, 3), -1.0), (slice(3, 6), 1.0)):
        result[:, half, :2] = slopes * ((1.0 + sign * t) / 2.0)[:, None, None]
        result[:, half, 2] = sign * triangle / 2.0
    return result

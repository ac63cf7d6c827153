"""Small meshes of any solid element: boxes of cells, jittered or curved."""

from itertools import permutations

import numpy as np
import pytest

from maggi.elements.shapes import HEX_CORNERS, HEX_EDGES, TET_EDGES

UNIT = (HEX_CORNERS + 1.0) / 2.0


def _tets():
    """Kuhn's six tetrahedra of the unit cube, counted positively."""
    for order in permutations(range(3)):
        corners = np.vstack([np.zeros(3), np.cumsum(np.eye(3)[list(order)], axis=0)])
        yield corners if np.linalg.det(corners[1:]) > 0 else corners[[0, 2, 1, 3]]


def _wedges():
    """Two prisms of the unit cube, along z."""
    for i, j, k in ((0, 1, 2), (0, 2, 3)):
        yield UNIT[[i, j, k, i + 4, j + 4, k + 4]]


CORNERS = {
    "tet4": list(_tets()),
    "tet10": list(_tets()),
    "hex8": [UNIT],
    "hex20": [UNIT],
    "wedge6": list(_wedges()),
}
EDGES = {"tet10": TET_EDGES, "hex20": HEX_EDGES}


def build(name, count=(2, 2, 1), size=(1.0, 1.0, 1.0), jitter=0.0, curve=0.0, origin=(0.0, 0.0, 0.0), seed=0):
    """Nodes (n, 3) and cells (c, k) of a box of cells of one type.

    jitter moves the corners (edges stay straight), curve bends everything; both as a share of a cell.
    """
    cells = np.array([(i, j, k) for i in range(count[0]) for j in range(count[1]) for k in range(count[2])])
    corners = np.array([c + cell for c in cells for cell in CORNERS[name]])
    shape = corners.shape
    grid, index = np.unique(corners.reshape(-1, 3).round(6), axis=0, return_inverse=True)
    rng = np.random.default_rng(seed)
    grid = grid + jitter * rng.uniform(-0.5, 0.5, grid.shape)
    points, connectivity = grid, index.reshape(shape[:2])
    if name in EDGES:
        ends = np.sort(connectivity[:, EDGES[name]], axis=2)
        edges, which = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
        points = np.vstack([grid, grid[edges].mean(axis=1)])
        connectivity = np.hstack([connectivity, len(grid) + which.reshape(len(connectivity), -1)])
    x, y, z = points.T
    bend = np.column_stack([np.sin(1.3 * y + 0.4 * z), np.cos(1.1 * x - 0.7 * z), np.sin(0.9 * x + 1.7 * y)])
    points = (points + curve * bend) * np.array(size) / np.array(count) + np.array(origin)
    return np.ascontiguousarray(points), connectivity.astype(np.int64)


@pytest.fixture(scope="session")
def box():
    return build

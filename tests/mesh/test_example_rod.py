"""The connecting rod of the slider-crank example: dimensions, symmetry, bores and cells."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from maggi.mesh import CELL_TYPES, load_mesh, set_geometry, surface_triangles
from maggi.model.meshes import FileMesh

FOLDER = Path(__file__).parents[2] / "examples" / "slider_crank"
# A tetrahedron's corners, the middles of its edges, and its centre.
POINTS = np.vstack(
    [
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.25, 0.25, 0.25)],
        [(0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0), (0, 0, 0.5), (0.5, 0, 0.5), (0, 0.5, 0.5)],
    ]
)


@pytest.fixture(scope="module")
def rod():
    return load_mesh(FileMesh("rod.msh"), str(FOLDER))


def jacobians(mesh):
    """Determinants of the quadratic map at `POINTS`, (points, cells)."""
    slopes = np.array([[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    cells = mesh.nodes[mesh.cells["tet10"]]
    result = []
    for point in POINTS:
        L = np.array([1 - point.sum(), *point])
        gradients = [(4 * L[i] - 1) * slopes[i] for i in range(4)]
        gradients += [4 * (L[a] * slopes[b] + L[b] * slopes[a]) for a, b in CELL_TYPES["tet10"].edges]
        result.append(np.linalg.det(np.einsum("cni,nj->cij", cells, np.array(gradients))))
    return np.array(result)


def test_size(rod):
    assert list(rod.cells) == ["tet10"]
    assert 3000 <= rod.n_nodes <= 10000
    assert (FOLDER / "rod.msh").stat().st_size < 2e6
    assert set(rod.node_sets) == {"rod", "big_end", "small_end"}
    # Dimensions of rod_mesh.py: eyes of radius 32 and 22 mm at x = 0 and 300 mm, 24 mm wide.
    np.testing.assert_allclose(rod.bounding_box(), [[-0.032, -0.012, -0.032], [0.322, 0.012, 0.032]], atol=1e-9)


@pytest.mark.parametrize(("name", "center", "radius"), [("big_end", 0.0, 0.020), ("small_end", 0.3, 0.0125)])
def test_bores_are_cylinders_along_y_and_their_nodes_mean_is_their_centre(rod, name, center, radius):
    found = set_geometry(rod, rod.node_sets[name])
    assert found.kind == "cylinder"
    assert found.radius == pytest.approx(radius, rel=1e-9)
    assert found.residual < 1e-9
    np.testing.assert_allclose(found.axis, [0, 1, 0], atol=1e-9)
    np.testing.assert_allclose(found.centroid, [center, 0, 0], atol=1e-12)


def test_no_cell_is_turned_inside_out_or_flat(rod):
    determinants = jacobians(rod)
    assert determinants.min() > 0.0
    assert (determinants.min(axis=0) / determinants.max(axis=0)).min() > 0.3


def test_it_is_symmetric_about_both_planes(rod):
    places = {tuple(p) for p in rod.nodes + 0.0}
    for mirror in ([1, -1, 1], [1, 1, -1]):
        assert {tuple(p) for p in rod.nodes * mirror + 0.0} == places


def test_volume(rod):
    """Against the area of the outline and the pocket of rod_mesh.py, integrated here on a fine grid."""
    dx = 2e-4
    x, z = np.meshgrid(np.arange(-0.033, 0.323, dx), np.arange(0.0, 0.033, dx) + dx / 2)
    edge = 0.019 - 0.006 * x / 0.3
    eyes = (np.hypot(x, z) < 0.032) | (np.hypot(x - 0.3, z) < 0.022)
    bores = (np.hypot(x, z) < 0.020) | (np.hypot(x - 0.3, z) < 0.0125)
    between = (x > 0) & (x < 0.3)
    web = between & (z < edge - 0.0055) & (np.hypot(x, z) > 0.036) & (np.hypot(x - 0.3, z) > 0.026)
    outline = (eyes | (between & (z < edge))) & ~bores
    expected = 2 * dx**2 * (0.024 * outline.sum() - 0.017 * web.sum())
    p = rod.nodes[surface_triangles(rod.cells)]
    volume = np.einsum("ti,ti->", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0
    # the grid leaves the fillets out: about 1 % of the volume
    assert volume == pytest.approx(expected, rel=0.02)
    assert 1.3 < 7850 * volume < 1.5

"""Free faces and surface triangles, also where types meet."""

from __future__ import annotations

import numpy as np
import pytest

from maggi.mesh import free_faces, surface_triangles

# A hexahedron and a wedge that share a quadrangle: unit cube, and a prism with apex at y = 2 (nodes 8, 9).
HEX = np.array([[0, 1, 2, 3, 4, 5, 6, 7]])
WEDGE = np.array([[3, 2, 8, 7, 6, 9]])
POINTS = np.array(
    [
        *[(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        (0.5, 2, 0),
        (0.5, 2, 1),
    ],
    dtype=float,
)


def test_a_face_shared_by_two_types_is_not_free():
    faces = free_faces({"hex8": HEX, "wedge6": WEDGE})
    assert faces["hex8"].tolist() == [[0, 0], [0, 1], [0, 2], [0, 3], [0, 5]]
    assert faces["wedge6"].tolist() == [[0, 0], [0, 1], [0, 3], [0, 4]]


def test_the_surface_of_mixed_cells_is_closed_and_encloses_their_volume():
    triangles = surface_triangles({"hex8": HEX, "wedge6": WEDGE})
    p = POINTS[triangles]
    assert np.einsum("ti,ti->", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0 == pytest.approx(1.5, rel=1e-14)
    directed = [(a, b) for t in triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)]
    assert sorted(directed) == sorted((b, a) for a, b in directed)


@pytest.mark.parametrize(("kind", "nodes", "triangles"), [("tet10", 10, 16), ("hex20", 20, 36), ("tet4", 4, 4)])
def test_faces_of_one_cell_are_split_at_their_middles(kind, nodes, triangles):
    split = surface_triangles({kind: np.arange(nodes)[None, :]})
    assert split.shape == (triangles, 3)
    assert split.dtype == np.int64
    assert set(split.ravel().tolist()) == set(range(nodes))


def test_beams_have_no_surface():
    assert surface_triangles({"beam2": np.array([[0, 1]])}).shape == (0, 3)
    assert free_faces({}) == {}

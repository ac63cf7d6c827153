"""The table of cells is consistent: edges, faces and their sense, for every type."""

from __future__ import annotations

import numpy as np
import pytest

from maggi.mesh import CELL_TYPES, SOLID_TYPES

_HEX = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
_TET = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
_WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
CORNERS = {"tet4": _TET, "tet10": _TET, "hex8": _HEX, "hex20": _HEX, "wedge6": _WEDGE}
NODES = {"tet4": 4, "tet10": 10, "hex8": 8, "hex20": 20, "wedge6": 6, "beam2": 2}


def test_every_type_has_the_nodes_its_name_says():
    assert {name: cell.nodes for name, cell in CELL_TYPES.items()} == NODES


@pytest.mark.parametrize("kind", SOLID_TYPES)
def test_faces_point_outwards_and_enclose_the_cell(kind):
    cell = CELL_TYPES[kind]
    corners = np.array(CORNERS[kind], dtype=float)
    total = np.zeros(3)
    for face in cell.faces:
        p = corners[list(face)]
        area = 0.5 * sum(np.cross(p[i] - p[0], p[i + 1] - p[0]) for i in range(1, len(p) - 1))
        assert area @ (p.mean(axis=0) - corners.mean(axis=0)) > 0.0
        total += area
    np.testing.assert_allclose(total, 0.0, atol=1e-15)


@pytest.mark.parametrize("kind", SOLID_TYPES)
def test_every_edge_belongs_to_two_faces_in_opposite_senses(kind):
    cell = CELL_TYPES[kind]
    directed = [(a, b) for face in cell.faces for a, b in zip(face, face[1:] + face[:1], strict=True)]
    assert sorted(directed) == sorted([*cell.edges, *((b, a) for a, b in cell.edges)])


@pytest.mark.parametrize("kind", ["tet10", "hex20"])
def test_middle_nodes_of_faces_lie_between_their_corners(kind):
    cell = CELL_TYPES[kind]
    corners = np.array(CORNERS[kind], dtype=float)
    nodes = np.vstack([corners, [corners[list(edge)].mean(axis=0) for edge in cell.edges]])
    for face, corner_face in zip(cell.face_nodes, cell.faces, strict=True):
        count = len(corner_face)
        assert face[:count] == corner_face
        for i in range(count):
            middle = nodes[[face[i], face[(i + 1) % count]]].mean(axis=0)
            np.testing.assert_array_equal(nodes[face[count + i]], middle)


def test_faces_are_abaqus_faces():
    # Abaqus' manual, solid element library: faces of C3D4, C3D8, C3D6 as sets of (1-based) corners.
    abaqus = {
        "tet4": [{1, 2, 3}, {1, 4, 2}, {2, 4, 3}, {3, 4, 1}],
        "hex8": [{1, 2, 3, 4}, {5, 8, 7, 6}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 8, 4}, {4, 8, 5, 1}],
        "wedge6": [{1, 2, 3}, {4, 6, 5}, {1, 4, 5, 2}, {2, 5, 6, 3}, {3, 6, 4, 1}],
    }
    for kind, faces in abaqus.items():
        assert [{node + 1 for node in face} for face in CELL_TYPES[kind].faces] == faces

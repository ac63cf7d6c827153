"""Parametric boxes and beams: volumes, sets, conforming splits, refusals; for every cell type."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maggi.mesh import CELL_TYPES, SOLID_TYPES, beam, box, free_faces, surface_triangles, validate
from maggi.model.errors import MeshError

SIZE = (0.7, 0.2, 0.3)
COUNTS = st.tuples(st.integers(1, 4), st.integers(1, 3), st.integers(1, 3))
LENGTHS = st.tuples(*[st.floats(1e-3, 1e3)] * 3)


def signed_volumes(mesh, kind):
    """Volume of each cell's linear shape: the mean of x over its faces, split into triangles about their centre."""
    p = mesh.nodes[mesh.cells[kind]]
    total = np.zeros(len(p))
    for face in CELL_TYPES[kind].faces:
        corners = p[:, face]
        center = corners.mean(axis=1)
        for i in range(len(face)):
            a, b = corners[:, i], corners[:, (i + 1) % len(face)]
            total += np.einsum("ci,ci->c", center, np.cross(a, b)) / 6.0
    return total


@pytest.mark.parametrize("kind", SOLID_TYPES)
@given(size=LENGTHS, cells=COUNTS)
def test_the_surface_encloses_the_volume_of_the_box(kind, size, cells):
    mesh = box(size, cells, kind)
    p = mesh.nodes[surface_triangles(mesh.cells)]
    volume = np.einsum("ti,ti->", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0
    assert volume == pytest.approx(np.prod(size), rel=1e-12)


@pytest.mark.parametrize("kind", SOLID_TYPES)
@given(cells=COUNTS)
def test_cells_are_right_side_out_and_fill_the_box(kind, cells):
    mesh = box(SIZE, cells, kind)
    validate(mesh)
    volumes = signed_volumes(mesh, kind)
    assert volumes.min() > 0.0
    assert volumes.sum() == pytest.approx(np.prod(SIZE), rel=1e-12)
    per_block = {"tet4": 6, "tet10": 6, "wedge6": 2}.get(kind, 1)
    assert mesh.n_cells == per_block * np.prod(cells)


@pytest.mark.parametrize("kind", SOLID_TYPES)
@given(cells=COUNTS)
def test_cells_conform_so_that_free_faces_lie_on_the_sides(kind, cells):
    mesh = box(SIZE, cells, kind)
    for name, pairs in free_faces(mesh.cells).items():
        for cell, face in pairs:
            nodes = mesh.nodes[mesh.cells[name][cell, CELL_TYPES[name].face_nodes[face]]]
            assert any((nodes[:, a] == end).all() for a in range(3) for end in (0.0, SIZE[a]))


@pytest.mark.parametrize("kind", SOLID_TYPES)
@given(size=LENGTHS, cells=COUNTS)
def test_sets_are_the_nodes_of_the_sides(kind, size, cells):
    mesh = box(size, cells, kind)
    assert sorted(mesh.node_sets) == ["x_max", "x_min", "y_max", "y_min", "z_max", "z_min"]
    for a, axis in enumerate("xyz"):
        for side, end in (("min", 0.0), ("max", size[a])):
            expected = np.flatnonzero(mesh.nodes[:, a] == end)
            np.testing.assert_array_equal(mesh.node_sets[f"{axis}_{side}"], expected)
            assert len(expected) > 0


@pytest.mark.parametrize("kind", ["tet10", "hex20"])
def test_middle_nodes_are_shared_and_in_the_middle(kind):
    mesh = box(SIZE, (3, 2, 2), kind)
    cell = CELL_TYPES[kind]
    ends = mesh.nodes[mesh.cells[kind][:, cell.edges]]
    np.testing.assert_allclose(mesh.nodes[mesh.cells[kind][:, cell.corners :]], ends.mean(axis=2), atol=1e-15)
    assert len(np.unique(mesh.nodes, axis=0)) == mesh.n_nodes


def test_hex8_nodes_run_along_x_first():
    mesh = box((2.0, 1.0, 1.0), (2, 1, 1))
    np.testing.assert_array_equal(mesh.nodes[:3], [[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    np.testing.assert_array_equal(mesh.cells["hex8"][0], [0, 1, 4, 3, 6, 7, 10, 9])
    np.testing.assert_array_equal(mesh.cell_labels["hex8"], [1, 2])


def test_beam():
    mesh = beam(1.2, 3)
    validate(mesh)
    np.testing.assert_allclose(mesh.nodes, [[0, 0, 0], [0.4, 0, 0], [0.8, 0, 0], [1.2, 0, 0]], rtol=1e-15)
    np.testing.assert_array_equal(mesh.cells["beam2"], [[0, 1], [1, 2], [2, 3]])
    assert mesh.nodes[mesh.node_sets["start"], 0].tolist() == [0.0]
    assert mesh.nodes[mesh.node_sets["end"], 0].tolist() == [1.2]


@pytest.mark.parametrize(
    ("size", "cells", "kind", "path", "found"),
    [
        ((1.0, 0.0, 1.0), (1, 1, 1), "hex8", "m.size", "[1.0, 0.0, 1.0]"),
        ((1.0, float("nan"), 1.0), (1, 1, 1), "hex8", "m.size", "nan"),
        ((1.0, float("inf"), 1.0), (1, 1, 1), "hex8", "m.size", "inf"),
        ((1.0, -1.0, 1.0), (1, 1, 1), "hex8", "m.size", "-1.0"),
        ((1.0, 1.0, 1.0), (1, 0, 1), "hex8", "m.cells", "[1, 0, 1]"),
        ((1.0, 1.0, 1.0), (1, 1, 1), "hex9", "m.cell", "hex9"),
        ((1.0, 1.0, 1.0), (1, 1, 1), "beam2", "m.cell", "beam2"),
        ((1.0, 1.0, 1.0), (10**6, 10**6, 10**6), "hex8", "m.cells", "nodes"),
        ((1.0, 1.0, 1.0), (10**30, 1, 1), "tet10", "m.cells", "nodes"),
    ],
)
def test_impossible_boxes_are_refused(size, cells, kind, path, found):
    with pytest.raises(MeshError) as error:
        box(size, cells, kind, path="m")
    assert error.value.path == path
    assert found in error.value.message
    assert error.value.remedy


@pytest.mark.parametrize(
    ("length", "elements", "path"),
    [(0.0, 3, "m.length"), (float("nan"), 3, "m.length"), (1.0, 0, "m.elements"), (1.0, 10**12, "m.elements")],
)
def test_impossible_beams_are_refused(length, elements, path):
    with pytest.raises(MeshError) as error:
        beam(length, elements, path="m")
    assert error.value.path == path

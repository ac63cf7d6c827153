"""What cannot make one body is refused, with labels and a remedy."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from maggi.mesh import SOLID_TYPES, Mesh, beam, box, validate
from maggi.model.errors import MeshError

MESH = box((2.0, 1.0, 1.0), (2, 1, 1))


def refused(mesh):
    with pytest.raises(MeshError) as error:
        validate(mesh)
    assert error.value.file == mesh.source
    assert error.value.remedy
    return error.value


def twice(first: Mesh, second: Mesh, shift: float) -> Mesh:
    """Two meshes of one type in one, the second moved along x; labels of the second from 1001 on."""
    (kind,) = first.cells
    return Mesh(
        nodes=np.vstack([first.nodes, second.nodes + [shift, 0, 0]]),
        cells={kind: np.vstack([first.cells[kind], second.cells[kind] + first.n_nodes])},
        node_labels=np.concatenate([first.node_labels, second.node_labels + 1000]),
        cell_labels={kind: np.concatenate([first.cell_labels[kind], second.cell_labels[kind] + 1000])},
        source="two.inp",
    )


@pytest.mark.parametrize("kind", SOLID_TYPES)
def test_good_meshes_pass(kind):
    validate(box((1, 1, 1), (2, 2, 2), kind))
    validate(beam(1.0, 3))


def test_empty():
    assert "empty" in refused(Mesh(np.zeros((0, 3)), {}, np.zeros(0, np.int64), {})).message
    none = {"hex8": np.zeros((0, 8), np.int64)}
    assert "0 cells" in refused(dataclasses.replace(MESH, cells=none, cell_labels={"hex8": np.zeros(0)})).message


def test_dangling_nodes_are_named():
    nodes = np.vstack([MESH.nodes, [[9.0, 9.0, 9.0]]])
    labels = np.append(MESH.node_labels, 77)
    error = refused(dataclasses.replace(MESH, nodes=nodes, node_labels=labels))
    assert error.message == "1 nodes belong to no cell: 77"


def test_a_node_twice_in_a_cell():
    cells = MESH.cells["hex8"].copy()
    cells[1, 3] = cells[1, 2]
    error = refused(dataclasses.replace(MESH, cells={"hex8": cells}))
    assert error.message == f"hex8 cell 2 has node {cells[1, 2] + 1} twice"


def test_coordinates_that_are_not_finite():
    nodes = MESH.nodes.copy()
    nodes[4, 1] = np.nan
    assert refused(dataclasses.replace(MESH, nodes=nodes)).message.endswith("nodes 5")


@pytest.mark.parametrize("scale", [0.0, 1e300])
def test_a_size_that_is_none(scale):
    assert "size" in refused(dataclasses.replace(MESH, nodes=MESH.nodes * scale)).message


def test_duplicate_labels():
    labels = MESH.node_labels.copy()
    labels[3] = 1
    assert refused(dataclasses.replace(MESH, node_labels=labels)).message.endswith("once: 1")
    assert "cell labels" in refused(dataclasses.replace(MESH, cell_labels={"hex8": np.array([5, 5])})).message


def test_disconnected_parts_are_counted_measured_and_named():
    error = refused(twice(MESH, box((1, 1, 1), (1, 1, 1)), 5.0))
    assert error.message == (
        "the mesh falls into 2 parts that share no node: 12 nodes around hex8 cell 1; 8 nodes around hex8 cell 1001"
    )
    assert error.file == "two.inp"


def test_parts_that_touch_but_are_not_merged():
    error = refused(twice(MESH, box((1, 1, 1), (1, 1, 1)), 2.0))
    assert "2 parts" in error.message
    assert "4 nodes of different parts coincide, such as 3 and 1001" in error.remedy
    assert "merge duplicate nodes" in error.remedy


@pytest.mark.parametrize("wrong", [-1, 12])
def test_cells_and_sets_with_nodes_that_do_not_exist(wrong):
    cells = MESH.cells["hex8"].copy()
    cells[1, 0] = wrong
    assert "cell 2" in refused(dataclasses.replace(MESH, cells={"hex8": cells})).message
    sets = {"pin": np.array([wrong])}
    assert "'pin'" in refused(dataclasses.replace(MESH, node_sets=sets)).message


def test_arrays_of_wrong_shape():
    assert "hex9" in refused(dataclasses.replace(MESH, cells={"hex9": MESH.cells["hex8"]})).message
    assert "shape" in refused(dataclasses.replace(MESH, cells={"hex20": MESH.cells["hex8"]})).message
    assert "shape" in refused(dataclasses.replace(MESH, node_labels=MESH.node_labels[:3])).message

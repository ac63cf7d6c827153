"""Gmsh files: every type, groups, ASCII and binary alike, and whatever is damaged refused with its line.

The files in ``data`` were written by Gmsh 4.15 (``data/make_fixtures.py``): blocks 2 x 1 x 1.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from maggi.mesh import CELL_TYPES, read_gmsh, surface_triangles, validate
from maggi.model.errors import MeshError

DATA = Path(__file__).parent / "data"
# Type, nodes and cells as Gmsh itself counted them when the files were made.
FILES = {
    "tet4": ("tet4", 44, 91),
    "tet4_all_parametric": ("tet4", 44, 91),
    "tet10": ("tet10", 220, 91),
    "tet10_binary": ("tet10", 220, 91),
    "hex8": ("hex8", 27, 8),
    "hex20": ("hex20", 81, 8),
    "hex20_binary": ("hex20", 81, 8),
    "wedge6": ("wedge6", 39, 28),
}


def read(name):
    return read_gmsh(str(DATA / f"{name}.msh"))


def text_of(name="hex8"):
    return (DATA / f"{name}.msh").read_text()


def read_text(folder, text):
    file = folder / "a.msh"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_gmsh(str(file))


def refused(folder, text):
    with pytest.raises(MeshError) as error:
        validate(read_text(folder, text))
    assert error.value.file.endswith("a.msh")
    assert error.value.remedy
    return error.value


def replaced(text, old, new):
    assert text.count(old) == 1, f"{text.count(old)} x {old!r}"
    return text.replace(old, new)


@pytest.mark.parametrize("name", FILES)
def test_nodes_cells_and_volume(name):
    mesh = read(name)
    validate(mesh)
    kind, nodes, cells = FILES[name]
    assert (mesh.n_nodes, {k: len(c) for k, c in mesh.cells.items()}) == (nodes, {kind: cells})
    p = mesh.nodes[surface_triangles(mesh.cells)]
    assert np.einsum("ti,ti->", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0 == pytest.approx(2.0, rel=1e-12)
    assert mesh.notes == ()


@pytest.mark.parametrize("name", ["tet10", "tet10_binary", "hex20", "hex20_binary"])
def test_the_middle_nodes_of_gmsh_come_into_our_order(name):
    mesh = read(name)
    ((kind, cells),) = mesh.cells.items()
    cell = CELL_TYPES[kind]
    middles = mesh.nodes[cells[:, cell.edges]].mean(axis=2)
    np.testing.assert_allclose(mesh.nodes[cells[:, cell.corners :]], middles, atol=1e-14)


@pytest.mark.parametrize("name", FILES)
def test_physical_groups_of_every_dimension_are_node_sets(name):
    mesh = read(name)
    x, y, z = mesh.nodes.T
    expected = {
        "block": np.ones(mesh.n_nodes, bool),
        "left": np.isclose(x, 0),
        "right side": np.isclose(x, 2),
        "ends": np.isclose(x, 0) | np.isclose(x, 2),
        "physical_2_5": np.isclose(z, 0),
        "edge": np.isclose(x, 0) & np.isclose(y, 0),
        "corner": np.isclose(x, 0) & np.isclose(y, 0) & np.isclose(z, 0),
    }
    assert set(mesh.node_sets) == set(expected)
    for group, chosen in expected.items():
        np.testing.assert_array_equal(mesh.node_sets[group], np.flatnonzero(chosen))
    kind, _, cells = FILES[name]
    assert list(mesh.element_sets) == ["block"]
    np.testing.assert_array_equal(mesh.element_sets["block"][kind], np.arange(cells))


@pytest.mark.parametrize("name", ["tet10", "hex20"])
def test_ascii_and_binary_are_the_same_mesh(name):
    text, binary = read(name), read(f"{name}_binary")
    np.testing.assert_allclose(text.nodes, binary.nodes, atol=1e-15)
    np.testing.assert_array_equal(text.node_labels, binary.node_labels)
    for kind in text.cells:
        np.testing.assert_array_equal(text.cells[kind], binary.cells[kind])
        np.testing.assert_array_equal(text.cell_labels[kind], binary.cell_labels[kind])
    for group in text.node_sets:
        np.testing.assert_array_equal(text.node_sets[group], binary.node_sets[group])


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("size", [4, 8])
def test_binary_of_either_byte_order_and_size(tmp_path, order, size):
    """One tetrahedron, written here by the format's description, with a line in a group and a set."""

    def ints(*values):
        return np.array(values, order + "i4").tobytes()

    def sizes(*values):
        return np.array(values, f"{order}u{size}").tobytes()

    def doubles(*values):
        return np.array(values, order + "f8").tobytes()

    data = b"$MeshFormat\n4.1 1 %d\n" % size + ints(1) + b"\n$EndMeshFormat\n"
    data += b'$PhysicalNames\n1\n1 5 "edge"\n$EndPhysicalNames\n'
    data += b"$Entities\n" + sizes(0, 1, 0, 1)
    data += ints(1) + doubles(0, 0, 0, 1, 0, 0) + sizes(1) + ints(-5) + sizes(0)
    data += ints(1) + doubles(0, 0, 0, 1, 1, 1) + sizes(0) + sizes(0) + b"\n$EndEntities\n"
    data += b"$Nodes\n" + sizes(1, 4, 10, 40) + ints(3, 1, 0) + sizes(4) + sizes(10, 20, 30, 40)
    data += doubles(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1) + b"\n$EndNodes\n"
    data += b"$Elements\n" + sizes(2, 2, 1, 2) + ints(1, 1, 1) + sizes(1) + sizes(1, 10, 20)
    data += ints(3, 1, 4) + sizes(1) + sizes(2, 10, 20, 30, 40) + b"\n$EndElements\n"
    mesh = read_text(tmp_path, data)
    assert mesh.cells["tet4"].tolist() == [[0, 1, 2, 3]]
    assert mesh.node_labels.tolist() == [10, 20, 30, 40]
    assert {name: nodes.tolist() for name, nodes in mesh.node_sets.items()} == {"edge": [0, 1]}
    np.testing.assert_array_equal(mesh.nodes, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def test_windows_line_ends(tmp_path):
    mesh = read_text(tmp_path, text_of().replace("\n", "\r\n"))
    assert mesh.n_nodes == 27
    assert "right side" in mesh.node_sets


def test_sections_that_say_nothing_about_the_mesh_are_passed_over(tmp_path):
    more = "$Comments\nhello $Nodes\n$EndComments\n", "\n$Periodic\n0\n$EndPeriodic\n"
    assert read_text(tmp_path, more[0] + text_of() + more[1]).n_nodes == 27


def test_a_name_used_in_two_dimensions_is_told_apart(tmp_path):
    mesh = read_text(tmp_path, replaced(text_of(), '2 2 "left"', '2 2 "block"'))
    assert "block" not in mesh.node_sets
    assert (len(mesh.node_sets["block_2d"]), len(mesh.node_sets["block_3d"])) == (9, 27)
    assert "block_2d, block_3d" in mesh.notes[0]


TET = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
0 1 "apart"
$EndPhysicalNames
$Entities
1 0 0 1
7 0 0 9 1 1
1 0 0 0 1 1 1 0 0
$EndEntities
$Nodes
2 5 1 5
0 7 0 1
5
0 0 9
3 1 0 4
1
2
3
4
0 0 0
1 0 0
0 1 0
0 0 1
$EndNodes
$Elements
2 2 1 2
0 7 15 1
1 5
3 1 4 1
2 1 2 3 4
$EndElements
"""


def test_construction_points_are_left_out_with_a_note(tmp_path):
    mesh = read_text(tmp_path, TET)
    validate(mesh)
    assert mesh.node_labels.tolist() == [1, 2, 3, 4]
    assert mesh.node_sets["apart"].tolist() == []
    assert "left out: 5" in mesh.notes[0]
    assert "'apart'" in mesh.notes[1]


def test_an_unused_node_inside_a_volume_is_refused(tmp_path):
    error = refused(tmp_path, replaced(TET, "0 7 0 1\n5", "3 1 0 1\n5"))
    assert error.message == "1 nodes inside volumes belong to no solid cell: 5"


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("4.1 0 8", "2.2 0 8", 2, "format 2.2 is not read"),
        ("4.1 0 8", "4.1 7 8", 2, "cannot understand '4.1 7 8'"),
        ("$MeshFormat\n", "", 1, "does not begin with $MeshFormat"),
        ('0 1 "apart"', "0 1 apart", 6, "cannot understand '0 1 apart'"),
        ("$Entities", "$PartitionedEntities", 8, "partitioned"),
        ("0 1 0\n0 0 1\n", "0 1 0\n0 0 x1\n", 26, "found 'x1'"),
        ("0 1 0\n0 0 1\n", "0 1 0\n0 0 nan\n", 26, "found 'nan'"),
        ("0 1 0\n0 0 1\n", "0 1 0\n", 26, "$Nodes ends too early"),
        ("0 1 0\n0 0 1\n", "0 1 0\n0 0 1\n7\n", 27, "more than its counts"),
        ("3 1 0 4\n", "3 1 0 4000000000000\n", 27, "$Nodes ends too early"),
        ("3 1 0 4\n", "3 1 0 4.5\n", 18, "whole number was expected, found 4.5"),
        ("3 1 0 4\n", "3 1 5 4\n", 18, "parametric 5"),
        ("3 1 0 4\n", "3 1 0 -4\n", 18, "negative count"),
        ("2 5 1 5", "2 6 1 5", 14, "announces 6 nodes and holds 5"),
        ("2 1 2 3 4\n", "2 1 2 3 44\n", 33, "element 2 has node 44"),
        ("3 1 4 1\n2 1 2 3 4\n", "3 1 7 1\n2 1 2 3 4 5\n", 32, "pyramids (Gmsh type 7)"),
        ("3 1 4 1\n", "3 1 99 1\n", 32, "type 99 is not read"),
        ("3 1 4 1\n", "2 1 4 1\n", 32, "dimension 2"),
        ("3 1 4 1\n2 1 2 3 4\n", "2 1 3 1\n2 1 2 3 4\n", 0, "no solid cells"),
        ("2 2 1 2", "2 3 1 2", 29, "announces 3 elements and holds 2"),
        ("$EndElements\n", "", 28, "not closed"),
        ("$EndElements\n", "$EndElements\nrubbish\n", 35, "a section was expected, found 'rubbish'"),
        ("$Elements\n", "$Nodes\n0 0 0 0\n$EndNodes\n$Elements\n", 28, "second $Nodes"),
        ("$PhysicalNames\n", "Nodes\n", 4, "a section was expected"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path, old, new, line, message):
    error = refused(tmp_path, replaced(TET, old, new))
    assert message in error.message
    assert error.line == line


def test_missing_sections(tmp_path):
    assert "no $Elements" in refused(tmp_path, TET[: TET.index("$Elements")]).message
    assert "$MeshFormat" in refused(tmp_path, b"\x7fELF\x00\x01\x02" * 50).message


@pytest.mark.parametrize(
    ("name", "message", "remedy"),
    [
        ("tet4_format22", "format 2.2", "-format msh41"),
        ("tet4_format40", "format 4 ", "-format msh41"),
        ("hex27", "27-node hexahedra (Gmsh type 12)", "SecondOrderIncomplete"),
        ("wedge15", "15-node wedges (Gmsh type 18)", "tet10"),
    ],
)
def test_real_files_that_are_not_read(name, message, remedy):
    with pytest.raises(MeshError) as error:
        read(name)
    assert message in error.value.message
    assert remedy in error.value.remedy
    assert error.value.line > 0


@pytest.mark.parametrize("name", ["hex8", "hex20_binary"])
def test_a_file_cut_short_anywhere_is_refused(tmp_path, name):
    data = (DATA / f"{name}.msh").read_bytes().rstrip()
    for end in range(1, len(data), 37):
        refused(tmp_path, data[:end])


@pytest.mark.parametrize("name", ["tet4", "hex20_binary"])
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(where=st.floats(0, 1, exclude_max=True), removed=st.integers(0, 40), added=st.binary(max_size=12))
def test_damage_anywhere_gives_a_mesh_or_a_mesh_error(tmp_path, name, where, removed, added):
    data = (DATA / f"{name}.msh").read_bytes()
    start = int(where * len(data))
    try:
        mesh = read_text(tmp_path, data[:start] + added + data[start + removed :])
        validate(mesh)
    except MeshError:
        return
    assert np.isfinite(mesh.nodes).all()
    assert mesh.n_cells > 0

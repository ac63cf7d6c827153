"""Abaqus and CalculiX files: elements, sets, surfaces, materials, and refusals with their lines."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from maggi.mesh import CELL_TYPES, SOLID_TYPES, box, read_abaqus, validate
from maggi.model.errors import MeshError
from maggi.model.materials import Material

# Two unit cubes side by side along x; nodes 1–12, elements 10 and 20.
TWO = """** two cubes
*HEADING
 free text, with *stars*
*Node, NSET=Nall
1, 0, 0, 0
 2 , 1.0 , 0., 0
3, 2, 0, 0
4, 0, 1, 0
** a comment within
5, 1, 1, 0
6, 2, 1, 0
7, 0, 0, 1
8, 1, 0, 1
9, 2.0D0, 0, 1
10, 0, 1, 1

11, 1, 1, 1,
12, 2, 1, 1
* ELEMENT , type = C3D8 ,
 ELSET="Eall"
10, 1, 2, 5, 4,
    7, 8, 11, 10
20, 2, 3, 6, 5, 8, 9, 12, 11
"""


def read(folder, text):
    file = folder / "a.inp"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    mesh = read_abaqus(str(file))
    validate(mesh)
    return mesh


def refused(folder, text):
    with pytest.raises(MeshError) as error:
        read(folder, text)
    assert error.value.file.endswith("a.inp")
    assert error.value.remedy
    return error.value


def labels(mesh, name):
    return mesh.node_labels[mesh.node_sets[name]].tolist()


def test_nodes_elements_and_the_sets_on_their_lines(tmp_path):
    mesh = read(tmp_path, TWO)
    assert mesh.node_labels.tolist() == list(range(1, 13))
    np.testing.assert_array_equal(mesh.nodes[[1, 8, 10]], [[1, 0, 0], [2, 0, 1], [1, 1, 1]])
    assert mesh.cells["hex8"].tolist() == [[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]]
    assert mesh.cell_labels["hex8"].tolist() == [10, 20]
    assert labels(mesh, "Nall") == list(range(1, 13))
    assert mesh.element_sets["Eall"]["hex8"].tolist() == [0, 1]
    assert mesh.notes == ()


ABAQUS_NAMES = {"tet4": "C3D4", "tet10": "C3D10", "hex8": "C3D8", "hex20": "C3D20", "wedge6": "C3D6"}


@pytest.mark.parametrize("kind", SOLID_TYPES)
@pytest.mark.parametrize("width", [1, 5, 16])
def test_every_type_comes_back_as_written(tmp_path, kind, width):
    """A box written with `width` numbers on a line."""
    mesh = box((1.0, 2.0, 3.0), (2, 1, 2), kind)
    rows = ["*NODE"]
    rows += [
        f"{label}, {x!r}, {y!r}, {z!r}" for label, (x, y, z) in zip(mesh.node_labels, mesh.nodes.tolist(), strict=True)
    ]
    rows += [f"*ELEMENT, TYPE={ABAQUS_NAMES[kind]}"]
    for label, cell in zip(mesh.cell_labels[kind], mesh.cells[kind], strict=True):
        numbers = [str(n) for n in (label, *mesh.node_labels[cell])]
        rows += [", ".join(numbers[i : i + width]) + "," for i in range(0, len(numbers), width)]
    again = read(tmp_path, "\n".join(rows))
    np.testing.assert_array_equal(again.nodes, mesh.nodes)
    np.testing.assert_array_equal(again.cells[kind], mesh.cells[kind])


@pytest.mark.parametrize(
    ("name", "kind"), [("C3D8R", "hex8"), ("C3D8I", "hex8"), ("C3D20R", "hex20"), ("C3D10M", "tet10")]
)
def test_reduced_elements_are_read_as_full_ones_with_a_note(tmp_path, name, kind):
    count = CELL_TYPES[kind].nodes
    nodes = "\n".join(f"{i},{i},{i * i},{i**3}" for i in range(1, count + 1))
    element = ",\n".join(["1", *map(str, range(1, count + 1))])
    mesh = read(tmp_path, f"*NODE\n{nodes}\n*ELEMENT, TYPE={name}\n{element}\n")
    assert list(mesh.cells) == [kind]
    assert mesh.notes == (f"line {count + 2}: {name} is read as the fully integrated {kind}",)


def test_beams(tmp_path):
    mesh = read(tmp_path, "*NODE\n1\n2, 1.5\n3, 3.\n*ELEMENT, TYPE=B31\n1, 1, 2\n2, 2, 3\n*BEAM SECTION, ELSET=E\n1.\n")
    np.testing.assert_array_equal(mesh.nodes, [[0, 0, 0], [1.5, 0, 0], [3, 0, 0]])
    assert mesh.cells["beam2"].tolist() == [[0, 1], [1, 2]]
    assert mesh.notes == ("line 8: *BEAM SECTION was passed over",)


def test_sets_by_labels_ranges_and_other_sets(tmp_path):
    mesh = read(
        tmp_path,
        TWO
        + "*NSET, NSET=some\n 3, 1\n12\n*NSET, NSET=odd, GENERATE\n1, 11, 2\n*NSET, nset=range, generate\n4,6\n"
        + "*nset, nset=both\n SOME, range, 7\n*nset, nset=SOME\n2\n"
        + "*ELSET, ELSET=one\n20\n*ELSET, ELSET=again, GENERATE\n10, 20, 10\n*ELSET, ELSET=nested\n one,\n"
        + "*NSET, NSET=ofelements, ELSET=one\n",
    )
    assert labels(mesh, "some") == [1, 2, 3, 12]
    assert labels(mesh, "odd") == [1, 3, 5, 7, 9, 11]
    assert labels(mesh, "range") == [4, 5, 6]
    assert labels(mesh, "both") == [1, 3, 4, 5, 6, 7, 12]
    assert labels(mesh, "ofelements") == [2, 3, 5, 6, 8, 9, 11, 12]
    assert {name: s["hex8"].tolist() for name, s in mesh.element_sets.items()} == {
        "Eall": [0, 1],
        "one": [1],
        "again": [0, 1],
        "nested": [1],
    }


def test_a_huge_range_costs_nothing(tmp_path):
    assert len(labels(read(tmp_path, TWO + "*NSET, NSET=a, GENERATE\n1, 1000000000000000, 1\n"), "a")) == 12


def test_surfaces_are_their_faces_nodes(tmp_path):
    mesh = read(
        tmp_path,
        TWO
        + "*NSET, NSET=base\n1, 2\n*SURFACE, NAME=top\nEall, S2\n*SURFACE, NAME=Ends, TYPE=ELEMENT\n10, S6\n20, s4\n"
        + "*SURFACE, NAME=pins, TYPE=NODE\nbase, 1.0\n7,\n*SURFACE, NAME=skin\nEall,\n*SURFACE, NAME=base\n10, S1\n",
    )
    assert labels(mesh, "top") == [7, 8, 9, 10, 11, 12]
    assert labels(mesh, "Ends") == [1, 3, 4, 6, 7, 9, 10, 12]
    assert labels(mesh, "pins") == [1, 2, 7]
    assert labels(mesh, "skin") == list(range(1, 13))
    assert labels(mesh, "base") == [1, 2]
    assert labels(mesh, "base_surface") == [1, 2, 4, 5]
    assert "'base_surface'" in mesh.notes[0]


@pytest.mark.parametrize("kind", SOLID_TYPES)
def test_the_free_surface_of_a_set_leaves_inner_nodes_out(tmp_path, kind):
    mesh = box((1.0, 1.0, 1.0), (3, 3, 3), kind)
    rows = ["*NODE"]
    rows += [
        f"{label}, {x!r}, {y!r}, {z!r}" for label, (x, y, z) in zip(mesh.node_labels, mesh.nodes.tolist(), strict=True)
    ]
    rows += [f"*ELEMENT, TYPE={ABAQUS_NAMES[kind]}, ELSET=E"]
    for label, cell in zip(mesh.cell_labels[kind], mesh.cells[kind], strict=True):
        rows += [",\n".join(str(n) for n in (label, *mesh.node_labels[cell]))]
    found = read(tmp_path, "\n".join([*rows, "*SURFACE, NAME=skin", "E"])).node_sets["skin"]
    outer = np.isclose(mesh.nodes, 0).any(axis=1) | np.isclose(mesh.nodes, 1).any(axis=1)
    np.testing.assert_array_equal(found, np.flatnonzero(outer))


MATERIALS = """*MATERIAL, NAME=Steel
*ELASTIC
 2.1E11, 0.3
*DENSITY
7850.,
*MATERIAL, NAME=Alu
*DENSITY
2700
*ELASTIC, TYPE=ISOTROPIC
7e10, 0.33
*MATERIAL, NAME=rubber
*ELASTIC
1e6, 0.49
"""


def test_materials_and_sections(tmp_path):
    mesh = read(
        tmp_path,
        TWO
        + MATERIALS
        + "*ELSET, ELSET=one\n20\n*ELSET, ELSET=two\n10\n*SOLID SECTION, ELSET=one, MATERIAL=ALU\n1.,\n"
        + "*SOLID SECTION, ELSET=two, MATERIAL=Rubber\n",
    )
    assert mesh.materials == {"Steel": Material(7850.0, 2.1e11, 0.3), "Alu": Material(2700.0, 7e10, 0.33)}
    assert mesh.cell_materials["hex8"].tolist() == [-1, 1]
    assert mesh.notes == ("material 'rubber' has no *DENSITY and was passed over",)


def test_what_is_passed_over_is_listed(tmp_path):
    text = TWO + "*ORIENTATION, NAME=o\n1,0,0,0,1,0\n*Plastic\n1,2\n*STEP\n*STATIC\n*NODE\nno node at all\n"
    first = TWO.count("\n") + 1
    assert read(tmp_path, text).notes == (
        f"line {first}: *ORIENTATION was passed over",
        f"line {first + 2}: *PLASTIC was passed over",
        f"line {first + 4}: everything from *STEP on was passed over",
    )


def test_line_ends_of_other_systems(tmp_path):
    assert read(tmp_path, TWO.replace("\n", "\r\n")).n_nodes == 12
    assert read(tmp_path, TWO.replace("\n", "\r")).n_nodes == 12


# What follows TWO; the line is counted from there.
@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("*INCLUDE, INPUT=other.inp\n", 1, "*INCLUDE is not read"),
        ("*Part, name=p\n", 1, "*PART is not read"),
        ("*INSTANCE, NAME=a, PART=p\n", 1, "*INSTANCE is not read"),
        ("*Assembly\n", 1, "*ASSEMBLY is not read"),
        ("*RIGID BODY, NSET=a, REF NODE=1\n", 1, "*RIGID BODY is not read"),
        ("*TIE, NAME=t\n", 1, "*TIE is not read"),
        ("*NGEN\n1,2\n", 1, "*NGEN is not read"),
        ("*NODE, SYSTEM=C\n1,2,3,4\n", 1, "SYSTEM="),
        ("*NODE, INPUT=n.txt\n", 1, "INPUT="),
        ("*NODE\n13, 0, x, 0\n", 2, "found 'x'"),
        ("*NODE\n13, 0, 1, 0, 4\n", 2, "5 entries"),
        ("*NODE\n13, 0, nan, 0\n", 2, "found 'nan'"),
        ("*NODE\n13.5, 0, 1, 0\n", 2, "whole, found 13.5"),
        ("*NODE\n13, 0, 1_0, 0\n", 2, "found '1_0'"),
        ("*ELEMENT\n1,2\n", 1, "*ELEMENT has no TYPE="),
        ("*ELEMENT, TYPE=S4R\n30, 1, 2, 5, 4\n", 1, "shell, plane or truss elements of type S4R"),
        ("*ELEMENT, TYPE=CPS3\n30, 1, 2, 5\n", 1, "shell, plane or truss elements of type CPS3"),
        ("*ELEMENT, TYPE=C3D15\n30\n", 1, "elements of type C3D15"),
        ("*ELEMENT, TYPE=C3D4, INPUT=a\n", 1, "INPUT="),
        ("*ELEMENT, TYPE=C3D4\n30, 1, 2, 4, 7\n31, 1, 2, 4\n", 3, "4 numbers where 5 make a record"),
        ("*ELEMENT, TYPE=C3D4\n30, 1, 2, 4, 7, 8\n", 2, "6 numbers where 5 make a record"),
        ("*ELEMENT, TYPE=C3D4\n30, 1, 2, 4, 7\n31, 1, 2, 4,\n77\n", 3, "element 31 has node 77"),
        ("*ELEMENT, TYPE=C3D4\n30, 1, 2, y, 7\n", 2, "found 'y'"),
        ("*ELEMENT, TYPE=C3D4\n30, 1, 2, 4.5, 7\n", 2, "found '4.5'"),
        ("*ELEMENT, TYPE=C3D4\n30, 1, 2, , 7\n", 2, "found ''"),
        ("*NSET\n1\n", 1, "*NSET has no NSET="),
        ("*NSET, NSET=a\n1, 2\n3, 99\n", 3, "there is no node 99"),
        ("*NSET, NSET=a\n1, nowhere\n", 2, "there is no node set 'nowhere'"),
        ("*NSET, NSET=a, ELSET=nowhere\n", 1, "there is no element set 'nowhere'"),
        ("*NSET, NSET=a, GENERATE\n1, 5, 0\n", 2, "cannot generate from '1, 5, 0'"),
        ("*NSET, NSET=a, GENERATE\n5\n", 2, "cannot generate from '5'"),
        ("*NSET, NSET=a, GENERATE\n50, 60\n", 2, "no node from 50 to 60"),
        ("*ELSET, ELSET=a\n11\n", 2, "there is no element 11"),
        ("*SURFACE, NAME=a\nEall, S7\n", 2, "hex8 has no face 'S7'"),
        ("*SURFACE, NAME=a\n11, S1\n", 2, "there is no element 11"),
        ("*SURFACE, NAME=a, TYPE=CYLINDER\n", 1, "TYPE=CYLINDER"),
        ("*ELASTIC\n1,0.3\n", 1, "before any *MATERIAL"),
        ("*MATERIAL, NAME=m\n*ELASTIC, TYPE=ORTHO\n1,2\n", 2, "TYPE=ORTHO"),
        ("*MATERIAL, NAME=m\n*ELASTIC\n1, 0.3, 20\n2, 0.3, 100\n", 2, "2 data lines"),
        ("*MATERIAL, NAME=m\n*ELASTIC\n2e11, 0.5\n", 3, "[200000000000.0, 0.5]"),
        ("*MATERIAL, NAME=m\n*DENSITY\n-7850\n", 3, "-7850"),
        ("*SOLID SECTION, ELSET=Eall, MATERIAL=m\n", 1, "there is no material 'm'"),
        ("*SOLID SECTION, ELSET=no, MATERIAL=m\n", 1, "there is no element set 'no'"),
        ("*SOLID SECTION, MATERIAL=m\n", 1, "no ELSET="),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path, text, line, message):
    error = refused(tmp_path, TWO + text)
    assert message in error.message
    assert error.line == TWO.count("\n") + line


def test_an_element_in_two_sections_with_different_materials(tmp_path):
    text = TWO + MATERIALS + "*SOLID SECTION, ELSET=Eall, MATERIAL=Steel\n*SOLID SECTION, ELSET=Eall, MATERIAL=Alu\n"
    error = refused(tmp_path, text)
    assert "another material" in error.message
    assert error.line == (TWO + MATERIALS).count("\n") + 2


def test_numbers_given_twice_nodes_in_no_cell_and_files_without_a_mesh(tmp_path):
    assert "node numbers are defined more than once: 3" in refused(tmp_path, TWO + "*NODE\n3, 1, 1, 1\n").message
    again = "*ELEMENT, TYPE=C3D4\n20, 1, 2, 4, 7\n"
    assert "element numbers are defined more than once: 20" in refused(tmp_path, TWO + again).message
    assert "1 nodes belong to no cell: 99" in refused(tmp_path, TWO + "*NODE\n99, 1, 1, 1\n").message
    assert "no *NODE" in refused(tmp_path, "*HEADING\n").message
    assert "no *ELEMENT" in refused(tmp_path, "*NODE\n1,0,0,0\n").message
    assert "no *NODE" in refused(tmp_path, "** only a comment\n").message


def test_files_of_another_kind(tmp_path):
    error = refused(tmp_path, "** comment\nnodes: 3\n")
    assert (error.line, error.message) == (2, "a keyword was expected, found 'nodes: 3'")
    assert "not a text file" in refused(tmp_path, b"\x7fELF\x00\x00\x01").message


@settings(max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    where=st.floats(0, 1, exclude_max=True),
    removed=st.integers(0, 30),
    added=st.text('*,.-\n 019eEdS=a\0"', max_size=9),
)
def test_damage_anywhere_gives_a_mesh_or_a_mesh_error(tmp_path, where, removed, added):
    whole = TWO + MATERIALS + "*NSET, NSET=a, GENERATE\n1,3\n*SURFACE, NAME=s\nEall, S2\n"
    start = int(where * len(whole))
    try:
        mesh = read(tmp_path, whole[:start] + added + whole[start + removed :])
    except MeshError:
        return
    assert np.isfinite(mesh.nodes).all()
    assert mesh.n_cells > 0

"""From a description to a mesh: which reader, which unit, and what is said about files that are not there."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from maggi.mesh import load_mesh, read_gmsh
from maggi.model.errors import MeshError
from maggi.model.meshes import BeamMesh, BoxMesh, FileMesh, Section

DATA = Path(__file__).parent / "data"
PATH = "bodies.rod.mesh"


def refused(source, folder):
    with pytest.raises(MeshError) as error:
        load_mesh(source, str(folder), PATH)
    assert error.value.remedy
    return error.value


def test_relative_names_start_at_the_folder_and_the_unit_scales(tmp_path):
    shutil.copy(DATA / "hex8.msh", tmp_path / "Block.MSH")
    meters = read_gmsh(str(DATA / "hex8.msh"))
    mesh = load_mesh(FileMesh("Block.MSH", unit=1e-3), str(tmp_path), PATH)
    np.testing.assert_allclose(mesh.nodes, 1e-3 * meters.nodes, rtol=1e-15)
    assert load_mesh(FileMesh(str(DATA / "hex8.msh")), str(tmp_path)).n_nodes == 27


def test_materials_are_not_scaled_and_a_note_says_so(tmp_path):
    text = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=E\n1,1,2,3,4\n"
    text += "*MATERIAL,NAME=m\n*ELASTIC\n2e11,0.3\n*DENSITY\n7850\n"
    (tmp_path / "a.inp").write_text(text)
    mesh = load_mesh(FileMesh("a.inp", unit=1e-3), str(tmp_path), PATH)
    assert mesh.materials["m"].density == 7850.0
    assert "0.001 m" in mesh.notes[0]
    assert load_mesh(FileMesh("a.inp"), str(tmp_path), PATH).notes == ()


def test_parametric_meshes():
    assert load_mesh(BoxMesh((1, 1, 1), (2, 1, 1), "wedge6")).n_cells == 4
    assert load_mesh(BeamMesh(2.0, Section.circle(0.1), 5)).n_cells == 5
    with pytest.raises(MeshError) as error:
        load_mesh(BoxMesh((1, 1, 0), (2, 1, 1)), path=PATH)
    assert error.value.path == "bodies.rod.mesh.box.size"
    with pytest.raises(MeshError) as error:
        load_mesh(BeamMesh(2.0, Section.circle(0.1), 0), path=PATH)
    assert error.value.path == "bodies.rod.mesh.beam.elements"


def test_missing_files_with_near_names(tmp_path):
    for name in ("rod.msh", "crank.inp", "notes.txt"):
        (tmp_path / name).write_text("x")
    error = refused(FileMesh("rodd.msh"), tmp_path)
    assert str(tmp_path / "rodd.msh") in error.message
    assert error.path == PATH + ".file"
    assert error.remedy == "in that folder: rod.msh"
    assert refused(FileMesh("zzzzz.msh"), tmp_path).remedy == "in that folder: crank.inp, rod.msh"
    assert "no folder" in refused(FileMesh("no/rod.msh"), tmp_path).remedy
    assert "\\x00" in refused(FileMesh("a\0b.msh"), tmp_path).message


@pytest.mark.parametrize("name", ["rod.bdf", "rod", "rod.vtk"])
def test_other_kinds_of_files(tmp_path, name):
    error = refused(FileMesh(name), tmp_path)
    assert error.path == PATH + ".file"
    assert ".msh" in error.remedy
    assert ".inp" in error.remedy


@pytest.mark.parametrize("extension", [".msh", ".inp"])
def test_folders_empty_files_garbage_and_pipes(tmp_path, extension):
    name = "a" + extension
    place = tmp_path / name
    place.mkdir()
    assert "a folder" in refused(FileMesh(name), tmp_path).message
    place.rmdir()
    place.write_bytes(b" \n\n")
    assert "empty" in refused(FileMesh(name), tmp_path).message
    for garbage in (bytes(range(256)) * 8, b"\xff\xfe" * 99, b"PK\x03\x04" + b"\0" * 40, b"{}\n"):
        place.write_bytes(garbage)
        assert refused(FileMesh(name), tmp_path).file == str(place)
    place.unlink()
    os.mkfifo(place)
    assert "regular" in refused(FileMesh(name), tmp_path).message


def test_files_too_large_are_not_opened(tmp_path):
    place = tmp_path / "a.msh"
    with place.open("wb") as stream:
        stream.truncate(3 * 1024**3)  # sparse: takes no space
    assert "3.0 GiB" in refused(FileMesh("a.msh"), tmp_path).message


@pytest.mark.parametrize("unit", [0.0, -1.0, float("nan"), float("inf")])
def test_units_that_are_none(unit):
    assert refused(FileMesh(str(DATA / "hex8.msh"), unit), ".").path == PATH + ".unit"


def test_a_unit_beyond_all_bounds():
    assert "not finite" in refused(FileMesh(str(DATA / "hex8.msh"), 1e308), ".").message

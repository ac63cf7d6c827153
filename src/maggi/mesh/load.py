"""From the description of a mesh to the mesh."""

from __future__ import annotations

import difflib
import math
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from maggi.model.errors import MeshError
from maggi.model.meshes import BeamMesh, BoxMesh, FileMesh, MeshSource

from .abaqus import read_abaqus
from .gmsh import read_gmsh
from .mesh import Mesh
from .parametric import beam, box
from .validate import validate

_READERS: Mapping[str, Callable[[str], Mesh]] = MappingProxyType({".msh": read_gmsh, ".inp": read_abaqus})
_WHAT_IS_READ = "Gmsh 4.1 (.msh) and Abaqus or CalculiX (.inp) meshes are read"
_LISTED = 2000


def load_mesh(source: MeshSource, folder: str = ".", path: str = "") -> Mesh:
    """The mesh that `source` describes, validated; coordinates in metres.

    folder : where relative file names start. path : where in the model the mesh stands
    (``bodies.rod.mesh``), for messages.

    ``FileMesh.unit`` scales the coordinates only: materials in the file are taken as SI, whatever the unit of
    length. (A file in mm, N, tonne has other numbers for density and stiffness: name a material in the model.)

    Raises MeshError: with file and line for what is wrong in a file, with `path` for what is wrong in the model.
    """
    match source:
        case FileMesh(name, unit):
            mesh = _read(name, unit, folder, path)
        case BoxMesh(size, cells, cell):
            mesh = box(size, cells, cell, path=f"{path}.box" if path else "box")
        case BeamMesh(length, _, elements):
            mesh = beam(length, elements, path=f"{path}.beam" if path else "beam")
    try:
        validate(mesh)
    except MeshError as error:
        raise in_the_model(error, source, path) from None
    return mesh


def in_the_model(error: MeshError, source: MeshSource, path: str) -> MeshError:
    """A copy of an error about a mesh as a whole that stands where the model names the mesh.

    path : as of `load_mesh`; without one, and for an error that has a line of its own, the error as it is.
    """
    if not path or error.line or error.path:
        return error
    name = f"{os.path.basename(source.path)}: " if isinstance(source, FileMesh) else ""
    key = {FileMesh: "file", BoxMesh: "box", BeamMesh: "beam"}[type(source)]
    return MeshError(f"{name}{error.message}", path=f"{path}.{key}", remedy=error.remedy)


def _read(name: str, unit: float, folder: str, path: str) -> Mesh:
    prefix = f"{path}." if path else ""
    if not (math.isfinite(unit) and unit > 0.0):
        remedy = "give the length of one unit of the file, such as 'mm'"
        raise MeshError(f"the unit must be a positive length, found {unit}", path=prefix + "unit", remedy=remedy)
    reader = _READERS.get(os.path.splitext(name)[1].lower())
    if reader is None:
        message = f"'{name}': this kind of mesh file is not read"
        raise MeshError(message, path=prefix + "file", remedy=f"{_WHAT_IS_READ}; write it as one of these")
    place = os.path.abspath(os.path.join(folder, name))
    if "\0" in place or not os.path.exists(place):
        raise MeshError(f"there is no file {place!r}", path=prefix + "file", remedy=_near(place))
    mesh = reader(place)
    if unit == 1.0:
        return mesh
    notes = mesh.notes
    if mesh.materials:
        notes += (f"the materials of the file are taken as SI and not scaled by its unit ({unit:g} m)",)
    with np.errstate(over="ignore"):  # what is too large is found by `validate`
        return replace(mesh, nodes=mesh.nodes * unit, notes=notes)


def _near(place: str) -> str:
    """Files of similar name in the folder where one was sought."""
    folder, name = os.path.split(place)
    try:
        with os.scandir(folder) as entries:
            files = [entry.name for entry, _ in zip(entries, range(_LISTED), strict=False)]
    except (OSError, ValueError):
        return f"there is no folder {folder!r} either"
    near = difflib.get_close_matches(name, files, n=3, cutoff=0.6)
    near = near or sorted(file for file in files if os.path.splitext(file)[1].lower() in _READERS)[:5]
    return f"in that folder: {', '.join(near)}" if near else "relative names start at the model file's folder"

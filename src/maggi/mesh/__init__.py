"""Meshes: nodes, cells and named sets; readers of mesh files; parametric boxes and beams."""

from .abaqus import read_abaqus
from .cells import CELL_TYPES, SOLID_TYPES, CellType
from .gmsh import read_gmsh
from .load import load_mesh
from .mesh import Mesh
from .parametric import beam, box
from .selection import select
from .set_geometry import SetGeometry, set_geometry
from .surface import free_faces, surface_triangles
from .validate import validate

__all__ = [
    "CELL_TYPES",
    "SOLID_TYPES",
    "CellType",
    "Mesh",
    "SetGeometry",
    "beam",
    "box",
    "free_faces",
    "load_mesh",
    "read_abaqus",
    "read_gmsh",
    "select",
    "set_geometry",
    "surface_triangles",
    "validate",
]

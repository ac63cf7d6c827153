"""Makes the Gmsh files beside it: blocks of 2 x 1 x 1 with physical groups of every dimension (Gmsh 4.15).

The tests read the stored files; Gmsh is needed only to make them anew.
"""

from __future__ import annotations

from pathlib import Path

import gmsh
import numpy as np

FOLDER = Path(__file__).parent


def groups() -> None:
    """Named, unnamed and overlapping groups."""
    model = gmsh.model

    def at(dimension: int, **coordinates: float) -> list[int]:
        chosen = []
        for _, tag in model.getEntities(dimension):
            box = np.array(model.getBoundingBox(dimension, tag)).reshape(2, 3)
            if all(np.allclose(box[:, "xyz".index(axis)], value, atol=1e-6) for axis, value in coordinates.items()):
                chosen.append(tag)
        return chosen

    left, right, bottom = at(2, x=0), at(2, x=2), at(2, z=0)
    model.addPhysicalGroup(3, [1], 1, name="block")
    model.addPhysicalGroup(2, left, 2, name="left")
    model.addPhysicalGroup(2, right, 3, name="right side")
    model.addPhysicalGroup(2, left + right, 4, name="ends")
    model.addPhysicalGroup(2, bottom, 5)
    model.addPhysicalGroup(1, at(1, x=0, y=0), 6, name="edge")
    model.addPhysicalGroup(0, at(0, x=0, y=0, z=0), 7, name="corner")


def block(kind: str) -> None:
    """One block of cells of a kind."""
    gmsh.clear()
    gmsh.model.add(kind)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", kind in ("hex20", "wedge15"))
    occ = gmsh.model.occ
    if kind.startswith("tet"):
        occ.addBox(0, 0, 0, 2, 1, 1)
    else:
        occ.extrude([(2, occ.addRectangle(0, 0, 0, 2, 1))], 0, 0, 1, numElements=[2], recombine=True)
    occ.synchronize()
    mesh = gmsh.model.mesh
    if kind.startswith("hex"):
        for _, curve in gmsh.model.getEntities(1):
            mesh.setTransfiniteCurve(curve, 3)
        for _, face in gmsh.model.getEntities(2):
            mesh.setTransfiniteSurface(face)
            mesh.setRecombine(2, face)
        mesh.setTransfiniteVolume(1)
    groups()
    mesh.generate(3)
    mesh.setOrder(1 if kind in ("tet4", "hex8", "wedge6") else 2)


def write(name: str, **options: float) -> None:
    """Write the present model with `Mesh.` options set for this one file."""
    before = {key: gmsh.option.getNumber(f"Mesh.{key}") for key in options}
    for key, value in options.items():
        gmsh.option.setNumber(f"Mesh.{key}", value)
    gmsh.write(str(FOLDER / f"{name}.msh"))
    for key, value in before.items():
        gmsh.option.setNumber(f"Mesh.{key}", value)


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.7)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 1.0)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    for kind in ("tet4", "tet10", "hex8", "hex20", "wedge6", "hex27", "wedge15"):
        block(kind)
        write(kind)
        if kind in ("tet10", "hex20"):
            write(f"{kind}_binary", Binary=1)
        if kind == "tet4":
            write("tet4_format22", MshFileVersion=2.2)
            write("tet4_format40", MshFileVersion=4.0)
            write("tet4_all_parametric", SaveAll=1, SaveParametric=1)
    gmsh.finalize()


if __name__ == "__main__":
    main()

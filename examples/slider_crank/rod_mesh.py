"""Makes ``rod.msh``: a connecting rod of tet10 cells (needs ``pip install maggi[mesh]``).

    python rod_mesh.py

Body frame: origin at the centre of the big end, x towards the small end, bores along y; metres. One quarter
(y > 0, z > 0) is meshed and reflected twice, so that the mesh is exactly symmetric about the planes y = 0 and
z = 0. The nodes of the bores lie on a regular grid in angle and y: their mean is the bore's centre, which makes
it the point of an attachment on them.

Physical groups: the volume ``rod``, the surfaces ``big_end`` and ``small_end`` (the bores).
"""

from __future__ import annotations

import math
from pathlib import Path

import gmsh
import numpy as np

LENGTH = 0.300  # between the bores' centres
BIG_BORE, BIG_EYE = 0.020, 0.032  # radii
SMALL_BORE, SMALL_EYE = 0.0125, 0.022
WIDTH, WEB = 0.024, 0.007  # along y
HALF_HEIGHT_BIG, HALF_HEIGHT_SMALL = 0.019, 0.013  # of the shank along z, at x = 0 and x = LENGTH
FLANGE = 0.0055  # thickness along z
FILLET, POCKET_FILLET, POCKET_GAP = 0.025, 0.005, 0.004  # radii in the x–z plane; between eye and pocket

CELL = 0.016
AROUND = {BIG_BORE: 5, SMALL_BORE: 4}  # cells along a quarter of a bore
ALONG_BORE = 2  # cells along y in the half-width
ROUND_A_FILLET = 2  # cells: with one only, cells between the fillets would turn inside out

SLOPE = (HALF_HEIGHT_SMALL - HALF_HEIGHT_BIG) / LENGTH
NORMAL = np.array([-SLOPE, 1.0]) / math.hypot(SLOPE, 1.0)  # of the shank's edge in the x–z plane, outwards

Point = np.ndarray


def fillet(
    center_x: float, radius: float, rounding: float, depth: float, outwards: float
) -> tuple[Point, Point, Point]:
    """The arc between a circle about (center_x, 0) and the shank's edge moved inwards by `depth`.

    Its centre lies `rounding` beyond the edge (`outwards` +1) or within (−1), and `rounding` outside the circle.
    Returns the point on the circle, the arc's centre, the point on the edge; (x, z) each.
    """
    on_edge = np.array([0.0, HALF_HEIGHT_BIG]) + (outwards * rounding - depth) * NORMAL
    along = np.array([NORMAL[1], -NORMAL[0]])
    eye = np.array([center_x, 0.0])
    b = (on_edge - eye) @ along
    c = (on_edge - eye) @ (on_edge - eye) - (radius + rounding) ** 2
    towards_shank = 1.0 if center_x == 0.0 else -1.0
    center = on_edge + (-b + towards_shank * math.sqrt(b * b - c)) * along
    return eye + radius / (radius + rounding) * (center - eye), center, center - outwards * rounding * NORMAL


def region(y: float, outline: list[tuple[Point, Point | None]]) -> int:
    """A plane face at height y. Outline: points (x, z), each with the centre of the arc to the next or None."""
    occ = gmsh.model.occ
    tags = [occ.addPoint(x, y, z) for (x, z), _ in outline]
    curves = []
    for i, (_, center) in enumerate(outline):
        first, last = tags[i], tags[(i + 1) % len(tags)]
        if center is None:
            curves.append(occ.addLine(first, last))
        else:
            curves.append(occ.addCircleArc(first, occ.addPoint(center[0], y, center[1]), last))
    return int(occ.addPlaneSurface([occ.addCurveLoop(curves)]))


def extrude(face: int, height: float) -> list[tuple[int, int]]:
    """The volume over a face, along y."""
    return [entity for entity in gmsh.model.occ.extrude([(2, face)], 0.0, height, 0.0) if entity[0] == 3]


def quarter() -> None:
    """The quarter y > 0, z > 0."""
    occ = gmsh.model.occ
    big, small = np.zeros(2), np.array([LENGTH, 0.0])
    up = np.array([0.0, 1.0])
    right = np.array([1.0, 0.0])
    big_tangent, big_center, big_edge = fillet(0.0, BIG_EYE, FILLET, 0.0, 1.0)
    small_tangent, small_center, small_edge = fillet(LENGTH, SMALL_EYE, FILLET, 0.0, 1.0)
    blank = extrude(
        region(
            0.0,
            [
                (-BIG_EYE * right, big),
                (BIG_EYE * up, big),
                (big_tangent, big_center),
                (big_edge, None),
                (small_edge, small_center),
                (small_tangent, small),
                (small + SMALL_EYE * up, small),
                (small + SMALL_EYE * right, None),
                (small + SMALL_BORE * right, small),
                (small + SMALL_BORE * up, small),
                (small - SMALL_BORE * right, None),
                (BIG_BORE * right, big),
                (BIG_BORE * up, big),
                (-BIG_BORE * right, None),
            ],
        ),
        WIDTH / 2.0,
    )
    big_radius, small_radius = BIG_EYE + POCKET_GAP, SMALL_EYE + POCKET_GAP
    big_corner, big_round, big_top = fillet(0.0, big_radius, POCKET_FILLET, FLANGE, -1.0)
    small_corner, small_round, small_top = fillet(LENGTH, small_radius, POCKET_FILLET, FLANGE, -1.0)
    pocket = extrude(
        region(
            WEB / 2.0,
            [
                (big_radius * right, big),
                (big_corner, big_round),
                (big_top, None),
                (small_top, small_round),
                (small_corner, small),
                (small - small_radius * right, None),
            ],
        ),
        WIDTH,
    )
    occ.cut(blank, pocket)
    occ.synchronize()


def bore_faces(center_x: float, radius: float) -> list[int]:
    """The faces of a bore: those all of whose corners lie on it."""
    faces = []
    for _, face in gmsh.model.getEntities(2):
        corners = gmsh.model.getBoundary([(2, face)], recursive=True)
        points = np.array([gmsh.model.getValue(0, tag, []) for _, tag in corners])
        distances = np.hypot(points[:, 0] - center_x, points[:, 2])
        if np.allclose(distances, radius, rtol=1e-6) and np.ptp(points[:, 1]) > 0.0:
            faces.append(face)
    return faces


def mesh_quarter(bores: dict[str, list[int]]) -> None:
    """Regular triangles on the bores, free tetrahedra elsewhere, all of second order."""
    mesh = gmsh.model.mesh
    cells = {**AROUND, FILLET: ROUND_A_FILLET, POCKET_FILLET: ROUND_A_FILLET}
    for _, curve in gmsh.model.getEntities(1):
        if gmsh.model.getType(1, curve) == "Circle":
            first, last = gmsh.model.getParametrizationBounds(1, curve)
            radius = 1.0 / gmsh.model.getCurvature(1, curve, [(first[0] + last[0]) / 2.0])[0]
            for known, count in cells.items():
                if math.isclose(radius, known, rel_tol=1e-6):
                    mesh.setTransfiniteCurve(curve, count + 1)
    for face in [face for faces in bores.values() for face in faces]:
        for _, curve in gmsh.model.getBoundary([(2, face)], oriented=False):
            if gmsh.model.getType(1, curve) == "Line":
                mesh.setTransfiniteCurve(curve, ALONG_BORE + 1)
        mesh.setTransfiniteSurface(face, "AlternateLeft")
    gmsh.option.setNumber("Mesh.MeshSizeMin", CELL / 2.0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", CELL)
    mesh.generate(3)
    mesh.setOrder(2)


# A reflection turns a cell inside out: its first two corners change places, and its edges with them (Gmsh's
# order of edges: 01 12 20 30 32 31).
TET_TURNED = [1, 0, 2, 3, 4, 6, 5, 9, 8, 7]
TRIANGLE_TURNED = [1, 0, 2, 3, 5, 4]


def reflected(bores: dict[str, list[int]]) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Nodes (n, 3), tetrahedra (c, 10) and the bores' triangles (t, 6) of the whole rod; indices from 0."""
    mesh = gmsh.model.mesh
    tags, coordinates, _ = mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    nodes = np.round(coordinates.reshape(-1, 3), 12)
    tets = place[mesh.getElementsByType(11)[1].astype(np.int64)].reshape(-1, 10)
    triangles = {
        name: np.vstack([place[mesh.getElementsByType(9, face)[1].astype(np.int64)].reshape(-1, 6) for face in faces])
        for name, faces in bores.items()
    }
    for axis in (1, 2):
        kept = nodes[:, axis] != 0.0  # nodes in the plane are their own images
        image = np.where(kept, len(nodes) + np.cumsum(kept) - 1, np.arange(len(nodes)))
        mirror = np.ones(3)
        mirror[axis] = -1.0
        nodes = np.vstack([nodes, nodes[kept] * mirror])
        tets = np.vstack([tets, image[tets][:, TET_TURNED]])
        triangles = {name: np.vstack([t, image[t][:, TRIANGLE_TURNED]]) for name, t in triangles.items()}
    used = np.unique(tets)
    new = np.zeros(len(nodes), dtype=np.int64)
    new[used] = np.arange(len(used))
    return nodes[used] + 0.0, new[tets], {name: new[t] for name, t in triangles.items()}


def write(file: Path, nodes: np.ndarray, tets: np.ndarray, bores: dict[str, np.ndarray]) -> None:
    """Write everything as format 4.1, ASCII, with its physical groups."""
    gmsh.model.add("rod")
    for tag, name in enumerate(bores, 1):
        gmsh.model.addDiscreteEntity(2, tag)
        gmsh.model.addPhysicalGroup(2, [tag], tag, name=name)
    gmsh.model.addDiscreteEntity(3, 1)
    gmsh.model.addPhysicalGroup(3, [1], 3, name="rod")
    mesh = gmsh.model.mesh
    mesh.addNodes(3, 1, np.arange(1, len(nodes) + 1), nodes.ravel())
    for tag, triangles in enumerate(bores.values(), 1):
        mesh.addElementsByType(tag, 9, [], triangles.ravel() + 1)
    mesh.addElementsByType(1, 11, [], tets.ravel() + 1)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.write(str(file))


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("quarter")
    quarter()
    bores = {"big_end": bore_faces(0.0, BIG_BORE), "small_end": bore_faces(LENGTH, SMALL_BORE)}
    mesh_quarter(bores)
    nodes, tets, triangles = reflected(bores)
    file = Path(__file__).with_name("rod.msh")
    write(file, nodes, tets, triangles)
    gmsh.finalize()
    print(f"{file.name}: {len(nodes)} nodes, {len(tets)} tet10")


if __name__ == "__main__":
    main()

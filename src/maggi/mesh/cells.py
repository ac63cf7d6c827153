"""The cell types and their numbering: one table, used by every reader, generator and element.

Numbering is that of Abaqus and CalculiX; VTK's is the same. Corners first, then one node in the middle of
each edge, in the order of `edges`:

=======  ==============================================================================================
beam2    0 at the start, 1 at the end
tet4     0 1 2 counter-clockwise seen from 3
tet10    tet4, then the middles of 01 12 20 03 13 23
hex8     0 1 2 3 the bottom, counter-clockwise seen from the top; 4 5 6 7 the top, above them
hex20    hex8, then the middles of 01 12 23 30 (bottom), 45 56 67 74 (top), 04 15 26 37 (uprights)
wedge6   0 1 2 the bottom, counter-clockwise seen from the top; 3 4 5 the top, above them
=======  ==============================================================================================

(VTK's manual draws the linear wedge with the triangle 0 1 2 turned the other way; its code, and everybody
else, uses the numbering above.) Gmsh numbers the edges of tet10 and hex20 differently: see `gmsh.py`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

Edge = tuple[int, int]
Face = tuple[int, ...]


@dataclass(frozen=True)
class CellType:
    """A cell type's topology.

    dimension : 3 for solids, 1 for beams. corners : number of corner nodes.
    edges : corner pairs. faces : corners of each face, counter-clockwise seen from outside, in the order of
    Abaqus' face labels S1, S2, …
    second_order : whether node ``corners + i`` sits in the middle of edge i.
    """

    name: str
    dimension: int
    corners: int
    edges: tuple[Edge, ...]
    faces: tuple[Face, ...]
    second_order: bool = False

    @property
    def nodes(self) -> int:
        """Nodes per cell."""
        return self.corners + (len(self.edges) if self.second_order else 0)

    @property
    def face_nodes(self) -> tuple[Face, ...]:
        """All nodes of each face: its corners, then the middles of its edges in the same sense of rotation."""
        if not self.second_order:
            return self.faces
        middle = {frozenset(edge): self.corners + i for i, edge in enumerate(self.edges)}
        return tuple(
            face + tuple(middle[frozenset((a, b))] for a, b in zip(face, face[1:] + face[:1], strict=True))
            for face in self.faces
        )


_TET_EDGES: tuple[Edge, ...] = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_TET_FACES: tuple[Face, ...] = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
_HEX_EDGES: tuple[Edge, ...] = (
    *((0, 1), (1, 2), (2, 3), (3, 0)),
    *((4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
_HEX_FACES: tuple[Face, ...] = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_WEDGE_EDGES: tuple[Edge, ...] = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
_WEDGE_FACES: tuple[Face, ...] = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))

CELL_TYPES: Mapping[str, CellType] = MappingProxyType(
    {
        cell.name: cell
        for cell in (
            CellType("tet4", 3, 4, _TET_EDGES, _TET_FACES),
            CellType("tet10", 3, 4, _TET_EDGES, _TET_FACES, second_order=True),
            CellType("hex8", 3, 8, _HEX_EDGES, _HEX_FACES),
            CellType("hex20", 3, 8, _HEX_EDGES, _HEX_FACES, second_order=True),
            CellType("wedge6", 3, 6, _WEDGE_EDGES, _WEDGE_FACES),
            CellType("beam2", 1, 2, ((0, 1),), ()),
        )
    }
)
SOLID_TYPES: tuple[str, ...] = tuple(name for name, cell in CELL_TYPES.items() if cell.dimension == 3)

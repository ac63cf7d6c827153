"""How an elastic body looks at an instant: its deformed, exaggerated mesh and the colour of every node."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.mesh.surface import surface_triangles
from maggi.results.chord import Chord, chord
from maggi.results.results import Array, IntArray, Results

TARGET = 0.06  # largest drawn displacement, relative to the body's size
_FACTORS = (1.0, 2.0, 5.0)


@dataclass(frozen=True, eq=False)
class BodyShape:
    """An elastic body of a run, ready to be drawn at any of its rows.

    What is exaggerated and coloured is the displacement from the line between the two attachments farthest
    apart, so that the drawn body stays on its joints; without such a line, the whole displacement.
    """

    name: str
    nodes: Array
    triangles: IntArray
    beams: IntArray
    results: Results
    line: Chord | None

    def elastic(self, row: int) -> tuple[Array, Array]:
        """Displacements (nodes, 3), body frame, m: the whole, and the part that is exaggerated and coloured."""
        whole = self.results.body(self.name).displacement[row]
        if self.line is None:
            return whole, whole
        return whole, self.line.relative(self.nodes, whole[None], slice(row, row + 1))[0]

    def drawn(self, row: int, factor: float) -> tuple[Array, Array]:
        """Where the nodes are drawn (nodes, 3), global, and the size of their displacement (nodes,), m."""
        whole, part = self.elastic(row)
        points = self.nodes + whole + (factor - 1.0) * part
        origin, rotation = frame(self.results, self.name, row)
        return origin + points @ rotation.T, np.linalg.norm(part, axis=1)


def frame(results: Results, name: str, row: int) -> tuple[Array, Array]:
    """A body's origin (3,) and rotation (3, 3) at a row."""
    at = f"bodies/{name}"
    return results.frames(f"{at}/origin")[row], results.frames(f"{at}/rotation")[row]


def body_shape(results: Results, name: str) -> BodyShape:
    """The shape of an elastic body with nodal displacements."""
    body = results.body(name)
    beams = body.cells.get("beam2", np.zeros((0, 2), dtype=np.int64))
    return BodyShape(name, body.nodes, surface_triangles(body.cells), beams, results, chord(results, body))


def exaggeration(shapes: tuple[BodyShape, ...], rows: NDArray[np.int64]) -> float:
    """One factor (1, 2, 5, 10, …) for all bodies at which the largest displacement can be seen but not misread."""
    limit = np.inf
    for shape in shapes:
        size = float(np.ptp(shape.nodes, axis=0).max())
        largest = max(float(np.abs(shape.elastic(int(row))[1]).max()) for row in rows)
        if largest > 0.0:
            limit = min(limit, TARGET * size / largest)
    if not 1.0 < limit < 1e9:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(limit))
    return float(max(factor for factor in _FACTORS if factor * decade <= limit * (1 + 1e-9)) * decade)

"""The straight line between two attachments of an elastic body, from which its deflection is measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .results import BodyResults, Results

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Chord:
    """The line between two attachments as it moves, body frame.

    ends : names of the two. start, end : their undeformed places (3,), m.
    start_moves, end_moves : their displacements (m, 3) in the rows looked at, m.
    """

    ends: tuple[str, str]
    start: Array
    end: Array
    start_moves: Array
    end_moves: Array

    def relative(self, nodes: Array, displacements: Array, rows: slice) -> Array:
        """Displacements (k, nodes, 3) less those of the line beside each node, in the given k rows."""
        along = self.end - self.start
        place = ((nodes - self.start) @ along / (along @ along))[None, :, None]
        line = (1.0 - place) * self.start_moves[rows, None] + place * self.end_moves[rows, None]
        return np.asarray(displacements - line)

    def square(self, relative: Array) -> Array:
        """The part of vectors (..., 3) that is square to the line."""
        along = self.end - self.start
        direction = along / np.linalg.norm(along)
        return relative - (relative @ direction)[..., None] * direction


def chord(results: Results, body: BodyResults, step: int = 1) -> Chord | None:
    """The line between the two attachments farthest apart, in every `step`-th row.

    None where the body has fewer than two attachments at different places, or positions were not kept.
    """
    at = f"bodies/{body.name}"
    if not (len(results.time) and results.has(f"{at}/origin")):
        return None
    origin, rotation = body.origin[::step], body.rotation[::step]
    moving = {
        name: np.einsum("nji,nj->ni", rotation, body.attachment(name).position[::step] - origin)
        for name in body.attachments
        if results.has(f"{at}/attachments/{name}/position")
    }
    names = list(moving)
    pairs = [(a, b) for i, b in enumerate(names) for a in names[:i]]
    if not pairs:
        return None
    a, b = max(pairs, key=lambda pair: float(np.linalg.norm(moving[pair[0]][0] - moving[pair[1]][0])))
    start, end = body.attachment(a).at, body.attachment(b).at
    if not np.linalg.norm(end - start) > 0.0:
        return None
    return Chord((a, b), start, end, moving[a] - start, moving[b] - end)

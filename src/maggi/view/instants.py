"""Which instants of a run to draw, and which paths."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.results.results import Array


def different_instants(points: Array, count: int, first: int = 0) -> NDArray[np.int64]:
    """Rows at which the mechanism looks as different as possible, in order of time.

    Evenly spread instants of a run of whole turns would all look alike; so each further instant is the one
    farthest, in the space of all points, from those already chosen.

    Parameters
    ----------
    points : (n, k, 3) positions over time.
    count : how many rows at most; fewer where the mechanism does not move.
    first : the row to start from.
    """
    states = points.reshape(len(points), -1)
    size = float(np.ptp(points.reshape(-1, 3), axis=0).max()) or 1.0
    chosen = [first]
    distance = np.linalg.norm(states - states[first], axis=1)
    while len(chosen) < count and distance.max() > 1e-3 * size:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(states - states[chosen[-1]], axis=1))
    return np.array(sorted(chosen), dtype=np.int64)


def distinct(paths: list[Array]) -> list[Array]:
    """One of each group of paths (n, 3) that a joint keeps together."""
    size = max((float(np.ptp(path, axis=0).max()) for path in paths), default=0.0)
    kept: list[Array] = []
    for path in paths:
        if all(np.abs(path - other).max() > 1e-3 * size for other in kept):
            kept.append(path)
    return kept


def distinct_points(points: list[Array], near: float) -> list[Array]:
    """The first of each group of points (3,) that are closer than `near` to it."""
    kept: list[Array] = []
    for point in points:
        if all(np.linalg.norm(point - other) > near for other in kept):
            kept.append(point)
    return kept

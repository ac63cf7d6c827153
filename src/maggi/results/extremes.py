"""The largest joint forces and elastic deflections of a run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .results import BodyResults, Results

Array = NDArray[np.float64]

_BLOCK_BYTES = 16 << 20
_NEAREST = 16


@dataclass(frozen=True)
class Extreme:
    """The largest magnitude of a vector over time: its value, when, and the components (global) then."""

    magnitude: float
    time: float
    components: tuple[float, float, float]


@dataclass(frozen=True)
class JointExtremes:
    """Largest force (N) and torque (N m) of a joint or driver."""

    name: str
    force: Extreme
    torque: Extreme


@dataclass(frozen=True, eq=False)
class DeflectionHistory:
    """How far an elastic body is from its undeformed shape, over time.

    time : (m,) s, of the rows looked at.
    displacement : (m,) largest nodal displacement relative to the body frame, m.
    ends : the two attachments farthest apart, and
    deflection : (m,) the largest displacement square to the straight line between them, relative to that
        line as it moves with the two, m; both None where the body has fewer than two attachments or their
        positions were not kept.
    """

    body: str
    time: Array
    displacement: Array
    ends: tuple[str, str] | None
    deflection: Array | None


@dataclass(frozen=True)
class DeflectionExtremes:
    """Largest displacement and deflection of an elastic body (m), and when (s); see `DeflectionHistory`."""

    body: str
    displacement: float
    displacement_time: float
    ends: tuple[str, str] | None
    deflection: float | None
    deflection_time: float | None


def joint_extremes(results: Results) -> tuple[JointExtremes, ...]:
    """Largest force and torque of every joint and driver; empty if joints were not kept or there is no row."""
    if not len(results.time):
        return ()
    return tuple(
        JointExtremes(
            name,
            _extreme(results.time, results.joint(name).force),
            _extreme(results.time, results.joint(name).torque),
        )
        for name in results.joints
        if results.has(f"joints/{name}/force")
    )


def deflection_extremes(results: Results, most_rows: int | None = None) -> tuple[DeflectionExtremes, ...]:
    """Largest displacement and deflection of every elastic body with nodal displacements."""
    listed: list[DeflectionExtremes] = []
    for name in elastic_bodies(results):
        history = deflection_history(results, name, most_rows)
        if not len(history.time):
            continue
        k = int(np.argmax(history.displacement))
        deflection = time = None
        if history.deflection is not None:
            d = int(np.argmax(history.deflection))
            deflection, time = float(history.deflection[d]), float(history.time[d])
        listed.append(
            DeflectionExtremes(
                name, float(history.displacement[k]), float(history.time[k]), history.ends, deflection, time
            )
        )
    return tuple(listed)


def elastic_bodies(results: Results) -> tuple[str, ...]:
    """Names of the bodies with nodal displacements."""
    return tuple(name for name in results.bodies if results.has(f"bodies/{name}/displacement"))


def deflection_history(results: Results, name: str, most_rows: int | None = None) -> DeflectionHistory:
    """Displacement and deflection of an elastic body over time.

    Parameters
    ----------
    most_rows : look at no more than about this many rows, evenly spread; None looks at all. (The nodal
        displacements of a long run may be larger than the memory; they are read block by block.)
    """
    body = results.body(name)
    step = 1 if most_rows is None else max(1, -(-len(results.time) // most_rows))
    time = results.time[::step]
    nodes = body.nodes
    chord = _chord(results, body, step)
    displacement = np.empty(len(time))
    deflection = None if chord is None else np.empty(len(time))
    for first, block in _blocks(body, step):
        here = slice(first, first + len(block))
        displacement[here] = _largest(block)
        if chord is not None and deflection is not None:
            deflection[here] = _largest(chord.relative(nodes, block, here))
    return DeflectionHistory(name, time, displacement, chord.ends if chord else None, deflection)


@dataclass(frozen=True, eq=False)
class _Chord:
    """The line between two attachments, body frame: its undeformed ends (3,), and how they move (m, 3)."""

    ends: tuple[str, str]
    start: Array
    end: Array
    start_moves: Array
    end_moves: Array

    def relative(self, nodes: Array, displacements: Array, rows: slice) -> Array:
        """Displacements (k, nodes, 3) square to the moving line and relative to it."""
        along = self.end - self.start
        length = float(np.linalg.norm(along))
        direction = along / length
        place = ((nodes - self.start) @ direction / length)[None, :, None]
        line = (1.0 - place) * self.start_moves[rows, None] + place * self.end_moves[rows, None]
        relative = displacements - line
        return relative - (relative @ direction)[..., None] * direction


def _chord(results: Results, body: BodyResults, step: int) -> _Chord | None:
    at = f"bodies/{body.name}"
    if not (len(results.time) and results.has(f"{at}/origin")):
        return None
    origin, rotation = body.origin[::step], body.rotation[::step]
    moving = {
        name: np.einsum("nji,nj->ni", rotation, body.attachment(name).position[::step] - origin)
        for name in body.attachments
        if results.has(f"{at}/attachments/{name}/position")
    }
    pairs = [(a, b) for i, a in enumerate(moving) for b in list(moving)[:i]]
    if not pairs:
        return None
    b, a = max(pairs, key=lambda pair: float(np.linalg.norm(moving[pair[0]][0] - moving[pair[1]][0])))
    start, end = _undeformed(body, moving[a], step), _undeformed(body, moving[b], step)
    if not np.linalg.norm(end - start) > 0.0:
        return None
    return _Chord((a, b), start, end, moving[a] - start, moving[b] - end)


def _undeformed(body: BodyResults, moving: Array, step: int) -> Array:
    """Where an attachment is on the undeformed mesh, body frame.

    Its displacement in the first row follows from that of the nodes around it by a linear fit, exact where
    the nodes are made rigid; it is subtracted from its position in that row.
    """
    nodes, displacement = body.nodes, body.displacement[0]
    point = moving[0]
    near = np.argsort(np.linalg.norm(nodes + displacement - point, axis=1))[:_NEAREST]
    offsets = nodes[near] + displacement[near] - point
    scale = float(np.abs(offsets).max()) or 1.0
    terms = np.column_stack([np.ones(len(near)), offsets / scale])
    fit = np.linalg.lstsq(terms, displacement[near], rcond=1e-9)[0]
    return np.asarray(point - fit[0])


def _blocks(body: BodyResults, step: int) -> Iterator[tuple[int, Array]]:
    frames = body.displacement
    rows = range(0, len(frames), step)
    size = max(1, _BLOCK_BYTES // max(1, 8 * int(np.prod(frames.shape[1:]))))
    for first in range(0, len(rows), size):
        part = rows[first : first + size]
        yield first, frames[part.start : part.stop : step]


def _largest(vectors: Array) -> Array:
    """Largest length over the nodes: (k, nodes, 3) to (k,)."""
    return np.asarray(np.sqrt(np.einsum("kni,kni->kn", vectors, vectors).max(axis=1)))


def _extreme(time: Array, vectors: Array) -> Extreme:
    lengths = np.linalg.norm(vectors, axis=1)
    k = int(np.argmax(lengths))
    x, y, z = (float(value) for value in vectors[k])
    return Extreme(float(lengths[k]), float(time[k]), (x, y, z))

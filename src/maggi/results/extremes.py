"""The largest joint forces and elastic deflections of a run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .chord import chord
from .results import BodyResults, Results

Array = NDArray[np.float64]

_BLOCK_BYTES = 16 << 20


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


def deflection_extremes(results: Results, step: int = 1) -> tuple[DeflectionExtremes, ...]:
    """Largest displacement and deflection of every elastic body, looking at every `step`-th row."""
    listed: list[DeflectionExtremes] = []
    for name in elastic_bodies(results):
        history = deflection_history(results, name, step)
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


def deflection_history(results: Results, name: str, step: int = 1) -> DeflectionHistory:
    """Displacement and deflection of an elastic body over time.

    Parameters
    ----------
    step : look at every `step`-th row. (The nodal displacements of a long run may be larger than the memory;
        they are read block by block.)
    """
    body = results.body(name)
    time = results.time[::step]
    nodes = body.nodes
    line = chord(results, body, step)
    displacement = np.empty(len(time))
    deflection = None if line is None else np.empty(len(time))
    for first, block in _blocks(body, step):
        here = slice(first, first + len(block))
        displacement[here] = _largest(block)
        if line is not None and deflection is not None:
            deflection[here] = _largest(line.square(line.relative(nodes, block, here)))
    return DeflectionHistory(name, time, displacement, line.ends if line else None, deflection)


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

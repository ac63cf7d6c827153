"""Which motions the freedoms of a mechanism are: a readable basis of the velocities that its liaisons admit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import MotionState
from maggi.projection.maggi import project
from maggi.system.dense import dense_rows, floating_velocities, velocity_scale
from maggi.system.system import System

from .coordinates import coordinate_rates, joint_coordinate_list
from .snapshot import body_kind

Array = NDArray[np.float64]

_CLEAR = (
    0.05  # part of a candidate that the motions chosen before it must not contain; less only where nothing else is left
)
_LEAST = 1e-6
_DUST = 1e-9  # rates below this part of the largest are round-off
_TWIST = (
    *((f"displacement along {axis}", "m") for axis in "xyz"),
    *((f"rotation about {axis}", "rad") for axis in "xyz"),
)


@dataclass(frozen=True)
class Response:
    """What else moves: a coordinate of a joint or a body, by `rate` of its unit for each unit of the motion."""

    name: str
    quantity: str
    rate: float
    unit: str


@dataclass(frozen=True)
class Freedom:
    """One independent motion: the coordinate of a joint, or a component of a body's (global axes, its frame's origin).

    driver : what prescribes it, so that it is no freedom. The coordinates that the other motions are named after stand still.
    """

    of: Literal["joint", "body"]
    name: str
    quantity: str
    unit: str
    driver: str | None
    responses: tuple[Response, ...]


@dataclass(frozen=True)
class ElasticFreedoms:
    """How a body can bend: its kind (see `BodyReport`), how many coordinates, and their frequencies (Hz, nothing holding
    the body) where a reduction knows them.
    """

    body: str
    kind: str
    freedoms: int
    range: tuple[float, float] | None


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A coordinate that may name a motion: its rates (k,) on the basis, in m (angles by the mechanism's size)."""

    of: Literal["joint", "body"]
    name: str
    quantity: str
    unit: str
    driver: str | None
    row: Array


def freedoms(system: System, motion: MotionState) -> tuple[Freedom, ...]:
    """The motions that the joints admit with every elastic body rigid: of joint coordinates as far as those tell them apart.

    Preferred are driven coordinates, then those of joints on ground or prescribed frames, then joints with one
    coordinate; what no joint coordinate shows is told as motions of bodies.
    """
    frames = floating_velocities(system)
    passive = np.flatnonzero(~system.driven)
    scale = velocity_scale(system)[frames]
    S = project(dense_rows(system, motion, 0.0).A[np.ix_(passive, frames)], scale).S
    if S.shape[1] == 0:
        return ()
    basis = np.zeros((system.coordinates, S.shape[1]))
    basis[frames] = np.linalg.qr(scale[:, None] * S)[0] / scale[:, None]
    rates = coordinate_rates(system, motion, basis)
    chosen = _chosen([*_of_joints(system, rates), *_of_bodies(system, motion, basis)], S.shape[1])
    units = np.array([_length(one.unit, system.size) for one in chosen])
    change = np.linalg.inv(np.array([one.row for one in chosen]) / units[:, None])
    return tuple(
        Freedom(one.of, one.name, one.quantity, one.unit, one.driver, tuple(responses))
        for one, responses in zip(chosen, _responses(system, motion, basis, rates, chosen, change), strict=True)
    )


def elastic_freedoms(system: System) -> tuple[ElasticFreedoms, ...]:
    """Elastic coordinates of all bodies that have any."""
    found = []
    for entry in system.body_entries:
        b = entry.index
        mesh, reduced = system.mesh_bodies.get(b), system.reduced.get(b)
        count = int(system.bodies.offset[b + 1] - system.bodies.offset[b]) - 6
        if mesh is not None:
            count = mesh.size - 6 * int(system.bodies.floating[b])
        if count <= 0:
            continue
        elastic = np.empty(0) if reduced is None else reduced.shapes.frequencies[reduced.shapes.rigid :]
        span = (float(elastic[0]), float(elastic[-1])) if elastic.size else None
        found.append(ElasticFreedoms(entry.name, body_kind(system, b), count, span))
    return tuple(found)


def _of_joints(system: System, rates: Array) -> list[_Candidate]:
    """Joint coordinates, those first that are best to name a motion by."""
    drivers = {int(entry.coordinates[0]): entry.name for entry in system.liaison_entries if entry.kind == "driver"}
    fixed = {"ground", *(e.name for e in system.body_entries if not system.bodies.floating[e.index])}
    entries = {entry.name: entry for entry in system.liaison_entries}

    def order(one: tuple[int, _Candidate]) -> tuple[bool, bool, int]:
        index, candidate = one
        entry = entries[candidate.name]
        held = {end.partition(".")[0] for end in (entry.first, entry.second)} & fixed
        return index not in drivers, not held, len(entry.coordinates)

    listed = []
    for one in joint_coordinate_list(system):
        row = rates[one.index] * _length(one.unit, system.size)
        candidate = _Candidate("joint", one.joint, one.quantity, one.unit, drivers.get(one.index), row)
        listed.append((one.index, candidate))
    return [candidate for _, candidate in sorted(listed, key=order)]


def _of_bodies(system: System, motion: MotionState, basis: Array) -> Iterator[_Candidate]:
    for name, b in _floating(system):
        twist = _twist(system, motion, b, basis)
        for (quantity, unit), row in zip(_TWIST, twist, strict=True):
            yield _Candidate("body", name, quantity, unit, None, row * _length(unit, system.size))


def _floating(system: System) -> Iterator[tuple[str, int]]:
    """Bodies of the model whose frames float; helpers only where the model's own move nothing."""
    for visible in (True, False):
        for entry in system.body_entries:
            if entry.visible == visible and system.bodies.floating[entry.index]:
                yield entry.name, entry.index


def _twist(system: System, motion: MotionState, b: int, basis: Array) -> Array:
    """Velocity and angular velocity of a frame, global (6, k)."""
    o = int(system.bodies.offset[b])
    R = motion.rotation[b]
    return np.vstack([R @ basis[o : o + 3], R @ basis[o + 3 : o + 6]])


def _chosen(candidates: list[_Candidate], count: int) -> list[_Candidate]:
    """Candidates whose rows are independent, as many as there are motions."""
    chosen: list[_Candidate] = []
    known = np.zeros((count, 0))
    # coordinates of joints down to round-off before any body's: a body moves whatever its joints do
    for of, least in (("joint", _CLEAR), ("joint", _LEAST), ("body", _CLEAR), ("body", _LEAST)):
        for one in candidates:
            if one.of != of or len(chosen) == count:
                continue
            size = float(np.linalg.norm(one.row))
            rest = one.row - known @ (known.T @ one.row)
            rest -= known @ (known.T @ rest)
            left = float(np.linalg.norm(rest))
            if size > _LEAST and left > least * size:
                known = np.column_stack([known, rest / left])
                chosen.append(one)
    assert len(chosen) == count  # a velocity that moves no frame is none
    return chosen


def _responses(
    system: System, motion: MotionState, basis: Array, rates: Array, chosen: list[_Candidate], change: Array
) -> Iterator[list[Response]]:
    """What moves along with each chosen motion: other joint coordinates and, with a body's, the rest of its motion."""
    names = {(one.of, one.name, one.quantity) for one in chosen}
    rates = rates @ change
    bodies = dict(_floating(system))
    for k, one in enumerate(chosen):
        found = [
            Response(other.joint, other.quantity, float(rates[other.index, k]), other.unit)
            for other in joint_coordinate_list(system)
            if ("joint", other.joint, other.quantity) not in names
        ]
        if one.of == "body":
            twist = _twist(system, motion, bodies[one.name], basis) @ change[:, k]
            found += [
                Response(one.name, quantity, float(rate), unit)
                for (quantity, unit), rate in zip(_TWIST, twist, strict=True)
                if ("body", one.name, quantity) not in names
            ]
        least = _DUST * max((abs(x.rate) * _length(x.unit, system.size) for x in found), default=0.0)
        least = max(least, _DUST * _length(one.unit, system.size))
        yield [x for x in found if abs(x.rate) * _length(x.unit, system.size) > least]


def _length(unit: str, size: float) -> float:
    """Metres that one unit of a coordinate counts as."""
    return size if unit == "rad" else 1.0

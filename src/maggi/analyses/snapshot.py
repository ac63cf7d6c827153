"""What the results keep of a system: its layout once, and rows at the output times."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.small_bodies import SmallBodyEnergies
from maggi.bodies.tables import MESH, RITZ
from maggi.liaisons.tables import COORDINATE_KIND, CURVE_FACE, CURVE_POINT, END_ATTACHMENT, TRANSLATION
from maggi.projection.redundancy import least_norm
from maggi.stepping.allocate import geometric_metric
from maggi.stepping.tables import ITERATIONS, REPEATED, Instant, Record
from maggi.system.system import LiaisonEntry, System

from .build_outline import build_outline
from .recorder import BodyLayout, JointLayout, Layout, Rows

if TYPE_CHECKING:
    from maggi.stepping.mesh_step import MeshStep

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_KINDS = {RITZ: "ritz", MESH: "mesh"}


def body_kind(system: System, body: int) -> str:
    """What the results call a body, by its row: ``rigid``, ``mesh``, ``reduced`` or ``ritz``."""
    return "reduced" if body in system.reduced else _KINDS.get(int(system.bodies.kind[body]), "rigid")


def layout(system: System, rows: int, attributes: dict[str, str | float | int]) -> Layout:
    """The shape of every row of a run."""
    bodies = []
    for entry in system.body_entries:
        if not entry.visible:
            continue
        mesh, reduced = system.mesh(entry.index), system.reduced.get(entry.index)
        kind = body_kind(system, entry.index)
        attachments = [a for a in system.attachment_entries if a.body == entry.name]
        bodies.append(
            BodyLayout(
                entry.name,
                kind,
                tuple(a.name for a in attachments),
                system.bodies.attachment_point[[a.index for a in attachments]].reshape(-1, 3),
                nodes=None if mesh is None else mesh.mesh.nodes,
                cells=None if mesh is None else mesh.mesh.cells,
                modes=_elastic(system, entry.index) if kind in ("ritz", "reduced") else 0,
                basis=None if reduced is None else reduced.nodal_basis(),
            )
        )
    joints = tuple(
        JointLayout(
            entry.name,
            entry.kind,
            entry.first,
            entry.second,
            tuple(coordinate_unit(int(system.liaisons.coordinate[c, COORDINATE_KIND])) for c in entry.coordinates),
            build_outline(system, entry),
        )
        for entry in visible_liaisons(system)
    )
    return Layout(tuple(bodies), joints, rows, attributes, system.model.gravity)


def coordinate_unit(kind: int) -> str:
    """Unit of a joint coordinate; that of a curve's parameter is the curve's own affair."""
    return "m" if kind == TRANSLATION else "1" if kind in (CURVE_POINT, CURVE_FACE) else "rad"


def visible_liaisons(system: System) -> list[LiaisonEntry]:
    """The joints and drivers of the model, without those that the program added."""
    return [entry for entry in system.liaison_entries if entry.visible]


def next_row(done: int, steps: int, every: int) -> int:
    """The nominal step after `done` that ends with a row: one of every so many, and the last."""
    return min(steps, (done // every + 1) * every)


class Present(Protocol):
    """A run as it stands: what rows are made of.

    state: the present instant. record: instants that were kept before. meshes: of bodies with nodal freedoms.
    last_iterations: what the last step, or row, has cost.
    """

    @property
    def system(self) -> System: ...
    @property
    def state(self) -> Instant: ...
    @property
    def record(self) -> Record: ...
    @property
    def meshes(self) -> Sequence[MeshStep]: ...
    @property
    def last_iterations(self) -> int: ...

    def dissipated(self) -> float:
        """Energy (J) that damping has taken up to the present."""


class Snapshots:
    """Makes rows of the instants of a run, of many at once: each by itself would cost as much as several steps."""

    def __init__(self, run: Present) -> None:
        system = run.system
        self._run = run
        self._bodies = [entry for entry in system.body_entries if entry.visible]
        order = [[a.index for a in system.attachment_entries if a.body == entry.name] for entry in self._bodies]
        self._attachments = np.array([index for part in order for index in part], dtype=np.int64)
        self._indices = np.array([entry.index for entry in self._bodies], dtype=np.int64)
        self._liaisons = visible_liaisons(system)
        self._seconds = np.array([entry.reference for entry in self._liaisons], dtype=np.int64)
        self.shared: dict[str, None] = {}  # joints whose forces were not unique at some row, in order
        # elastic rotation |θ| (rad) of a meshed body's attachment so far, and which it is
        self.largest_rotation = 0.0, ""
        self._meshes: dict[int, MeshStep] = {mesh.index: mesh for mesh in run.meshes}
        self._liaison, self._row, self._end = _shares(system, self._liaisons)
        self._exerting, self._starts = np.unique(self._liaison, return_index=True)
        bodies = system.bodies
        self._small = SmallBodyEnergies(bodies, system.forces.gravity)
        self._modal = [
            slice(int(bodies.offset[b]) + 6, int(bodies.offset[b + 1])) for b in self._indices if bodies.kind[b] == RITZ
        ]
        self._visible_meshes = [self._meshes[int(b)] for b in self._indices if bodies.kind[b] == MESH]
        counts = [len(entry.coordinates) for entry in self._liaisons]
        self._coordinates = np.array([c for entry in self._liaisons for c in entry.coordinates], dtype=np.int64)
        self._of_liaison = [slice(end - count, end) for count, end in zip(counts, accumulate(counts), strict=True)]
        self._of_meshes: list[tuple[list[Array], Array]] = []  # displacements and energies at every instant kept
        self._metric: Array | None = None  # where rows repeat each other

    def take(self, step: int) -> None:
        """Keep the present instant, at the end of a nominal step."""
        run = self._run
        run.dissipated()  # brings the balance of damping up to date
        run.state.counts[ITERATIONS] = run.last_iterations
        if self._meshes:
            gravity = run.system.forces.gravity
            energies = np.sum([mesh.energies(run.state.now, gravity) for mesh in run.meshes], axis=0)
            shown = [mesh.body.nodal_displacement(mesh.u) for mesh in self._visible_meshes]
            self._of_meshes.append((shown, energies))
        run.record.keep(run.state, step)

    def rows(self, step: float) -> Rows:
        """Rows of all instants kept, which are forgotten. step (s): the nominal one."""
        record, state = self._run.record, self._run.state
        now, at = state.now, state.attachments
        del self._of_meshes[record.kept :]  # of an instant that an interrupt kept from being kept
        position = record.values(state, at.position)
        e = record.values(state, now.e)
        coordinate = record.values(state, state.rows.coordinate)[:, self._coordinates, 0]
        force, torque, unique = self._joint_forces()
        self._watch_rotations(e)
        chosen = self._attachments
        rows = Rows(
            record.steps[: record.kept] * np.float64(step),
            record.values(state, now.origin)[:, self._indices],
            record.values(state, now.rotation)[:, self._indices],
            position[:, chosen],
            record.values(state, at.rotation)[:, chosen],
            record.values(state, at.velocity)[:, chosen],
            record.values(state, at.angular_velocity)[:, chosen],
            tuple(np.array([shown[k] for shown, _ in self._of_meshes]) for k in range(len(self._visible_meshes))),
            tuple(e[:, part].copy() for part in self._modal),
            position[:, self._seconds],
            force,
            torque,
            unique,
            tuple(coordinate[:, part] for part in self._of_liaison),
            self._energies(e),
            record.values(state, state.residuals).copy(),
            record.values(state, state.counts)[:, ITERATIONS].astype(np.int64),
        )
        self._of_meshes.clear()
        record.clear()
        return rows

    def _energies(self, e: Array) -> Array:
        """Kinetic, strain (springs included), gravity energy, energy dissipated, work (m, 5), J."""
        record, state = self._run.record, self._run.state
        now = state.now
        origin, rotation, v = (record.values(state, part) for part in (now.origin, now.rotation, now.v))
        result = np.empty((len(e), 5))
        result[:, :3] = self._small.at(origin, rotation, e, v)[:, :3]
        result[:, 1] += record.values(state, state.power)[:, 0]
        work = record.values(state, state.work)
        result[:, 3], result[:, 4] = work[:, 1], work[:, 0]
        for k, (_, of_meshes) in enumerate(self._of_meshes):
            result[k, :3] += of_meshes
        return result

    def _watch_rotations(self, e: Array) -> None:
        """Look for a larger elastic rotation of an attachment than there was before."""
        system = self._run.system
        for index in (*self._meshes, *system.reduced):
            body = system.mesh(index)
            assert body is not None
            turns = e[:, system.bodies.offset[index] + 6 : system.bodies.offset[index + 1]]
            if index in system.reduced:
                turns = turns @ system.reduced[index].psi.reshape(-1, turns.shape[1]).T
            for k, coupling in enumerate(body.couplings):
                angle = float(np.linalg.norm(turns[:, 6 * k + 3 : 6 * k + 6], axis=1).max(initial=0.0))
                if angle > self.largest_rotation[0]:
                    self.largest_rotation = angle, f"{body.name}.{coupling.name}"

    def _joint_forces(self) -> tuple[Array, Array, IntArray]:
        """Force and torque of first on second at the joint's point on second, global (T11), and which are unique; (m, j, …).

        They are minus the rows' shares in Aᵀλ, of least norm where rows repeat each other.
        """
        record, state = self._run.record, self._run.state
        multipliers = record.values(state, state.multipliers)
        unique = np.ones((len(multipliers), len(self._liaisons)), dtype=np.int64)
        repeated = np.flatnonzero(record.values(state, state.counts)[:, REPEATED])
        if repeated.size:
            multipliers = multipliers.copy()
            multipliers[repeated], sure = self._least_norm(repeated, multipliers[repeated])
            for j, entry in enumerate(self._liaisons):
                unique[repeated, j] = sure[:, entry.rows].all(axis=1)
                if not unique[:, j].all():
                    self.shared[entry.name] = None
        wrench = np.zeros((len(multipliers), len(self._liaisons), 6))
        if self._liaison.size:
            shares = record.values(state, state.rows.wrench)[:, self._end]
            shares *= -multipliers[:, self._row, None]
            wrench[:, self._exerting] = np.add.reduceat(shares, self._starts, axis=1)
        return wrench[..., :3], wrench[..., 3:], unique

    def _least_norm(self, places: IntArray, multipliers: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Of instants where rows repeat each other; see `least_norm`."""
        system, record, state = self._run.system, self._run.record, self._run.state
        if self._metric is None:
            self._metric = geometric_metric(system)
        A, active = record.values(state, state.rows.A)[places], record.values(state, state.active)[places]
        return least_norm(system.liaisons, system.bodies, A, self._metric, active, multipliers, system.size)


def _shares(system: System, liaisons: list[LiaisonEntry]) -> tuple[IntArray, IntArray, IntArray]:
    """What joints exert on their second bodies is made of: liaison, row and end of every share, (s,) each."""
    table = system.liaisons
    found = [
        (j, row, end)
        for j, entry in enumerate(liaisons)
        for row in entry.rows
        for end in range(table.end_start[row], table.end_start[row + 1])
        if table.end[end, END_ATTACHMENT] == entry.reference
    ]
    liaison, row, end = np.array(found, dtype=np.int64).reshape(-1, 3).T
    return liaison, row, end


def _elastic(system: System, body: int) -> int:
    return int(system.bodies.offset[body + 1] - system.bodies.offset[body]) - 6

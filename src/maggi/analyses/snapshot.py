"""What the results keep of a system: its layout once, and a row at every output time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.small_bodies import small_body_energy
from maggi.bodies.tables import MESH, RITZ
from maggi.liaisons.tables import COORDINATE_KIND, CURVE_FACE, CURVE_POINT, END_ATTACHMENT, TRANSLATION
from maggi.stepping.tables import Instant
from maggi.system.system import LiaisonEntry, System

from .build_outline import build_outline
from .recorder import BodyLayout, JointLayout, Layout, Row

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


class Present(Protocol):
    """A run as it stands: what rows are made of.

    state: motion, attachments, rows, the energy stored in springs (`power`), work (the first of `work`). meshes: of bodies with nodal freedoms. last_iterations: what the last step, or row, has cost.
    """

    @property
    def system(self) -> System: ...
    @property
    def state(self) -> Instant: ...
    @property
    def meshes(self) -> Sequence[MeshStep]: ...
    @property
    def last_iterations(self) -> int: ...

    def dissipated(self) -> float:
        """Energy (J) that damping has taken up to the present."""

    def residuals(self) -> Array:
        """Scaled liaison residuals at position, velocity and acceleration level, (3,)."""

    def multipliers(self) -> tuple[Array, NDArray[np.bool_]]:
        """λ (r,) of least norm (T11), and which are unique (r,)."""


class Snapshots:
    """Makes rows of a run's present state."""

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
        self._meshes: dict[int, MeshStep] = {mesh.index: mesh for mesh in run.meshes}
        self._shares = _shares(system, self._liaisons)
        bodies = system.bodies
        self._modal = [
            slice(int(bodies.offset[b]) + 6, int(bodies.offset[b + 1])) for b in self._indices if bodies.kind[b] == RITZ
        ]
        self._visible_meshes = [self._meshes[int(b)] for b in self._indices if bodies.kind[b] == MESH]
        counts = [len(entry.coordinates) for entry in self._liaisons]
        self._coordinates = np.array([c for entry in self._liaisons for c in entry.coordinates], dtype=np.int64)
        self._of_liaison = [slice(end - count, end) for count, end in zip(counts, accumulate(counts), strict=True)]

    def row(self, t: float) -> Row:
        """The present state at time t."""
        run = self._run
        state = run.state
        motion, at = state.now, state.attachments
        force, torque, unique = self._joint_forces()
        self.shared |= {entry.name: None for entry, sure in zip(self._liaisons, unique, strict=True) if not sure}
        coordinate = state.rows.coordinate[self._coordinates, 0]
        chosen = self._attachments
        return Row(
            t,
            motion.origin[self._indices],
            motion.rotation[self._indices],
            at.position[chosen],
            at.rotation[chosen],
            at.velocity[chosen],
            at.angular_velocity[chosen],
            tuple(mesh.body.nodal_displacement(mesh.u) for mesh in self._visible_meshes),
            tuple(motion.e[part].copy() for part in self._modal),
            at.position[self._seconds],
            force,
            torque,
            unique,
            tuple(coordinate[part] for part in self._of_liaison),
            self.energies(),
            run.residuals(),
            run.last_iterations,
        )

    def energies(self) -> Array:
        """Kinetic, strain (springs included), gravity energy, energy dissipated, work (5,), J."""
        run = self._run
        state, gravity = run.state, run.system.forces.gravity
        small = small_body_energy(run.system.bodies, state.now, gravity)
        result = np.array([small[0], small[1] + state.power[0], small[2], run.dissipated(), state.work[0]])
        for mesh in run.meshes:
            result[:3] += mesh.energies(state.now, gravity)
        return result

    def largest_rotation(self) -> tuple[float, str]:
        """The largest elastic rotation |θ| (rad) of a meshed body's attachment, and which attachment it is."""
        system, e = self._run.system, self._run.state.now.e
        largest, name = 0.0, ""
        for index in (*self._meshes, *system.reduced):
            body = system.mesh(index)
            assert body is not None
            turns = e[system.bodies.offset[index] + 6 : system.bodies.offset[index + 1]]
            if index in system.reduced:
                turns = (system.reduced[index].psi @ turns).ravel()
            for k, coupling in enumerate(body.couplings):
                angle = float(np.linalg.norm(turns[6 * k + 3 : 6 * k + 6]))
                if angle > largest:
                    largest, name = angle, f"{body.name}.{coupling.name}"
        return largest, name

    def _joint_forces(self) -> tuple[Array, Array, IntArray]:
        """Force and torque of first on second at the joint's point on second, global (T11), and which are unique.

        They are minus the rows' shares in Aᵀλ, of least norm where rows repeat each other.
        """
        multipliers, sure = self._run.multipliers()
        liaison, row, end = self._shares
        wrench = np.zeros((len(self._liaisons), 6))
        np.subtract.at(wrench, liaison, multipliers[row, None] * self._run.state.rows.wrench[end])
        unique = np.ones(len(self._liaisons), dtype=np.int64)
        if not sure.all():
            for j, entry in enumerate(self._liaisons):
                unique[j] = sure[entry.rows].all()
        return wrench[:, :3], wrench[:, 3:], unique


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

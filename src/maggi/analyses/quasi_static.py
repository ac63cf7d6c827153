"""The quasi-static start: elastic bodies in balance with the inertia and joint forces of the rigid motion (Theory §2).

A part that starts undeformed under finite loads rings with the full amplitude of its forces, however stiff it is.
So u is found from ``Pᵀ(K u + M a) = liaison forces`` with the relative accelerations left out, and u̇ as the
rate of that u along the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import attachment_motion, move
from maggi.bodies.motions import prescribe
from maggi.bodies.small_bodies import body_residual
from maggi.bodies.tables import FIXED, MESH, RITZ, MotionState
from maggi.forces.kernels import applied_forces
from maggi.liaisons.kernels import evaluate_rows
from maggi.model.bodies import RitzBody
from maggi.model.errors import SimulationError
from maggi.stepping.allocate import copy_motion
from maggi.stepping.mesh_step import MeshStep
from maggi.system.dense import dense_mass, dense_rows, floating_velocities, new_attachments, new_rows
from maggi.system.system import System

from .static_response import StaticResponse

Array = NDArray[np.float64]

ATTEMPTS = 40
SETTLED = 1e-10  # change of an iteration, relative to the largest displacement
STALLED = 1e-6  # the same where it no longer falls


@dataclass(frozen=True, eq=False)
class _Static:
    """A body's static response: elastic small coordinates from forces on them, with 6 rigid motions if not floating.

    W (n_e, n_e): static compliance; rigid (n_e, k): elastic coordinates of rigid motions, k = 6 or 0.
    """

    index: int
    W: Array
    rigid: Array


class QuasiStatic:
    """Static balance of all elastic bodies of a system at a given motion of the frames."""

    def __init__(self, system: System, meshes: list[MeshStep]) -> None:
        self._system = system
        self._meshes = {mesh.index: mesh for mesh in meshes}
        responses: dict[str, StaticResponse] = {}
        self._responses: dict[int, StaticResponse] = {}
        for mesh in meshes:
            if mesh.body.likeness not in responses:
                responses[mesh.body.likeness] = StaticResponse(mesh.body, mesh.shared)
            self._responses[mesh.index] = responses[mesh.body.likeness]
        self._bodies = [self._static(b) for b in _elastic(system)]
        self._multipliers = np.zeros(system.rows)
        self._twist_rates = np.zeros(system.coordinates)

    def deform(self, motion: MotionState, t: float) -> dict[int, Array]:
        """Put `motion` in balance at time t: positions, elastic coordinates and frames' accelerations, in place.

        Returns the meshed bodies' displacements u by row. Raises SimulationError where there is no balance.
        """
        system = self._system
        moving = floating_velocities(system)
        fields = {index: mesh.u.copy() for index, mesh in self._meshes.items()}
        change = previous = np.inf
        loads = self._loads(self._undeformed(motion), t)
        for _ in range(ATTEMPTS):
            before, previous = (motion.e.copy(), *fields.values()), change
            try:
                fields = self._improve(motion, t, moving, fields, loads)
            except np.linalg.LinAlgError:  # of equations that are no longer finite
                change = np.inf
                break
            after = (motion.e, *fields.values())
            reach = max(float(np.abs(part).max(initial=0.0)) for part in after)
            change = max(float(np.abs(b - a).max(initial=0.0)) for a, b in zip(before, after, strict=True))
            if not np.isfinite(change):
                break
            # what no longer falls is round-off, of joints that hold stiff bodies against each other, too
            stalled = change >= 0.1 * previous
            if change <= max((STALLED if stalled else SETTLED) * reach, 1e-16 * system.size):
                return fields
        raise SimulationError(
            f"no static balance of the elastic bodies was found at the start (last change {change:.3g} m); "
            "use `start: undeformed`, or check that the joints hold every prescribed body"
        )

    def _improve(
        self, motion: MotionState, t: float, moving: NDArray[np.int64], fields: dict[int, Array], loads: Array
    ) -> dict[int, Array]:
        """One step of Newton's method on frames' accelerations, liaison forces, elastic and rigid displacements."""
        system = self._system
        bodies, n, r = system.bodies, system.coordinates, system.rows
        motion.vd[moving] = self._twist_rates[moving]
        rows = dense_rows(system, motion, t)
        holonomic = system.holonomic
        residual, free = self._inertia(motion, fields)
        applied = rows.A.T @ self._multipliers - loads
        # elastic coordinates that the present inertia alone gives, e₀, and per unit multipliers
        target = motion.e.copy()  # which bodies with given initial values keep
        compliance = np.zeros((n, n))
        rigid_columns, rigid_rows = [], []
        for body in self._bodies:
            part = slice(bodies.offset[body.index] + 6, bodies.offset[body.index + 1])
            compliance[part, part] = body.W
            target[part] = free[body.index][1] - body.W @ applied[part]
            for k in range(body.rigid.shape[1]):
                column = np.zeros(n)
                column[part] = body.rigid[:, k]
                rigid_columns.append(column)
                rigid_rows.append(free[body.index][2][k] + column @ applied)
        Phi_e = np.array(rigid_columns).reshape(-1, n).T
        A_t, A_e = rows.A[:, moving], rows.A.copy()
        A_e[:, moving] = 0.0
        nt, k = moving.size, Phi_e.shape[1]
        h = int(holonomic.sum())
        matrix = np.zeros((nt + r + h + k, nt + r + nt + k))
        right = np.zeros(nt + r + h + k)
        frame, force, shift, drift = (
            slice(0, nt),
            slice(nt, nt + r),
            slice(nt + r, 2 * nt + r),
            slice(2 * nt + r, 2 * nt + r + k),
        )
        first, second, third, fourth = (
            slice(0, nt),
            slice(nt, nt + r),
            slice(nt + r, nt + r + h),
            slice(nt + r + h, nt + r + h + k),
        )
        matrix[first, frame] = dense_mass(system, motion)[np.ix_(moving, moving)]
        matrix[first, force] = A_t.T
        right[first] = -(residual + applied)[moving]
        matrix[second, frame] = A_t
        right[second] = -rows.acceleration
        matrix[third, force] = -(A_e @ compliance @ rows.A.T)[holonomic]
        matrix[third, shift] = A_t[holonomic]
        matrix[third, drift] = (A_e @ Phi_e)[holonomic]
        right[third] = -(rows.position + A_e @ (target - motion.e))[holonomic]
        matrix[fourth, force] = Phi_e.T @ A_e.T
        right[fourth] = -np.array(rigid_rows)
        x = _least_squares(matrix, right)
        self._twist_rates[moving] += x[frame]
        motion.vd[moving] = self._twist_rates[moving]
        self._multipliers += x[force]
        applied = rows.A.T @ self._multipliers - loads
        increment = np.zeros(n)
        increment[moving] = x[shift]
        move(bodies, copy_motion(motion), increment, motion)
        result = {}
        cursor = 0
        for body in self._bodies:
            part = slice(bodies.offset[body.index] + 6, bodies.offset[body.index + 1])
            a = x[drift][cursor : cursor + body.rigid.shape[1]]
            cursor += body.rigid.shape[1]
            motion.e[part] = free[body.index][1] - body.W @ applied[part] + body.rigid @ a
            if body.index in self._meshes:
                u = free[body.index][0] - applied[part] @ self._responses[body.index].Y
                if a.size:
                    u = u + self._meshes[body.index].body.Phi @ a
                result[body.index] = u
        return result

    def admit_rates(self, motion: MotionState, rates: dict[int, Array]) -> None:
        """Correct elastic rates, in place, so that with some velocities of the frames they satisfy all liaisons.

        Differences of balanced positions do so up to their own error only, and where elastic bodies are held at both
        ends no motion of the frames can take that up. The change is that of least strain, ``ė −= W Aₑᵀκ``, Aₜᵀκ = 0.
        """
        system = self._system
        bodies, moving = system.bodies, floating_velocities(system)
        rows = dense_rows(system, motion, 0.0)
        A_t, A_e = rows.A[:, moving], rows.A.copy()
        A_e[:, moving] = 0.0
        Y = np.zeros((system.coordinates, system.coordinates))
        for body in self._bodies:
            part = slice(bodies.offset[body.index] + 6, bodies.offset[body.index + 1])
            Y[part, part] = body.W + body.rigid @ body.rigid.T
        nt, r = moving.size, system.rows
        matrix = np.zeros((nt + r, nt + r))
        matrix[:nt, nt:] = A_t.T
        matrix[nt:, :nt] = A_t
        matrix[nt:, nt:] = -(A_e @ Y @ A_e.T)
        kappa = _least_squares(matrix, np.concatenate([np.zeros(nt), -rows.velocity]))[nt:]
        force = A_e.T @ kappa
        for body in self._bodies:
            part = slice(bodies.offset[body.index] + 6, bodies.offset[body.index + 1])
            motion.v[part] -= Y[part, part] @ force[part]
            if body.index in self._meshes:
                rates[body.index] -= force[part] @ self._responses[body.index].Y
                if body.rigid.shape[1]:
                    rates[body.index] -= self._meshes[body.index].body.Phi @ (body.rigid.T @ force[part])

    def _undeformed(self, motion: MotionState) -> MotionState:
        """The motion with its elastic bodies as they are without load.

        Applied forces are those of the rigid motion: a stiff spring at a free mechanism would otherwise have the
        mechanism's position, which is given, follow from its force.
        """
        rigid = copy_motion(motion)
        for body in self._bodies:
            part = slice(self._system.bodies.offset[body.index] + 6, self._system.bodies.offset[body.index + 1])
            rigid.e[part] = 0.0
            rigid.v[part] = 0.0
        return rigid

    def _loads(self, motion: MotionState, t: float) -> Array:
        system = self._system
        if system.forces.empty:
            return np.zeros(system.coordinates)
        attachments = new_attachments(system.bodies.attachment_body.size)
        rows = new_rows(system)
        attachment_motion(system.bodies, motion, attachments)
        evaluate_rows(system.liaisons, system.bodies, motion, attachments, rows, t)
        Q = np.zeros(system.coordinates)
        applied_forces(system.forces, system.bodies, system.liaisons, motion, attachments, rows, t, Q, np.zeros(3))
        return Q

    def _inertia(
        self, motion: MotionState, fields: dict[int, Array]
    ) -> tuple[Array, dict[int, tuple[Array, Array, Array]]]:
        """Frames' residuals, and each elastic body's free static response: field, small coordinates, rigid forces."""
        system = self._system
        bodies, gravity = system.bodies, system.forces.gravity
        residual = np.zeros(system.coordinates)
        for b in range(bodies.kind.size):
            if bodies.kind[b] in (FIXED, MESH):
                continue
            residual[bodies.offset[b] : bodies.offset[b + 1]] = body_residual(bodies, b, motion, gravity)
        free: dict[int, tuple[Array, Array, Array]] = {}
        for body in self._bodies:
            o, e = int(bodies.offset[body.index]), int(bodies.offset[body.index + 1])
            if body.index not in self._meshes:
                n = e - o - 6
                q = int(bodies.ritz_square[body.index])
                k = bodies.k[q : q + n * n].reshape(n, n)
                inertia = residual[o + 6 : e] - k @ motion.e[o + 6 : e]
                free[body.index] = (np.empty(0), -body.W @ inertia, body.rigid.T @ inertia)
                continue
            mesh = self._meshes[body.index]
            zero = np.zeros(mesh.body.size)
            nodal, frame = np.empty(mesh.body.size), np.empty(6)
            v, w = motion.v[o : o + 3], motion.v[o + 3 : o + 6]
            a_O = motion.vd[o : o + 3] + np.cross(w, v) - motion.rotation[body.index].T @ gravity
            drive = np.array((a_O, w, motion.vd[o + 3 : o + 6]))
            mesh.body.inertia.forces(fields[body.index], zero, zero, nodal).residual(drive, frame)
            residual[o : o + 6] = frame
            u = -self._responses[body.index].displacements(nodal[None])[0]
            rigid = mesh.body.Phi.T @ nodal if body.rigid.shape[1] else np.empty(0)
            free[body.index] = (u, np.asarray(mesh.body.B.T @ u), rigid)
        return residual, free

    def _static(self, b: int) -> _Static:
        bodies = self._system.bodies
        if b in self._system.reduced:
            reduced = self._system.reduced[b]
            return _Static(b, reduced.static_compliance(), reduced.rigid_motions())
        if b not in self._meshes:
            n = int(bodies.offset[b + 1] - bodies.offset[b]) - 6
            q = int(bodies.ritz_square[b])
            W = np.linalg.pinv(bodies.k[q : q + n * n].reshape(n, n), rcond=1e-12, hermitian=True)
            return _Static(b, np.asarray(W, dtype=np.float64), np.empty((n, 0)))
        body = self._meshes[b].body
        W = self._responses[b].W
        rigid = np.zeros((W.shape[0], 0)) if body.floating else np.asarray(body.B.T @ body.Phi)
        return _Static(b, W, rigid)


def quasi_static_start(system: System, motion: MotionState, meshes: list[MeshStep], dt: float) -> None:
    """Set u, u̇ of the meshes, and e, ė of `motion`, to the static balance along the motion that starts at t = 0.

    dt (s): the difference step of the rates. The motion is continued with the accelerations of the balance.
    """
    if not _elastic(system):
        return
    static = QuasiStatic(system, meshes)
    fields = static.deform(motion, 0.0)
    moving = floating_velocities(system)
    states = [(motion.e.copy(), fields)]
    for k in (1, 2):
        ahead = copy_motion(motion)
        increment = np.zeros(system.coordinates)
        increment[moving] = k * dt * motion.v[moving] + 0.5 * (k * dt) ** 2 * motion.vd[moving]
        move(system.bodies, motion, increment, ahead)
        ahead.v[moving] = motion.v[moving] + k * dt * motion.vd[moving]
        prescribe(system.motions, system.bodies, k * dt, ahead)
        field = static.deform(ahead, k * dt)
        states.append((ahead.e.copy(), field))
    elastic = np.flatnonzero(_elastic_mask(system))
    motion.v[elastic] = _rate([state[0] for state in states], dt)[elastic]
    rates = {mesh.index: _rate([state[1][mesh.index] for state in states], dt) for mesh in meshes}
    static.admit_rates(motion, rates)
    for mesh in meshes:
        mesh.u[:], mesh.ud[:] = fields[mesh.index], rates[mesh.index]


def _rate(values: list[Array], dt: float) -> Array:
    """Rate at the first of three equidistant values, second order."""
    first, second, third = values
    return np.asarray((-1.5 * first + 2.0 * second - 0.5 * third) / dt)


def _elastic(system: System) -> list[int]:
    """Rows of the bodies that are to be deformed: those with elastic coordinates and no initial values of their own."""
    bodies = system.bodies
    given = {
        entry.index
        for entry in system.body_entries
        if isinstance(body := system.model.bodies.get(entry.name), RitzBody) and body.initial is not None
    }
    return [
        b
        for b in range(bodies.kind.size)
        if bodies.kind[b] in (RITZ, MESH) and bodies.offset[b + 1] - bodies.offset[b] >= 6 and b not in given
    ]


def _elastic_mask(system: System) -> NDArray[np.bool_]:
    mask = np.zeros(system.coordinates, dtype=bool)
    for b in _elastic(system):
        mask[system.bodies.offset[b] + 6 : system.bodies.offset[b + 1]] = True
    return mask


def _least_squares(matrix: Array, right: Array) -> Array:
    """Minimum-norm least squares after equilibration: unknowns and equations are of very different units."""
    rows, columns = np.ones(matrix.shape[0]), np.ones(matrix.shape[1])
    for _ in range(6):
        scaled = np.abs(rows[:, None] * matrix * columns)
        high = scaled.max(axis=1, initial=0.0)
        rows /= np.sqrt(np.where(high > 0.0, high, 1.0))
        high = scaled.max(axis=0, initial=0.0)
        columns /= np.sqrt(np.where(high > 0.0, high, 1.0))
    solution = np.linalg.lstsq(rows[:, None] * matrix * columns, rows * right, rcond=1e-13)[0]
    return np.asarray(columns * solution)

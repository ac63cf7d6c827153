"""One step for every mechanism: the small system's kernels, and around them full-mesh bodies' back-substitutions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numba
import numpy as np
from numpy.typing import NDArray

from maggi.bodies.small_bodies import body_mass
from maggi.bodies.tables import MESH, RITZ
from maggi.integrators.generalized_alpha import GeneralizedAlpha, generalized_alpha, instantaneous
from maggi.linalg.lanes import WIDTH
from maggi.model.errors import SimulationError
from maggi.projection.relative_motion import relative_motion
from maggi.projection.relative_system import RelativeSystem, relative_system
from maggi.system.dense import dense_rows
from maggi.system.system import System

from . import iteration
from .allocate import elastic_compliances, new_instant, new_record, new_state, new_work, small_system
from .failures import almost_flat, why_undefined
from .instant_kernels import show, to_model
from .linking import link
from .policy import MOST, SolvePolicy
from .residuals import local_error
from .tables import BEST, BOUND, CALM, ERROR, EVERY, HIGHEST_ORDER, LAST, NUMBER, ORDER

if TYPE_CHECKING:
    from .mesh_groups import MeshGroup

Array = NDArray[np.float64]

# The tolerance is for positions, relative to the size, and this many times as large for nodal accelerations: one more
# back-substitution in smooth motion changes neither (see docs/decisions.md).
FORCE_SHARE = 1e3
MOST_KEPT = 256  # instants
SETTLE = 10  # steps after which displacements of meshes are put on mean axes again: round-off by then, and below it


@dataclass
class Counts:
    """What a run has cost: steps, corrections of the small system, back-substitutions of each meshed body, and
    factorisations and restarts in all; steps not accepted because of their local error.
    """

    steps: int = 0
    corrections: int = 0
    back_substitutions: int = 0
    factorisations: int = 0
    restarts: int = 0
    rejected: int = 0


class Stepper:
    """Advances a system in time.

    Parameters
    ----------
    system : the mechanism. rho_inf : generalised-α's spectral radius at infinity. tolerance : relative error that the
        iteration of a step may leave.
    least_speed, least_acceleration : what residuals are scaled with where nothing moves (m/s, m/s²).
    exact : iterate every step to round-off instead of counting on smooth motion.
    """

    def __init__(
        self,
        system: System,
        rho_inf: float,
        tolerance: float,
        least_speed: float,
        least_acceleration: float,
        *,
        exact: bool = False,
        announce: Callable[[str], None] = lambda text: None,
    ) -> None:
        self.system = system
        self.relative = relative_system(system)
        self.small = small_system(system, self.relative)
        self.state = new_instant(system, least_speed, least_acceleration)
        self.trial = new_state(system, self.relative, self.state)
        self.tried = new_instant(system, least_speed, least_acceleration)
        self.record = new_record(self.state, 1 if (system.bodies.kind == MESH).any() else MOST_KEPT)
        self.work = new_work(system, self.relative)
        self.mesh_groups = _mesh_groups(system, self.relative)
        self.meshes = sorted((m for group in self.mesh_groups for m in group.meshes), key=lambda mesh: mesh.index)
        self.counts = Counts()
        self.policy = SolvePolicy(exact=exact)
        self.coefficients = instantaneous()
        self.last_iterations = 0
        self.reason = iteration.CONVERGED  # why the last call of `advance` ended
        self._rho_inf = rho_inf
        self._tolerance = tolerance
        self._announce = announce
        self._alike = 0  # how many accelerations before the last belong to the same step size
        # power (W) that damping of the meshes took at the last instant whose dissipation is in the balance, and the steps
        # (s) made since
        self._power, self._unaccounted = 0.0, list[float]()

    def set_step(self, h: float) -> None:
        """Prepare for steps of size h (s): matrices of all bodies, factorised once."""
        before = self.coefficients.h
        if before == h:
            return
        if before > 0.0:  # a = v̇ + (½ − γ) h v̈ + … belongs to its step
            vectors = self.trial.vectors
            vectors.a[:] = vectors.nud + h / before * (vectors.a - vectors.nud)
            for mesh in self.meshes:
                mesh.rescale(h / before)
        self.coefficients = generalized_alpha(h, self._rho_inf)
        c, work = self.coefficients, self.work
        self._condense(c)
        for mesh in self.meshes:
            mesh.release()
        for mesh in self.meshes:
            if not mesh.shared.has(c):
                self._announce(f"factorising {mesh.body.name} ({mesh.body.size:,} freedoms)")
            self.counts.factorisations += mesh.prepare(c, work.W, work.W_Z, work.W_D)
        self.policy.restart()
        self._alike = 0

    def _condense(self, c: GeneralizedAlpha) -> None:
        """Compliances of Ritz bodies' own coordinates for a step."""
        elastic_compliances(self.small.bodies, c, self.work.elastic)

    def link(self) -> None:
        """Have the stages of the step compiled, or loaded; those that a second process compiles are waited for."""
        link(self.small, self.trial, self.work, self.state, self.record, self._announce)

    def start_accelerations(self, t: float) -> None:
        """True accelerations and liaison forces of the present state (Eq. T10), the algorithmic ones set equal."""
        self.link()
        self._alike = 0
        c = instantaneous()
        state, work, vectors = self.state, self.work, self.trial.vectors
        relative_motion(self.relative, state.now, self.trial.joints, self.trial.accepted, vectors.nu, vectors.nud)
        self.trial.rows.previous[:] = state.rows.previous
        self._condense(c)
        for mesh in self.meshes:
            mesh.prepare_start(work.W)
            mesh.u_next[:], mesh.ud_next[:], mesh.udd_next[:] = mesh.u, mesh.ud, mesh.udd
            mesh.a_next[:] = mesh.udd
        self.coefficients = c
        vectors.a[:] = vectors.nud
        self._phase(iteration.PREDICT, c, t)
        self._converge(c, t, exact=True)
        vectors.a_next[:] = vectors.nud_next
        self._phase(iteration.ACCEPT, c, t)
        for mesh in self.meshes:
            mesh.a_next[:] = mesh.udd_next
            mesh.accept()
        for mesh in self.meshes:
            mesh.write_small(self.trial.accepted, vectors)
        self._alike = 0
        self._keep_damping(0.0)
        self._show(t)

    def _show(self, t: float) -> None:
        """Renew `state`, what the accepted state at time t looks like in the frames of the model."""
        show(self.small, self.trial, self.work, self.state, t)

    def advance(self, t: float, steps: int) -> int:
        """Up to `steps` steps of the prepared size from time t; returns how many were done.

        Fewer have a `reason`: the iteration of the next did not converge, or, where a `bound` is set, the next would have
        made too large a local error, or they could be longer. The state is that of the last good step.
        """
        self.reason = iteration.CONVERGED
        if self.meshes:
            threads = numba.get_num_threads()
            if not any(mesh.threaded for mesh in self.meshes):
                numba.set_num_threads(1)
            try:
                done = self._mesh_steps(t, steps)
            finally:
                numba.set_num_threads(threads)
            self._ended(t, done, steps)
            return done
        self.record.check_room(steps)
        self.reason, done, corrections = self._kernel(iteration.WHOLE_STEPS, self.coefficients, t, steps)
        self.counts.steps += done
        self.counts.corrections += corrections
        self.last_iterations = round(corrections / done) if done else corrections
        self._alike += done
        self._ended(t, done, steps)
        return int(done)

    def keep(self, number: int, every: int, last: int) -> None:
        """From now on `record` gets the instant after every so many nominal steps (0: none) and after the last, where all bodies are small.

        number : of the nominal steps so far. Until there is no more room; a step that fails counts as none.
        """
        places = self.record.places
        places[NUMBER], places[EVERY], places[LAST] = number, every, last

    def bound(self, error: float) -> None:
        """The local error that a step may make, over the mechanism's size; 0 to accept whatever it is."""
        self.work.numbers[BOUND] = error
        self.work.flags[CALM] = 0

    @property
    def error(self) -> float:
        """The local error of the last step over the mechanism's size, where there is a bound."""
        return float(self.work.numbers[ERROR])

    def _ended(self, t: float, done: int, steps: int) -> None:
        """After `done` of `steps` steps from time t: renew `state`, and keep what a step that failed has tried."""
        if done < steps:
            to_model(self.small, self.trial, self.tried)
        self._show(t + done * self.coefficients.h)

    def _phase(self, phase: int, c: GeneralizedAlpha, end: float) -> tuple[int, int]:
        """One phase of the small system's step that ends at time `end`; returns (reason, corrections)."""
        reason, _, corrections = self._kernel(phase, c, end - c.h, 1)
        return reason, corrections

    def _kernel(self, phase: int, c: GeneralizedAlpha, t: float, steps: int) -> tuple[int, int, int]:
        """The compiled step on this system's tables and state; see `iteration.advance`."""
        work = self.work
        work.method[:] = c
        work.flags[ORDER] = min(self._alike, HIGHEST_ORDER)
        if self.meshes:  # whose nodal accelerations are predicted by a line
            work.flags[BEST] = 1
        reason, done, corrections = iteration.advance(
            self.small, self.trial, work, self.state, self.record, phase, t, steps, self._tolerance
        )
        return reason, done, corrections

    def _keep_damping(self, step: float) -> None:
        """Have what damping of the meshes takes now, after a step (s), come into the balance."""
        damped = [mesh for mesh in self.meshes if mesh.damping]
        if not damped:
            return
        if len(self._unaccounted) == WIDTH:
            self._account()
        for mesh in damped:
            assert mesh.damping
            mesh.damping.keep(len(self._unaccounted), mesh.ud)
        self._unaccounted.append(step)  # at last: an interrupt before leaves what can be accounted for

    def _account(self) -> None:
        """Integrate what damping of the meshes has taken up to the present, by the trapezoidal rule.

        Some steps later than the rest of the balance: K is read once for four of them.
        """
        if not self._unaccounted:
            return
        powers = np.sum([mesh.damping.find(len(self._unaccounted)) for mesh in self.meshes if mesh.damping], axis=0)
        for step, power in zip(self._unaccounted, powers, strict=True):
            self.trial.work[1] += 0.5 * step * (self._power + float(power))
            self._power = float(power)
        self._unaccounted.clear()

    def _mesh_steps(self, t: float, steps: int) -> int:
        for k in range(steps):
            if not self._mesh_step(t + (k + 1) * self.coefficients.h):
                return k
            if self.work.numbers[BOUND] > 0.0 and self.work.flags[CALM] >= iteration.CALM_STEPS:
                self.reason = iteration.COULD_BE_LONGER
                return k + 1
        return steps

    def _mesh_step(self, t: float) -> bool:
        c = self.coefficients
        self._phase(iteration.PREDICT, c, t)
        for mesh in self.meshes:
            mesh.predict(c, float(self._alike > 0))
        if not self._converge(c, t, exact=self.policy.exact):
            self.reason, self._alike = iteration.NOT_CONVERGED, 0
            return False
        if not self._accurate(c):
            self.reason, self._alike = iteration.TOO_LARGE, 0
            return False
        self.policy.accepted()
        self._phase(iteration.ACCEPT, c, t)
        for mesh in self.meshes:
            mesh.accept()
        self._keep_damping(c.h)
        self.counts.steps += 1
        if self.counts.steps % SETTLE == 0:
            for mesh in self.meshes:
                mesh.settle()
        for mesh in self.meshes:
            mesh.write_small(self.trial.accepted, self.trial.vectors)
        self._alike += 1
        return True

    def _accurate(self, c: GeneralizedAlpha) -> bool:
        """Whether a step of a mechanism with meshes makes no larger local error than it may."""
        numbers, flags = self.work.numbers, self.work.flags
        if numbers[BOUND] == 0.0:
            return True
        factor = abs(c.beta + 0.5 * (0.5 - c.gamma) - 1.0 / 6.0) * c.h**2 / self.system.size
        of_meshes = factor * max(mesh.jump() for mesh in self.meshes)
        numbers[ERROR] = max(local_error(self.small, c, self.trial), of_meshes)
        flags[CALM] = flags[CALM] + 1 if numbers[ERROR] <= iteration.TWICE * numbers[BOUND] else 0
        return bool(numbers[ERROR] <= numbers[BOUND])

    def _converge(self, c: GeneralizedAlpha, t: float, exact: bool) -> bool:
        """Residual, back-substitution and the small system's iteration, as often as the policy asks."""
        motion, work = self.trial.motion, self.work
        gravity = self.small.forces.gravity
        sizes: list[float] = []
        while True:
            for mesh in self.meshes:
                mesh.residual(c, motion, gravity, work.base, work.W)
            for group in self.mesh_groups:
                group.solve()
            for mesh in self.meshes:
                mesh.respond(work.base)
            self.counts.back_substitutions += bool(self.meshes)
            reason, corrections = self._phase(iteration.ITERATE, c, t)
            self.counts.corrections += corrections
            self.last_iterations = corrections
            if reason != iteration.CONVERGED:
                return False
            if not self.meshes:
                return True
            for mesh in self.meshes:
                mesh.correct(c, work.accounted, work.position_force, work.velocity_force)
            sizes.append(max(mesh.correction for mesh in self.meshes))
            self.last_iterations = len(sizes)
            if not np.isfinite(sizes[-1]):
                return False
            if self._enough(c, sizes, exact):
                return True
            if len(sizes) >= MOST or (len(sizes) > 4 and sizes[-1] > sizes[-2] > sizes[-3]):
                return False

    def _enough(self, c: GeneralizedAlpha, sizes: list[float], exact: bool) -> bool:
        scale = self.state.scales[2]
        if c.h == 0.0:
            return sizes[-1] <= 1e-12 * scale or (len(sizes) >= 4 and sizes[-1] >= 0.5 * sizes[-2])
        reach = 1.0 / (c.beta * c.h**2)
        allowed = self._tolerance * min(FORCE_SHARE * scale, self.system.size * reach)
        deflection = max(mesh.deflection for mesh in self.meshes)
        # round-off of accelerations, of displacements, and of the joints' positions, to which a stiff body answers
        floor = max(1e-13 * scale, 1e-13 * deflection * reach, 1e-15 * self.system.size * reach)
        if exact and sizes[-1] <= floor:
            return True
        return self.policy.enough(sizes, allowed, floor)

    def dissipated(self) -> float:
        """Energy (J) that damping has taken up to the present."""
        self._account()
        return float(self.trial.work[1])

    def failure(self, t: float) -> SimulationError:
        """Why the iteration of the step to time t did not converge, as a message."""
        system, state, tried = self.system, self.state, self.tried
        undefined = why_undefined(system, state.now, tried.now, state.rows.previous, t, self.coefficients.h)
        if undefined is not None:
            return SimulationError(f"{undefined}, at t = {t:.6g} s")
        flat = almost_flat(system, state.now)
        if flat is not None:
            return SimulationError(
                f"the step to t = {t:.6g} s fails: the disc {flat[0].name!r} is about to lie flat on its plane "
                f"({np.degrees(flat[1]):.2g} degrees are left), where no point of it is the one that rolls"
            )
        if not all(np.isfinite(part).all() for part in tried.now):
            return SimulationError(f"the motion is no longer finite at t = {t:.6g} s; try a smaller step")
        for entry in system.body_entries:
            if system.bodies.kind[entry.index] == RITZ and not self._has_positive_mass(entry.index):
                return SimulationError(
                    f"the mass matrix of body {entry.name!r} is no longer positive definite at t = {t:.6g} s: its "
                    "constants (m, m_O, G, H, s, s2, J0) do not belong to one set of shape functions"
                )
        text = f"the iteration of the step to t = {t:.6g} s does not converge"
        if system.rows:
            worst = int(np.argmax(np.abs(dense_rows(system, tried.now, t, state.rows.previous).acceleration)))
            text += f"; the liaison furthest from being met is {system.row_name(worst)}"
        return SimulationError(f"{text}; try a smaller step, or look for a singular position there")

    def _has_positive_mass(self, body: int) -> bool:
        bodies, motion = self.small.bodies, self.state.now
        o, e = int(bodies.offset[body]), int(bodies.offset[body + 1])
        return bool(np.linalg.eigvalsh(body_mass(bodies, body, motion.e[o + 6 : e]))[0] > 0.0)

    def has_elastic(self) -> bool:
        """Whether any body has elastic coordinates."""
        return bool(np.isin(self.system.bodies.kind, (RITZ, MESH)).any())


def _mesh_groups(system: System, relative: RelativeSystem) -> list[MeshGroup]:
    """`mesh_groups` of a system that has any: others do without what meshes need."""
    if not system.mesh_bodies:
        return []
    from .mesh_groups import mesh_groups

    return mesh_groups(system, relative)

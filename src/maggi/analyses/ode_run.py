"""A transient run by an integrator of ordinary differential equations, with rows at the nominal instants."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import attachment_motion
from maggi.bodies.tables import FIXED, RITZ
from maggi.liaisons.kernels import evaluate_rows
from maggi.model.errors import SimulationError
from maggi.model.simulation import Simulation
from maggi.stepping.allocate import new_instant, new_record
from maggi.stepping.failures import almost_flat, why_raised
from maggi.stepping.residuals import scaled_residuals
from maggi.stepping.stepper import MOST_KEPT, Counts
from maggi.stepping.tables import REPEATED
from maggi.system.system import System

from .initial import initial_motion, set_velocities
from .ode import Ode
from .ode_solution import Piece, pieces
from .snapshot import next_row

if TYPE_CHECKING:
    from maggi.stepping.mesh_step import MeshStep

Array = NDArray[np.float64]

METHODS = {"dop853": "DOP853", "radau": "RadauIIA"}
"""Names in models and names of integrators."""


class OdeWithWork:
    """The equations of a mechanism with two more: the work of drivers, loads and prescribed frames, and what is dissipated.

    z = (y, work, dissipated). They follow the motion and do not steer the integrator's step.
    """

    def __init__(self, ode: Ode) -> None:
        self.ode = ode
        self.z0 = np.concatenate([ode.y0, np.zeros(2)])

    def f(self, t: float, z: Array) -> Array:
        """See `Ode.f`; powers (W) in the last two."""
        rates = self.ode.f(t, z[:-2])
        _, dampers, loads, given = self.ode.evaluation.state.power
        powers = [given + loads, dampers] if np.isfinite(rates).all() else [np.nan, np.nan]
        return np.concatenate([rates, powers])

    def jacobian(self, t: float, z: Array) -> Array:
        """∂f/∂z without what the powers depend on: nothing depends on their integrals."""
        n = len(z)
        J = np.zeros((n, n))
        J[:-2, :-2] = self.ode.jacobian(t, z[:-2])
        return J

    def tolerances(self, t: float, z: Array, rtol: float) -> Array:
        """See `Ode.tolerances`; none for the energies, unless there is nothing else."""
        energy = np.inf
        if len(z) == 2:
            energy = rtol * float(self.ode.system.bodies.mass.sum()) * self.ode.speed(z[:-2]) ** 2
        return np.concatenate([self.ode.tolerances(t, z[:-2], rtol), [energy, energy]])

    def event(self, t: float, z: Array) -> float:
        """See `Ode.event`."""
        return self.ode.event(t, z[:-2])

    def settle(self) -> None:
        """See `Ode.settle`."""
        self.ode.settle()

    def reparametrise(self, t: float, z: Array) -> Array:
        """See `Ode.reparametrise`."""
        return np.concatenate([self.ode.reparametrise(t, z[:-2]), z[-2:]])


class OdeRun:
    """Advances a system in time by an integrator's own steps and stands at the nominal instants k · step.

    It is `snapshot.Present`: `state` is that of the instant reached last, put on the liaisons exactly. `counts.steps` are
    the integrator's, `counts.corrections` evaluations of f, `counts.restarts` new charts.
    """

    def __init__(
        self, system: System, simulation: Simulation, every: int, notes: list[str], announce: Callable[[str], None]
    ) -> None:
        announce("finding the initial state")
        motion = initial_motion(system, notes)
        if simulation.start == "quasi-static" and bool((system.bodies.kind == RITZ).any()):
            from .quasi_static import quasi_static_start

            quasi_static_start(system, motion, [], simulation.step)
            set_velocities(system, motion, [])  # what there is to tell was told for the undeformed bodies
        gravity = float(np.linalg.norm(system.forces.gravity))
        slowest = 1e-3 * system.size / simulation.duration
        self.system = system
        self.meshes: Sequence[MeshStep] = ()
        self.state = new_instant(system, slowest, max(gravity, slowest / simulation.duration))
        self.record = new_record(self.state, MOST_KEPT)
        self.counts = Counts()
        self.last_iterations = 0
        announce("compiling the equations of motion (once per installation)")
        self._equations = OdeWithWork(Ode(system, motion))
        self._h = simulation.step
        self._steps, self._every = round(simulation.duration / simulation.step), every
        self._evaluations = 0
        # prescribed frames that follow another run have kinks at its instants; without freedoms no error limits the step
        rough = system.motions.recorded_body.size > 0 or len(self._equations.ode.y0) == 0
        self._pieces = pieces(
            self._equations,
            (0.0, self._steps * self._h),
            self._equations.z0,
            METHODS[simulation.method],
            simulation.tolerance,
            None,
            self._h if rough else np.inf,
        )
        self._piece: Piece | None = None
        self._chart = self._equations.ode.chart
        self._show(0.0, self._equations.z0)

    def advance(self, done: int) -> int:
        """Go on towards the next nominal step that makes a row by at least one step of the integrator; how many nominal steps that was.

        Raises SimulationError where the motion cannot be continued.
        """
        until = next_row(done, self._steps, self._every)
        wanted = until * self._h
        if self._piece is None or self._piece.end < wanted:
            self._piece = self._next()
        if self._piece.end < wanted:
            return max(0, int(self._piece.end / self._h) - done)
        piece = self._piece
        self._show(wanted, piece.y if wanted == piece.end else piece.at(wanted))
        return until - done

    def note(self) -> str:
        """How it goes, for whoever watches."""
        return f"{self.counts.steps:,} steps of the integrator"

    def dissipated(self) -> float:
        """Energy (J) that damping has taken up to the present."""
        return float(self.state.work[1])

    def _next(self) -> Piece:
        try:
            piece = next(self._pieces)
        except SimulationError as error:
            raise self._explained(error) from None
        chart = self._equations.ode.chart
        self.counts.steps += 1
        self.counts.corrections = self._equations.ode.evaluations
        self.counts.restarts += chart is not self._chart
        self._chart = chart
        return piece

    def _explained(self, error: SimulationError) -> SimulationError:
        raised = why_raised(self.system)
        if raised is not None:
            return SimulationError(f"{raised}; {error}")
        flat = almost_flat(self.system, self.state.now)
        if flat is not None:
            return SimulationError(f"{error}; the disc {flat[0].name!r} lies almost flat, by {flat[1]:.2g} rad")
        return error

    def _show(self, t: float, z: Array) -> None:
        """Make the state at time t the present one, with everything that a row tells of it."""
        ode, system, state = self._equations.ode, self.system, self.state
        try:
            evaluation = ode.at(t, z[:-2])
        except ValueError as error:
            raise SimulationError(str(error)) from None
        for target, source in zip(state.now, evaluation.state.motion, strict=True):
            target[:] = source
        state.rows.previous[:] = evaluation.rows.coordinate[:, 0]
        attachment_motion(system.bodies, state.now, state.attachments)
        evaluate_rows(system.liaisons, system.bodies, state.now, state.attachments, state.rows, t)
        state.multipliers[:] = evaluation.state.multipliers
        state.power[:] = evaluation.state.power[:3]
        state.work[:2] = z[-2:]
        state.counts[REPEATED] = len(ode.chart.velocities.redundant) > 0
        self._scale()
        scaled_residuals(system.liaisons, state.rows, state.scales, state.residuals)
        self.last_iterations = ode.evaluations - self._evaluations
        self._evaluations = ode.evaluations

    def _scale(self) -> None:
        """What residuals are compared with: the largest speed and acceleration of a row so far."""
        bodies, now, scales = self.system.bodies, self.state.now, self.state.scales
        size = scales[0]
        for b in range(bodies.kind.size):
            if bodies.kind[b] == FIXED:
                continue
            o = int(bodies.offset[b])
            v, w = (float(np.linalg.norm(now.v[o + k : o + k + 3])) for k in (0, 3))
            a, e = (float(np.linalg.norm(now.vd[o + k : o + k + 3])) for k in (0, 3))
            scales[1] = max(scales[1], v, size * w)
            scales[2] = max(scales[2], a, size * e, size * w * w)

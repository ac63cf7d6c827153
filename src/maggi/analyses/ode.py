"""A mechanism as an ordinary differential equation y' = f(t, y) in its true freedoms, y = (s, ν) (T8–T10).

s are free positions in a chart about a base state, ν independent velocities. Every state that comes from a y satisfies
all liaisons at position, velocity and acceleration level to round-off, so that any integrator of ordinary differential
equations can be used and none of them drifts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import OdeSolver

from maggi.bodies.motions import prescribe
from maggi.bodies.tables import MESH, RITZ, MotionState
from maggi.model.errors import ModelError
from maggi.model.model import Model
from maggi.projection.chart import ChartEvaluation, make_chart, unknown_velocities
from maggi.projection.chart_kernels import DONE
from maggi.projection.maggi import liaison_forces
from maggi.projection.spanning_tree import spanning_tree
from maggi.projection.strategies import kept_or_renewed, named_strategy
from maggi.system.build import build_system
from maggi.system.dense import dense_rows, velocity_scale
from maggi.system.system import System

from .differences import central_differences
from .initial import initial_motion
from .ode_solution import Trajectory, solve

Array = NDArray[np.float64]

SLIGHT = 1e-3  # part of a body's largest deflection that counts for each of its coordinates
DRIVEN = 1e-9  # part of the largest force that is more than round-off
FARTHEST = 1.5  # rad that a body may have turned in a chart; at 2π rotation vectors end
STILL_GENERAL = 0.3  # part of the smallest pivot in general position that is expected of the next chart at least
CLEAR = 0.2  # of the general size of the smallest pivot: not close to a singular position
GROWTH = 4.0  # of what one of s or ν moves, since the chart's base


class Ode:
    """The equations of motion of a system from a state on.

    Parameters
    ----------
    system : the mechanism, its elastic bodies with dense coordinates.
    motion : positions and velocities at time t, on the liaisons; default: the model's initial state at t = 0.
    coordinates : (c,) unwrapped joint coordinates there; default: as measured, without full turns.
    strategy : how independent velocities are chosen: ``lu``, ``qr``, ``svd``, ``tree``; default by structure.

    Attributes
    ----------
    t0, y0 : initial time (s) and state (p + f,). chart : the chart in use. evaluations : of f so far.

    Raises
    ------
    ModelError : meshed bodies with their nodes as unknowns; no consistent initial state; forces on a freedom without
        inertia. (One on which there are none, such as the rotation of a point mass, keeps its velocity.)
    ValueError : a strategy that there is not.
    """

    def __init__(
        self,
        system: System,
        motion: MotionState | None = None,
        t: float = 0.0,
        *,
        coordinates: Array | None = None,
        strategy: str | None = None,
    ) -> None:
        _refuse_meshes(system)
        self.system = system
        self.t0 = float(t)
        self.evaluations = 0
        self._last: tuple[float, Array] | None = None
        self._unknown = unknown_velocities(system)
        self._scale = velocity_scale(system)[self._unknown]
        self._holonomic = np.flatnonzero(system.holonomic)
        motion = initial_motion(system, []) if motion is None else MotionState(*(part.copy() for part in motion))
        prescribe(system.motions, system.bodies, self.t0, motion)
        A = dense_rows(system, motion, self.t0, coordinates).A[:, self._unknown]
        tree = spanning_tree(system, A, self._unknown)
        self._velocity_strategy = named_strategy(strategy, tree)
        self._position_strategy = named_strategy(strategy, tree.among(self._holonomic))
        positions = self._position_strategy(motion, A[self._holonomic], self._scale, None)
        velocities = positions
        if self._nonholonomic:
            velocities = self._velocity_strategy(motion, A, self._scale, None)
        measured = np.zeros(len(system.liaisons.coordinate)) if coordinates is None else coordinates
        self.chart = make_chart(system, motion, self.t0, measured, A, positions, velocities)
        self._evaluation = ChartEvaluation(system, self.chart)
        self.y0 = self._at_base(motion)
        self._refuse_driven_without_inertia()

    @property
    def freedoms(self) -> int:
        """Number of independent velocities ν."""
        return self.chart.velocity_count

    def split(self, y: Array) -> tuple[Array, Array]:
        """s (p,) and ν (f,) of y."""
        return y[: self.chart.position_count], y[self.chart.position_count :]

    def f(self, t: float, y: Array) -> Array:
        """y' = (ṡ, ν̇) at time t (s). NaN where the present chart does not reach, so that integrators step back."""
        y = np.ascontiguousarray(y, dtype=np.float64)
        self._last = None
        self.evaluations += 1
        reason, sd, nud = self._evaluation.rates(t, *self.split(y))
        if reason != DONE:
            return np.full(len(y), np.nan)
        self._last = (float(t), y.copy())
        return np.concatenate([sd, nud])

    def jacobian(self, t: float, y: Array, order: int = 2) -> Array:
        """∂f/∂y (p + f, p + f) by central differences of order 2, 4 or 6.

        Costs `order` evaluations of f for every component of y.
        """
        return central_differences(lambda x: self.f(t, x), y, self.typical(y), order)

    def typical(self, y: Array) -> Array:
        """For every component of y the change that moves the mechanism by its size, or at its speed (p + f,)."""
        moves = [
            np.linalg.norm(split.E * self._scale[:, None], axis=0)
            for split in (self.chart.positions, self.chart.velocities)
        ]
        return np.concatenate([self.system.size / moves[0], self.speed(y) / moves[1]])

    def speed(self, y: Array) -> float:
        """The mechanism's speed (m/s) with velocities ν, at least that of a fall through its size or its size a second."""
        v = self._scale * (self.chart.velocities.E @ self.split(y)[1])
        size = self.system.size
        fall = float(np.sqrt(np.linalg.norm(self.system.forces.gravity) * size))
        return max(float(np.abs(v).max(initial=0.0)), fall if fall > 0.0 else size)

    def tolerances(self, t: float, y: Array, rtol: float) -> Array:
        """Absolute tolerances (p + f,) that go with rtol, in this state.

        rtol times the mechanism's size and speed, and for elastic coordinates their deflection and its rate, at least
        as much a second as the mechanism's speed is of its size.
        """
        extents, rates = self._extents(t, y)
        return rtol * np.concatenate(
            [np.abs(self.chart.positions.P) @ extents, np.abs(self.chart.velocities.P) @ rates]
        )

    def _extents(self, t: float, y: Array) -> tuple[Array, Array]:
        """For every unknown velocity what counts as a change of position, and of velocity (u,)."""
        state, bodies = self.at(t, y).state, self.system.bodies
        full, rates = np.zeros((2, self.system.coordinates))
        full[self._unknown] = self.system.size / self._scale
        rates[self._unknown] = self.speed(y) / self._scale
        forces = np.zeros(self.system.coordinates)
        forces[self._unknown] = state.forces
        for b in np.flatnonzero(bodies.kind == RITZ):
            o, end = int(bodies.offset[b]) + 6, int(bodies.offset[b + 1])
            n, q = end - o, int(bodies.ritz_square[b])
            k = bodies.k[q : q + n * n].reshape(n, n)
            e, stiff = state.motion.e[o:end], np.diag(k)
            bends = stiff > 0.0
            # where it is, and where its loads (all forces on it but its own) would have it
            loads = np.abs(forces[o:end] + k @ e)
            deflection = np.abs(e)
            deflection[bends] = np.maximum(deflection[bends], loads[bends] / stiff[bends])
            deflection = np.maximum(deflection, SLIGHT * deflection.max(initial=0.0))
            known = bends & (deflection > 0.0)
            at = np.arange(o, end)[known]
            full[at] = deflection[known]
            rates[at] = np.maximum(np.abs(state.motion.v[at]), deflection[known] * self.speed(y) / self.system.size)
        return full[self._unknown], rates[self._unknown]

    def settle(self) -> None:
        """Tell that the state evaluated last is one on the motion, and not a trial of an integrator."""
        self._evaluation.settle()

    def solve(
        self,
        t_span: tuple[float, float],
        method: str | type[OdeSolver] = "DOP853",
        *,
        rtol: float = 1e-8,
        atol: ArrayLike | None = None,
        t_eval: ArrayLike | None = None,
        y0: Array | None = None,
        max_step: float = np.inf,
        first_step: float | None = None,
    ) -> Trajectory:
        """The motion over a span of time, through as many charts as it takes; see `ode_solution.solve`."""
        return solve(
            self,
            t_span,
            method,
            rtol=rtol,
            atol=atol,
            t_eval=t_eval,
            y0=y0,
            max_step=max_step,
            first_step=first_step,
        )

    def event(self, t: float, y: Array) -> float:
        """Positive while the chart is good, negative where it should be renewed; falls continuously on the way there."""
        evaluation = self.at(t, y)
        turned, grown = evaluation.turned() / FARTHEST, (evaluation.grown() - 1.0) / (GROWTH - 1.0)
        # a base at a singular position would be a bad one, and a little later there is a better
        return 1.0 - max(turned, grown) + max(0.0, 1.0 - evaluation.pivots() / CLEAR)

    def reparametrise(self, t: float, y: Array) -> Array:
        """A new chart about this state, and this state's y in it: the same positions and velocities to round-off.

        The independent velocities are kept while S is well conditioned, see `strategies.kept_or_renewed`.
        """
        evaluation, chart = self.at(t, y), self.chart
        motion = MotionState(*(part.copy() for part in evaluation.state.motion))
        A = evaluation.state.A.copy()
        positions = kept_or_renewed(chart.positions, self._position_strategy, motion, A[self._holonomic])
        velocities = positions
        if self._nonholonomic:
            velocities = kept_or_renewed(chart.velocities, self._velocity_strategy, motion, A)
        self.chart = make_chart(self.system, motion, t, evaluation.rows.coordinate[:, 0], A, positions, velocities)
        self._evaluation = ChartEvaluation(self.system, self.chart, STILL_GENERAL * evaluation.state.generic)
        self._last = None
        return self._at_base(motion)

    def at(self, t: float, y: Array) -> ChartEvaluation:
        """Everything of this state: rows, attachments, forces; valid until the next evaluation.

        Raises ValueError where the chart does not reach the state.
        """
        known = self._last is not None and self._last[0] == t and np.array_equal(self._last[1], y)
        if not known and not np.isfinite(self.f(t, y)).all():
            raise ValueError(f"the chart does not reach the state at t = {t:.6g} s")
        return self._evaluation

    @property
    def evaluation(self) -> ChartEvaluation:
        """The equations on the chart in use, and the state evaluated last."""
        return self._evaluation

    def state(self, t: float, y: Array) -> MotionState:
        """Positions, velocities and accelerations of all bodies, on the liaisons to round-off."""
        return MotionState(*(part.copy() for part in self.at(t, y).state.motion))

    def coordinates(self, t: float, y: Array) -> Array:
        """Unwrapped joint coordinates (c,), m and rad."""
        return self.at(t, y).rows.coordinate[:, 0].copy()

    def accelerations(self, t: float, y: Array) -> Array:
        """v̇ of all small coordinates (n,) (T9)."""
        return self.at(t, y).state.motion.vd.copy()

    def liaison_forces(self, t: float, y: Array) -> Array:
        """λ (r,), of least norm where rows are redundant (T11)."""
        state = self.at(t, y).state
        return liaison_forces(self.chart.velocities.at(state.A), state.residual)

    def _refuse_driven_without_inertia(self) -> None:
        state = self.at(self.t0, self.y0).state
        if state.massless[0] == 0.0 or state.massless[1] < DRIVEN:
            return
        light = [e.name for e in self.system.body_entries if e.visible and self.system.inertia_floor[e.index] > 0.0]
        raise ModelError(
            f"a force turns a body about an axis without inertia: {' or '.join(light) or 'one of them'}",
            path=f"bodies.{light[0]}.inertia" if light else "bodies",
            remedy="give it a moment of inertia, or let the force act at its centre of mass",
        )

    @property
    def _nonholonomic(self) -> bool:
        return len(self._holonomic) < self.system.rows

    def _at_base(self, motion: MotionState) -> Array:
        chart = self.chart
        return np.concatenate([np.zeros(chart.position_count), chart.velocities.P @ motion.v[self._unknown]])


def equations_of(
    model: Model | System,
    motion: MotionState | None = None,
    t: float = 0.0,
    *,
    coordinates: Array | None = None,
    strategy: str | None = None,
) -> Ode:
    """The equations of motion of a model, its meshed bodies with dense elastic coordinates, or of a system; see `Ode`."""
    system = build_system(model, dense=True) if isinstance(model, Model) else model
    return Ode(system, motion, t, coordinates=coordinates, strategy=strategy)


def _refuse_meshes(system: System) -> None:
    for entry in system.body_entries:
        if system.bodies.kind[entry.index] == MESH:
            raise ModelError(
                f"the meshed body {entry.name!r} has too many freedoms for an explicit differential equation",
                path=f"bodies.{entry.name}",
                remedy="give it Ritz functions, or run it by generalised-α",
            )

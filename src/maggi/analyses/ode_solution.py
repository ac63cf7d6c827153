"""Solving a mechanism's differential equation over a span of time, from chart to chart."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import BDF, DOP853, LSODA, RK23, RK45, OdeSolver, Radau

from maggi.bodies.tables import MotionState
from maggi.integrators.radau_iia import RadauIIA
from maggi.model.errors import SimulationError
from maggi.system.system import System

if TYPE_CHECKING:
    from .ode import Ode

Array = NDArray[np.float64]

METHODS: dict[str, type[OdeSolver]] = {
    "DOP853": DOP853,
    "RadauIIA": RadauIIA,
    "RK45": RK45,
    "RK23": RK23,
    "Radau": Radau,
    "BDF": BDF,
    "LSODA": LSODA,
}
"""Integrators by name: those of SciPy's `solve_ivp`, and the program's own Radau IIA."""
RESTARTS = 8  # from one state with other steps, where a step ended where the chart does not reach
SHORTENED = 0.37
UNREACHED = "the positions cannot be found; it may be a singular position where motions branch"
WITH_JACOBIAN = ("Radau", "BDF", "RadauIIA", "LSODA")


@dataclass(frozen=True, eq=False)
class Trajectory:
    """States at times (n,): every one on the liaisons at all three levels.

    origin (n, b, 3), rotation (n, b, 3, 3): of all bodies' frames, by row in the tables (`System.body(name).index`);
    e, v, vd (n, small coordinates); coordinates (n, c): unwrapped joint coordinates.
    evaluations: of f; steps: accepted; charts: used.
    """

    system: System
    t: Array
    origin: Array
    rotation: Array
    e: Array
    v: Array
    vd: Array
    coordinates: Array
    evaluations: int
    steps: int
    charts: int

    def state(self, k: int) -> MotionState:
        """The state at time t[k]."""
        return MotionState(self.origin[k], self.rotation[k], self.e[k], self.v[k], self.vd[k])


@dataclass(frozen=True, eq=False)
class Piece:
    """One accepted step, from `start` to `end` (s), in the chart that is in use while it is handed over.

    y: at its end. at(t): y anywhere in it.
    """

    start: float
    end: float
    y: Array
    at: Callable[[float], Array]


def solve(
    ode: Ode,
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
    """The motion from t_span[0] to t_span[1] (s), through as many charts as it takes.

    method : a name of `METHODS`, or an integrator derived from SciPy's `OdeSolver`. atol : scalar or (p + f,); default
        see `Ode.tolerances`. t_eval : times at which states are wanted, in
        order; default: the ends of all steps. y0 : state at the start in the present chart; default `ode.y0`.

    Raises SimulationError where the integrator cannot go on.
    """
    times = None if t_eval is None else np.asarray(t_eval, dtype=np.float64)
    rows: list[tuple[Array, ...]] = []
    reached: list[float] = []

    def keep(t: float, y: Array) -> None:
        reached.append(t)
        rows.append((*ode.state(t, y), ode.coordinates(t, y)))

    before = ode.evaluations
    steps, next_time = 0, 0
    charts = [ode.chart]
    start = ode.y0 if y0 is None else y0
    if times is None or (len(times) and times[0] == t_span[0]):
        keep(t_span[0], start)
        next_time = 1
    for piece in pieces(ode, t_span, start, method, rtol, atol, max_step, first_step):
        steps += 1
        if ode.chart is not charts[-1]:
            charts.append(ode.chart)
        if times is None:
            keep(piece.end, piece.y)
            continue
        while next_time < len(times) and times[next_time] <= piece.end:
            t = float(times[next_time])
            keep(t, piece.y if t == piece.end else piece.at(t))
            next_time += 1
    origin, rotation, e, v, vd, coordinates = (np.array([row[k] for row in rows]) for k in range(6))
    cost = (ode.evaluations - before, steps, len(charts))
    return Trajectory(ode.system, np.array(reached), origin, rotation, e, v, vd, coordinates, *cost)


class Equations(Protocol):
    """What `pieces` asks of a differential equation on charts; see `Ode`."""

    def f(self, t: float, y: Array) -> Array: ...
    def jacobian(self, t: float, y: Array) -> Array: ...
    def tolerances(self, t: float, y: Array, rtol: float) -> Array: ...
    def event(self, t: float, y: Array) -> float: ...
    def settle(self) -> None: ...
    def reparametrise(self, t: float, y: Array) -> Array: ...


def pieces(
    ode: Equations,
    t_span: tuple[float, float],
    y0: Array,
    method: str | type[OdeSolver],
    rtol: float,
    atol: ArrayLike | None,
    max_step: float = np.inf,
    first_step: float | None = None,
) -> Iterator[Piece]:
    """Accepted steps one after the other; the chart is renewed between them where `Ode.event` says so."""
    solver_class = METHODS[method] if isinstance(method, str) else method
    t, y, step = float(t_span[0]), y0, first_step
    attempts, last_step = 0, t_span[1] - t
    while t < t_span[1]:
        options = {"jac": ode.jacobian} if solver_class.__name__ in WITH_JACOBIAN else {}
        solver = solver_class(
            ode.f,
            t,
            y,
            t_span[1],
            rtol=rtol,
            atol=ode.tolerances(t, y, rtol) if atol is None else np.broadcast_to(np.asarray(atol), len(y)),
            max_step=max_step,
            first_step=None if step is None else min(step, t_span[1] - t),
            **options,
        )
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed" or not np.isfinite(ode.f(solver.t, solver.y)).all():
                attempts += 1
                if attempts > RESTARTS:
                    raise SimulationError(
                        f"the motion cannot be continued beyond t = {t:.6g} s: {message or UNREACHED}"
                    )
                step = (SHORTENED**attempts) * last_step
                break
            attempts, last_step = 0, solver.step_size
            yield Piece(solver.t_old, solver.t, solver.y, solver.dense_output())
            t, y = solver.t, solver.y
            used_up = ode.event(t, y) < 0.0
            ode.settle()
            if used_up:
                step = getattr(solver, "h_abs", last_step)
                y = ode.reparametrise(t, y)
                break

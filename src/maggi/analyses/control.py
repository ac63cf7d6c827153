"""A mechanism with actuators that a controller commands, as an ordinary differential equation; computed torque."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import generalised_force
from maggi.bodies.tables import MotionState
from maggi.liaisons.tables import COORDINATE_JOINT
from maggi.system.dense import dense_mass
from maggi.system.system import System

from .inverse_dynamics import coordinate_numbers, solve
from .ode import Ode

Array = NDArray[np.float64]
Wanted = Callable[[float], tuple[Array, Array, Array]]


@dataclass(frozen=True, eq=False)
class Measured:
    """What a controller sees: time (s), all joint coordinates (c,) with rates (c,), and positions and velocities."""

    t: float
    coordinates: Array
    rates: Array
    motion: MotionState


Controller = Callable[[Measured], Array]


class ControlledOde(Ode):
    """The equations of motion with forces ``u = controller(measured)`` (m,) on the actuators, N or N m.

    Parameters
    ----------
    actuators : joint coordinates by name (`inverse_dynamics.coordinate_numbers`); u is exerted by first on second.
    controller : a function of the present state; continuous, or steps of the integrator suffer.
    motion : the state at the start; default: the model's initial one.

    Raises
    ------
    ModelError : an actuator that there is not; see `Ode` for the rest.
    """

    def __init__(
        self, system: System, actuators: Sequence[str], controller: Controller, motion: MotionState | None = None
    ) -> None:
        self._actuators = coordinate_numbers(system, actuators)
        self._controller = controller
        self.commanded = np.zeros(len(actuators))
        super().__init__(system, motion)

    def f(self, t: float, y: Array) -> Array:
        """y' = (ṡ, ν̇); what the state evaluated last knows of forces and accelerations has the actuators in it."""
        slopes = super().f(t, y)
        if not np.isfinite(slopes).all():
            return slopes
        evaluation = self.evaluation
        state, rows = evaluation.state, evaluation.rows
        unknown = self.chart.table.unknown
        coordinate = rows.coordinate
        u = self._controller(Measured(t, coordinate[:, 0].copy(), coordinate[:, 1].copy(), state.motion))
        self.commanded = np.asarray(u, dtype=np.float64)
        force = self._force(self.commanded)[unknown]
        M = dense_mass(self.system, state.motion)[np.ix_(unknown, unknown)]
        change = np.linalg.solve(state.S.T @ M @ state.S, state.S.T @ force)
        slopes[self.chart.position_count :] += change
        state.vd[:] += state.S @ change
        state.motion.vd[unknown] = state.vd
        state.forces[:] += force
        state.residual[:] += force - M @ (state.S @ change)
        return slopes

    def _force(self, u: Array) -> Array:
        """Bᵀu (n,): the generalised forces of the actuators."""
        bodies, table = self.system.bodies, self.system.liaisons
        evaluation = self.evaluation
        force = np.zeros(self.system.coordinates)
        for c, value in zip(self._actuators, u, strict=True):
            for side in range(2):
                end = int(table.joint[table.coordinate[c, COORDINATE_JOINT], side])
                b = int(bodies.attachment_body[end])
                w = value * evaluation.rows.coordinate_wrench[c, side]
                part = force[bodies.offset[b] : bodies.offset[b + 1]]
                motion, attachments = evaluation.state.motion, evaluation.attachments
                generalised_force(bodies, motion, attachments, end, w[0], w[1], w[2], w[3], w[4], w[5], part)
        return force


def computed_torque(
    system: System, actuators: Sequence[str], outputs: Sequence[str], wanted: Wanted, stiffness: float, damping: float
) -> Controller:
    """A controller by feedback linearisation: outputs follow ``ÿ = ÿ_d + damping (ẏ_d − ẏ) + stiffness (y_d − y)``.

    system : the mechanism as the controller knows it; where it is the one that moves, and the state that it sees is
        that one's, the error obeys this linear equation exactly. wanted(t): y_d, ẏ_d, ÿ_d (m,) each.
    stiffness (1/s²), damping (1/s). Source: Eq. T8–T10; see `inverse_dynamics`.
    """
    acting, observed = coordinate_numbers(system, actuators), coordinate_numbers(system, outputs)

    def control(measured: Measured) -> Array:
        y, yd, ydd = wanted(measured.t)
        error = y - measured.coordinates[observed]
        rate = yd - measured.rates[observed]
        return solve(
            system, measured.motion, measured.t, acting, observed, ydd + damping * rate + stiffness * error
        ).forces

    return control

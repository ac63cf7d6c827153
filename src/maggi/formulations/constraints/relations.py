"""Liaisons that are relations: drivers, couplers of joint coordinates, rods, and rows on velocities."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.model.functions import Formula, TimeFunction
from maggi.model.joints import PfaffianRow

from ..bodies import Marker
from ..kinematics import Frame
from ..programs import at_time, formula_at
from ..taylor import Taylor, angular_velocity, constant, norm, product, time, unit
from .joints import JointGeometry
from .locked import Locked, Places, Wrench, between

Array = NDArray[np.float64]
NONE = np.zeros(3)


@dataclass(frozen=True, eq=False)
class DriverGeometry:
    """A joint's coordinate, or its rate (`quantity` speed), as a function of time."""

    joint: JointGeometry
    quantity: str
    function: TimeFunction

    def at(self, places: Places) -> Locked:
        coordinate, wrench = self.joint.coordinate(None if self.quantity == "speed" else self.quantity, places)
        if self.quantity == "speed":
            return Locked((coordinate.derivative() - at_time(self.function, places.t, 1),), (wrench,))
        return Locked((coordinate - at_time(self.function, places.t),), (wrench,))


@dataclass(frozen=True, eq=False)
class CouplerGeometry:
    """``relation = 0`` between joint coordinates, or between their rates."""

    joints: Mapping[str, tuple[JointGeometry, str | None]]
    relation: Formula
    rates: bool

    def at(self, places: Places) -> Locked:
        found = {name: joint.coordinate(quantity, places) for name, (joint, quantity) in self.joints.items()}
        values = {name: x.derivative() if self.rates else x for name, (x, _) in found.items()}
        residual = formula_at(self.relation, {"t": time(places.t, 1 if self.rates else 2), **values})
        parts = []
        for name, (_, wrench) in found.items():
            slope = self._slope(name, values, places.t)
            parts += [(frame, slope * force, slope * torque) for frame, force, torque in wrench.parts]
        return Locked((residual,), (Wrench(tuple(parts)),))

    def _slope(self, name: str, values: Mapping[str, Taylor], t: float) -> float:
        """Derivative of the relation to one of its coordinates: that one moves at unit rate, all else rests."""
        moving = {other: Taylor((x.value,), np.array([float(other == name)])) for other, x in values.items()}
        return float(formula_at(self.relation, {"t": constant(t, 1), **moving}).highest[0])


@dataclass(frozen=True, eq=False)
class RodGeometry:
    """The distance of two points is `length` (m), a number or a function of time."""

    first: Marker
    second: Marker
    length: TimeFunction | float

    def at(self, places: Places) -> Locked:
        first, second = places.frame(self.first), places.frame(self.second)
        gap = second.position - first.position
        length = constant(self.length) if isinstance(self.length, float) else at_time(self.length, places.t)
        pull = unit(gap).value
        return Locked((norm(gap) - length,), (between(first, second, second.position.value, pull, NONE),))


@dataclass(frozen=True, eq=False)
class PfaffianGeometry:
    """Rows Σ coefficient · velocity + constant = 0 on the velocities of named frames; all components are global."""

    ends: Mapping[str, Marker]
    rows: tuple[PfaffianRow, ...]

    def at(self, places: Places) -> Locked:
        frames = {name: places.frame(marker) for name, marker in self.ends.items()}
        variables = {"t": time(places.t, 1)}
        velocities: dict[tuple[str, str], Taylor] = {}
        for name, frame in frames.items():
            variables |= _pose_variables(name, frame)
            for letter, vector in (("v", frame.position.derivative()), ("w", angular_velocity(frame.axes))):
                velocities |= {(name, f"{letter}.{axis}"): vector[k] for k, axis in enumerate("xyz")}
        residuals, wrenches = [], []
        for row in self.rows:
            residual = constant(0.0, 1) if row.constant is None else formula_at(row.constant, variables)
            forces = {name: np.zeros(6) for name in frames}
            for (name, component), formula in row.coefficients.items():
                factor = formula_at(formula, variables)
                residual = residual + product(",->", factor, velocities[name, component])
                forces[name]["vw".index(component[0]) * 3 + "xyz".index(component[2])] += float(factor.value)
            residuals.append(residual)
            wrenches.append(Wrench(tuple((frames[name], f[:3], f[3:]) for name, f in forces.items())))
        return Locked(tuple(residuals), tuple(wrenches))


def _pose_variables(name: str, frame: Frame) -> dict[str, Taylor]:
    """``name.x`` … ``name.r33``, of order 1."""
    position, axes = frame.position.lower(), frame.axes.lower()
    variables = {f"{name}.{axis}": position[k] for k, axis in enumerate("xyz")}
    return variables | {f"{name}.r{i + 1}{j + 1}": axes[i, j] for i in range(3) for j in range(3)}


# Central differences of order eight on nine points, and their step in radians or in parts of the motion's scale.
_OFFSETS = np.arange(-4, 5)
_WEIGHTS = np.array([3.0, -32.0, 168.0, -672.0, 0.0, 672.0, -168.0, 32.0, -3.0]) / 840.0


@dataclass(frozen=True, eq=False)
class PfaffianFunctionGeometry:
    """Rows ``(A, b) = function(t, position, rotation)`` of Python; their rate along the motion by differences."""

    ends: tuple[Marker, ...]
    function: Callable[[float, Array, Array], tuple[Array, Array]]

    def at(self, places: Places) -> Locked:
        frames = [places.frame(marker) for marker in self.ends]
        velocities = [(frame.position.derivative(), angular_velocity(frame.axes)) for frame in frames]
        step = 1e-2 / max([1.0, *(float(np.linalg.norm(w.value)) for _, w in velocities)])
        A, b = self._rows(frames, places.t, 0.0)
        samples = [self._rows(frames, places.t, k * step) for k in _OFFSETS]
        A_rate = sum(w * a for w, (a, _) in zip(_WEIGHTS, samples, strict=True)) / step
        b_rate = sum(w * x for w, (_, x) in zip(_WEIGHTS, samples, strict=True)) / step
        residuals, wrenches = [], []
        for row in range(len(b)):
            residual = Taylor((np.array(b[row]),), np.array([b_rate[row]]))
            for k, (v, w) in enumerate(velocities):
                for part, vector in ((slice(0, 3), v), (slice(3, 6), w)):
                    factor = Taylor((A[row, k, part],), A_rate[row, k, part][None])
                    residual = residual + product("i,i->", factor, vector)
            residuals.append(residual)
            wrenches.append(Wrench(tuple((frame, A[row, k, :3], A[row, k, 3:]) for k, frame in enumerate(frames))))
        return Locked(tuple(residuals), tuple(wrenches))

    def _rows(self, frames: list[Frame], t: float, dt: float) -> tuple[Array, Array]:
        """A and b where the motion is dt later, to second order in its known derivatives; only the rate at 0 counts."""
        position = np.array([f.position.value + dt * f.position.rate for f in frames])
        rotation = []
        for frame in frames:
            spin = dt * frame.axes.rate @ frame.axes.value.T
            rotation.append(_cayley(spin) @ frame.axes.value)
        A, b = self.function(t + dt, position, np.array(rotation))
        return np.asarray(A, dtype=np.float64), np.asarray(b, dtype=np.float64)


def _cayley(spin: Array) -> Array:
    """A rotation that agrees with exp(spin) in its first derivative, exactly orthogonal."""
    return np.asarray(np.linalg.solve(np.eye(3) - 0.5 * spin, np.eye(3) + 0.5 * spin))

"""Points on curves and surfaces, and cams: where the parameter is, is found anew; its acceleration never counts.

In each of the residuals here the derivative to the curve's parameter vanishes where the liaison holds, so that the
parameter enters accelerations by its rate alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from maggi.model.curves import Curve, ExpressionSurface, SplineCurve, SplineSurface, Surface
from maggi.model.operations import evaluate

from ..bodies import Marker
from ..kinematics import Frame
from ..programs import formula_at
from ..taylor import Taylor, compose, constant, dot, function, product, stack
from .locked import Locked, Places, between

Array = NDArray[np.float64]
NONE = np.zeros(3)
SAMPLES = 2001
ITERATIONS = 50


@dataclass(frozen=True, eq=False)
class Track:
    """A curve c(s) in the axes of its body."""

    curve: Curve

    def at(self, s: Taylor) -> Taylor:
        """The point (3,) at a parameter that moves."""
        curve = self.curve
        if isinstance(curve, SplineCurve):
            spline, _ = _spline(curve)
            c, tangent, bend = (spline(float(s.value), order) for order in range(3))
            return stack([function(float(c[i]), float(tangent[i]), float(bend[i]), s) for i in range(3)])
        start, stop = curve.interval
        if curve.closed:
            turns = np.floor((float(s.value) - start) / (stop - start))
            s = s - turns * (stop - start)
        return stack([formula_at(part, {"s": s}) for part in (curve.x, curve.y, curve.z)])

    def derivatives(self, s: float) -> tuple[Array, Array, Array]:
        """c, c′, c″ (3,) at s."""
        at = self.at(Taylor((np.array(s), np.array(1.0)), np.zeros(1)))
        return at.value, at.rate, at.highest[0]

    def sampled(self) -> tuple[Array, Array]:
        """Parameters (p,) all along, and points (p, 3)."""
        curve = self.curve
        if isinstance(curve, SplineCurve):
            spline, length = _spline(curve)
            s = np.linspace(0.0, length, SAMPLES)
            return s, np.asarray(spline(s))
        s = np.linspace(*curve.interval, SAMPLES)
        return s, np.column_stack([evaluate(f.codes, f.values, [s]) for f in (curve.x, curve.y, curve.z)])


def _spline(curve: SplineCurve) -> tuple[CubicSpline, float]:
    """The spline over the length of its chords, and that length."""
    points = np.array(curve.points)
    if curve.closed:
        points = np.vstack([points, points[:1]])
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    spline = CubicSpline(lengths, points, bc_type="periodic" if curve.closed else "natural")
    return spline, float(lengths[-1])


@dataclass(frozen=True, eq=False)
class _Seen:
    """The second's point (3,) and a direction of it in the axes of the body that carries the curve."""

    first: Frame
    second: Frame
    shift: Array

    def point(self) -> Taylor:
        return product("ij,i->j", self.first.axes, self.second.position - self.first.position) + self.shift

    def direction(self, vector: Taylor) -> Taylor:
        return product("ij,i->j", self.first.axes, vector)

    def locked(self, residuals: list[Taylor], forces: list[Array], point: Array) -> Locked:
        """Residuals held by forces (3,) in the carrier's axes at a point (3,) of the carrier's body frame."""
        R = self.first.axes.value
        place = self.first.position.value + R @ (point - self.shift)
        return Locked(
            tuple(residuals), tuple(between(self.first, self.second, place, R @ force, NONE) for force in forces)
        )


@dataclass(frozen=True, eq=False)
class CurveGeometry:
    """A point of second on a curve that first carries; its marker has the axes of its body."""

    first: Marker
    second: Marker
    track: Track

    def at(self, places: Places) -> Locked:
        seen = _Seen(places.frame(self.first), places.frame(self.second), self.first.point)
        x = seen.point()
        s = _nearest(self.track, x)
        _, tangent, _ = self.track.derivatives(float(s.value))
        gap = x - self.track.at(s)
        normals = np.linalg.svd(tangent[None])[2][1:]
        return seen.locked([dot(gap, n) for n in normals], list(normals), x.value)


@dataclass(frozen=True, eq=False)
class SurfaceGeometry:
    """A point of second on a surface that first carries; its marker has the axes of its body."""

    first: Marker
    second: Marker
    surface: Surface

    def at(self, places: Places) -> Locked:
        seen = _Seen(places.frame(self.first), places.frame(self.second), self.first.point)
        x = seen.point()
        here = constant(x.value, 1)
        gradient = [float(self._height(here + _moving(k)).rate) for k in range(3)]
        return seen.locked([self._height(x)], [np.array(gradient)], x.value)

    def _height(self, x: Taylor) -> Taylor:
        if isinstance(self.surface, ExpressionSurface):
            return formula_at(self.surface.F, {"x": x[0], "y": x[1], "z": x[2]})
        h = _heights(self.surface, float(x[0].value), float(x[1].value))
        return x[2] - compose(
            h[0, 0], [h[1, 0], h[0, 1]], np.array([[h[2, 0], h[1, 1]], [h[1, 1], h[0, 2]]]), x[0], x[1]
        )


def _moving(k: int) -> Taylor:
    """A unit velocity along axis k."""
    return Taylor((np.zeros(3),), np.eye(3)[k][None])


def _heights(surface: SplineSurface, x: float, y: float) -> Array:
    """Derivatives (3, 3) of the natural bicubic spline: [i, j] i times to x, j times to y."""
    along_x = CubicSpline(surface.x, np.array(surface.z), axis=0, bc_type="natural")
    result = np.empty((3, 3))
    for i in range(3):
        along_y = CubicSpline(surface.y, along_x(x, i), bc_type="natural")
        result[i] = [along_y(y, j) for j in range(3)]
    return result


@dataclass(frozen=True, eq=False)
class RollerGeometry:
    """A roller of `radius` (m; 0: an edge) about second's point on a plane profile that first carries, normal `axis` (3,)."""

    first: Marker
    second: Marker
    track: Track
    axis: Array
    radius: float

    def at(self, places: Places) -> Locked:
        seen = _Seen(places.frame(self.first), places.frame(self.second), self.first.point)
        x = seen.point()
        s = _nearest(self.track, x, self.axis)
        flat = np.eye(3) - np.outer(self.axis, self.axis)
        gap = product("i,ij->j", x - self.track.at(s), flat)
        if self.radius == 0.0:
            _, tangent, _ = self.track.derivatives(float(s.value))
            normal = np.cross(self.axis, tangent) / np.linalg.norm(tangent)
            return seen.locked([dot(gap, normal)], [normal], x.value)
        return seen.locked([(dot(gap, gap) - self.radius**2) * (0.5 / self.radius)], [gap.value / self.radius], x.value)


@dataclass(frozen=True, eq=False)
class FaceGeometry:
    """A flat face of second (normal: its marker's z axis) that touches a plane profile that first carries."""

    first: Marker
    second: Marker
    track: Track

    def at(self, places: Places) -> Locked:
        seen = _Seen(places.frame(self.first), places.frame(self.second), self.first.point)
        x, normal = seen.point(), seen.direction(seen.second.axis(2))
        s = _touching(self.track, x.value, normal)
        point = self.track.at(s)
        return seen.locked([dot(x - point, normal)], [normal.value], point.value)


def _nearest(track: Track, x: Taylor, axis: Array | None = None) -> Taylor:
    """The parameter of the point nearest to x, seen along `axis` where one is given: (x − c) · c′ = 0, with its rate."""
    flat = np.eye(3) if axis is None else np.eye(3) - np.outer(axis, axis)
    parameters, points = track.sampled()
    s = float(parameters[int(np.argmin(np.linalg.norm((points - x.value) @ flat, axis=1)))])
    for _ in range(ITERATIONS):
        c, tangent, bend = track.derivatives(s)
        gap = flat @ (x.value - c)
        step = gap @ tangent / (tangent @ tangent - gap @ bend)
        s += float(step)
        if abs(step) < 1e-15 * (1.0 + abs(s)):
            break
    c, tangent, bend = track.derivatives(s)
    rate = x.rate @ tangent / (tangent @ tangent - (flat @ (x.value - c)) @ bend)
    return Taylor((np.array(s), np.array(rate)), np.zeros(1))


def _touching(track: Track, x: Array, normal: Taylor) -> Taylor:
    """The parameter where the face through x touches: c′ · m = 0, with its rate."""
    parameters, points = track.sampled()
    heights = (points - x) @ normal.value
    s = float(parameters[min((int(np.argmax(heights)), int(np.argmin(heights))), key=lambda k: abs(heights[k]))])
    for _ in range(ITERATIONS):
        _, tangent, bend = track.derivatives(s)
        step = -(tangent @ normal.value) / (bend @ normal.value)
        s += float(step)
        if abs(step) < 1e-15 * (1.0 + abs(s)):
            break
    _, tangent, bend = track.derivatives(s)
    rate = -(tangent @ normal.rate) / (bend @ normal.value)
    return Taylor((np.array(s), np.array(rate)), np.zeros(1))

"""Curves, cams and surfaces of joints, from their descriptions to rows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from maggi.liaisons.splines import curve_pieces, surface_pieces
from maggi.liaisons.tables import CAM, CAM_FACE, CURVE, CURVE_FACE, CURVE_POINT
from maggi.linalg.jets import evaluate as evaluate_jet
from maggi.linalg.jets import program
from maggi.model.curves import Curve, SplineCurve, SplineSurface
from maggi.model.errors import ModelError
from maggi.model.functions import Formula, TimeFunction
from maggi.model.joints import Cam
from maggi.model.operations import evaluate

from .body_list import BodyList
from .liaison_list import LiaisonList, RowPlan

Array = NDArray[np.float64]
SAMPLES = 2001
PLANAR = 1e-6  # a cam's profile may leave its plane by this part of its size, its follower's face be tilted by this


class CurveBuilder:
    """Adds curves to the list, with the rows of points, rollers and faces on them."""

    def __init__(self, bodies: BodyList, liaisons: LiaisonList) -> None:
        self._bodies = bodies
        self._liaisons = liaisons

    def point(self, joint: int, curve: Curve, path: str) -> tuple[list[RowPlan], int]:
        """Two rows that keep the second's point on a curve, and the coordinate that is the curve's parameter."""
        ends = self._liaisons.ends(joint)
        s, points = sampled(curve, f"{path}.curve")
        x = self._seen_from_carrier(ends)
        nearest = int(np.argmin(np.linalg.norm(points - x, axis=1)))
        initial = _refined(curve, s, nearest, lambda c: ((c[0] - x) @ c[1], c[1] @ c[1] + (c[0] - x) @ c[2]))
        row = self._add(curve, s, initial, ends[0], _away_from_tangents(points), f"{path}.curve")
        coordinate = self._liaisons.add_coordinate(joint, CURVE_POINT, row)
        return [
            RowPlan(CURVE, joint, k, coordinate, ends, f"offset from the curve, normal {k + 1}") for k in range(2)
        ], coordinate

    def cam(self, joint: int, cam: Cam, axis: Array, path: str) -> tuple[RowPlan, int]:
        """The row of a follower on a cam's profile, and the coordinate that is the profile's parameter."""
        ends = self._liaisons.ends(joint)
        R = self._bodies.rotation(self._bodies.attachment_body(ends[0]))
        u = R.T @ axis
        s, points = sampled(cam.profile, f"{path}.profile")
        across = (points - points[0]) @ u
        if np.ptp(across) > PLANAR * np.ptp(points, axis=0).max():
            raise ModelError(
                f"the profile leaves the plane normal to the axis by {np.ptp(across):.3g} m",
                path=f"{path}.profile",
                remedy="give the profile in the cam's plane, in the axes of its body",
            )
        x = self._seen_from_carrier(ends)
        if cam.face is None:
            apart = points - x
            apart -= np.outer(apart @ u, u)
            nearest = int(np.argmin(np.linalg.norm(apart, axis=1)))
            tangent = points[(nearest + 1) % len(points)] - points[nearest - 1]
            side = float(np.sign(np.cross(u, tangent) @ -apart[nearest]))
            initial = _refined(cam.profile, s, nearest, lambda c: ((c[0] - x) @ c[1], c[1] @ c[1] + (c[0] - x) @ c[2]))
            row = self._add(cam.profile, s, initial, ends[0], u, f"{path}.profile")
            coordinate = self._liaisons.add_coordinate(joint, CURVE_POINT, row)
            start = self._liaisons.add_data([side * cam.radius])
            return RowPlan(CAM, joint, start, coordinate, ends, "contact with the cam"), coordinate
        m = R.T @ (np.array(cam.face) / np.linalg.norm(cam.face))
        if abs(m @ u) > PLANAR:
            raise ModelError(
                "the follower's face is not parallel to the cam's axis",
                path=f"{path}.face",
                remedy="give a normal in the cam's plane",
            )
        heights = (points - x) @ m
        extreme = [int(np.argmax(heights)), int(np.argmin(heights))]
        touching = min(extreme, key=lambda k: abs(heights[k]))
        initial = _refined(cam.profile, s, touching, lambda c: (c[1] @ m, c[2] @ m))
        row = self._add(cam.profile, s, initial, ends[0], u, f"{path}.profile")
        coordinate = self._liaisons.add_coordinate(joint, CURVE_FACE, row)
        return RowPlan(CAM_FACE, joint, 0, coordinate, ends, "contact with the cam"), coordinate

    def _add(self, curve: Curve, s: Array, initial: float, carrier: int, reference: Array, path: str) -> int:
        shift = -self._bodies.attachment_point(carrier)
        data = [initial, s[0], s[-1], *shift, *reference]
        function, pieces = -1, 0
        if isinstance(curve, SplineCurve):
            breaks, coefficients = _pieces(curve, path)
            pieces = len(coefficients)
            data += [*breaks, *coefficients.ravel()]
        else:
            function = min(self._liaisons.add_function(_of_s(part)) for part in (curve.x, curve.y, curve.z))
        return self._liaisons.add_curve(function, self._liaisons.add_data(data), pieces, curve.closed)

    def _seen_from_carrier(self, ends: tuple[int, int]) -> Array:
        """The second's point in the axes of the body that carries the curve, initial pose."""
        body = self._bodies.attachment_body(ends[0])
        return self._bodies.to_body(body, self._bodies.attachment_position(ends[1]))


def sampled(curve: Curve, path: str) -> tuple[Array, Array]:
    """Parameters (p,) from the first to the last and points (p, 3). Raises ModelError where the curve is not one."""
    if isinstance(curve, SplineCurve):
        breaks, c = _pieces(curve, path)
        s = np.linspace(breaks[0], breaks[-1], SAMPLES)
        piece = np.clip(np.searchsorted(breaks, s, side="right") - 1, 0, len(c) - 1)
        x = (s - breaks[piece])[:, None]
        points = c[piece, :, 0] + x * (c[piece, :, 1] + x * (c[piece, :, 2] + x * c[piece, :, 3]))
        return s, points
    start, stop = curve.interval
    if not start < stop:
        raise ModelError(
            f"the parameter runs from {start} to {stop}", path=f"{path}.s", remedy="give an increasing pair"
        )
    s = np.linspace(start, stop, SAMPLES)
    points = np.column_stack([evaluate(f.codes, f.values, [s]) for f in map(_of_s, (curve.x, curve.y, curve.z))])
    if not np.isfinite(points).all():
        bad = s[int(np.argmin(np.isfinite(points).all(axis=1)))]
        raise ModelError(f"the curve is not finite at s = {bad:.6g}", path=path, remedy="shorten the interval of s")
    if curve.closed and np.linalg.norm(points[-1] - points[0]) > 1e-9 * max(np.ptp(points, axis=0).max(), 1e-300):
        raise ModelError(
            f"the closed curve's ends are {np.linalg.norm(points[-1] - points[0]):.3g} m apart",
            path=path,
            remedy="let s run over one whole period, or leave out `closed`",
        )
    return s, points


def _refined(curve: Curve, s: Array, k: int, condition: Callable[[Array], tuple[float, float]]) -> float:
    """The parameter near the sample s[k] at which a condition is zero, by Newton's method, else the sample.

    condition : of the curve and its first two derivatives (3, 3), with its own derivative. So that the coordinate, which
    counts from here, begins at zero.
    """
    step = float(s[1] - s[0])
    low, high = float(s[k]) - step, float(s[k]) + step
    if not curve.closed:
        low, high = max(low, float(s[0])), min(high, float(s[-1]))
    at = float(s[k])
    for _ in range(10):
        within = s[0] + (at - s[0]) % (s[-1] - s[0]) if curve.closed else at
        value, slope = condition(_derivatives(curve, within))
        change = -value / slope if slope != 0.0 else np.nan
        if not np.isfinite(change):
            return float(s[k])
        at = min(max(at + change, low), high)
    return at


def _derivatives(curve: Curve, s: float) -> Array:
    """The point and its first two derivatives (3, 3) at s."""
    if isinstance(curve, SplineCurve):
        breaks, c = curve_pieces(curve)
        piece = min(max(int(np.searchsorted(breaks, s, side="right")) - 1, 0), len(c) - 1)
        x = s - breaks[piece]
        powers = np.array([[1.0, x, x * x, x**3], [0.0, 1.0, 2.0 * x, 3.0 * x * x], [0.0, 0.0, 2.0, 6.0 * x]])
        return np.asarray(powers @ c[piece].T)
    out = np.empty((3, 3))
    for i, part in enumerate((curve.x, curve.y, curve.z)):
        evaluate_jet(*program(_of_s(part)), s, out[i])
    return out.T


def surface_data(surface: SplineSurface, path: str) -> list[float]:
    """What the kernels read of a spline surface."""
    try:
        x, y, c = surface_pieces(surface)
    except ValueError as error:
        raise ModelError(str(error), path=path, remedy="give increasing x and y and a height for every pair") from None
    return [float(x.size), float(y.size), *x, *y, *c.ravel()]


def _of_s(formula: Formula) -> TimeFunction:
    return TimeFunction(formula.text, formula.codes, formula.values)


def _pieces(curve: SplineCurve, path: str) -> tuple[Array, Array]:
    try:
        return curve_pieces(curve)
    except ValueError as error:
        raise ModelError(str(error), path=path, remedy="give different points, in order along the curve") from None


def _away_from_tangents(points: Array) -> Array:
    """A direction that no tangent of the curve is close to: a plane curve's normal, or the best of many."""
    tangents = np.diff(points, axis=0)
    tangents = tangents[np.linalg.norm(tangents, axis=1) > 0.0]
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    candidates = np.linalg.svd(tangents, full_matrices=True)[2][::-1]
    grid = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) > (0, 0, 0)])
    candidates = np.vstack([candidates, grid / np.linalg.norm(grid, axis=1)[:, None]])
    return np.asarray(candidates[int(np.argmin(np.abs(candidates @ tangents.T).max(axis=1)))])

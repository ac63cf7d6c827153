"""What a set of nodes looks like: a bore, a plane face, an edge. For checks of a model, not for mechanics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from .mesh import Array, IntArray, Mesh

Kind = Literal["point", "line", "circle", "plane", "cylinder", "general"]

_FLAT = 1e-4  # spread across a line or plane, relative to the largest spread
_ROUND = 0.05  # root mean square distance from a circle or cylinder, relative to its radius
_EXPLAINED = 0.2  # and relative to the spread that the circle or cylinder is to explain
_FEWEST = 6
_SEARCHED = 400


@dataclass(frozen=True, eq=False)
class SetGeometry:
    """The shape of a set of nodes (body frame, m).

    centroid : (3,) mean of the nodes, the point of an attachment on them.
    kind, axis : ``cylinder``: its axis; ``plane`` and ``circle``: the normal; ``line``: its direction;
        ``general``: the direction of largest spread; ``point``: none. A unit vector (3,) whose largest
        component is positive.
    point : (3,) on the axis of a cylinder, or centre of a circle, nearest the centroid; otherwise the centroid.
    radius : of the cylinder or circle, m. residual : root mean square distance of the nodes from the fitted
        shape, m (0 for ``general``, which fits nothing).
    """

    kind: Kind
    centroid: Array
    axis: Array | None
    point: Array
    radius: float | None = None
    residual: float = 0.0


def set_geometry(mesh: Mesh, nodes: IntArray) -> SetGeometry:
    """The shape of the set `nodes` (indices, at least one).

    By principal axes first: a set whose spread (root mean square) across a direction or a plane is below 1e-4
    of its largest is a line or a plane. In a plane the best circle is tried, otherwise the best cylinder: a
    linear least-squares circle across each direction of a grid on the half sphere, then orthogonal distance
    regression from the best. It is taken if six nodes or more lie within 5 % of the radius and within 20 % of
    the spread to be explained (root mean square), so that neither a block's sides nor a rough plane pass for a
    cylinder. A chordal mesh of a bore leaves a residual; eight chords are still recognised.
    """
    points = mesh.nodes[nodes]
    centroid = points.mean(axis=0)
    offsets = points - centroid
    # three rows of zeros: the factorisation then gives three directions however few the nodes are
    _, singular, directions = np.linalg.svd(np.vstack([offsets, np.zeros((3, 3))]), full_matrices=False)
    spread = singular / np.sqrt(len(points))
    if spread[0] == 0.0:
        return SetGeometry("point", centroid, None, centroid)
    if spread[1] <= _FLAT * spread[0]:
        return SetGeometry("line", centroid, _oriented(directions[0]), centroid, residual=float(np.hypot(*spread[1:])))
    if spread[2] <= _FLAT * spread[0]:
        normal = _oriented(directions[2])
        center, radius, residual = _circle(offsets, normal)
        if _accepted(len(points), radius, residual, spread[1]):
            return SetGeometry(
                "circle", centroid, normal, centroid + center, radius, float(np.hypot(residual, spread[2]))
            )
        return SetGeometry("plane", centroid, normal, centroid, residual=float(spread[2]))
    if len(points) >= _FEWEST:
        axis, center, radius, residual = _cylinder(offsets, directions)
        if _accepted(len(points), radius, residual, spread[2]):
            return SetGeometry("cylinder", centroid, _oriented(axis), centroid + center, radius, residual)
    return SetGeometry("general", centroid, _oriented(directions[0]), centroid)


def _accepted(count: int, radius: float, residual: float, spread: float) -> bool:
    return count >= _FEWEST and residual <= _ROUND * radius and residual <= _EXPLAINED * spread


def _oriented(axis: Array) -> Array:
    """The unit vector along `axis` with its largest component positive."""
    largest = axis[np.argmax(np.abs(axis) > 0.999 * np.abs(axis).max())]
    oriented: Array = axis / np.linalg.norm(axis) * np.sign(largest) + 0.0  # no negative zeros
    return oriented


def _across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors that make a right-handed frame with `axis`."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def _circle(offsets: Array, axis: Array) -> tuple[Array, float, float]:
    """Least-squares circle of the points (n, 3) seen along `axis`: centre (3,), radius, residual.

    Linear in centre and r² − |centre|² (Kåsa's fit): |p|² = 2 p·c + (r² − |c|²).
    """
    first, second = _across(axis)
    plane = offsets @ np.column_stack([first, second])
    columns = np.column_stack([2.0 * plane, np.ones(len(plane))])
    solution = np.linalg.lstsq(columns, (plane**2).sum(axis=1), rcond=None)[0]
    center = solution[:2]
    distance = np.linalg.norm(plane - center, axis=1)
    radius = float(distance.mean())
    residual = float(np.sqrt(np.mean((distance - radius) ** 2)))
    return center[0] * first + center[1] * second, radius, residual


def _cylinder(offsets: Array, principal: Array) -> tuple[Array, Array, float, float]:
    """Best cylinder of the points (n, 3): axis (3,), point on it nearest the centroid (3,), radius, residual."""
    few = offsets[:: max(1, len(offsets) // _SEARCHED)]
    candidates = np.vstack([principal, _half_sphere()])
    start = candidates[np.argmin([_circle(few, axis)[2] / _circle(few, axis)[1] for axis in candidates])]
    first, second = _across(start)

    def unpack(x: Array) -> tuple[Array, Array]:
        axis = start + x[0] * first + x[1] * second
        return axis / np.linalg.norm(axis), x[2] * first + x[3] * second

    def distances(x: Array) -> Array:
        axis, center = unpack(x)
        relative = offsets - center
        across: Array = np.linalg.norm(relative - np.outer(relative @ axis, axis), axis=1)
        return across - float(x[4])

    center, radius, _ = _circle(offsets, start)
    guess = np.array([0.0, 0.0, center @ first, center @ second, radius])
    from scipy.optimize import least_squares  # not at the start of every run: it brings much along

    fit = least_squares(distances, guess, x_scale=[1.0, 1.0, radius, radius, radius], max_nfev=50)
    axis, center = unpack(fit.x)
    center = center - (center @ axis) * axis
    return axis, center, float(fit.x[4]), float(np.sqrt(np.mean(fit.fun**2)))


def _half_sphere(count: int = 100) -> Array:
    """Directions spread evenly over a half sphere (Fibonacci's spiral), (count, 3)."""
    height = (np.arange(count) + 0.5) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    flat = np.sqrt(1.0 - height**2)
    return np.column_stack([flat * np.cos(turn), flat * np.sin(turn), height])

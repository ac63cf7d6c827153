"""From space to paper: the camera, and surfaces as shaded polygons from back to front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

PLANAR = 1e-3  # motion out of the plane, relative to motion in it, below which a mechanism counts as planar
SHARP = np.cos(np.radians(35.0))  # edges sharper than this are drawn as lines
_AMBIENT = 0.5


@dataclass(frozen=True, eq=False)
class Camera:
    """A parallel projection: `right`, `up` and `toward` the viewer, a right-handed set of unit vectors (3,)."""

    right: Array
    up: Array
    toward: Array

    def flat(self, points: Array) -> Array:
        """Points (..., 3) on paper, (..., 2)."""
        return np.stack([points @ self.right, points @ self.up], axis=-1)

    def depth(self, points: Array) -> Array:
        """How near points (..., 3) are to the viewer, (...)."""
        return np.asarray(points @ self.toward)

    def axis_names(self) -> tuple[str, str] | None:
        """Names of the global axes that run along the paper's two, where they do."""
        names = [_axis_name(self.right), _axis_name(self.up)]
        return None if None in names else (str(names[0]), str(names[1]))


UPWARDS = (0.0, 0.0, 1.0)


def upwards(gravity: Array) -> Array:
    """The global axis, or its opposite, that comes closest to the upward direction; z without gravity (3,)."""
    k = int(np.argmax(np.abs(gravity)))
    return np.array(UPWARDS) if gravity[k] == 0.0 else -np.sign(gravity[k]) * np.eye(3)[k]


def _across(up: Array) -> tuple[Array, Array]:
    """For an axis that is up, those that run to the right and away from the viewer: a right-handed set."""
    right = np.eye(3)[1 if up[0] != 0.0 else 0]
    return right, np.cross(up, right)


def facing(normal: Array, vertical: Sequence[float] | Array = UPWARDS) -> Camera:
    """A camera that looks at the plane with a given normal, from the side on which the view reads usually.

    Up is the `vertical` (a global axis) as far as the plane allows; where the plane is horizontal, the axis that a
    viewer above sees going up (y). The side is chosen so that the main horizontal axis runs to the right.
    """
    normal = normal / np.linalg.norm(normal)
    up = np.asarray(vertical, dtype=np.float64)
    if abs(up @ normal) > 0.9:
        up = _across(up)[1]
    up = up - (up @ normal) * normal
    up /= np.linalg.norm(up)
    right = np.cross(up, normal)
    if right[np.argmax(np.abs(right))] < 0.0:
        right = -right
    return Camera(right, up, np.cross(right, up))


def axonometric(azimuth: float = -60.0, elevation: float = 24.0, vertical: Sequence[float] | Array = UPWARDS) -> Camera:
    """A camera that looks down on the scene with a global axis upwards (z); angles in degrees."""
    a, e = np.radians(azimuth), np.radians(elevation)
    up = np.asarray(vertical, dtype=np.float64)
    first, second = _across(up)
    toward = np.cos(e) * (np.cos(a) * first + np.sin(a) * second) + np.sin(e) * up
    right = np.cos(a) * second - np.sin(a) * first
    return Camera(right, np.cross(toward, right), toward)


def plane_of(directions: Array) -> Array | None:
    """Normal (3,) of the plane that directions (k, 3) span, or None if they do not span just a plane."""
    squares, axes = np.linalg.eigh(directions.T @ directions)
    across, second, first = np.sqrt(np.maximum(squares, 0.0))
    if second <= PLANAR * first or across > PLANAR * second:
        return None
    return np.asarray(axes[:, 0])


@dataclass(frozen=True, eq=False)
class Polygons:
    """Polygons on paper, from back to front: corners (2 or 3 each, 2), where they come from, and their light.

    triangle : number of the triangle that each shows; −1 for the line of a sharp edge.
    light : brightness (0 to 1) of each.
    """

    corners: list[Array]
    triangle: IntArray
    light: Array


def surface(camera: Camera, points: Array, triangles: IntArray) -> Polygons:
    """What a closed surface shows to a camera, as polygons to be painted one over the other.

    Triangles (t, 3) of points (n, 3), counter-clockwise seen from outside. Those that face away are left out;
    the others are lit by Lambert's law from above the viewer's left shoulder. Sharp edges and the outline
    become lines of two corners, which stand just in front of the triangles that they belong to.
    """
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    front = normals @ camera.toward > 1e-6
    lamp = camera.toward + 0.55 * camera.up - 0.45 * camera.right
    lamp = lamp / np.linalg.norm(lamp)
    light = _AMBIENT + (1.0 - _AMBIENT) * np.clip(normals @ lamp, 0.0, 1.0)

    seen = np.flatnonzero(front)
    edges = _sharp_edges(triangles, normals, front)
    size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    depth = np.concatenate(
        [
            camera.depth(corners[seen]).mean(axis=1),
            camera.depth(points[edges]).max(axis=1) + 2e-3 * size,
        ]
    )
    flat = camera.flat(points)
    shapes = [*flat[triangles[seen]], *flat[edges]]
    origin = np.concatenate([seen, np.full(len(edges), -1, dtype=np.int64)])
    brightness = np.concatenate([light[seen], np.zeros(len(edges))])
    order = np.argsort(depth, kind="stable")
    return Polygons([shapes[i] for i in order], origin[order], brightness[order])


def _sharp_edges(triangles: IntArray, normals: Array, front: NDArray[np.bool_]) -> IntArray:
    """Edges (e, 2) between a visible triangle and one at a sharp angle to it, facing away, or missing."""
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort(sides.T)
    sides, owner = sides[order], owner[order]
    same = (sides[1:] == sides[:-1]).all(axis=1)
    first = np.flatnonzero(same)
    a, b = owner[first], owner[first + 1]
    sharp = (np.einsum("ij,ij->i", normals[a], normals[b]) < SHARP) | (front[a] != front[b])
    sharp &= front[a] | front[b]
    paired = np.zeros(len(sides), dtype=np.bool_)
    paired[first] = paired[first + 1] = True
    single = ~paired & front[owner]
    return np.concatenate([sides[first[sharp]], sides[single]])


def _axis_name(direction: Array) -> str | None:
    k = int(np.argmax(np.abs(direction)))
    return "xyz"[k] if direction[k] > 1.0 - 1e-6 else None

"""Splines of curves and surfaces, as the numbers that the kernels read."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.model.curves import SplineCurve, SplineSurface

Array = NDArray[np.float64]


def curve_pieces(curve: SplineCurve) -> tuple[Array, Array]:
    """Breaks (n + 1,) and coefficients (n, 3, 4), powers of s − break, of the spline through a curve's points.

    Raises ValueError for fewer than two points (three if closed) or two equal neighbours.
    """
    points = np.array(curve.points, dtype=np.float64)
    if len(points) < (3 if curve.closed else 2):
        raise ValueError(f"{len(points)} points are too few")
    if curve.closed:
        points = np.vstack([points, points[:1]])
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if np.any(chords == 0.0):
        raise ValueError(f"points {int(np.argmin(chords)) + 1} and the next are the same")
    breaks = np.concatenate([[0.0], np.cumsum(chords)])
    from scipy.interpolate import CubicSpline  # not at the start of every run: it brings much along

    spline = CubicSpline(breaks, points, bc_type="periodic" if curve.closed else "natural")
    return breaks, np.ascontiguousarray(np.asarray(spline.c)[::-1].transpose(1, 2, 0))


def surface_pieces(surface: SplineSurface) -> tuple[Array, Array, Array]:
    """Breaks in x and y and coefficients (p − 1, q − 1, 4, 4) of the tensor-product spline z = h(x, y).

    Raises ValueError where the grid does not increase or the heights do not fit it.
    """
    x, y, z = (np.array(part, dtype=np.float64) for part in (surface.x, surface.y, surface.z))
    if z.shape != (x.size, y.size) or min(z.shape) < 2:
        raise ValueError(f"the heights are {z.shape}, the grid is ({x.size}, {y.size})")
    if np.any(np.diff(x) <= 0.0) or np.any(np.diff(y) <= 0.0):
        raise ValueError("the grid must increase")
    from scipy.interpolate import CubicSpline  # not at the start of every run: it brings much along

    along_x = np.asarray(CubicSpline(x, z, axis=0, bc_type="natural").c)[::-1]  # (4, p − 1, q)
    both = np.asarray(CubicSpline(y, along_x, axis=2, bc_type="natural").c)[::-1]  # (4, q − 1, 4, p − 1)
    return x, y, np.ascontiguousarray(both.transpose(3, 1, 2, 0))

"""Compiled curves: points with derivatives, and the parameter nearest to a point or touched by a face.

A curve c(s) is three functions of s or a piecewise cubic. Its entry in `data`: the parameter at t = 0, the first and
the last one, the curve's origin seen from the attachment that carries it (3), a unit vector (3) that its tangents stay
away from (a cam's axis), then for a spline the n + 1 breaks and the coefficients (n, 3, 4) of powers of s − break.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from maggi.linalg.compiling import kernel
from maggi.linalg.jets import evaluate

from .tables import (
    CURVE_CLOSED,
    CURVE_DATA,
    CURVE_FUNCTION,
    CURVE_PIECES,
    Array,
    IntArray,
    LiaisonTable,
)
from .vectors import dot

INITIAL, START, STOP, SHIFT, REFERENCE, SPLINE = 0, 1, 2, 3, 6, 9
MOST_ITERATIONS = 30


@njit(cache=True)
def curve_point(table: LiaisonTable, curve: IntArray, s: float, out: Array) -> None:
    """Point, first and second derivative of a curve at s: out (3, 3); NaN beyond the ends of an open one."""
    d = curve[CURVE_DATA]
    data = table.data
    start, stop = data[d + START], data[d + STOP]
    if curve[CURVE_CLOSED] == 1:
        s = start + (s - start) % (stop - start)
    elif not (start <= s <= stop):
        out[:, :] = np.nan
        return
    if curve[CURVE_FUNCTION] >= 0:
        jet = np.empty(3)
        for i in range(3):
            f = curve[CURVE_FUNCTION] + i
            o, e = table.function_start[f], table.function_start[f + 1]
            evaluate(table.function_codes[o:e], table.function_values[o:e], s, jet)
            for k in range(3):
                out[k, i] = jet[k]
    else:
        n = curve[CURVE_PIECES]
        breaks = data[d + SPLINE : d + SPLINE + n + 1]
        piece = min(max(np.searchsorted(breaks, s, side="right") - 1, 0), n - 1)
        x = s - breaks[piece]
        o = d + SPLINE + n + 1 + 12 * piece
        for i in range(3):
            c0, c1, c2, c3 = data[o + 4 * i], data[o + 4 * i + 1], data[o + 4 * i + 2], data[o + 4 * i + 3]
            out[0, i] = c0 + x * (c1 + x * (c2 + x * c3))
            out[1, i] = c1 + x * (2.0 * c2 + x * 3.0 * c3)
            out[2, i] = 2.0 * c2 + x * 6.0 * c3
    for i in range(3):
        out[0, i] += data[d + SHIFT + i]


@kernel
def nearest_parameter(table: LiaisonTable, curve: IntArray, s: float, x: Array, out: Array) -> float:
    """The parameter near s with (x − c(s)) · c′(s) = 0, and the curve there: out (3, 3). x (3,): carrier's axes."""
    for _ in range(MOST_ITERATIONS):
        curve_point(table, curve, s, out)
        value = 0.0
        slope = 0.0
        speed = 0.0
        for i in range(3):
            value += (x[i] - out[0, i]) * out[1, i]
            slope += (x[i] - out[0, i]) * out[2, i] - out[1, i] * out[1, i]
            speed += out[1, i] * out[1, i]
        # inside the centre of curvature the point is nearest; beyond, walk along the curve
        step = -value / slope if slope < -1e-3 * speed else value / speed
        limit = 0.1 * (table.data[curve[CURVE_DATA] + STOP] - table.data[curve[CURVE_DATA] + START])
        step = min(max(step, -limit), limit)
        if not math.isfinite(step):
            return np.nan
        s += step
        if abs(step) <= 1e-15 * (abs(s) + limit):
            break
    curve_point(table, curve, s, out)
    return s


@kernel
def touching_parameter(table: LiaisonTable, curve: IntArray, s: float, m: Array, out: Array) -> float:
    """The parameter near s with c′(s) · m = 0, and the curve there: out (3, 3). m (3,): a normal, carrier's axes."""
    for _ in range(MOST_ITERATIONS):
        curve_point(table, curve, s, out)
        slope = dot(out[2], m)
        speed = math.sqrt(dot(out[1], out[1]))
        limit = 0.1 * (table.data[curve[CURVE_DATA] + STOP] - table.data[curve[CURVE_DATA] + START])
        step = -dot(out[1], m) / slope if abs(slope) > 1e-6 * speed / limit else limit
        step = min(max(step, -limit), limit)
        if not math.isfinite(step):
            return np.nan
        s += step
        if abs(step) <= 1e-15 * (abs(s) + limit):
            break
    curve_point(table, curve, s, out)
    return s

"""Compiled surfaces F(x) = 0: value, gradient and the gradient's rate along a motion.

An expression gives F directly; a bicubic spline gives F = z − h(x, y), its entry in `data` being the numbers of breaks
in x and y, the breaks, and the coefficients (n_x − 1, n_y − 1, 4, 4) of powers of x − break and y − break.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.linalg.jets import evaluate_jet

from .tables import Array, LiaisonTable


@njit(cache=True)
def surface(table: LiaisonTable, function: int, start: int, x: Array, xd: Array, gradient: Array, rate: Array) -> float:
    """F at x (3,), ∇F to `gradient` (3,) and its rate H ẋ to `rate` (3,); carrier's axes."""
    if function < 0:
        return spline_surface(table.data, start, x, xd, gradient, rate)
    o, e = table.function_start[function], table.function_start[function + 1]
    codes, values = table.function_codes[o:e], table.function_values[o:e]
    jets = np.zeros((3, 3))
    out = np.empty(3)
    for i in range(3):
        jets[i, 0] = x[i]
    for k in range(3):
        # e_kᵀ H ẋ = (D²F along e_k + ẋ, less that along e_k − ẋ) / 4
        for i in range(3):
            jets[i, 1] = xd[i]
        jets[k, 1] += 1.0
        evaluate_jet(codes, values, jets, out)
        rate[k] = 0.25 * out[2]
        for i in range(3):
            jets[i, 1] = -xd[i]
        jets[k, 1] += 1.0
        evaluate_jet(codes, values, jets, out)
        rate[k] -= 0.25 * out[2]
        for i in range(3):
            jets[i, 1] = 0.0
        jets[k, 1] = 1.0
        evaluate_jet(codes, values, jets, out)
        gradient[k] = out[1]
    return float(out[0])


@njit(cache=True)
def spline_surface(data: Array, start: int, x: Array, xd: Array, gradient: Array, rate: Array) -> float:
    """`surface` for z − h(x, y); NaN beyond the grid."""
    p, q = int(data[start]), int(data[start + 1])
    xs = data[start + 2 : start + 2 + p]
    ys = data[start + 2 + p : start + 2 + p + q]
    if not (xs[0] <= x[0] <= xs[p - 1] and ys[0] <= x[1] <= ys[q - 1]):
        return np.nan
    i = min(max(np.searchsorted(xs, x[0], side="right") - 1, 0), p - 2)
    j = min(max(np.searchsorted(ys, x[1], side="right") - 1, 0), q - 2)
    u, v = x[0] - xs[i], x[1] - ys[j]
    o = start + 2 + p + q + 16 * (i * (q - 1) + j)
    h = hx = hy = hxx = hxy = hyy = 0.0
    for k in range(3, -1, -1):
        c0, c1, c2, c3 = data[o + 4 * k], data[o + 4 * k + 1], data[o + 4 * k + 2], data[o + 4 * k + 3]
        b = c0 + v * (c1 + v * (c2 + v * c3))
        by = c1 + v * (2.0 * c2 + v * 3.0 * c3)
        byy = 2.0 * c2 + v * 6.0 * c3
        hxx = hxx * u + 2.0 * hx
        hx = hx * u + h
        h = h * u + b
        hxy = hxy * u + hy
        hy = hy * u + by
        hyy = hyy * u + byy
    gradient[0] = -hx
    gradient[1] = -hy
    gradient[2] = 1.0
    rate[0] = -(hxx * xd[0] + hxy * xd[1])
    rate[1] = -(hxy * xd[0] + hyy * xd[1])
    rate[2] = 0.0
    return float(x[2] - h)

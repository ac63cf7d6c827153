"""Compiled passes over a meshed body's freedoms: Newmark's prediction and the correction, nothing allocated."""

from __future__ import annotations

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from maggi.integrators.generalized_alpha import GeneralizedAlpha

Array = NDArray[np.float64]


@njit(cache=True, parallel=True)
def predict_nodal(
    c: GeneralizedAlpha,
    linear: float,
    u: Array,
    ud: Array,
    udd: Array,
    a: Array,
    a_previous: Array,
    u_next: Array,
    ud_next: Array,
    udd_next: Array,
    a_next: Array,
) -> None:
    """The state at the end of the step with predicted accelerations: `kernels.predict` for nodal freedoms."""
    for i in prange(u.size):
        b = a[i] + linear * (a[i] - a_previous[i])
        a_next[i] = b
        udd_next[i] = ((1.0 - c.alpha_m) * b + c.alpha_m * a[i] - c.alpha_f * udd[i]) / (1.0 - c.alpha_f)
        ud_next[i] = ud[i] + c.h * ((1.0 - c.gamma) * a[i] + c.gamma * b)
        u_next[i] = u[i] + c.h * ud[i] + c.h * c.h * ((0.5 - c.beta) * a[i] + c.beta * b)


@njit(cache=True, parallel=True)
def correct_nodal(
    c: GeneralizedAlpha,
    free: Array,
    Y: Array,
    Z: Array,
    Z_D: Array,
    force: Array,
    position_force: Array,
    velocity_force: Array,
    u_next: Array,
    ud_next: Array,
    udd_next: Array,
    a_next: Array,
    squares: Array,
) -> None:
    """δ = x − Yφ − Zπ − Z_Dκ and what follows from it, with the shifts Yπ, Yκ (Theory §5, step 6).

    squares (p,): sums of δ² over p equal parts of the freedoms, so that their sum does not depend on the threads.
    """
    parts = squares.size
    k = force.size
    for part in prange(parts):
        total = 0.0
        for i in range(free.size * part // parts, free.size * (part + 1) // parts):
            delta = free[i]
            shift = 0.0
            rate_shift = 0.0
            for j in range(k):
                y = Y[i, j]
                delta -= y * force[j] + Z[i, j] * position_force[j] + Z_D[i, j] * velocity_force[j]
                shift += y * position_force[j]
                rate_shift += y * velocity_force[j]
            total += delta * delta
            a_next[i] += delta
            udd_next[i] += c.sigma * delta
            ud_next[i] += c.gamma * c.h * delta + rate_shift
            u_next[i] += c.beta * c.h * c.h * delta + shift
        squares[part] = total

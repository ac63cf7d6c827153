"""Compiled passes over a meshed body's freedoms, nothing allocated, and what connects them with its small coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.compiling import kernel
from maggi.linalg.lanes import WIDTH, farther, four, four_at, number, put_four, sum_of
from maggi.linalg.shared import SharedPass, inner_pass
from maggi.linalg.table import Table

Array = NDArray[np.float64]

CACHED = 512  # freedoms that the prediction takes at a time, so that what it reads twice is still at hand


@dataclass(frozen=True, eq=False)
class NodalStep(Table):
    """The nodal fields of a body through a step, and what changes them; fields have N = 4g ≥ nd places, the last of them zero.

    linear (1,): 1 where accelerations are extrapolated by a line, 0 where kept. prediction (3, 4), gain (4,): see
    `coefficients`. now, following (4, N): u, u̇, ü and a at the beginning and at the end of the step; before the
    prediction the last a is that of the step before. solution (N,): Ŝ⁻¹ of the residual. responses (k, g, 12, 4): see
    `Condensation`. forces (4, 6k): φ + yκ, π, κ, π + zκ for damping (y, z). loaded (k,): 0 where all forces of an attachment are zero.
    sizes (p, 2): sums of δ² and the largest |u| of p equal parts of the freedoms.
    """

    linear: Array
    prediction: Array
    gain: Array
    now: Array
    following: Array
    solution: Array
    responses: Array
    forces: Array
    loaded: NDArray[np.int64]
    sizes: Array


def coefficients(c: GeneralizedAlpha) -> tuple[Array, Array]:
    """The step's method as numbers: what u, u̇, ü at its end have of themselves, u̇, a and b, the a at its end, (3, 4); and
    what an increment of b adds to u, u̇, ü and b, (4,).
    """
    prediction = (
        (1.0, c.h, c.h**2 * (0.5 - c.beta), c.h**2 * c.beta),
        (1.0, 0.0, c.h * (1.0 - c.gamma), c.h * c.gamma),
        (-c.alpha_f / (1.0 - c.alpha_f), 0.0, c.alpha_m / (1.0 - c.alpha_f), c.sigma),
    )
    return np.array(prediction), np.array((c.beta * c.h**2, c.gamma * c.h, c.sigma, 1.0))


@SharedPass
def predict_nodal(of: NodalStep, part: int, parts: int) -> None:
    """The state at the end of the step with predicted accelerations: `prediction.predict` for nodal freedoms."""
    now, following, linear = of.now, of.following, of.linear[0]
    size = now.shape[1]
    end = size * (part + 1) // parts
    for first in range(size * part // parts, end, CACHED):
        here = slice(first, min(first + CACHED, end))
        ud, a, b = now[1][here], now[3][here], following[3][here]
        _extrapolate(linear, a, b)
        for r in range(3):
            _combine(of.prediction[r], now[r][here], ud, a, b, following[r][here])


@inner_pass
def _extrapolate(linear: float, a: Array, before: Array) -> None:
    """``before = a + linear (a − before)``."""
    for i in range(a.size):
        before[i] = a[i] if linear == 0.0 else a[i] + linear * (a[i] - before[i])  # not finite where a step has failed


@inner_pass
def _combine(weights: Array, x: Array, y: Array, z: Array, w: Array, out: Array) -> None:
    """A weighted sum of four; loops that write one array LLVM vectorises."""
    w0, w1, w2, w3 = weights[0], weights[1], weights[2], weights[3]
    for i in range(out.size):
        out[i] = w0 * x[i] + w1 * y[i] + w2 * z[i] + w3 * w[i]


@SharedPass
def correct_nodal(of: NodalStep, part: int, parts: int) -> None:
    """δ = −x − Yφ − Zπ − Z_Dκ and what follows from it, with the shifts Yπ, Yκ (Theory §5, step 6); x becomes −δ."""
    x, following, groups = of.solution, of.following, of.responses.shape[1]
    size = following.shape[1]
    total = largest = four(0.0)
    for g in range(groups * part // parts, groups * (part + 1) // parts):
        place = WIDTH * g
        negative, moved, quickened = four_at(x, place), four(0.0), four(0.0)
        for k in range(of.loaded.size):
            if of.loaded[k] != 0:
                negative, moved, quickened = _respond(of, k, g, negative, moved, quickened)
        put_four(x, place, negative)
        u = four_at(following, place) + (moved + -of.gain[0] * negative)
        put_four(following, place, u)
        _add_four(following, size + place, quickened + -of.gain[1] * negative)
        for r in range(2, 4):
            _add_four(following, r * size + place, -of.gain[r] * negative)
        total += negative * negative
        largest = farther(largest, u)
    of.sizes[part, 0] = sum_of(total)
    of.sizes[part, 1] = max(max(number(largest, 0), number(largest, 1)), max(number(largest, 2), number(largest, 3)))


@inner_pass
def _respond(of, k, g, negative, moved, quickened):  # type: ignore[no-untyped-def]
    """What forces at an attachment add to −δ and to the shifts of u and u̇, at four freedoms."""
    responses, forces = of.responses, of.forces
    place = 12 * WIDTH * (k * responses.shape[1] + g)
    for j in range(6):
        Y = four_at(responses, place + WIDTH * j)
        negative += forces[0, 6 * k + j] * Y
        moved += forces[1, 6 * k + j] * Y
        quickened += forces[2, 6 * k + j] * Y
    for j in range(6):
        negative += forces[3, 6 * k + j] * four_at(responses, place + WIDTH * (6 + j))
    return negative, moved, quickened


@inner_pass
def _add_four(x, place, more):  # type: ignore[no-untyped-def]
    put_four(x, place, four_at(x, place) + more)


@kernel
def add_fields(a: float, x: Array, b: float, y: Array, out: Array) -> None:
    """``out += a x + b y``."""
    for i in range(out.size):
        out[i] += a * x[i] + b * y[i]


@kernel
def inner_product(x: Array, y: Array) -> float:
    """x · y, in one order: BLAS would share it among its threads."""
    total = 0.0
    for i in range(x.size):
        total += x[i] * y[i]
    return total


@kernel
def attachment_values(indptr: Array, indices: Array, values: Array, factor: float, x: Array, out: Array) -> None:
    """``out = factor Bᵀ x``; B (nd, 6k) by columns: indptr, indices, values."""
    for j in range(out.size):
        total = 0.0
        for p in range(indptr[j], indptr[j + 1]):
            total += values[p] * x[indices[p]]
        out[j] = factor * total


@kernel
def distance(x: Array, y: Array) -> float:
    """|x − y|, in one order."""
    total = 0.0
    for i in range(x.size):
        total += (x[i] - y[i]) * (x[i] - y[i])
    return float(np.sqrt(total))


@kernel
def frame_compliance(sigma: float, mass: float, S: Array, J: Array, out: Array) -> None:
    """``(σ J₆)⁻¹``, J₆ = [[m I, −S̃], [S̃, J]], into out (6, 6): by the inertia about the centre of mass, s = S/m."""
    s0, s1, s2 = S[0] / mass, S[1] / mass, S[2] / mass
    # J_s = J − m (s·s I − s sᵀ), and its adjugate
    square = s0 * s0 + s1 * s1 + s2 * s2
    a = J[0, 0] - mass * (square - s0 * s0)
    b = J[1, 1] - mass * (square - s1 * s1)
    c = J[2, 2] - mass * (square - s2 * s2)
    d = 0.5 * (J[0, 1] + J[1, 0]) + mass * s0 * s1
    e = 0.5 * (J[0, 2] + J[2, 0]) + mass * s0 * s2
    f = 0.5 * (J[1, 2] + J[2, 1]) + mass * s1 * s2
    i00, i11, i22 = b * c - f * f, a * c - e * e, a * b - d * d
    i01, i02, i12 = e * f - d * c, d * f - e * b, d * e - a * f
    scale = 1.0 / (sigma * (a * i00 + d * i01 + e * i02))
    out[3, 3], out[3, 4], out[3, 5] = scale * i00, scale * i01, scale * i02
    out[4, 3], out[4, 4], out[4, 5] = scale * i01, scale * i11, scale * i12
    out[5, 3], out[5, 4], out[5, 5] = scale * i02, scale * i12, scale * i22
    # upper right: s̃ J_s⁻¹; upper left: I/m − s̃ J_s⁻¹ s̃, where (row) s̃ = row × s
    for k in range(3, 6):
        x, y, z = out[3, k], out[4, k], out[5, k]
        out[0, k] = s1 * z - s2 * y
        out[1, k] = s2 * x - s0 * z
        out[2, k] = s0 * y - s1 * x
    for i in range(3):
        for k in range(3, 6):
            out[k, i] = out[i, k]
    for i in range(3):
        x, y, z = out[i, 3], out[i, 4], out[i, 5]
        out[i, 0] = -(y * s2 - z * s1)
        out[i, 1] = -(z * s0 - x * s2)
        out[i, 2] = -(x * s1 - y * s0)
        out[i, i] += 1.0 / (sigma * mass)
    out[1, 0], out[2, 0], out[2, 1] = out[0, 1], out[0, 2], out[1, 2]

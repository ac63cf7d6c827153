"""Compiled passes over a meshed body's freedoms, nothing allocated, and what connects them with its small coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.compiling import kernel
from maggi.linalg.shared import SharedPass, inner_pass
from maggi.linalg.table import Table

Array = NDArray[np.float64]

CACHED = 512  # freedoms that a pass over many fields takes at a time, so that what it reads twice is still at hand


@dataclass(frozen=True, eq=False)
class NodalStep(Table):
    """The nodal fields of a body through a step, and what changes them; all (nd,) where nothing else is said.

    linear (1,): 1 where accelerations are extrapolated by a line, 0 where kept. prediction (3, 4), gain (4,): see
    `coefficients`. now, following (4, nd): u, u̇, ü and a at the beginning and at the end of the step; before the
    prediction the last a is that of the step before. solution: Ŝ⁻¹ of the residual. responses (k, 12, nd), damping (2,):
    see `Condensation`. forces (3, 6k): φ, π, κ. scratch (p, 2, CACHED). sizes (p, 2): sums of δ² and the largest |u| of p
    equal parts of the freedoms.
    """

    linear: Array
    prediction: Array
    gain: Array
    now: Array
    following: Array
    solution: Array
    responses: Array
    damping: Array
    forces: Array
    scratch: Array
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
    x, responses, forces, y, z = of.solution, of.responses, of.forces, of.damping[0], of.damping[1]
    following = of.following
    scratch = of.scratch[part]
    total = 0.0
    largest = 0.0
    end = x.size * (part + 1) // parts
    for first in range(x.size * part // parts, end, CACHED):
        here = slice(first, min(first + CACHED, end))
        negative = x[here]
        moved, quickened = scratch[0, : negative.size], scratch[1, : negative.size]
        moved[:] = 0.0
        quickened[:] = 0.0
        for k in range(responses.shape[0]):
            six = slice(6 * k, 6 * k + 6)
            phi, pi, kappa, Y, Z = forces[0, six], forces[1, six], forces[2, six], responses[k, :6], responses[k, 6:]
            if _nonzero(phi) + _nonzero(pi) + _nonzero(kappa) == 0:
                continue
            _add_columns(Y, phi, y, kappa, here, negative)
            _add_columns(Z, pi, z, kappa, here, negative)
            _add_columns(Y, pi, 0.0, pi, here, moved)
            _add_columns(Y, kappa, 0.0, kappa, here, quickened)
        for r in range(4):
            _add(-of.gain[r], negative, following[r][here])
        for r in range(2):
            _add(1.0, scratch[r, : negative.size], following[r][here])
        total += inner_product(negative, negative)
        largest = max(largest, _largest(following[0][here]))
    of.sizes[part, 0] = total
    of.sizes[part, 1] = largest


@inner_pass
def _add_columns(columns: Array, weights: Array, factor: float, more: Array, here: slice, out: Array) -> None:
    """``out += columnsᵀ (weights + factor more)`` of the freedoms here; columns (6, nd), weights, more (6,)."""
    y0, y1, y2, y3, y4, y5 = (
        columns[0][here],
        columns[1][here],
        columns[2][here],
        columns[3][here],
        columns[4][here],
        columns[5][here],
    )
    w0, w1, w2 = weights[0] + factor * more[0], weights[1] + factor * more[1], weights[2] + factor * more[2]
    w3, w4, w5 = weights[3] + factor * more[3], weights[4] + factor * more[4], weights[5] + factor * more[5]
    for i in range(out.size):
        out[i] += y0[i] * w0 + y1[i] * w1 + y2[i] * w2 + y3[i] * w3 + y4[i] * w4 + y5[i] * w5


@inner_pass
def _add(factor: float, x: Array, out: Array) -> None:
    """``out += factor x``."""
    for i in range(out.size):
        out[i] += factor * x[i]


@inner_pass
def _nonzero(x: Array) -> int:
    """How many values are not zero; what is not finite counts."""
    count = 0
    for i in range(x.size):
        count += 1 if x[i] != 0.0 else 0
    return count


@inner_pass
def _largest(x: Array) -> float:
    """The largest absolute value."""
    largest = 0.0
    for i in range(x.size):
        largest = max(largest, abs(x[i]))
    return largest


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

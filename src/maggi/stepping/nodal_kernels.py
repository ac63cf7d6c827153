"""Compiled passes over a meshed body's freedoms, nothing allocated: prediction and correction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.lanes import WIDTH, farther, four, four_at, number, put_four, sum_of
from maggi.linalg.shared import SharedPass, inner_pass
from maggi.linalg.table import Table

Array = NDArray[np.float64]

CACHED = 512  # freedoms that the prediction takes at a time, so that what it reads twice is still at hand


@dataclass(frozen=True, eq=False)
class Columns(Table):
    """A sparse matrix by columns."""

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    values: Array

    @staticmethod
    def of(matrix: sp.csc_matrix) -> Columns:
        """The same."""
        return Columns(matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32), matrix.data)


@dataclass(frozen=True, eq=False)
class NodalStep(Table):
    """The nodal fields of a body through a step, and what changes them; fields have N = 4g ≥ nd places, those behind nd zero.

    linear (1,): 1 where accelerations are extrapolated by a line, 0 where kept. prediction (3, 4), gain (4,): see
    `coefficients`. now, following (4, N): u, u̇, ü and a at the beginning and at the end of the step; before the
    prediction the last a is that of the step before. solution (N,): Ŝ⁻¹ of the residual, to which implied (2,) times u and u̇ is to
    be added. columns: of B. responses (k, g, 12, 4), damping (2,), y and z: see `Condensation`. forces (4, 6k): φ + yκ, π, κ, π + zκ.
    loaded (k,): 0 where all forces of an attachment are zero. sizes (p, 2): sums of δ² and the largest |u| of p equal parts
    of the freedoms.
    """

    linear: Array
    prediction: Array
    gain: Array
    now: Array
    following: Array
    solution: Array
    implied: Array
    columns: Columns
    responses: Array
    damping: Array
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

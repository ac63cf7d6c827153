"""Prescribed frames, compiled: given functions of time, or the recorded motion of another run."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from maggi.linalg.jets import evaluate
from maggi.linalg.rotations import exp_se3_update, exp_so3
from maggi.linalg.table import Table

from .tables import Array, BodyTable, IntArray, MotionState


@dataclass(frozen=True, eq=False)
class MotionTable(Table):
    """Constants of all prescribed frames. g given by functions, q recorded at n equidistant times.

    given_body (g,); given_rotation (g, 3, 3): at angle 0; given_axis (g, 3): body axes; four functions each
    (origin x, y, z; angle) in function_start (4 g + 1,), function_codes, function_values.
    recorded_body (q,); recorded_step (s); recorded_origin (q, n, 3), recorded_rotation (q, n, 3, 3),
    recorded_twist, recorded_rate (q, n, 6): body axes.
    """

    given_body: IntArray
    given_rotation: Array
    given_axis: Array
    function_start: IntArray
    function_codes: IntArray
    function_values: Array
    recorded_body: IntArray
    recorded_step: float
    recorded_origin: Array
    recorded_rotation: Array
    recorded_twist: Array
    recorded_rate: Array


def prescribe(table: MotionTable, bodies: BodyTable, t: float, state: MotionState) -> None:
    """`move_prescribed`, which nothing calls, or compiles, where no frame is prescribed."""
    if table.given_body.size or table.recorded_body.size:
        move_prescribed(table, bodies, t, state)


@njit(cache=True)
def move_prescribed(table: MotionTable, bodies: BodyTable, t: float, state: MotionState) -> None:
    """Set origin, rotation, twist and its rate of every prescribed frame at time t.

    Between two recorded instants the motion is continued from the earlier with the constant twist rate that
    leads to the later, third-order accurate in position.
    """
    jet = np.empty((4, 3))
    increment = np.empty(6)
    for g in range(table.given_body.shape[0]):
        b = table.given_body[g]
        o = bodies.offset[b]
        for i in range(4):
            s, e = table.function_start[4 * g + i], table.function_start[4 * g + i + 1]
            evaluate(table.function_codes[s:e], table.function_values[s:e], t, jet[i])
        axis = table.given_axis[g]
        for i in range(3):
            state.origin[b, i] = jet[i, 0]
            increment[i] = axis[i] * jet[3, 0]
            state.v[o + 3 + i] = axis[i] * jet[3, 1]
            state.vd[o + 3 + i] = axis[i] * jet[3, 2]
        R = state.rotation[b]
        turn = np.empty((3, 3))
        exp_so3(increment[:3], turn)
        for i in range(3):
            for j in range(3):
                value = 0.0
                for k in range(3):
                    value += table.given_rotation[g, i, k] * turn[k, j]
                R[i, j] = value
        for i in range(3):
            v = 0.0
            a = 0.0
            for k in range(3):
                v += R[k, i] * jet[k, 1]
                a += R[k, i] * jet[k, 2]
            state.v[o + i] = v
            state.vd[o + i] = a
        # (Rᵀṙ)˙ = Rᵀr̈ − ω × Rᵀṙ
        w0, w1, w2 = state.v[o + 3], state.v[o + 4], state.v[o + 5]
        v0, v1, v2 = state.v[o], state.v[o + 1], state.v[o + 2]
        state.vd[o] -= w1 * v2 - w2 * v1
        state.vd[o + 1] -= w2 * v0 - w0 * v2
        state.vd[o + 2] -= w0 * v1 - w1 * v0
    if table.recorded_body.shape[0] == 0:
        return
    x = t / table.recorded_step
    n = table.recorded_origin.shape[1]
    k = min(max(math.floor(x + 1e-9), 0), n - 1)
    dt = t - k * table.recorded_step
    if abs(dt) < 1e-9 * table.recorded_step:
        dt = 0.0
    share = dt / table.recorded_step
    m = min(k + 1, n - 1)
    for q in range(table.recorded_body.shape[0]):
        b = table.recorded_body[q]
        o = bodies.offset[b]
        for i in range(6):
            twist = table.recorded_twist[q, k, i]
            slope = table.recorded_twist[q, m, i] - twist
            increment[i] = dt * (twist + 0.5 * share * slope)
            state.v[o + i] = twist + share * slope
            state.vd[o + i] = (1.0 - share) * table.recorded_rate[q, k, i] + share * table.recorded_rate[q, m, i]
        exp_se3_update(
            table.recorded_rotation[q, k],
            table.recorded_origin[q, k],
            increment[:3],
            increment[3:],
            state.rotation[b],
            state.origin[b],
        )

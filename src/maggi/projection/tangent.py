"""Positions of all bodies in coordinates near a base state, and the rates of these coordinates, compiled.

A frame (R₀, r₀) is moved by x = (d, θ) to R = R₀ exp(θ̃), r = r₀ + R₀ d, so that travel and turns do not mix: a body
that rolls or drives far keeps a good chart. The twist in body axes is then ``v = exp(θ̃)ᵀ ḋ``, ``ω = T_r(θ) θ̇``,
T_r = T_lᵀ. Elastic coordinates are added.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.bodies.tables import FIXED, Array, BodyTable, IntArray, MotionState
from maggi.linalg.compiling import kernel
from maggi.linalg.rotations import exp_so3, left_tangent


@njit(cache=True)
def displace(bodies: BodyTable, base: MotionState, x: Array, turns: Array, out: MotionState) -> None:
    """Positions x (n,) away from the base; turns (b, 3, 3): exp(θ̃) of every floating frame."""
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED:
            continue
        o = bodies.offset[b]
        for i in range(o + 6, bodies.offset[b + 1]):
            out.e[i] = base.e[i] + x[i]
        if bodies.floating[b] == 0:
            continue
        exp_so3(x[o + 3 : o + 6], turns[b])
        for i in range(3):
            shift = 0.0
            for k in range(3):
                shift += base.rotation[b, i, k] * x[o + k]
            out.origin[b, i] = base.origin[b, i] + shift
            for j in range(3):
                value = 0.0
                for k in range(3):
                    value += base.rotation[b, i, k] * turns[b, k, j]
                out.rotation[b, i, j] = value


@njit(cache=True)
def on_coordinates(bodies: BodyTable, slot: IntArray, x: Array, turns: Array, rows: Array) -> None:
    """Turn rows (k, u), in place, from coefficients on the velocities to coefficients on ẋ."""
    T = np.empty((3, 3))
    y = np.empty(6)
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED or bodies.floating[b] == 0:
            continue
        left_tangent(x[bodies.offset[b] + 3 : bodies.offset[b] + 6], T)
        o = slot[bodies.offset[b]]
        for i in range(rows.shape[0]):
            for k in range(3):
                y[k] = 0.0
                y[3 + k] = 0.0
                for l in range(3):
                    y[k] += rows[i, o + l] * turns[b, k, l]
                    y[3 + k] += rows[i, o + 3 + l] * T[k, l]
            for k in range(6):
                rows[i, o + k] = y[k]


@njit(cache=True)
def rates_of_coordinates(bodies: BodyTable, x: Array, turns: Array, v: Array, out: Array) -> None:
    """out (n,) = ẋ for velocities v (n,); zero for prescribed frames."""
    T = np.empty((3, 3))
    inverse = np.empty((3, 3))
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED:
            continue
        o = bodies.offset[b]
        for i in range(o + 6, bodies.offset[b + 1]):
            out[i] = v[i]
        if bodies.floating[b] == 0:
            for i in range(o, o + 6):
                out[i] = 0.0
            continue
        left_tangent(x[o + 3 : o + 6], T)
        invert3(T, inverse)
        for i in range(3):
            out[o + i] = 0.0
            out[o + 3 + i] = 0.0
            for j in range(3):
                out[o + i] += turns[b, i, j] * v[o + j]
                out[o + 3 + i] += inverse[j, i] * v[o + 3 + j]


@kernel
def invert3(a: Array, out: Array) -> None:
    """The inverse of a (3, 3), by cofactors."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for l in range(3):
            m, n = (l + 1) % 3, (l + 2) % 3
            out[l, i] = a[j, m] * a[k, n] - a[j, n] * a[k, m]
    determinant = a[0, 0] * out[0, 0] + a[0, 1] * out[1, 0] + a[0, 2] * out[2, 0]
    for i in range(3):
        for j in range(3):
            out[i, j] /= determinant

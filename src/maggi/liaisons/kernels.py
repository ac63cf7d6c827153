"""Compiled rows of liaisons: residuals at three levels and coefficients (Eq. T7), from attachments' motions alone."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from maggi.bodies.kernels import generalised_force
from maggi.bodies.tables import Array, AttachmentState, BodyTable, MotionState
from maggi.linalg.jets import evaluate
from maggi.linalg.rotations import log_so3

from .tables import (
    DRIVEN,
    DRIVEN_RATE,
    OFFSET,
    PRODUCT,
    ROTATION,
    ROTATION_VECTOR,
    TRANSLATION,
    LiaisonState,
    LiaisonTable,
)


@njit(cache=True)
def _axis(rotation: Array, frame: Array, k: int, out: Array) -> None:
    """Axis k of a joint's frame, global components."""
    for i in range(3):
        out[i] = rotation[i, 0] * frame[0, k] + rotation[i, 1] * frame[1, k] + rotation[i, 2] * frame[2, k]


@njit(cache=True)
def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@njit(cache=True)
def _cross(a: Array, b: Array, out: Array) -> None:
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    out[0] = x
    out[1] = y
    out[2] = z


@njit(cache=True)
def joint_coordinates(table: LiaisonTable, attachments: AttachmentState, out: LiaisonState) -> None:
    """Every joint coordinate and its rate: second relative to first, rotations right-handed and unwrapped."""
    x = np.empty(3)
    y = np.empty(3)
    z = np.empty(3)
    for c in range(table.coordinate_joint.shape[0]):
        j = table.coordinate_joint[c]
        k = table.coordinate_axis[c]
        kind = table.coordinate_kind[c]
        p, q = table.first[j], table.second[j]
        R, S = attachments.rotation[p], attachments.rotation[q]
        w = attachments.angular_velocity
        if kind == TRANSLATION:
            _axis(R, table.first_frame[j], k, z)
            for i in range(3):
                x[i] = attachments.position[q, i] - attachments.position[p, i]
                y[i] = attachments.velocity[q, i] - attachments.velocity[p, i]
            out.coordinate[c] = _dot(x, z)
            out.rate[c] = _dot(y, z)
            _cross(w[p], z, z)
            out.rate[c] += _dot(x, z)
            continue
        if kind == ROTATION_VECTOR:
            relative = np.empty((3, 3))
            for i in range(3):
                _axis(R, table.first_frame[j], i, x)
                for l in range(3):
                    _axis(S, table.second_frame[j], l, y)
                    relative[i, l] = _dot(x, y)
            log_so3(relative, y)
            _axis(R, table.first_frame[j], k, z)
            out.coordinate[c] = y[k]
        else:
            # the angle about z between an axis of the first and the same axis of the second, both normal to z
            if kind == ROTATION:
                _axis(R, table.first_frame[j], k, z)
                other = (k + 1) % 3
            else:
                _axis(S, table.second_frame[j], k, z)
                other = (k + 2) % 3
            _axis(R, table.first_frame[j], other, x)
            _axis(S, table.second_frame[j], other, y)
            cosine = _dot(x, y)
            _cross(x, y, x)
            angle = math.atan2(_dot(x, z), cosine)
            turns = round((out.previous[c] - angle) / (2.0 * math.pi))
            out.coordinate[c] = angle + 2.0 * math.pi * turns
        out.rate[c] = z[0] * (w[q, 0] - w[p, 0]) + z[1] * (w[q, 1] - w[p, 1]) + z[2] * (w[q, 2] - w[p, 2])


@njit(cache=True)
def evaluate_rows(
    table: LiaisonTable,
    bodies: BodyTable,
    state: MotionState,
    attachments: AttachmentState,
    t: float,
    out: LiaisonState,
) -> None:
    """Φ, A v + b, A v̇ + γ and the coefficients A of every row.

    offset:   φ = D·a,  D = p₂ − p₁, a turning with the first end
    product:  φ = a·b,  a turning with the first end, b with the second
    driven:   φ = coordinate − f(t), or only its rate
    """
    joint_coordinates(table, attachments, out)
    a = np.empty(3)
    n = np.empty(3)
    D = np.empty(3)
    V = np.empty(3)
    B = np.empty(3)
    x = np.empty(3)
    f = np.zeros(3)
    w = attachments.angular_velocity
    al = attachments.angular_acceleration
    out.A[:] = 0.0
    for i in range(table.row_kind.shape[0]):
        kind = table.row_kind[i]
        j = table.row_joint[i]
        p, q = table.first[j], table.second[j]
        k = table.row_first[i]
        rotation = kind != OFFSET
        if kind == DRIVEN or kind == DRIVEN_RATE:
            c = k
            k = table.coordinate_axis[c]
            rotation = table.coordinate_kind[c] == ROTATION
            o, e = table.function_start[table.row_second[i]], table.function_start[table.row_second[i] + 1]
            evaluate(table.function_codes[o:e], table.function_values[o:e], t, f)
        _axis(attachments.rotation[p], table.first_frame[j], k, a)
        if rotation:
            # coefficients ±n on the angular velocities: n = a × b, or minus the driven axis
            if kind != PRODUCT:
                for l in range(3):
                    n[l] = -a[l]
                _cross(w[p], n, x)
            else:
                _axis(attachments.rotation[q], table.second_frame[j], table.row_second[i], B)
                out.position[i] = _dot(a, B)
                _cross(a, B, n)
                _cross(w[p], a, V)
                _cross(V, B, x)
                _cross(w[q], B, V)
                _cross(a, V, V)
                for l in range(3):
                    x[l] += V[l]
            rate = 0.0
            gamma = 0.0
            for l in range(3):
                rate += n[l] * (w[p, l] - w[q, l])
                gamma += n[l] * (al[p, l] - al[q, l]) + x[l] * (w[p, l] - w[q, l])
                out.force[i, 0, l] = 0.0
                out.force[i, 1, l] = 0.0
                out.moment[i, 0, l] = n[l]
                out.moment[i, 1, l] = -n[l]
            out.velocity[i] = rate
            out.acceleration[i] = gamma
        else:
            for l in range(3):
                D[l] = attachments.position[q, l] - attachments.position[p, l]
                V[l] = attachments.velocity[q, l] - attachments.velocity[p, l]
                B[l] = attachments.acceleration[q, l] - attachments.acceleration[p, l]
            out.position[i] = _dot(D, a)
            _cross(w[p], a, x)
            _cross(a, D, n)
            out.velocity[i] = _dot(V, a) + _dot(D, x)
            gamma = _dot(B, a) + 2.0 * _dot(V, x) + _dot(n, al[p])
            _cross(w[p], x, x)
            out.acceleration[i] = gamma + _dot(D, x)
            for l in range(3):
                out.force[i, 0, l] = -a[l]
                out.force[i, 1, l] = a[l]
                out.moment[i, 0, l] = n[l]
                out.moment[i, 1, l] = 0.0
        out.rhs[i] = 0.0
        if kind == DRIVEN:
            out.position[i] = out.coordinate[c] - f[0]
            out.velocity[i] -= f[1]
            out.acceleration[i] -= f[2]
            out.rhs[i] = -f[1]
        elif kind == DRIVEN_RATE:
            out.position[i] = 0.0
            out.velocity[i] -= f[0]
            out.acceleration[i] -= f[1]
            out.rhs[i] = -f[0]
        for l in range(2):
            end = p if l == 0 else q
            b = bodies.attachment_body[end]
            start = table.segment[i, l]
            size = bodies.offset[b + 1] - bodies.offset[b]
            generalised_force(
                bodies,
                state,
                attachments,
                end,
                out.force[i, l, 0],
                out.force[i, l, 1],
                out.force[i, l, 2],
                out.moment[i, l, 0],
                out.moment[i, l, 1],
                out.moment[i, l, 2],
                out.A[start : start + size],
            )

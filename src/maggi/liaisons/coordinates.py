"""Compiled joint coordinates: second relative to first, with rates, accelerations and the rates' coefficients."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from maggi.bodies.tables import Array, AttachmentState
from maggi.linalg.rotations import log_so3

from .curves import INITIAL, nearest_parameter, touching_parameter
from .tables import (
    COORDINATE_AXIS,
    COORDINATE_JOINT,
    COORDINATE_KIND,
    CURVE_DATA,
    CURVE_FACE,
    CURVE_POINT,
    ROTATION,
    ROTATION_VECTOR,
    TRANSLATION,
    LiaisonState,
    LiaisonTable,
)
from .vectors import (
    axis,
    cross,
    difference,
    dot,
    row,
    scalar_product,
    to_global,
    to_local,
    turned_axis,
    vector_product,
)


@njit(cache=True)
def joint_coordinates(table: LiaisonTable, attachments: AttachmentState, out: LiaisonState) -> None:
    """Every joint coordinate, with rate, acceleration and coefficients; rotations right-handed and unwrapped."""
    x = np.empty(3)
    y = np.empty(3)
    z = np.empty(3)
    zd = np.empty(3)
    for c in range(table.coordinate.shape[0]):
        j = table.coordinate[c, COORDINATE_JOINT]
        k = table.coordinate[c, COORDINATE_AXIS]
        kind = table.coordinate[c, COORDINATE_KIND]
        p, q = table.joint[j, 0], table.joint[j, 1]
        R, S = attachments.rotation[p], attachments.rotation[q]
        w = attachments.angular_velocity
        al = attachments.angular_acceleration
        wrench = out.coordinate_wrench[c]
        wrench[:, :] = 0.0
        if kind == TRANSLATION:
            axis(R, table.frame[j, 0], k, z)
            for i in range(3):
                x[i] = attachments.position[q, i] - attachments.position[p, i]
                wrench[0, i] = -z[i]
                wrench[1, i] = z[i]
            out.coordinate[c, 0] = dot(x, z)
            cross(x, z, wrench[0, 3:])
            for i in range(3):
                wrench[0, 3 + i] = -wrench[0, 3 + i]
            out.coordinate[c, 1] = _rate(wrench, attachments, p, q)
            cross(w[p], z, zd)
            value = 0.0
            for i in range(3):
                y[i] = attachments.velocity[q, i] - attachments.velocity[p, i]
                value += z[i] * (attachments.acceleration[q, i] - attachments.acceleration[p, i])
            value += 2.0 * dot(y, zd)
            cross(al[p], z, y)
            value += dot(x, y)
            cross(w[p], zd, y)
            out.coordinate[c, 2] = value + dot(x, y)
            continue
        if kind == CURVE_POINT or kind == CURVE_FACE:
            _curve_parameter(table, attachments, c, out)
            continue
        if kind == ROTATION_VECTOR:
            relative = np.empty((3, 3))
            for i in range(3):
                axis(R, table.frame[j, 0], i, x)
                for l in range(3):
                    axis(S, table.frame[j, 1], l, y)
                    relative[i, l] = dot(x, y)
            log_so3(relative, y)
            axis(R, table.frame[j, 0], k, z)
            cross(w[p], z, zd)
            out.coordinate[c, 0] = y[k]
            rate = 0.0
            value = 0.0
            for i in range(3):
                wrench[0, 3 + i] = -z[i]
                wrench[1, 3 + i] = z[i]
                rate += z[i] * (w[q, i] - w[p, i])
                value += zd[i] * (w[q, i] - w[p, i]) + z[i] * (al[q, i] - al[p, i])
            out.coordinate[c, 1] = rate
            out.coordinate[c, 2] = value
            continue
        # the angle about an axis between an axis of the first and the same axis of the second, both normal to it
        first = kind == ROTATION
        carrier = p if first else q
        other = (k + 1) % 3 if first else (k + 2) % 3
        about = turned_axis(attachments.rotation, carrier, table.frame, j, 0 if first else 1, k)
        turning = vector_product(row(w, carrier), about)
        a = turned_axis(attachments.rotation, p, table.frame, j, 0, other)
        b = turned_axis(attachments.rotation, q, table.frame, j, 1, other)
        angle = math.atan2(scalar_product(vector_product(a, b), about), scalar_product(a, b))
        turns = round((out.previous[c] - angle) / (2.0 * math.pi))
        spin = difference(row(w, q), row(w, p))
        out.coordinate[c, 0] = angle + 2.0 * math.pi * turns
        out.coordinate[c, 1] = scalar_product(about, spin)
        value = scalar_product(turning, spin)
        out.coordinate[c, 2] = value + scalar_product(about, difference(row(al, q), row(al, p)))
        for i in range(3):
            wrench[0, 3 + i] = -about[i]
            wrench[1, 3 + i] = about[i]


@njit(cache=True)
def _rate(wrench: Array, attachments: AttachmentState, p: int, q: int) -> float:
    value = 0.0
    for i in range(3):
        value += wrench[0, i] * attachments.velocity[p, i] + wrench[1, i] * attachments.velocity[q, i]
        value += wrench[0, 3 + i] * attachments.angular_velocity[p, i]
        value += wrench[1, 3 + i] * attachments.angular_velocity[q, i]
    return float(value)


@njit(cache=True, error_model="numpy")
def _curve_parameter(table: LiaisonTable, attachments: AttachmentState, c: int, out: LiaisonState) -> None:
    """The parameter of a curve joint, less its initial value.

    Point: ṡ = c′·ẋ / (c′·c′ − (x − c)·c″). Face with normal m: ṡ = −c′·ṁ / (c″·m). x, m in the carrier's axes.
    """
    j = table.coordinate[c, COORDINATE_JOINT]
    curve = table.curve[table.coordinate[c, COORDINATE_AXIS]]
    initial = table.data[curve[CURVE_DATA] + INITIAL]
    p, q = table.joint[j, 0], table.joint[j, 1]
    R = attachments.rotation[p]
    D = np.empty(3)
    y = np.empty(3)
    x = np.empty(3)
    r = np.empty((3, 3))
    wrench = out.coordinate_wrench[c]
    if table.coordinate[c, COORDINATE_KIND] == CURVE_POINT:
        for i in range(3):
            D[i] = attachments.position[q, i] - attachments.position[p, i]
        to_local(R, D, x)
        s = nearest_parameter(table, curve, initial + out.previous[c], x, r)
        scale = 0.0
        for i in range(3):
            scale += r[1, i] * r[1, i] - (x[i] - r[0, i]) * r[2, i]
        to_global(R, r[1], y)
        for i in range(3):
            y[i] /= scale
            wrench[0, i] = -y[i]
            wrench[1, i] = y[i]
        cross(y, D, wrench[0, 3:])
    else:
        axis(attachments.rotation[q], table.frame[j, 1], 2, D)
        to_local(R, D, x)
        s = touching_parameter(table, curve, initial + out.previous[c], x, r)
        to_global(R, r[1], y)
        cross(D, y, y)
        scale = dot(r[2], x)
        for i in range(3):
            # −c′·((ω₂ − ω₁) × m) / (c″·m)
            wrench[1, 3 + i] = -y[i] / scale
            wrench[0, 3 + i] = y[i] / scale
    out.coordinate[c, 0] = s - initial
    out.coordinate[c, 1] = _rate(wrench, attachments, p, q)
    out.coordinate[c, 2] = np.nan  # would need third derivatives: nothing may be driven along a curve

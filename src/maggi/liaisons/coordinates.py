"""Compiled joint coordinates: second relative to first, with rates, accelerations and the rates' coefficients."""

from __future__ import annotations

import math

import numpy as np

from maggi.bodies.tables import Array, AttachmentState
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.rotations import log_so3

from .curves import INITIAL, nearest_parameter, touching_parameter
from .tables import (
    COORDINATE_AXIS,
    COORDINATE_JOINT,
    COORDINATE_KIND,
    CURVE_DATA,
    CURVE_POINT,
    ROTATION,
    ROTATION_SECOND,
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


@inner_kernel
def joint_coordinates(table: LiaisonTable, attachments: AttachmentState, out: LiaisonState) -> None:
    """The joint coordinates that the table measures, with rate, acceleration and coefficients."""
    for x in range(table.measured.shape[0]):
        joint_coordinate(table, attachments, table.measured[x], out)


@inner_kernel
def joint_coordinate(table: LiaisonTable, attachments: AttachmentState, c: int, out: LiaisonState) -> None:
    """One joint coordinate; rotations right-handed and unwrapped. The rest are left to `special`."""
    kind = table.coordinate[c, COORDINATE_KIND]
    if kind == ROTATION or kind == ROTATION_SECOND:
        _turn(table, attachments, c, out)
    elif kind == TRANSLATION:
        _translation(table, attachments, c, out)


@inner_kernel
def _turn(table: LiaisonTable, attachments: AttachmentState, c: int, out: LiaisonState) -> None:
    """The angle about an axis between an axis of the first and the same axis of the second, both normal to it."""
    j = table.coordinate[c, COORDINATE_JOINT]
    k = table.coordinate[c, COORDINATE_AXIS]
    p, q = table.joint[j, 0], table.joint[j, 1]
    w, al = attachments.angular_velocity, attachments.angular_acceleration
    wrench = out.coordinate_wrench[c]
    first = table.coordinate[c, COORDINATE_KIND] == ROTATION
    carrier = p if first else q
    other = (k + 1) % 3 if first else (k + 2) % 3
    about = turned_axis(attachments.rotation, carrier, table.frame, j, 0 if first else 1, k)
    turning = vector_product(row(w, carrier), about)
    a = turned_axis(attachments.rotation, p, table.frame, j, 0, other)
    b = turned_axis(attachments.rotation, q, table.frame, j, 1, other)
    angle = math.atan2(scalar_product(vector_product(a, b), about), scalar_product(a, b))
    turns = math.floor((out.previous[c] - angle) / (2.0 * math.pi) + 0.5)
    spin = difference(row(w, q), row(w, p))
    out.coordinate[c, 0] = angle + 2.0 * math.pi * turns
    out.coordinate[c, 1] = scalar_product(about, spin)
    value = scalar_product(turning, spin)
    out.coordinate[c, 2] = value + scalar_product(about, difference(row(al, q), row(al, p)))
    for i in range(3):
        wrench[0, i] = 0.0
        wrench[1, i] = 0.0
        wrench[0, 3 + i] = -about[i]
        wrench[1, 3 + i] = about[i]


@inner_kernel
def _translation(table: LiaisonTable, attachments: AttachmentState, c: int, out: LiaisonState) -> None:
    """The position of the second end along an axis of the first."""
    j = table.coordinate[c, COORDINATE_JOINT]
    p, q = table.joint[j, 0], table.joint[j, 1]
    w = row(attachments.angular_velocity, p)
    wrench = out.coordinate_wrench[c]
    z = turned_axis(attachments.rotation, p, table.frame, j, 0, table.coordinate[c, COORDINATE_AXIS])
    x = difference(row(attachments.position, q), row(attachments.position, p))
    v = difference(row(attachments.velocity, q), row(attachments.velocity, p))
    a = difference(row(attachments.acceleration, q), row(attachments.acceleration, p))
    turning = vector_product(w, z)
    moment = vector_product(z, x)
    out.coordinate[c, 0] = scalar_product(x, z)
    out.coordinate[c, 1] = scalar_product(v, z) + scalar_product(x, turning)
    value = scalar_product(a, z) + 2.0 * scalar_product(v, turning)
    value += scalar_product(moment, row(attachments.angular_acceleration, p))
    out.coordinate[c, 2] = value + scalar_product(x, vector_product(w, turning))
    for i in range(3):
        wrench[0, i] = -z[i]
        wrench[1, i] = z[i]
        wrench[0, 3 + i] = moment[i]
        wrench[1, 3 + i] = 0.0


@kernel
def rotation_vector_component(table: LiaisonTable, attachments: AttachmentState, c: int, out: LiaisonState) -> None:
    """A component, along an axis of the first, of the rotation vector from the first's axes to the second's."""
    j = table.coordinate[c, COORDINATE_JOINT]
    k = table.coordinate[c, COORDINATE_AXIS]
    p, q = table.joint[j, 0], table.joint[j, 1]
    w, al = attachments.angular_velocity, attachments.angular_acceleration
    wrench = out.coordinate_wrench[c]
    relative = out.scratch[:3]
    for i in range(3):
        a = turned_axis(attachments.rotation, p, table.frame, j, 0, i)
        for l in range(3):
            relative[i, l] = scalar_product(a, turned_axis(attachments.rotation, q, table.frame, j, 1, l))
    log_so3(relative, out.scratch[3])
    z = turned_axis(attachments.rotation, p, table.frame, j, 0, k)
    spin = difference(row(w, q), row(w, p))
    out.coordinate[c, 0] = out.scratch[3, k]
    out.coordinate[c, 1] = scalar_product(z, spin)
    value = scalar_product(vector_product(row(w, p), z), spin)
    out.coordinate[c, 2] = value + scalar_product(z, difference(row(al, q), row(al, p)))
    for i in range(3):
        wrench[0, i] = 0.0
        wrench[1, i] = 0.0
        wrench[0, 3 + i] = -z[i]
        wrench[1, 3 + i] = z[i]


@inner_kernel
def _rate(wrench: Array, attachments: AttachmentState, p: int, q: int) -> float:
    value = 0.0
    for i in range(3):
        value += wrench[0, i] * attachments.velocity[p, i] + wrench[1, i] * attachments.velocity[q, i]
        value += wrench[0, 3 + i] * attachments.angular_velocity[p, i]
        value += wrench[1, 3 + i] * attachments.angular_velocity[q, i]
    return float(value)


@kernel
def curve_parameter(table: LiaisonTable, attachments: AttachmentState, c: int, out: LiaisonState) -> None:
    """The parameter of a curve joint, less its initial value.

    Point: ṡ = c′·ẋ / (c′·c′ − (x − c)·c″). Face with normal m: ṡ = −c′·ṁ / (c″·m). x, m in the carrier's axes.
    """
    j = table.coordinate[c, COORDINATE_JOINT]
    curve = table.curve[table.coordinate[c, COORDINATE_AXIS]]
    initial = table.data[curve[CURVE_DATA] + INITIAL]
    p, q = table.joint[j, 0], table.joint[j, 1]
    R = attachments.rotation[p]
    D, y, x = out.scratch[0], out.scratch[1], out.scratch[2]
    r = out.scratch[3:6]
    wrench = out.coordinate_wrench[c]
    wrench[:, :] = 0.0
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

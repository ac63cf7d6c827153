"""Compiled rows of liaisons: residuals at three levels and coefficients (Eq. T7), from attachments' motions alone."""

from __future__ import annotations

from numba import njit

from maggi.bodies.attachment_kernels import generalised_force
from maggi.bodies.tables import AttachmentState, BodyTable, MotionState
from maggi.linalg.compiling import inner_kernel
from maggi.linalg.links import Link, call3

from .coordinates import joint_coordinates
from .sums import relation_row
from .tables import (
    OFFSET,
    PRODUCT,
    RATE_RELATION,
    RELATION,
    ROW_FIRST,
    ROW_JOINT,
    ROW_KIND,
    ROW_SECOND,
    SPECIAL_COORDINATES,
    SPECIAL_ROWS,
    TWIST,
    LiaisonState,
    LiaisonTable,
)
from .vectors import difference, row, scalar_product, total, turned_axis, vector_product


@inner_kernel
def offset_rows(table: LiaisonTable, attachments: AttachmentState, i: int, out: LiaisonState) -> int:
    """Row i and those after it of the same kind and joint, Φ = a·(p₂ − p₁) with axes a of the first; returns the row after.

    All are components of one relative motion, Φ̇ = a·[V − ω × D] and
    Φ̈ = a·[A − 2 ω × V − ε × D + ω × (ω × D)].
    """
    row_table, rotation = table.row, attachments.rotation
    j = row_table[i, ROW_JOINT]
    p, q = table.joint[j, 0], table.joint[j, 1]
    w = row(attachments.angular_velocity, p)
    D = difference(row(attachments.position, q), row(attachments.position, p))
    V = difference(row(attachments.velocity, q), row(attachments.velocity, p))
    A = difference(row(attachments.acceleration, q), row(attachments.acceleration, p))
    swept = vector_product(w, D)
    rate = difference(V, swept)
    # 2 ω × V − ω × (ω × D) = ω × (V + rate)
    A = difference(A, vector_product(w, total(V, rate)))
    A = difference(A, vector_product(row(attachments.angular_acceleration, p), D))
    while i < row_table.shape[0] and row_table[i, ROW_KIND] == OFFSET and row_table[i, ROW_JOINT] == j:
        out.rhs[i] = 0.0
        a = turned_axis(rotation, p, table.frame, j, 0, row_table[i, ROW_FIRST])
        moment = vector_product(a, D)
        out.position[i] = scalar_product(D, a)
        out.velocity[i] = scalar_product(rate, a)
        out.acceleration[i] = scalar_product(A, a)
        e = table.end_start[i]
        for l in range(3):
            out.wrench[e, l] = -a[l]
            out.wrench[e, 3 + l] = moment[l]
            out.wrench[e + 1, l] = a[l]
            out.wrench[e + 1, 3 + l] = 0.0
        i += 1
    return i


@inner_kernel
def turn_row(table: LiaisonTable, attachments: AttachmentState, i: int, out: LiaisonState) -> None:
    """Products of axes: Φ = a_k·b_l, or a_k·b_l − a_l·b_k; a turns with the first end, b with the second."""
    j = table.row[i, ROW_JOINT]
    p, q = table.joint[j, 0], table.joint[j, 1]
    w1, w2 = row(attachments.angular_velocity, p), row(attachments.angular_velocity, q)
    spin = difference(w1, w2)
    turn = difference(row(attachments.angular_acceleration, p), row(attachments.angular_acceleration, q))
    k, l = table.row[i, ROW_FIRST], table.row[i, ROW_SECOND]
    value = 0.0
    rate = 0.0
    acceleration = 0.0
    e = table.end_start[i]
    for m in range(6):
        out.wrench[e, m] = 0.0
        out.wrench[e + 1, m] = 0.0
    sign = 1.0
    for _ in range(1 if table.row[i, ROW_KIND] == PRODUCT else 2):
        a = turned_axis(attachments.rotation, p, table.frame, j, 0, k)
        b = turned_axis(attachments.rotation, q, table.frame, j, 1, l)
        n = vector_product(a, b)
        turning = total(vector_product(vector_product(w1, a), b), vector_product(a, vector_product(w2, b)))
        value += sign * scalar_product(a, b)
        rate += sign * scalar_product(n, spin)
        acceleration += sign * (scalar_product(n, turn) + scalar_product(turning, spin))
        for m in range(3):
            out.wrench[e, 3 + m] += sign * n[m]
            out.wrench[e + 1, 3 + m] -= sign * n[m]
        k, l = l, k
        sign = -1.0
    out.position[i] = value
    out.velocity[i] = rate
    out.acceleration[i] = acceleration


@inner_kernel
def on_bodies(
    table: LiaisonTable, bodies: BodyTable, state: MotionState, attachments: AttachmentState, out: LiaisonState
) -> None:
    """A: the rows' coefficients on the bodies' velocities, from those on their ends' twists."""
    for x in range(table.end.shape[0]):
        end = table.end[x, 0]
        start = table.end[x, 1]
        b = bodies.attachment_body[end]
        size = bodies.offset[b + 1] - bodies.offset[b]
        f = row(out.wrench, x)
        m = (out.wrench[x, 3], out.wrench[x, 4], out.wrench[x, 5])
        if size == 6:  # of a rigid body: (Rᵀf, c × Rᵀf + Rᵀm), c the point in body axes
            R = state.rotation
            force = (
                R[b, 0, 0] * f[0] + R[b, 1, 0] * f[1] + R[b, 2, 0] * f[2],
                R[b, 0, 1] * f[0] + R[b, 1, 1] * f[1] + R[b, 2, 1] * f[2],
                R[b, 0, 2] * f[0] + R[b, 1, 2] * f[1] + R[b, 2, 2] * f[2],
            )
            moment = vector_product(row(attachments.arm, end), force)
            for k in range(3):
                out.A[start + k] = force[k]
                out.A[start + 3 + k] = moment[k] + R[b, 0, k] * m[0] + R[b, 1, k] * m[1] + R[b, 2, k] * m[2]
        elif size > 0:
            part = out.A[start : start + size]
            part[:] = 0.0
            generalised_force(bodies, state, attachments, end, f[0], f[1], f[2], m[0], m[1], m[2], part)


@njit(cache=True, error_model="numpy")
def evaluate_rows(
    table: LiaisonTable,
    bodies: BodyTable,
    state: MotionState,
    attachments: AttachmentState,
    out: LiaisonState,
    t: float,
) -> None:
    """Φ, A v + b, A v̇ + γ and the coefficients A of every row."""
    joint_coordinates(table, attachments, out)
    if table.special[SPECIAL_COORDINATES] != 0:
        call3(table.special[SPECIAL_COORDINATES], table, attachments, out, t)
    done = 0  # rows of one joint are evaluated together
    for i in range(table.row.shape[0]):
        if i < done:
            continue
        kind = table.row[i, ROW_KIND]
        if kind == OFFSET:
            done = offset_rows(table, attachments, i, out)
            continue
        out.rhs[i] = 0.0
        if kind == PRODUCT or kind == TWIST:
            turn_row(table, attachments, i, out)
        elif kind == RELATION or kind == RATE_RELATION:
            relation_row(table, i, t, out)
    if table.special[SPECIAL_ROWS] != 0:
        call3(table.special[SPECIAL_ROWS], table, attachments, out, t)
    on_bodies(table, bodies, state, attachments, out)


all_rows = Link(evaluate_rows)
"""`evaluate_rows` by address."""

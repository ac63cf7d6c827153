"""Compiled rows of liaisons: residuals at three levels and coefficients (Eq. T7), from attachments' motions alone."""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.bodies.kernels import generalised_force
from maggi.bodies.tables import Array, AttachmentState, BodyTable, MotionState
from maggi.linalg.jets import evaluate

from .callbacks import callback_row
from .coordinates import joint_coordinates
from .directions import point_direction
from .sums import pfaffian_row, relation_row
from .tables import (
    CALLBACK,
    DISTANCE,
    PFAFFIAN,
    PRODUCT,
    RATE_RELATION,
    RELATION,
    ROW_FIRST,
    ROW_HOLONOMIC,
    ROW_JOINT,
    ROW_KIND,
    ROW_SECOND,
    TWIST,
    LiaisonState,
    LiaisonTable,
)
from .vectors import axis, cross, dot


@njit(cache=True)
def point_row(attachments: AttachmentState, p: int, q: int, start: int, i: int, work: Array, out: LiaisonState) -> None:
    """N · [v₂ + ω₂ × ρ − v₁ − ω₁ × (P − p₁)], its rate and its coefficients; work: N, Ṅ, ρ, ρ̇ (`directions`)."""
    N, Nd, rho, rhod = work[0], work[1], work[2], work[3]
    w1, w2 = attachments.angular_velocity[p], attachments.angular_velocity[q]
    arm, armd, V, A, x = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for l in range(3):
        V[l] = attachments.velocity[q, l] - attachments.velocity[p, l]
        A[l] = attachments.acceleration[q, l] - attachments.acceleration[p, l]
        arm[l] = attachments.position[q, l] + rho[l] - attachments.position[p, l]
        armd[l] = V[l] + rhod[l]
    cross(attachments.angular_acceleration[q], rho, x)
    for l in range(3):
        A[l] += x[l]
    cross(w2, rhod, x)
    for l in range(3):
        A[l] += x[l]
    cross(attachments.angular_acceleration[p], arm, x)
    for l in range(3):
        A[l] -= x[l]
    cross(w1, armd, x)
    for l in range(3):
        A[l] -= x[l]
    cross(w2, rho, x)
    for l in range(3):
        V[l] += x[l]
    cross(w1, arm, x)
    for l in range(3):
        V[l] -= x[l]
    out.velocity[i] = dot(N, V)
    out.acceleration[i] = dot(N, A) + dot(Nd, V)
    first, second = out.wrench[start], out.wrench[start + 1]
    for l in range(3):
        first[l] = -N[l]
        second[l] = N[l]
    cross(N, arm, first[3:])
    cross(rho, N, second[3:])


@njit(cache=True)
def turn_row(table: LiaisonTable, attachments: AttachmentState, i: int, out: LiaisonState) -> None:
    """Products of axes: Φ = a_k·b_l, or a_k·b_l − a_l·b_k; a turns with the first end, b with the second."""
    j = table.row[i, ROW_JOINT]
    p, q = table.joint[j, 0], table.joint[j, 1]
    w1, w2 = attachments.angular_velocity[p], attachments.angular_velocity[q]
    a, b, ad, bd, x = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    n, nd = np.zeros(3), np.zeros(3)
    k, l = table.row[i, ROW_FIRST], table.row[i, ROW_SECOND]
    value = 0.0
    for term in range(2):
        sign = 1.0
        if term == 1:
            if table.row[i, ROW_KIND] == PRODUCT:
                break
            k, l = l, k
            sign = -1.0
        axis(attachments.rotation[p], table.frame[j, 0], k, a)
        axis(attachments.rotation[q], table.frame[j, 1], l, b)
        value += sign * dot(a, b)
        cross(w1, a, ad)
        cross(w2, b, bd)
        cross(ad, b, x)
        cross(a, bd, bd)
        cross(a, b, ad)
        for m in range(3):
            n[m] += sign * ad[m]
            nd[m] += sign * (x[m] + bd[m])
    rate = 0.0
    acceleration = 0.0
    first, second = out.wrench[table.end_start[i]], out.wrench[table.end_start[i] + 1]
    for m in range(3):
        rate += n[m] * (w1[m] - w2[m])
        acceleration += nd[m] * (w1[m] - w2[m])
        acceleration += n[m] * (attachments.angular_acceleration[p, m] - attachments.angular_acceleration[q, m])
        first[m] = 0.0
        second[m] = 0.0
        first[3 + m] = n[m]
        second[3 + m] = -n[m]
    out.position[i] = value
    out.velocity[i] = rate
    out.acceleration[i] = acceleration


@njit(cache=True)
def evaluate_rows(
    table: LiaisonTable,
    bodies: BodyTable,
    state: MotionState,
    attachments: AttachmentState,
    t: float,
    out: LiaisonState,
) -> None:
    """Φ, A v + b, A v̇ + γ and the coefficients A of every row."""
    joint_coordinates(table, attachments, out)
    work = np.empty((4, 3))
    jet = np.empty(3)
    out.A[:] = 0.0
    out.rhs[:] = 0.0
    for i in range(table.row.shape[0]):
        kind = table.row[i, ROW_KIND]
        if kind == PRODUCT or kind == TWIST:
            turn_row(table, attachments, i, out)
        elif kind == RELATION or kind == RATE_RELATION:
            relation_row(table, i, t, out)
        elif kind == PFAFFIAN:
            pfaffian_row(table, attachments, i, t, out)
        elif kind == CALLBACK:
            callback_row(table, attachments, i, t, out)
        else:
            j = table.row[i, ROW_JOINT]
            value = point_direction(table, attachments, i, t, out, work)
            point_row(attachments, table.joint[j, 0], table.joint[j, 1], table.end_start[i], i, work, out)
            out.position[i] = value if table.row[i, ROW_HOLONOMIC] == 1 else 0.0
            if kind == DISTANCE:
                f = table.row[i, ROW_FIRST]
                o, e = table.function_start[f], table.function_start[f + 1]
                evaluate(table.function_codes[o:e], table.function_values[o:e], t, jet)
                out.rhs[i] = -jet[1]
                out.velocity[i] -= jet[1]
                out.acceleration[i] -= jet[2]
    for i in range(table.row.shape[0]):
        for x in range(table.end_start[i], table.end_start[i + 1]):
            end = table.end[x, 0]
            b = bodies.attachment_body[end]
            start = table.end[x, 1]
            size = bodies.offset[b + 1] - bodies.offset[b]
            wrench = out.wrench[x]
            generalised_force(
                bodies,
                state,
                attachments,
                end,
                wrench[0],
                wrench[1],
                wrench[2],
                wrench[3],
                wrench[4],
                wrench[5],
                out.A[start : start + size],
            )

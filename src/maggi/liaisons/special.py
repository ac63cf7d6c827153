"""Compiled rows and coordinates that only some mechanisms have, called by address so that others need not compile them.

Rows between two points (`directions`) but those of lower pairs, rows that users write, parameters of curves, and rotation
vectors, which are the coordinates of joints that leave all rotations free.
"""

from __future__ import annotations

import numpy as np

from maggi.bodies.tables import Array, AttachmentState
from maggi.linalg.compiling import inner_kernel
from maggi.linalg.jets import evaluate
from maggi.linalg.links import Link

from .callbacks import callback_row
from .coordinates import curve_parameter, rotation_vector_component
from .directions import point_direction
from .sums import pfaffian_row
from .tables import (
    CALLBACK,
    COORDINATE_KIND,
    CURVE_FACE,
    CURVE_POINT,
    DISTANCE,
    OFFSET,
    PFAFFIAN,
    PRODUCT,
    RATE_RELATION,
    RELATION,
    ROTATION_VECTOR,
    ROW_FIRST,
    ROW_HOLONOMIC,
    ROW_JOINT,
    ROW_KIND,
    SPECIAL_COORDINATES,
    SPECIAL_ROWS,
    TWIST,
    LiaisonState,
    LiaisonTable,
)
from .vectors import cross, dot


@inner_kernel
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


@Link
def special_rows(table: LiaisonTable, attachments: AttachmentState, out: LiaisonState, t: float) -> None:
    """Those of all rows that `kernels.evaluate_rows` leaves to this."""
    work, jet = out.scratch[:4], out.scratch[4]
    for i in range(table.row.shape[0]):
        kind = table.row[i, ROW_KIND]
        if kind == OFFSET or kind == PRODUCT or kind == TWIST or kind == RELATION or kind == RATE_RELATION:
            continue
        if kind == PFAFFIAN:
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


@Link
def special_coordinates(table: LiaisonTable, attachments: AttachmentState, out: LiaisonState, t: float) -> None:
    """Rotation vectors and parameters of curves among the coordinates that the table measures."""
    for x in range(table.measured.shape[0]):
        c = table.measured[x]
        kind = table.coordinate[c, COORDINATE_KIND]
        if kind == CURVE_POINT or kind == CURVE_FACE:
            curve_parameter(table, attachments, c, out)
        elif kind == ROTATION_VECTOR:
            rotation_vector_component(table, attachments, c, out)


def link_special(table: LiaisonTable, attachments: AttachmentState, rows: LiaisonState) -> None:
    """Fill `table.special` with what its rows and coordinates need; the other two only give their types."""
    common = (OFFSET, PRODUCT, TWIST, RELATION, RATE_RELATION)
    if not np.isin(table.row[:, ROW_KIND], common).all():
        table.special[SPECIAL_ROWS] = special_rows.address(table, attachments, rows)
    if np.isin(table.coordinate[:, COORDINATE_KIND], (CURVE_POINT, CURVE_FACE, ROTATION_VECTOR)).any():
        table.special[SPECIAL_COORDINATES] = special_coordinates.address(table, attachments, rows)

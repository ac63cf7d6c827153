"""Compiled directions of rows between two points: where, along what, and how that turns.

Most liaisons restrict the velocity of a material point of the second body relative to the material point of the first
that is at the same place P = p₂ + ρ,

    N · [v₂ + ω₂ × ρ − v₁ − ω₁ × (P − p₁)] = 0

and differ only in the direction N and the arm ρ. Each function here fills `work` (4, 3) with N, Ṅ, ρ, ρ̇ (global) and
returns Φ, whose rate along any motion that holds the liaison is that row.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from maggi.bodies.tables import Array, AttachmentState
from maggi.linalg.compiling import inner_kernel
from maggi.linalg.jets import evaluate

from .curves import INITIAL, REFERENCE, curve_point
from .surfaces import surface
from .tables import (
    BLADE,
    CAM,
    CAM_FACE,
    COORDINATE_AXIS,
    CURVE,
    CURVE_DATA,
    DISTANCE,
    ROLL,
    ROLL_SPHERE,
    ROW_FIRST,
    ROW_JOINT,
    ROW_KIND,
    ROW_SECOND,
    SURFACE,
    LiaisonState,
    LiaisonTable,
)
from .vectors import axis, cross, dot, to_global, to_local

FLAT = 1e-6  # a disc within this angle (rad) of lying flat has no contact point


@njit(cache=True)
def point_direction(
    table: LiaisonTable, attachments: AttachmentState, i: int, t: float, out: LiaisonState, work: Array
) -> float:
    """N, Ṅ, ρ, ρ̇ of row i to `work`; returns Φ."""
    j = table.row[i, ROW_JOINT]
    kind = table.row[i, ROW_KIND]
    first = table.row[i, ROW_FIRST]
    p, q = table.joint[j, 0], table.joint[j, 1]
    N, Nd = work[0], work[1]
    work[2:, :] = 0.0
    w = attachments.angular_velocity
    D = np.empty(3)
    for l in range(3):
        D[l] = attachments.position[q, l] - attachments.position[p, l]
    if kind == BLADE:
        axis(attachments.rotation[q], table.frame[j, 1], first, N)
        cross(w[q], N, Nd)
        return 0.0
    if kind == DISTANCE:
        return _distance(table, attachments, first, p, q, t, D, N, Nd)
    if kind == ROLL or kind == ROLL_SPHERE:
        return _roll(table, attachments, i, D, work)
    if kind == SURFACE:
        return _surface(table, attachments, i, D, N, Nd)
    return _on_curve(table, attachments, i, out, D, work)


@njit(cache=True)
def _distance(
    table: LiaisonTable, attachments: AttachmentState, f: int, p: int, q: int, t: float, D: Array, N: Array, Nd: Array
) -> float:
    """|p₂ − p₁| − f(t)."""
    length = math.sqrt(dot(D, D))
    rate = 0.0
    for l in range(3):
        N[l] = D[l] / length if length > 0.0 else np.nan
        Nd[l] = (attachments.velocity[q, l] - attachments.velocity[p, l]) / length if length > 0.0 else np.nan
        rate += N[l] * Nd[l]
    for l in range(3):
        Nd[l] -= rate * N[l]
    jet = np.empty(3)
    o, e = table.function_start[f], table.function_start[f + 1]
    evaluate(table.function_codes[o:e], table.function_values[o:e], t, jet)
    return length - float(jet[0])


@inner_kernel
def _roll(table: LiaisonTable, attachments: AttachmentState, i: int, D: Array, work: Array) -> float:
    """A disc or a sphere on the plane through the first's point, normal n = z of the first; centre on n's side.

    Disc with axis u: ρ = r e, e = −(n − (n·u) u)/σ, σ² = 1 − (n·u)². Sphere: ρ = −r n. Φ = n·(D + ρ).
    """
    j = table.row[i, ROW_JOINT]
    p, q = table.joint[j, 0], table.joint[j, 1]
    w = attachments.angular_velocity
    radius = table.data[table.row[i, ROW_SECOND]]
    n, nd, u, ud = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    axis(attachments.rotation[p], table.frame[j, 0], 2, n)
    cross(w[p], n, nd)
    axis(attachments.rotation[p], table.frame[j, 0], table.row[i, ROW_FIRST], work[0])
    cross(w[p], work[0], work[1])
    if table.row[i, ROW_KIND] == ROLL:
        axis(attachments.rotation[q], table.frame[j, 1], 2, u)
        cross(w[q], u, ud)
        c = dot(n, u)
        cd = dot(nd, u) + dot(n, ud)
        sine = math.sqrt(max(1.0 - c * c, 0.0))
        if sine < FLAT:
            work[:, :] = np.nan
            return np.nan
        sd = -c * cd / sine
        for l in range(3):
            e = -(n[l] - c * u[l]) / sine
            work[2, l] = radius * e
            work[3, l] = radius * (-(nd[l] - cd * u[l] - c * ud[l]) - e * sd) / sine
    else:
        for l in range(3):
            work[2, l] = -radius * n[l]
            work[3, l] = -radius * nd[l]
    return dot(n, D) + dot(n, work[2])


@njit(cache=True)
def _relative_velocity(attachments: AttachmentState, p: int, q: int, D: Array, out: Array) -> None:
    """Velocity of the second point as seen from the first's axes, out (3,) in those axes."""
    w = attachments.angular_velocity[p]
    y = np.empty(3)
    cross(w, D, y)
    for l in range(3):
        y[l] = attachments.velocity[q, l] - attachments.velocity[p, l] - y[l]
    to_local(attachments.rotation[p], y, out)


@inner_kernel
def _surface(table: LiaisonTable, attachments: AttachmentState, i: int, D: Array, N: Array, Nd: Array) -> float:
    """F(x)/|∇F| for the second point x in the carrier's axes; N = R ∇F/|∇F|."""
    j = table.row[i, ROW_JOINT]
    p, q = table.joint[j, 0], table.joint[j, 1]
    R = attachments.rotation[p]
    start = table.row[i, ROW_SECOND]
    x, xd, g, gd, y = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    to_local(R, D, x)
    _relative_velocity(attachments, p, q, D, xd)
    for l in range(3):
        x[l] -= table.data[start + l]
    value = surface(table, table.row[i, ROW_FIRST], start + 3, x, xd, g, gd)
    size = math.sqrt(dot(g, g))
    for l in range(3):
        g[l] /= size
        gd[l] /= size
    along = dot(g, gd)
    for l in range(3):
        gd[l] -= along * g[l]
    to_global(R, g, N)
    to_global(R, gd, Nd)
    cross(attachments.angular_velocity[p], N, y)
    for l in range(3):
        Nd[l] += y[l]
    return value / size


@inner_kernel
def _on_curve(
    table: LiaisonTable, attachments: AttachmentState, i: int, out: LiaisonState, D: Array, work: Array
) -> float:
    """A point on a curve (two normals), a roller on a cam's profile, or a flat face that touches it.

    With e = c′/|c′| and the reference direction u: normals u × e/|u × e| and e × (that). A cam's profile lies in the
    plane normal to u; Φ = n·(x − c) − radius, for a face with normal m at the second's point Φ = m·(p₂ − P).
    """
    j = table.row[i, ROW_JOINT]
    kind = table.row[i, ROW_KIND]
    p, q = table.joint[j, 0], table.joint[j, 1]
    R = attachments.rotation[p]
    w = attachments.angular_velocity
    c = table.row[i, ROW_SECOND]
    curve = table.curve[table.coordinate[c, COORDINATE_AXIS]]
    d = curve[CURVE_DATA]
    r = np.empty((3, 3))
    curve_point(table, curve, table.data[d + INITIAL] + out.coordinate[c, 0], r)
    sd = out.coordinate[c, 1]
    x, y, e, ed = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    to_local(R, D, x)
    if kind == CAM_FACE:
        axis(attachments.rotation[q], table.frame[j, 1], 2, work[0])
        cross(w[q], work[0], work[1])
        for l in range(3):
            x[l] = r[0, l]
        to_global(R, x, y)
        to_global(R, r[1], e)
        cross(w[p], y, ed)
        for l in range(3):
            # the touching point, from the second's point, and its rate
            work[2, l] = y[l] - D[l]
            work[3, l] = attachments.velocity[p, l] + ed[l] + e[l] * sd - attachments.velocity[q, l]
        return -dot(work[0], work[2])
    u = table.data[d + REFERENCE : d + REFERENCE + 3]
    n, nd = np.empty(3), np.empty(3)
    cross(u, r[1], n)
    cross(u, r[2], nd)
    size = math.sqrt(dot(n, n))
    for l in range(3):
        n[l] /= size
        nd[l] *= sd / size
    along = dot(n, nd)
    for l in range(3):
        nd[l] -= along * n[l]
    if kind == CURVE and table.row[i, ROW_FIRST] == 1:
        size = math.sqrt(dot(r[1], r[1]))
        for l in range(3):
            e[l] = r[1, l] / size
            ed[l] = r[2, l] * sd / size
        along = dot(e, ed)
        for l in range(3):
            ed[l] -= along * e[l]
        cross(ed, n, y)
        cross(e, nd, nd)
        cross(e, n, n)
        for l in range(3):
            nd[l] += y[l]
    value = 0.0
    for l in range(3):
        value += n[l] * (x[l] - r[0, l])
    if kind == CAM:
        value -= table.data[table.row[i, ROW_FIRST]]
    to_global(R, n, work[0])
    to_global(R, nd, work[1])
    cross(w[p], work[0], y)
    for l in range(3):
        work[1, l] += y[l]
    return value

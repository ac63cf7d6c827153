"""Maggi's equations as an ordinary differential equation y' = f(t, y), y = (s, ν), compiled (T7–T11)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from maggi.bodies.attachment_kernels import attachment_motion
from maggi.bodies.motions import MotionTable, move_prescribed
from maggi.bodies.ritz_kernels import inertia_residual, mass_matrix
from maggi.bodies.tables import FIXED, RITZ, Array, AttachmentState, BodyTable, IntArray, MotionState
from maggi.forces.kernels import applied_forces
from maggi.forces.tables import ForceTable
from maggi.liaisons.kernels import evaluate_rows
from maggi.liaisons.tables import LiaisonState, LiaisonTable

from .chart_tables import ChartState, ChartTable
from .lu import factorise_lu, multiply, multiply_transposed, solve_inertia, solve_lu, solve_lu_transposed
from .tangent import displace, on_coordinates, rates_of_coordinates

DONE, NOT_CLOSED, TOO_FAR, NOT_FINITE, SINGULAR = 0, 1, 2, 3, 4
MOST = 15
REACH = 0.2  # of the predicted change, and of the distance from where branches meet: a correction may be as large
SETTLED = 1e-8  # a Newton correction below this part of the length leaves the square of it, round-off


@njit(cache=True)
def gather_rows(liaisons: LiaisonTable, bodies: BodyTable, slot: IntArray, flat: Array, out: Array) -> None:
    """out (r, u): the rows' coefficients on the unknown velocities, from the flat array over bodies."""
    out[:, :] = 0.0
    for b in range(bodies.kind.shape[0]):
        o = bodies.offset[b]
        n = bodies.offset[b + 1] - o
        for y in range(liaisons.incidence_start[b], liaisons.incidence_start[b + 1]):
            i = liaisons.incidence[y, 0]
            p = liaisons.incidence[y, 1]
            for k in range(n):
                j = slot[o + k]
                if j >= 0:
                    out[i, j] += flat[p + k]


@njit(cache=True)
def inertia_product(bodies: BodyTable, slot: IntArray, motion: MotionState, X: Array, out: Array) -> None:
    """out (u, k) = M X of the bodies as they stand, block by block."""
    out[:, :] = 0.0
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED:
            continue
        o = bodies.offset[b]
        size = bodies.offset[b + 1] - o
        block = np.empty((size, size))
        mass_matrix(bodies, b, motion.e[o + 6 : o + size], block)
        for i in range(size):
            p = slot[o + i]
            if p < 0:
                continue
            for j in range(size):
                q = slot[o + j]
                y = block[i, j]
                if q >= 0 and y != 0.0:
                    for k in range(X.shape[1]):
                        out[p, k] += y * X[q, k]


@njit(cache=True)
def chosen_rows(A: Array, rows: IntArray, row_scale: Array, out: Array) -> None:
    """out (k, u): the rows that are chosen as independent, scaled."""
    for i in range(rows.shape[0]):
        for l in range(A.shape[1]):
            out[i, l] = A[rows[i], l] * row_scale[rows[i]]


@njit(cache=True)
def evaluate(
    bodies: BodyTable,
    motions: MotionTable,
    liaisons: LiaisonTable,
    forces: ForceTable,
    base: MotionState,
    chart: ChartTable,
    t: float,
    s: Array,
    nu: Array,
    attachments: AttachmentState,
    rows: LiaisonState,
    out: ChartState,
    sd: Array,
    nud: Array,
) -> int:
    """ṡ (p,) and ν̇ (f,) at time t, and everything else of that state in `out`; returns DONE or why not.

    1. q(s, t): x = E_s s + N_s z such that Φ = 0, by Newton's method on z, started from the last evaluation and
       given up where it would go further from there than a continuous motion does.
    2. v = S ν + v_p.   3. γ with these velocities, a_p.   4. T10.   5. ẋ from v, ṡ = P_s ẋ.
    """
    u = chart.unknown.shape[0]
    motion = out.motion
    move_prescribed(motions, bodies, t, motion)
    for i in range(u):
        motion.v[chart.unknown[i]] = 0.0
        motion.vd[chart.unknown[i]] = 0.0
    reason = close(bodies, liaisons, base, chart, t, s, attachments, rows, out)
    if reason != DONE:
        return reason
    # velocities
    k = chart.rows.shape[0]
    f = nu.shape[0]
    B = np.empty((k, k))
    order = np.empty(k, dtype=np.int64)
    chosen = np.empty((k, u))
    chosen_rows(out.A, chart.rows, chart.row_scale, chosen)
    multiply(chosen, chart.N, B)
    out.pivots[1] = factorise_lu(B, order)
    if not out.pivots[1] > 0.0:
        return SINGULAR
    # right sides: the columns of A E, then b
    Z = np.empty((k, f + 1))
    multiply(chosen, chart.E, Z[:, :f])
    for i in range(k):
        Z[i, f] = rows.velocity[chart.rows[i]] * chart.row_scale[chart.rows[i]]
    out.b[:] = rows.velocity
    solve_lu(B, order, Z)
    NZ = np.empty((u, f + 1))
    multiply(chart.N, Z, NZ)
    for i in range(u):
        v = -NZ[i, f]
        for j in range(f):
            out.S[i, j] = chart.E[i, j] - NZ[i, j]
            v += out.S[i, j] * nu[j]
        out.v[i] = v
        motion.v[chart.unknown[i]] = v
    # accelerations
    attachment_motion(bodies, motion, attachments)
    evaluate_rows(liaisons, bodies, motion, attachments, rows, t)
    out.gamma[:] = rows.acceleration
    z = np.empty((k, 1))
    for i in range(k):
        z[i, 0] = rows.acceleration[chart.rows[i]] * chart.row_scale[chart.rows[i]]
    solve_lu(B, order, z)
    for i in range(u):
        x = 0.0
        for j in range(k):
            x -= chart.N[i, j] * z[j, 0]
        out.a_p[i] = x
    project_forces(bodies, liaisons, forces, chart, t, attachments, rows, out, nud)
    # ṡ
    full = np.empty(motion.v.shape[0])
    rates_of_coordinates(bodies, out.x, out.turns, motion.v, full)
    for i in range(s.shape[0]):
        x = 0.0
        for j in range(u):
            x += chart.P_s[i, j] * full[chart.unknown[j]]
        sd[i] = x
    # liaison forces of the chosen rows, T11
    y = np.zeros(k)
    for i in range(u):
        for j in range(k):
            y[j] += chart.N[i, j] * out.residual[i]
    solve_lu_transposed(B, order, y)
    out.multipliers[:] = 0.0
    for i in range(k):
        out.multipliers[chart.rows[i]] = y[i] * chart.row_scale[chart.rows[i]]
    for i in range(u):
        motion.vd[chart.unknown[i]] = out.vd[i]
    out.power[3] = given_power(bodies, liaisons, forces.gravity, rows, motion, out)
    total = 0.0
    for i in range(s.shape[0]):
        total += sd[i]
    for i in range(f):
        total += nud[i]
    return DONE if math.isfinite(total) else NOT_FINITE


@njit(cache=True)
def close(
    bodies: BodyTable,
    liaisons: LiaisonTable,
    base: MotionState,
    chart: ChartTable,
    t: float,
    s: Array,
    attachments: AttachmentState,
    rows: LiaisonState,
    out: ChartState,
) -> int:
    """Positions with Φ = 0 to round-off at time t, and the rows there; the unknown velocities in `out.motion` are zero."""
    u = chart.unknown.shape[0]
    k = chart.rows_s.shape[0]
    motion = out.motion
    start = out.x.copy()
    predicted = np.empty(u)
    change = 0.0
    pivot = out.pivots[0]
    for i in range(u):
        x = out.drift[i] * (t - out.at[0])
        for j in range(s.shape[0]):
            x += out.S_s[i, j] * (s[j] - out.s[j])
        out.x[chart.unknown[i]] += x
        predicted[i] = out.x[chart.unknown[i]]
        change = max(change, abs(x) * chart.scale[i])
    B = np.empty((k, k))
    order = np.empty(k, dtype=np.int64)
    chosen = np.empty((k, u))
    Z = np.empty((k, 1))
    largest = math.inf
    previous = math.inf
    for attempt in range(MOST):
        displace(bodies, base, out.x, out.turns, motion)
        attachment_motion(bodies, motion, attachments)
        evaluate_rows(liaisons, bodies, motion, attachments, rows, t)
        gather_rows(liaisons, bodies, chart.slot, rows.A, out.A)
        if largest <= SETTLED * chart.length or k == 0:
            break
        if attempt == MOST - 1 or not largest <= 4.0 * previous:
            out.x[:] = start
            return NOT_CLOSED
        previous = largest
        chosen_rows(out.A, chart.rows_s, chart.row_scale, chosen)
        on_coordinates(bodies, chart.slot, out.x, out.turns, chosen)
        multiply(chosen, chart.N_s, B)
        for i in range(k):
            Z[i, 0] = rows.position[chart.rows_s[i]] * chart.row_scale[chart.rows_s[i]]
        out.pivots[0] = factorise_lu(B, order)
        if not out.pivots[0] > 0.0:
            out.x[:] = start
            return SINGULAR
        solve_lu(B, order, Z)
        largest = 0.0
        for i in range(k):
            if abs(Z[i, 0]) > largest or math.isnan(Z[i, 0]):
                largest = abs(Z[i, 0])
        correction = 0.0
        for i in range(u):
            x = 0.0
            for j in range(k):
                x += chart.N_s[i, j] * Z[j, 0]
            out.x[chart.unknown[i]] -= x
            correction = max(correction, abs(out.x[chart.unknown[i]] - predicted[i]) * chart.scale[i])
        near = min(pivot, out.pivots[0]) / out.generic[0]  # to a singular position: about its sine
        if correction > REACH * min(change, 0.5 * near * chart.length) + 1e-8 * chart.length:
            out.x[:] = start
            return TOO_FAR
    predict(bodies, chart, rows, t, s, B, order, out)
    return DONE


@njit(cache=True)
def predict(
    bodies: BodyTable,
    chart: ChartTable,
    rows: LiaisonState,
    t: float,
    s: Array,
    B: Array,
    order: IntArray,
    out: ChartState,
) -> None:
    """Keep how the dependent coordinates answer to s and t, with the last factors of Newton's method."""
    u = chart.unknown.shape[0]
    k = chart.rows_s.shape[0]
    p = s.shape[0]
    chosen = np.empty((k, u))
    chosen_rows(out.A, chart.rows_s, chart.row_scale, chosen)
    on_coordinates(bodies, chart.slot, out.x, out.turns, chosen)
    Z = np.empty((k, p + 1))
    multiply(chosen, chart.E_s, Z[:, :p])
    for i in range(k):
        Z[i, p] = rows.velocity[chart.rows_s[i]] * chart.row_scale[chart.rows_s[i]]
    solve_lu(B, order, Z)
    for i in range(u):
        for j in range(p + 1):
            x = 0.0
            for l in range(k):
                x += chart.N_s[i, l] * Z[l, j]
            if j < p:
                out.S_s[i, j] = chart.E_s[i, j] - x
            else:
                out.drift[i] = -x
    out.at[0] = t
    out.s[:] = s


@njit(cache=True)
def project_forces(
    bodies: BodyTable,
    liaisons: LiaisonTable,
    forces: ForceTable,
    chart: ChartTable,
    t: float,
    attachments: AttachmentState,
    rows: LiaisonState,
    out: ChartState,
    nud: Array,
) -> None:
    """(SᵀMS) ν̇ = Sᵀ(Q − h − M a_p), v̇ = S ν̇ + a_p (T9, T10)."""
    u = chart.unknown.shape[0]
    f = nud.shape[0]
    motion = out.motion
    Q = out.loads
    h = np.empty(motion.v.shape[0])
    applied_forces(forces, bodies, liaisons, motion, attachments, rows, t, Q, out.power[:3])
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] != FIXED:
            inertia_residual(bodies, b, motion, forces.gravity, h[bodies.offset[b] : bodies.offset[b + 1]])
    X = np.empty((u, f + 1))
    for i in range(u):
        out.forces[i] = Q[chart.unknown[i]] - h[chart.unknown[i]]
        for j in range(f):
            X[i, j] = out.S[i, j]
        X[i, f] = out.a_p[i]
    MX = np.empty((u, f + 1))
    inertia_product(bodies, chart.slot, motion, X, MX)
    G = np.empty((f, f + 1))
    multiply_transposed(out.S, MX, G)
    reference = np.zeros(f)
    for j in range(f):
        x = -G[j, f]
        for i in range(u):
            x += out.S[i, j] * out.forces[i]
            reference[j] += chart.mass[i] * out.S[i, j] * out.S[i, j]
        nud[j] = x
    count, left = solve_inertia(G[:, :f], reference, nud)
    out.massless[0] = count
    out.massless[1] = left
    for i in range(u):
        a = out.a_p[i]
        inertia = MX[i, f]
        for j in range(f):
            a += out.S[i, j] * nud[j]
            inertia += MX[i, j] * nud[j]
        out.vd[i] = a
        out.residual[i] = out.forces[i] - inertia
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] != RITZ:
            continue
        o = bodies.offset[b] + 6
        m = bodies.offset[b + 1] - o
        q = bodies.ritz_square[b]
        for i in range(m):
            for j in range(m):
                out.power[1] += motion.v[o + i] * bodies.D[q + i * m + j] * motion.v[o + j]


@njit(cache=True)
def given_power(
    bodies: BodyTable,
    liaisons: LiaisonTable,
    gravity: Array,
    rows: LiaisonState,
    motion: MotionState,
    out: ChartState,
) -> float:
    """Power (W) that driven rows and prescribed frames put into the mechanism: λᵀb, and frame force times twist."""
    power = 0.0
    for i in range(rows.rhs.shape[0]):
        power += out.multipliers[i] * rows.rhs[i]
    for b in range(bodies.kind.shape[0]):
        if bodies.kind[b] == FIXED or bodies.floating[b] == 1:
            continue
        o = bodies.offset[b]
        force = np.empty(bodies.offset[b + 1] - o)
        inertia_residual(bodies, b, motion, gravity, force)
        for k in range(6):
            force[k] -= out.loads[o + k]
        for y in range(liaisons.incidence_start[b], liaisons.incidence_start[b + 1]):
            for k in range(6):
                force[k] += rows.A[liaisons.incidence[y, 1] + k] * out.multipliers[liaisons.incidence[y, 0]]
        for k in range(6):
            power += force[k] * motion.v[o + k]
    return power

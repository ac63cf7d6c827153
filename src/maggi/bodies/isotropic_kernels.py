"""Compiled passes over the nodes of a mesh whose interpolation is isotropic (T4)."""

from __future__ import annotations

import numpy as np
from numba import njit

from maggi.linalg.shared import SharedPass


@njit(cache=True)
def three_times(indptr, indices, data):  # type: ignore[no-untyped-def]
    """μ ⊗ I₃ as CSR arrays."""
    n = indptr.size - 1
    first, columns, values = np.empty(3 * n + 1, np.int32), np.empty(3 * data.size, np.int32), np.empty(3 * data.size)
    first[0] = 0
    filled = 0
    for row in range(n):
        for i in range(3):
            for p in range(indptr[row], indptr[row + 1]):
                columns[filled] = 3 * indices[p] + i
                values[filled] = data[p]
                filled += 1
            first[3 * row + i + 1] = filled
    return first, columns, values


@njit(cache=True, fastmath={"contract"})
def _acceleration(drive, X, u, ud, udd):  # type: ignore[no-untyped-def]
    """T4 at one node."""
    w0, w1, w2 = drive[3], drive[4], drive[5]
    e0, e1, e2 = drive[6], drive[7], drive[8]
    c0, c1, c2 = X[0] + u[0], X[1] + u[1], X[2] + u[2]
    y0 = w1 * c2 - w2 * c1 + 2.0 * ud[0]
    y1 = w2 * c0 - w0 * c2 + 2.0 * ud[1]
    y2 = w0 * c1 - w1 * c0 + 2.0 * ud[2]
    return (
        drive[0] + e1 * c2 - e2 * c1 + w1 * y2 - w2 * y1 + udd[0],
        drive[1] + e2 * c0 - e0 * c2 + w2 * y0 - w0 * y2 + udd[1],
        drive[2] + e0 * c1 - e1 * c0 + w0 * y1 - w1 * y0 + udd[2],
    )


@njit(cache=True, fastmath={"contract"})
def _with_node(sums, w, m, u, a):  # type: ignore[no-untyped-def]
    """The sums (15) of `accelerations` with one more node, in registers."""
    u0, u1, u2 = u
    a0, a1, a2 = a
    s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12, s13, s14 = sums
    return (
        s0 + w * u0,
        s1 + w * u1,
        s2 + w * u2,
        s3 + (2.0 * m[0] + w * u0) * u0,
        s4 + m[0] * u1 + (m[1] + w * u1) * u0,
        s5 + m[0] * u2 + (m[2] + w * u2) * u0,
        s6 + (2.0 * m[1] + w * u1) * u1,
        s7 + m[1] * u2 + (m[2] + w * u2) * u1,
        s8 + (2.0 * m[2] + w * u2) * u2,
        s9 + w * a0,
        s10 + w * a1,
        s11 + w * a2,
        s12 + m[1] * a2 - m[2] * a1,
        s13 + m[2] * a0 - m[0] * a2,
        s14 + m[0] * a1 - m[1] * a0,
    )


@njit(cache=True)
def _tied_value(x, block, arm):  # type: ignore[no-untyped-def]
    """d + θ × arm."""
    t0, t1, t2 = x[block + 1, 0], x[block + 1, 1], x[block + 1, 2]
    return (
        x[block, 0] + t1 * arm[2] - t2 * arm[1],
        x[block, 1] + t2 * arm[0] - t0 * arm[2],
        x[block, 2] + t0 * arm[1] - t1 * arm[0],
    )


@SharedPass
def accelerations(  # type: ignore[no-untyped-def]
    part, parts, drive, X, weights, moments, u, ud, udd, master, arm, out, sums, done
):
    """a_n = a_O + ε × c + ω × (ω × c + 2 u̇) + ü, c = X + u (T4), free nodes first; gravity is in a_O, drive (9,) is a_O, ω, ε.

    sums (p, 15), by part: Σ w u, the upper triangle of Σ (μX) uᵀ + u (μX)ᵀ + w u uᵀ, and Cᵀa.
    """
    free = X.shape[0] - master.size
    first, last = X.shape[0] * part // parts, X.shape[0] * (part + 1) // parts
    here, there = slice(min(first, free), min(last, free)), slice(max(first, free), max(last, free))
    s = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    s = _accelerate(drive, X[here], weights[here], moments[here], u[here], ud[here], udd[here], out[here], s)
    tied = slice(there.start - free, there.stop - free)
    fields, ties = (u, ud, udd), (master[tied], arm[tied])
    s = _accelerate_tied(drive, X[there], weights[there], moments[there], fields, ties, out[there], s)
    for i, total in enumerate(s):
        sums[part, i] = total


@njit(cache=True, fastmath={"contract"})
def _accelerate(drive, X, weights, moments, u, ud, udd, out, s):  # type: ignore[no-untyped-def]
    for n in range(X.shape[0]):
        d = _value(u, n)
        a = _acceleration(drive, X[n], d, _value(ud, n), _value(udd, n))
        out[n, 0], out[n, 1], out[n, 2] = a
        s = _with_node(s, weights[n], moments[n], d, a)
    return s


@njit(cache=True, fastmath={"contract"})
def _accelerate_tied(drive, X, weights, moments, fields, ties, out, s):  # type: ignore[no-untyped-def]
    (u, ud, udd), (master, arm) = fields, ties
    for n in range(X.shape[0]):
        b, r = master[n], arm[n]
        d = _tied_value(u, b, r)
        a = _acceleration(drive, X[n], d, _tied_value(ud, b, r), _tied_value(udd, b, r))
        out[n, 0], out[n, 1], out[n, 2] = a
        s = _with_node(s, weights[n], moments[n], d, a)
    return s


@SharedPass
def inertia_forces(  # type: ignore[no-untyped-def]
    part, parts, indptr, indices, values, starts, a, weights, moments, g, X, u, nodal, on_tied, sums, done
):
    """F = μ a: less C g on free nodes' blocks, nodal (b, 3), whole on tied nodes; resultant and moment Φ(c)ᵀF of the free.

    sums (p, 6), by part.
    """
    free = X.shape[0] - on_tied.shape[0]
    total = sums[part]
    total[:] = 0.0
    for n in range(starts[part], starts[part + 1]):
        y0, y1, y2 = _row(indices[indptr[n] : indptr[n + 1]], values[indptr[n] : indptr[n + 1]], a)
        if n < free:
            nodal[n, 0], nodal[n, 1], nodal[n, 2] = _less_rigid(y0, y1, y2, weights[n], moments[n], g)
            _add_wrench(y0, y1, y2, X[n, 0] + u[n, 0], X[n, 1] + u[n, 1], X[n, 2] + u[n, 2], total)
        else:
            on_tied[n - free, 0], on_tied[n - free, 1], on_tied[n - free, 2] = y0, y1, y2


@njit(cache=True)
def gather_tied(on_tied, weights, moments, g, X, u, master, arm, nodal, frame):  # type: ignore[no-untyped-def]
    """What `inertia_forces` leaves on tied nodes, less C g, on their attachments' blocks, and all of it on the frame."""
    free = X.shape[0] - master.size
    for b in range(free, nodal.shape[0]):
        nodal[b, :] = 0.0
    for k in range(master.size):
        n, b, r = free + k, master[k], arm[k]
        y0, y1, y2 = on_tied[k, 0], on_tied[k, 1], on_tied[k, 2]
        u0, u1, u2 = _tied_value(u, b, r)
        _add_wrench(y0, y1, y2, X[n, 0] + u0, X[n, 1] + u1, X[n, 2] + u2, frame)
        x, y, z = _less_rigid(y0, y1, y2, weights[n], moments[n], g)
        nodal[b, 0] += x
        nodal[b, 1] += y
        nodal[b, 2] += z
        nodal[b + 1, 0] += r[1] * z - r[2] * y
        nodal[b + 1, 1] += r[2] * x - r[0] * z
        nodal[b + 1, 2] += r[0] * y - r[1] * x


@njit(cache=True)
def _value(x, n):  # type: ignore[no-untyped-def]
    return x[n, 0], x[n, 1], x[n, 2]


@njit(cache=True, fastmath={"contract"})
def _row(indices, values, a):  # type: ignore[no-untyped-def]
    """One row of μ a."""
    y0 = y1 = y2 = 0.0
    for p in range(indices.size):
        m, value = np.uint32(indices[p]), values[p]  # unsigned: no look for places from the end
        y0 += value * a[m, 0]
        y1 += value * a[m, 1]
        y2 += value * a[m, 2]
    return y0, y1, y2


@njit(cache=True)
def _less_rigid(y0, y1, y2, weight, moment, g):  # type: ignore[no-untyped-def]
    """y less C g at a node."""
    return (
        y0 - weight * g[0] - (g[4] * moment[2] - g[5] * moment[1]),
        y1 - weight * g[1] - (g[5] * moment[0] - g[3] * moment[2]),
        y2 - weight * g[2] - (g[3] * moment[1] - g[4] * moment[0]),
    )


@njit(cache=True)
def _add_wrench(y0, y1, y2, c0, c1, c2, out):  # type: ignore[no-untyped-def]
    """To out (6,) the force y at c, and its moment."""
    out[0] += y0
    out[1] += y1
    out[2] += y2
    out[3] += c1 * y2 - c2 * y1
    out[4] += c2 * y0 - c0 * y2
    out[5] += c0 * y1 - c1 * y0

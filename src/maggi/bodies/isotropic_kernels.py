"""Compiled passes over the nodes of a mesh whose interpolation is isotropic (T4)."""

from __future__ import annotations

import numpy as np
from numba import njit, prange


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


@njit(cache=True)
def _at_node(drive, X, w, mX, u, ud, udd, out, sums):  # type: ignore[no-untyped-def]
    """T4 at one node, and its part in S and J."""
    w0, w1, w2 = drive[3], drive[4], drive[5]
    e0, e1, e2 = drive[6], drive[7], drive[8]
    u0, u1, u2 = u
    v0, v1, v2 = ud
    c0, c1, c2 = X[0] + u0, X[1] + u1, X[2] + u2
    y0 = w1 * c2 - w2 * c1 + 2.0 * v0
    y1 = w2 * c0 - w0 * c2 + 2.0 * v1
    y2 = w0 * c1 - w1 * c0 + 2.0 * v2
    out[0] = drive[0] + e1 * c2 - e2 * c1 + w1 * y2 - w2 * y1 + udd[0]
    out[1] = drive[1] + e2 * c0 - e0 * c2 + w2 * y0 - w0 * y2 + udd[1]
    out[2] = drive[2] + e0 * c1 - e1 * c0 + w0 * y1 - w1 * y0 + udd[2]
    m0, m1, m2 = mX[0], mX[1], mX[2]
    sums[0] += w * u0
    sums[1] += w * u1
    sums[2] += w * u2
    sums[3] += (2.0 * m0 + w * u0) * u0
    sums[4] += m0 * u1 + (m1 + w * u1) * u0
    sums[5] += m0 * u2 + (m2 + w * u2) * u0
    sums[6] += (2.0 * m1 + w * u1) * u1
    sums[7] += m1 * u2 + (m2 + w * u2) * u1
    sums[8] += (2.0 * m2 + w * u2) * u2


@njit(cache=True)
def _tied_value(x, block, arm):  # type: ignore[no-untyped-def]
    """d + θ × arm."""
    t0, t1, t2 = x[block + 1, 0], x[block + 1, 1], x[block + 1, 2]
    return (
        x[block, 0] + t1 * arm[2] - t2 * arm[1],
        x[block, 1] + t2 * arm[0] - t0 * arm[2],
        x[block, 2] + t0 * arm[1] - t1 * arm[0],
    )


@njit(cache=True)
def accelerations(drive, X, weights, moments, u, ud, udd, master, arm, out, sums):  # type: ignore[no-untyped-def]
    """a_n = a_O + ε × c + ω × (ω × c + 2 u̇) + ü, c = X + u (T4), free nodes first; gravity is in a_O, drive (9,) is a_O, ω, ε.

    sums (9,): Σ w u and the upper triangle of Σ (μX) uᵀ + u (μX)ᵀ + w u uᵀ.
    """
    free = X.shape[0] - master.size
    sums[:] = 0.0
    for n in range(free):
        here = (u[n, 0], u[n, 1], u[n, 2]), (ud[n, 0], ud[n, 1], ud[n, 2]), (udd[n, 0], udd[n, 1], udd[n, 2])
        _at_node(drive, X[n], weights[n], moments[n], here[0], here[1], here[2], out[n], sums)
    for k in range(master.size):
        n, b, r = free + k, master[k], arm[k]
        tied = _tied_value(u, b, r), _tied_value(ud, b, r), _tied_value(udd, b, r)
        _at_node(drive, X[n], weights[n], moments[n], tied[0], tied[1], tied[2], out[n], sums)


@njit(cache=True, parallel=True, fastmath={"contract"})
def inertia_forces(  # type: ignore[no-untyped-def]
    indptr, indices, values, starts, a, X, u, master, arm, nodal, on_tied, frame, sums
):
    """F = μ a, gathered on the freedoms' blocks, nodal (b, 3), and on the frame: resultant and moment Φ(c)ᵀ F, (6,)."""
    parts = sums.shape[0]
    free = X.shape[0] - master.size
    for part in prange(parts):
        f0 = f1 = f2 = m0 = m1 = m2 = 0.0
        for n in range(starts[part], starts[part + 1]):
            y0 = y1 = y2 = 0.0
            for p in range(indptr[n], indptr[n + 1]):
                m, value = np.uint32(indices[p]), values[p]  # unsigned: no look for places from the end
                y0 += value * a[m, 0]
                y1 += value * a[m, 1]
                y2 += value * a[m, 2]
            if n >= free:
                on_tied[n - free, 0], on_tied[n - free, 1], on_tied[n - free, 2] = y0, y1, y2
                continue
            nodal[n, 0], nodal[n, 1], nodal[n, 2] = y0, y1, y2
            c0, c1, c2 = X[n, 0] + u[n, 0], X[n, 1] + u[n, 1], X[n, 2] + u[n, 2]
            f0 += y0
            f1 += y1
            f2 += y2
            m0 += c1 * y2 - c2 * y1
            m1 += c2 * y0 - c0 * y2
            m2 += c0 * y1 - c1 * y0
        sums[part, 0], sums[part, 1], sums[part, 2] = f0, f1, f2
        sums[part, 3], sums[part, 4], sums[part, 5] = m0, m1, m2
    for i in range(6):
        total = 0.0
        for part in range(parts):
            total += sums[part, i]
        frame[i] = total
    for b in range(free, nodal.shape[0]):
        nodal[b, :] = 0.0
    for k in range(master.size):
        n, b, r = free + k, master[k], arm[k]
        x, y, z = on_tied[k, 0], on_tied[k, 1], on_tied[k, 2]
        u0, u1, u2 = _tied_value(u, b, r)
        c0, c1, c2 = X[n, 0] + u0, X[n, 1] + u1, X[n, 2] + u2
        frame[0] += x
        frame[1] += y
        frame[2] += z
        frame[3] += c1 * z - c2 * y
        frame[4] += c2 * x - c0 * z
        frame[5] += c0 * y - c1 * x
        nodal[b, 0] += x
        nodal[b, 1] += y
        nodal[b, 2] += z
        nodal[b + 1, 0] += r[1] * z - r[2] * y
        nodal[b + 1, 1] += r[2] * x - r[0] * z
        nodal[b + 1, 2] += r[0] * y - r[1] * x

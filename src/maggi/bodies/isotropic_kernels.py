"""Compiled passes over the nodes of a mesh whose interpolation is isotropic (T4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.lanes import four, four_at, number, put_four, three_fours
from maggi.linalg.shared import SharedPass, inner_pass
from maggi.linalg.table import Table, address
from maggi.linalg.team import Crew, share

from .mean_axes import times_six

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class NodalMass(Table):
    """μ (n, n) by rows, of which part p has those from starts[p] to starts[p + 1]."""

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    values: Array
    starts: IntArray


@dataclass(frozen=True, eq=False)
class NodalForces(Table):
    """What the inertia forces of one set of fields are found from and written to; n nodes, free ones first, b blocks.

    mass: μ. nodes (n, 3). weights (n,), moments (n, 3): row sums of μ, and μ times the nodes. master (t,), arm (t, 3): see `Freedoms`.
    mean_axes (6, 6): J₆⁻¹ where forces on the freedoms are Pᵀ of what they would be, else 0. drive (3, 3): a_O less gravity, ω, ε.
    relative (2,): what of u and u̇ is added to the accelerations for the freedoms. u, ud, udd, nodal (3b,). tied (3, t, 3): u, u̇, ü
    of tied nodes. field (n + 1, 6): accelerations for the frame, for the freedoms; the last row is read, but not used. on_tied
    (t, 6): forces. sums (p, 15), wrenches (p, 6): by part. S0, J0: of the undeformed body. wrench (6,), S (3,), J (3, 3): found.
    """

    mass: NodalMass
    nodes: Array
    weights: Array
    moments: Array
    master: IntArray
    arm: Array
    mean_axes: Array
    drive: Array
    relative: Array
    u: Array
    ud: Array
    udd: Array
    nodal: Array
    tied: Array
    field: Array
    on_tied: Array
    sums: Array
    wrenches: Array
    S0: Array
    J0: Array
    wrench: Array
    S: Array
    J: Array


@dataclass(frozen=True, eq=False)
class NodalSquares(Table):
    """xᵀ(μ ⊗ I₃)x of four fields (n, 3, 4); sums (p, 4): by part."""

    mass: NodalMass
    fields: Array
    sums: Array


@kernel
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


@SharedPass
def accelerations(of: NodalForces, part: int, parts: int) -> None:
    """a_n = a_O + ε × c + ω × (ω × c + 2 u̇) + ü, c = X + u (T4), into `field`; gravity is in a_O.

    Behind it the same with what is `relative` added. To `sums` Σ w u, the upper triangle of Σ (μX) uᵀ + u (μX)ᵀ + w u uᵀ,
    and Cᵀa.
    """
    X, weights, moments, field, tied = of.nodes, of.weights, of.moments, of.field, of.tied
    u, ud, udd = of.u.reshape(-1, 3), of.ud.reshape(-1, 3), of.udd.reshape(-1, 3)
    n, free = X.shape[0], X.shape[0] - tied.shape[1]
    first, last = n * part // parts, n * (part + 1) // parts
    total = of.sums[part]
    total[:] = 0.0
    if first < free:
        here = slice(first, min(last, free))
        _accelerate(of.drive, of.relative, X[here], u[here], ud[here], udd[here], field[here])
        _add_sums(weights[here], moments[here], u[here], field[here], total)
    if last > free:
        here = slice(max(first, free), last)
        ties = slice(here.start - free, last - free)
        master, arm = of.master[ties], of.arm[ties]
        d, v, vd = tied[0, ties], tied[1, ties], tied[2, ties]
        _carry(u, master, arm, d)
        _carry(ud, master, arm, v)
        _carry(udd, master, arm, vd)
        _accelerate(of.drive, of.relative, X[here], d, v, vd, field[here])
        _add_sums(weights[here], moments[here], d, field[here], total)


@inner_pass
def _carry(x, master, arm, out):  # type: ignore[no-untyped-def]
    """d + θ × arm of tied nodes."""
    for k in range(out.shape[0]):
        b = master[k]
        t0, t1, t2 = x[b + 1, 0], x[b + 1, 1], x[b + 1, 2]
        out[k, 0] = x[b, 0] + t1 * arm[k, 2] - t2 * arm[k, 1]
        out[k, 1] = x[b, 1] + t2 * arm[k, 0] - t0 * arm[k, 2]
        out[k, 2] = x[b, 2] + t0 * arm[k, 1] - t1 * arm[k, 0]


@inner_pass
def _accelerate(drive, relative, X, u, ud, udd, out):  # type: ignore[no-untyped-def]
    """T4 at nodes with these displacements and rates, and with what is relative added."""
    p, q = relative[0], relative[1]
    (a0, a1, a2), (w0, w1, w2), (e0, e1, e2) = _three(drive[0]), _three(drive[1]), _three(drive[2])
    for n in range(X.shape[0]):
        u0, u1, u2, v0, v1, v2 = u[n, 0], u[n, 1], u[n, 2], ud[n, 0], ud[n, 1], ud[n, 2]
        c0, c1, c2 = X[n, 0] + u0, X[n, 1] + u1, X[n, 2] + u2
        y0 = w1 * c2 - w2 * c1 + 2.0 * v0
        y1 = w2 * c0 - w0 * c2 + 2.0 * v1
        y2 = w0 * c1 - w1 * c0 + 2.0 * v2
        f0 = a0 + e1 * c2 - e2 * c1 + w1 * y2 - w2 * y1 + udd[n, 0]
        f1 = a1 + e2 * c0 - e0 * c2 + w2 * y0 - w0 * y2 + udd[n, 1]
        f2 = a2 + e0 * c1 - e1 * c0 + w0 * y1 - w1 * y0 + udd[n, 2]
        out[n, 0], out[n, 1], out[n, 2] = f0, f1, f2
        out[n, 3], out[n, 4], out[n, 5] = f0 + p * u0 + q * v0, f1 + p * u1 + q * v1, f2 + p * u2 + q * v2


@inner_pass
def _three(x):  # type: ignore[no-untyped-def]
    return x[0], x[1], x[2]


@inner_pass
def _add_sums(weights, moments, u, a, out):  # type: ignore[no-untyped-def]
    """To out (15,) the sums of `accelerations` over these nodes."""
    s0 = s1 = s2 = q0 = q1 = q2 = q3 = q4 = q5 = f0 = f1 = f2 = m0 = m1 = m2 = 0.0
    for n in range(u.shape[0]):
        w, x, y, z = weights[n], moments[n, 0], moments[n, 1], moments[n, 2]
        u0, u1, u2 = u[n, 0], u[n, 1], u[n, 2]
        a0, a1, a2 = a[n, 0], a[n, 1], a[n, 2]
        s0 += w * u0
        s1 += w * u1
        s2 += w * u2
        q0 += (2.0 * x + w * u0) * u0
        q1 += x * u1 + (y + w * u1) * u0
        q2 += x * u2 + (z + w * u2) * u0
        q3 += (2.0 * y + w * u1) * u1
        q4 += y * u2 + (z + w * u2) * u1
        q5 += (2.0 * z + w * u2) * u2
        f0 += w * a0
        f1 += w * a1
        f2 += w * a2
        m0 += y * a2 - z * a1
        m1 += z * a0 - x * a2
        m2 += x * a1 - y * a0
    for i, total in enumerate((s0, s1, s2, q0, q1, q2, q3, q4, q5, f0, f1, f2, m0, m1, m2)):
        out[i] += total


@SharedPass
def inertia_forces(of: NodalForces, part: int, parts: int) -> None:
    """F = μ a: less C g on free nodes' blocks, whole on tied nodes; resultant and moment Φ(c)ᵀF of the free to `wrenches`."""
    mass, field = of.mass, of.field
    indptr, indices, values = mass.indptr, mass.indices, mass.values
    X, u, nodal, on_tied = of.nodes, of.u.reshape(-1, 3), of.nodal.reshape(-1, 3), of.on_tied
    weights, moments, g = of.weights, of.moments, _rigid_part(of)
    free = X.shape[0] - on_tied.shape[0]
    total = of.wrenches[part]
    total[:] = 0.0
    for n in range(mass.starts[part], mass.starts[part + 1]):
        y = z = four(0.0)  # three of each
        for p in range(np.uint32(indptr[n]), np.uint32(indptr[n + 1])):
            value, place = values[p], 6 * np.int64(np.uint32(indices[p]))
            y = value * four_at(field, place) + y
            z = value * four_at(field, place + 3) + z
        y0, y1, y2, z0, z1, z2 = number(y, 0), number(y, 1), number(y, 2), number(z, 0), number(z, 1), number(z, 2)
        if n < free:
            nodal[n, 0], nodal[n, 1], nodal[n, 2] = _less_rigid(z0, z1, z2, weights[n], moments[n], g)
            _add_wrench(y0, y1, y2, X[n, 0] + u[n, 0], X[n, 1] + u[n, 1], X[n, 2] + u[n, 2], total)
        else:
            tied = on_tied[n - free]
            tied[0], tied[1], tied[2], tied[3], tied[4], tied[5] = y0, y1, y2, z0, z1, z2


@inner_kernel
def _rigid_part(of):  # type: ignore[no-untyped-def]
    """g = J₆⁻¹Cᵀa, six numbers, from what the parts have summed; 0 without mean axes."""
    sums = of.sums
    f0 = f1 = f2 = m0 = m1 = m2 = 0.0
    for p in range(sums.shape[0]):
        f0 += sums[p, 9]
        f1 += sums[p, 10]
        f2 += sums[p, 11]
        m0 += sums[p, 12]
        m1 += sums[p, 13]
        m2 += sums[p, 14]
    return times_six(of.mean_axes, (f0, f1, f2, m0, m1, m2))


@kernel
def evaluate(of: NodalForces, entries: IntArray, crew: Crew) -> None:
    """All that follows from the fields and `drive`: forces on the freedoms, resultants for the frame, S and J.

    Pᵀμa = μa − C g with g = J₆⁻¹Cᵀa, which is known before μa is. entries: of `accelerations` and `inertia_forces`.
    """
    parts = of.sums.shape[0]
    share(crew, entries[0], address(of), parts)
    share(crew, entries[1], address(of), parts)
    _gather_tied(of)
    _sum_up(of)


@inner_kernel
def _gather_tied(of):  # type: ignore[no-untyped-def]
    """What `inertia_forces` leaves on tied nodes, less C g, on their attachments' blocks, and all on the frame."""
    X, nodal, d, on_tied, frame = of.nodes, of.nodal.reshape(-1, 3), of.tied[0], of.on_tied, of.wrenches[0]
    weights, moments, g = of.weights, of.moments, _rigid_part(of)
    free = X.shape[0] - on_tied.shape[0]
    for b in range(free, nodal.shape[0]):
        for i in range(3):
            nodal[b, i] = 0.0
    for k in range(on_tied.shape[0]):
        n, b, r, y = free + k, of.master[k], of.arm[k], on_tied[k]
        _add_wrench(y[0], y[1], y[2], X[n, 0] + d[k, 0], X[n, 1] + d[k, 1], X[n, 2] + d[k, 2], frame)
        x0, x1, x2 = _less_rigid(y[3], y[4], y[5], weights[n], moments[n], g)
        nodal[b, 0] += x0
        nodal[b, 1] += x1
        nodal[b, 2] += x2
        nodal[b + 1, 0] += r[1] * x2 - r[2] * x1
        nodal[b + 1, 1] += r[2] * x0 - r[0] * x2
        nodal[b + 1, 2] += r[0] * x1 - r[1] * x0


@inner_kernel
def _sum_up(of):  # type: ignore[no-untyped-def]
    """The frame's resultants, and S and J from the sums ``Σ w u`` and the upper triangle of ``Σ (μX) uᵀ + u (μX)ᵀ + w u uᵀ``."""
    sums, wrenches, wrench, S, J = of.sums, of.wrenches, of.wrench, of.S, of.J
    for i in range(6):
        wrench[i] = 0.0
        for p in range(wrenches.shape[0]):
            wrench[i] += wrenches[p, i]
    xx = xy = xz = yy = yz = zz = 0.0
    for i in range(3):
        S[i] = of.S0[i]
    for p in range(sums.shape[0]):
        for i in range(3):
            S[i] += sums[p, i]
        xx += sums[p, 3]
        xy += sums[p, 4]
        xz += sums[p, 5]
        yy += sums[p, 6]
        yz += sums[p, 7]
        zz += sums[p, 8]
    J0 = of.J0
    J[0, 0], J[1, 1], J[2, 2] = J0[0, 0] + yy + zz, J0[1, 1] + xx + zz, J0[2, 2] + xx + yy
    J[0, 1], J[0, 2], J[1, 2] = J0[0, 1] - xy, J0[0, 2] - xz, J0[1, 2] - yz
    J[1, 0], J[2, 0], J[2, 1] = J[0, 1], J[0, 2], J[1, 2]


@inner_pass
def _less_rigid(y0, y1, y2, weight, moment, g):  # type: ignore[no-untyped-def]
    """y less C g at a node."""
    return (
        y0 - weight * g[0] - (g[4] * moment[2] - g[5] * moment[1]),
        y1 - weight * g[1] - (g[5] * moment[0] - g[3] * moment[2]),
        y2 - weight * g[2] - (g[3] * moment[1] - g[4] * moment[0]),
    )


@inner_pass
def _add_wrench(y0, y1, y2, c0, c1, c2, out):  # type: ignore[no-untyped-def]
    """To out (6,) the force y at c, and its moment."""
    out[0] += y0
    out[1] += y1
    out[2] += y2
    out[3] += c1 * y2 - c2 * y1
    out[4] += c2 * y0 - c0 * y2
    out[5] += c0 * y1 - c1 * y0


@SharedPass
def nodal_squares(of: NodalSquares, part: int, parts: int) -> None:
    """What the rows of a part add to xᵀ(μ ⊗ I₃)x, into `sums`."""
    mass, fields = of.mass, of.fields
    indptr, indices, values = mass.indptr, mass.indices, mass.values
    total = four(0.0)
    for n in range(mass.starts[part], mass.starts[part + 1]):
        y0 = y1 = y2 = four(0.0)
        for p in range(np.uint32(indptr[n]), np.uint32(indptr[n + 1])):
            value, (x0, x1, x2) = values[p], three_fours(fields, np.uint32(indices[p]))
            y0, y1, y2 = value * x0 + y0, value * x1 + y1, value * x2 + y2
        x0, x1, x2 = three_fours(fields, np.uint32(n))
        total = x0 * y0 + (x1 * y1 + (x2 * y2 + total))
    put_four(of.sums[part], 0, total)

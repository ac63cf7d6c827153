"""What connects a mesh's passes with the small system, each a call: its frame, its attachments, what they have to do with its fields."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.mean_axes import MeanAxes, project
from maggi.bodies.tables import MotionState
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.table import address
from maggi.linalg.team import Crew, share

from .nodal_kernels import NodalStep

Array = NDArray[np.float64]


@kernel
def frame_drive(motion: MotionState, gravity: Array, body: int, first: int, out: Array) -> None:
    """a_O less gravity, ω and ε of a body's frame, body axes, into out (3, 3); `first`: of its places in v."""
    v, vd, R = motion.v, motion.vd, motion.rotation[body]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        spin = v[first + 3 + j] * v[first + k] - v[first + 3 + k] * v[first + j]
        fall = R[0, i] * gravity[0] + R[1, i] * gravity[1] + R[2, i] * gravity[2]
        out[0, i] = vd[first + i] + spin - fall
        out[1, i] = v[first + 3 + i]
        out[2, i] = vd[first + 3 + i]


@kernel
def respond(of: NodalStep, axes: MeanAxes, floating: int, out: Array) -> None:
    """The solution complete and, where the body floats, on mean axes; ``−Bᵀ`` of it into out (6k,)."""
    size = 3 * (axes.Phi.scale.size + axes.Phi.rest.shape[0])
    x = of.solution[:size]
    if of.implied[0] != 0.0:
        add_fields(of.implied[0], of.following[0][:size], of.implied[1], of.following[1][:size], x)
    if floating:
        project(axes, x)
    columns = of.columns
    for j in range(out.size):
        out[j] = -_column_times(columns, j, x)


@kernel
def correct(of: NodalStep, entry: int, crew: Crew, phi: Array, pi: Array, kappa: Array) -> tuple[float, float]:
    """Nodal increments with the forces at the attachments, (6k,) each: the sum of δ² and the largest |u|. entry: of `correct_nodal`."""
    forces, loaded, y, z = of.forces, of.loaded, of.damping[0], of.damping[1]
    for k in range(loaded.size):
        loaded[k] = 0
        for j in range(6 * k, 6 * k + 6):
            forces[0, j] = phi[j] + y * kappa[j]
            forces[1, j] = pi[j]
            forces[2, j] = kappa[j]
            forces[3, j] = pi[j] + z * kappa[j]
            if phi[j] != 0.0 or pi[j] != 0.0 or kappa[j] != 0.0:  # what is not finite is not zero
                loaded[k] = 1
    sizes = of.sizes
    share(crew, entry, address(of), sizes.shape[0])
    total = largest = 0.0
    for p in range(sizes.shape[0]):
        total += sizes[p, 0]
        largest = max(largest, sizes[p, 1])
    return total, largest


@kernel
def write_attachments(of: NodalStep, e: Array, nu: Array, nud: Array, a: Array, difference: Array) -> None:
    """Bᵀ of u, u̇, ü and a of the present, `now`, into e, nu, nud and a (6k,); what a has changed by is added to `difference`."""
    columns, now = of.columns, of.now
    for j in range(e.size):
        e[j] = _column_times(columns, j, now[0])
        nu[j] = _column_times(columns, j, now[1])
        nud[j] = _column_times(columns, j, now[2])
        before = a[j]
        a[j] = _column_times(columns, j, now[3])
        difference[j] += a[j] - before


@inner_kernel
def _column_times(columns, j, x):  # type: ignore[no-untyped-def]
    """A column's product with x."""
    indices, values = columns.indices, columns.values
    total = 0.0
    for p in range(columns.indptr[j], columns.indptr[j + 1]):
        total += values[p] * x[indices[p]]
    return total


@kernel
def add_fields(a: float, x: Array, b: float, y: Array, out: Array) -> None:
    """``out += a x + b y``."""
    for i in range(out.size):
        out[i] += a * x[i] + b * y[i]


@kernel
def inner_product(x: Array, y: Array) -> float:
    """x · y, in one order: BLAS would share it among its threads."""
    total = 0.0
    for i in range(x.size):
        total += x[i] * y[i]
    return total


@kernel
def distance(x: Array, y: Array) -> float:
    """|x − y|, in one order."""
    total = 0.0
    for i in range(x.size):
        total += (x[i] - y[i]) * (x[i] - y[i])
    return float(np.sqrt(total))


@kernel
def frame_compliance(sigma: float, mass: float, S: Array, J: Array, out: Array) -> None:
    """``(σ J₆)⁻¹``, J₆ = [[m I, −S̃], [S̃, J]], into out (6, 6): by the inertia about the centre of mass, s = S/m."""
    s0, s1, s2 = S[0] / mass, S[1] / mass, S[2] / mass
    # J_s = J − m (s·s I − s sᵀ), and its adjugate
    square = s0 * s0 + s1 * s1 + s2 * s2
    a = J[0, 0] - mass * (square - s0 * s0)
    b = J[1, 1] - mass * (square - s1 * s1)
    c = J[2, 2] - mass * (square - s2 * s2)
    d = 0.5 * (J[0, 1] + J[1, 0]) + mass * s0 * s1
    e = 0.5 * (J[0, 2] + J[2, 0]) + mass * s0 * s2
    f = 0.5 * (J[1, 2] + J[2, 1]) + mass * s1 * s2
    i00, i11, i22 = b * c - f * f, a * c - e * e, a * b - d * d
    i01, i02, i12 = e * f - d * c, d * f - e * b, d * e - a * f
    scale = 1.0 / (sigma * (a * i00 + d * i01 + e * i02))
    out[3, 3], out[3, 4], out[3, 5] = scale * i00, scale * i01, scale * i02
    out[4, 3], out[4, 4], out[4, 5] = scale * i01, scale * i11, scale * i12
    out[5, 3], out[5, 4], out[5, 5] = scale * i02, scale * i12, scale * i22
    # upper right: s̃ J_s⁻¹; upper left: I/m − s̃ J_s⁻¹ s̃, where (row) s̃ = row × s
    for k in range(3, 6):
        x, y, z = out[3, k], out[4, k], out[5, k]
        out[0, k] = s1 * z - s2 * y
        out[1, k] = s2 * x - s0 * z
        out[2, k] = s0 * y - s1 * x
    for i in range(3):
        for k in range(3, 6):
            out[k, i] = out[i, k]
    for i in range(3):
        x, y, z = out[i, 3], out[i, 4], out[i, 5]
        out[i, 0] = -(y * s2 - z * s1)
        out[i, 1] = -(z * s0 - x * s2)
        out[i, 2] = -(x * s1 - y * s0)
        out[i, i] += 1.0 / (sigma * mass)
    out[1, 0], out[2, 0], out[2, 1] = out[0, 1], out[0, 2], out[1, 2]

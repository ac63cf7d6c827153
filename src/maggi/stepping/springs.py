"""Springs and dampers in Newton's iteration: stiff ones would make it diverge where β h² k/m exceeds one.

Each spring is a row J of elongation rates (or angular rates) with stiffness k' = βh²k + γhd. It borders the
liaisons' system instead of entering it, so that rank and liaison forces know nothing of springs:

    [ Λ    B    ] [φ]   [A x + (A v̇ + γ)/σ]        Λ = A W Aᵀ,  B = A W Jᵀ
    [ Bᵀ  JWJᵀ + 1/k' ] [ψ] = [J x          ]        δ = x − W(Aᵀφ + Jᵀψ)
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from maggi.bodies.kernels import generalised_force
from maggi.bodies.tables import Array, AttachmentState, BodyTable, MotionState
from maggi.forces.tables import ForceTable
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.liaisons.tables import COORDINATE_JOINT, LiaisonTable
from maggi.projection.range_space import block_product, product, solve


@njit(cache=True)
def invert(matrix: Array, out: Array) -> None:
    """The inverse of a small positive definite matrix, by L D Lᵀ; `matrix` is overwritten."""
    n = matrix.shape[0]
    for i in range(n):
        for j in range(i):
            value = matrix[i, j]
            for k in range(j):
                value -= matrix[i, k] * matrix[j, k] * matrix[k, k]
            matrix[i, j] = value / matrix[j, j]
        value = matrix[i, i]
        for k in range(i):
            value -= matrix[i, k] * matrix[i, k] * matrix[k, k]
        matrix[i, i] = value
    for column in range(n):
        for i in range(n):
            value = 1.0 if i == column else 0.0
            for k in range(column, i):
                value -= matrix[i, k] * out[k, column]
            out[i, column] = value
        for i in range(n - 1, -1, -1):
            value = out[i, column] / matrix[i, i]
            for k in range(i + 1, n):
                value -= matrix[k, i] * out[k, column]
            out[i, column] = value


@njit(cache=True)
def spring_rows(
    forces: ForceTable,
    bodies: BodyTable,
    liaisons: LiaisonTable,
    motion: MotionState,
    attachments: AttachmentState,
    coordinate_wrench: Array,
    J: Array,
) -> None:
    """Rows J (s, n) of all springs, then torsion springs: the rates of their lengths or angles are J v."""
    J[:, :] = 0.0
    linear = forces.spring_ends.shape[0]
    n = np.zeros(3)
    for s in range(J.shape[0]):
        if s < linear:
            p, q = forces.spring_ends[s, 0], forces.spring_ends[s, 1]
            length = 0.0
            for i in range(3):
                n[i] = attachments.position[q, i] - attachments.position[p, i]
                length += n[i] * n[i]
            length = math.sqrt(length)
            if length == 0.0:
                continue
            for i in range(3):
                n[i] /= length
        else:
            c = forces.torsion_coordinate[s - linear]
            j = liaisons.coordinate[c, COORDINATE_JOINT]
            p, q = liaisons.joint[j, 0], liaisons.joint[j, 1]
        for end in range(2):
            a = p if end == 0 else q
            sign = -1.0 if end == 0 else 1.0
            b = bodies.attachment_body[a]
            row = J[s, bodies.offset[b] : bodies.offset[b + 1]]
            if s < linear:
                x, y, z = sign * n[0], sign * n[1], sign * n[2]
                generalised_force(bodies, motion, attachments, a, x, y, z, 0.0, 0.0, 0.0, row)
            else:
                f = coordinate_wrench[c, end]
                generalised_force(bodies, motion, attachments, a, f[0], f[1], f[2], f[3], f[4], f[5], row)


@njit(cache=True)
def spring_border(
    forces: ForceTable,
    bodies: BodyTable,
    liaisons: LiaisonTable,
    c: GeneralizedAlpha,
    A: Array,
    W: Array,
    L: Array,
    pivot: Array,
    J: Array,
    WJ: Array,
    border: Array,
    inverse: Array,
) -> None:
    """WJ (s, n) = W Jᵀ, border (s, r) = Λ⁻¹B, inverse (s, s) of JWJᵀ + 1/k' − BᵀΛ⁻¹B; springs with k' = 0 stay out."""
    count = J.shape[0]
    linear = forces.spring_ends.shape[0]
    B = np.empty(border.shape)
    for s in range(count):
        block_product(bodies, W, J[s], WJ[s])
        product(liaisons, bodies, A, WJ[s], B[s])
        border[s, :] = B[s]
        solve(liaisons.skyline_first, liaisons.skyline_start, L, pivot, border[s])
    matrix = np.empty((count, count))
    for s in range(count):
        data = forces.spring_data[s] if s < linear else forces.torsion_data[s - linear]
        stiffness = c.beta * c.h * c.h * data[0] + c.gamma * c.h * data[1]
        for q in range(count):
            value = 0.0
            for i in range(J.shape[1]):
                value += J[s, i] * WJ[q, i]
            for i in range(border.shape[1]):
                value -= B[s, i] * border[q, i]
            matrix[s, q] = value
        if stiffness > 0.0:
            matrix[s, s] += 1.0 / stiffness
        else:
            J[s, :] = 0.0
            WJ[s, :] = 0.0
            border[s, :] = 0.0
    for s in range(count):
        data = forces.spring_data[s] if s < linear else forces.torsion_data[s - linear]
        if c.beta * c.h * c.h * data[0] + c.gamma * c.h * data[1] <= 0.0:
            matrix[s, :] = 0.0
            matrix[:, s] = 0.0
            matrix[s, s] = 1.0
    invert(matrix, inverse)


@njit(cache=True)
def shift_springs(forces: ForceTable, J: Array, shift: Array, rate_shift: Array, out: Array) -> None:
    """Add to `out` (n,) the forces Jᵀ(k J Δq + d J Δv) that shifts of positions and velocities cause."""
    linear = forces.spring_ends.shape[0]
    for s in range(J.shape[0]):
        data = forces.spring_data[s] if s < linear else forces.torsion_data[s - linear]
        force = 0.0
        for i in range(J.shape[1]):
            force += J[s, i] * (data[0] * shift[i] + data[1] * rate_shift[i])
        for i in range(J.shape[1]):
            out[i] += J[s, i] * force


@njit(cache=True)
def solve_springs(
    J: Array, border: Array, inverse: Array, x: Array, right: Array, phi: Array, forces: Array, psi: Array
) -> None:
    """ψ, and φ corrected for it: `right` = A x + …, `phi` = Λ⁻¹ right on entry; adds Jᵀψ to `forces` (n,)."""
    count = J.shape[0]
    defect = np.empty(count)
    for s in range(count):
        value = 0.0
        for i in range(J.shape[1]):
            value += J[s, i] * x[i]
        for i in range(right.shape[0]):
            value -= border[s, i] * right[i]
        defect[s] = value
    for s in range(count):
        value = 0.0
        for q in range(count):
            value += inverse[s, q] * defect[q]
        psi[s] = value
        for i in range(phi.shape[0]):
            phi[i] -= border[s, i] * value
        for i in range(J.shape[1]):
            forces[i] += J[s, i] * value

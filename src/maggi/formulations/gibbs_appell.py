"""Gibbs–Appell's formulation by Gauss' principle: among the accelerations that the liaisons admit, those of least Z.

    Z(v̇) = ½ Σ m_p |a_p − g|² − Σ F·a

over all mass points and applied forces, each taken with the acceleration of its own point; up to what does not depend
on v̇ this is ½ Σ m |a − F/m|². A constrained least-squares problem, solved as such: no mass matrix is formed from
points of positive mass.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .admissible import admissible
from .instant import FreeBody
from .question import Answer, Question

Array = NDArray[np.float64]

NULL = 1e-13  # part of the largest singular value below which a motion has no inertia


def gibbs_appell(question: Question) -> Answer:
    """Accelerations and joint forces by minimising Gauss' function."""
    instant = question.instant
    n, moving = instant.size, instant.moving
    force = instant.applied_forces()
    B, b = np.zeros((n, n)), np.zeros(n)
    for body in instant.bodies:
        B[body.slots, body.slots], b[body.slots], rest = _root(body)
        force[body.slots] += body.elastic - rest
    B, force = B[:, moving], force[moving]
    allowed = admissible(*instant.acceleration_rows(), instant.kinetic_weights())
    U, values, Vt = np.linalg.svd(B @ allowed.motions, full_matrices=False)
    kept = values > NULL * values.max(initial=0.0)
    U, values, Vt = U[:, kept], values[kept], Vt[kept]
    steepest = U.T @ (B @ allowed.particular + b) - (Vt @ (allowed.motions.T @ force)) / values
    accelerations = allowed.particular - allowed.motions @ (Vt.T @ (steepest / values))
    joint_forces = B.T @ (B @ accelerations + b) - force
    return Answer(accelerations, joint_forces, {})


def _root(body: FreeBody) -> tuple[Array, Array, Array]:
    """B (s, s), b (s,) and h (s,) with ``½ Σ m |a − g|² = ½ |B v̇ + b|² + h·v̇`` up to a constant; h is zero but for
    bodies with points of negative mass, which stand for an inertia tensor that no body has.
    """
    slopes, free = body.acceleration[1:], body.acceleration[0]
    s = len(slopes)
    if np.all(body.masses >= 0.0):
        root = np.sqrt(body.masses)[:, None]
        rows, right = np.zeros((max(free.size, s), s)), np.zeros(max(free.size, s))
        rows[: free.size], right[: free.size] = (root * slopes).reshape(s, -1).T, (root * free).ravel()
        Q, R = np.linalg.qr(rows)
        return R, Q.T @ right, np.zeros(s)
    H = np.einsum("p,jpi,kpi->jk", body.masses, slopes, slopes)
    h = np.einsum("p,jpi,pi->j", body.masses, slopes, free)
    values, axes = np.linalg.eigh(H)
    root = np.sqrt(np.where(values > NULL * values.max(initial=0.0), values, 0.0))
    B, b = root[:, None] * axes.T, np.divide(axes.T @ h, root, out=np.zeros(s), where=root > 0.0)
    return B, b, h - B.T @ b

"""Terms of rigid and Ritz bodies one at a time, where a computation asks for few (Eq. T2, T5a).

Those of rigid bodies are a few products of small arrays, for which nothing needs compiling.
"""

from __future__ import annotations

import numpy as np

from maggi.linalg.vectors import cross, cross_rows

from .ritz_kernels import deformed_inertia, inertia_residual, mass_matrix
from .tables import RIGID, RITZ, Array, BodyTable, MotionState


def body_mass(table: BodyTable, b: int, elastic: Array) -> Array:
    """Mass matrix (6 + n, 6 + n) on (v, ω, ė) of a rigid or Ritz body with elastic coordinates (n,) (Eq. T5a).

    With none: that of the body as it is undeformed.
    """
    n = elastic.size
    M = np.zeros((6 + n, 6 + n))
    if n:
        mass_matrix(table, b, elastic, M)
        return M
    M[:3, :3] = table.mass[b] * np.eye(3)
    M[3:, :3] = np.cross(np.eye(3), table.S0[b])  # S ×
    M[:3, 3:] = -M[3:, :3]
    M[3:, 3:] = table.J0[b]
    return M


def body_residual(table: BodyTable, b: int, state: MotionState, gravity: Array) -> Array:
    """Inertia, gravity, elastic and damping forces (6 + n,) of a rigid or Ritz body; see `inertia_residual`."""
    o, e = int(table.offset[b]), int(table.offset[b + 1])
    if e - o > 6:
        out = np.zeros(e - o)
        inertia_residual(table, b, state, gravity, out)
        return out
    v, w, eps = state.v[o : o + 3], state.v[o + 3 : e], state.vd[o + 3 : e]
    S, J = table.S0[b], table.J0[b]
    a = state.vd[o : o + 3] + cross(w, v) - state.rotation[b].T @ gravity
    force = table.mass[b] * a + cross(eps, S) + cross(w, cross(w, S))
    return np.concatenate([force, cross(S, a) + J @ eps + cross(w, J @ w)])


def small_body_energy(table: BodyTable, state: MotionState, gravity: Array) -> Array:
    """Kinetic, strain and gravity energy (J) and dissipated power (W) of all rigid and Ritz bodies, (4,)."""
    rigid = np.flatnonzero(table.kind == RIGID)
    first = table.offset[rigid][:, None] + np.arange(3)
    v, w = state.v[first], state.v[first + 3]
    mass, S, J = table.mass[rigid], table.S0[rigid], table.J0[rigid]
    # v·(ω × S) = S·(v × ω)
    angular = 0.5 * (J @ w[:, :, None])[:, :, 0]
    kinetic = 0.5 * mass @ (v * v).sum(axis=1) + (w * angular).sum() + (S * cross_rows(v, w)).sum()
    moment = mass @ state.origin[rigid] + (state.rotation[rigid] @ S[:, :, None]).sum(axis=0)[:, 0]
    out = np.array([kinetic, 0.0, -gravity @ moment, 0.0])
    for b in map(int, np.flatnonzero(table.kind == RITZ)):
        o, e = int(table.offset[b]), int(table.offset[b + 1])
        v, elastic, n = state.v[o:e], state.e[o + 6 : e], e - o - 6
        q = int(table.ritz_square[b])
        k, D = (part[q : q + n * n].reshape(n, n) for part in (table.k, table.D))
        S, J = np.empty(3), np.empty((3, 3))
        deformed_inertia(table, b, elastic, S, J)
        out[0] += 0.5 * v @ body_mass(table, b, elastic) @ v
        out[1] += 0.5 * elastic @ k @ elastic
        out[2] -= gravity @ (table.mass[b] * state.origin[b] + state.rotation[b] @ S)
        out[3] += v[6:] @ D @ v[6:]
    return out

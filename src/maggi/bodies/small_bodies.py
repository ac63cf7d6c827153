"""Terms of rigid and Ritz bodies one at a time, where a computation asks for few (Eq. T2, T5a).

Those of rigid bodies are a few products of small arrays, for which nothing needs compiling.
"""

from __future__ import annotations

import math

import numpy as np

from maggi.linalg.vectors import cross

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


class SmallBodyEnergies:
    """Energies of all rigid and Ritz bodies at many instants at once."""

    def __init__(self, table: BodyTable, gravity: Array) -> None:
        """gravity (3,), m/s²."""
        self._table, self._gravity = table, gravity
        self._rigid = np.flatnonzero(table.kind == RIGID)
        self._ritz = [int(b) for b in np.flatnonzero(table.kind == RITZ)]
        self._twists = table.offset[self._rigid][:, None] + np.arange(6)
        self._M = np.zeros((self._rigid.size, 6, 6))
        for M, b in zip(self._M, self._rigid, strict=True):
            M[:] = body_mass(table, int(b), np.empty(0))
        self._weight = table.mass[self._rigid, None] * gravity
        self._leverage = gravity[:, None] * table.S0[self._rigid][:, None, :]  # what rotations are to be multiplied by

    def at(self, origin: Array, rotation: Array, e: Array, v: Array) -> Array:
        """Kinetic, strain and gravity energy (J) and dissipated power (W), (m, 4).

        origin (m, b, 3), rotation (m, b, 3, 3), e, v (m, n): as in `MotionState`, m instants.
        """
        out = np.zeros((len(v), 4))
        t = np.ascontiguousarray(v[:, self._twists])
        out[:, 0] = 0.5 * _sums(t * (self._M @ t[..., None])[..., 0])
        out[:, 2] = -_sums(origin[:, self._rigid] * self._weight) - _sums(rotation[:, self._rigid] * self._leverage)
        for b in self._ritz:
            for k in range(len(v)):
                out[k] += self._of_ritz(b, origin[k, b], rotation[k, b], e[k], v[k])
        return out

    def _of_ritz(self, b: int, origin: Array, rotation: Array, e: Array, v: Array) -> Array:
        table, gravity = self._table, self._gravity
        o, end = int(table.offset[b]), int(table.offset[b + 1])
        v, elastic, n = v[o:end], np.ascontiguousarray(e[o + 6 : end]), end - o - 6
        q = int(table.ritz_square[b])
        k, D = (part[q : q + n * n].reshape(n, n) for part in (table.k, table.D))
        S, J = np.empty(3), np.empty((3, 3))
        deformed_inertia(table, b, elastic, S, J)
        kinetic, strain = 0.5 * v @ body_mass(table, b, elastic) @ v, 0.5 * elastic @ k @ elastic
        return np.array([kinetic, strain, -gravity @ (table.mass[b] * origin + rotation @ S), v[6:] @ D @ v[6:]])


def _sums(values: Array) -> Array:
    """Of all but the first axis, (m,): in the same order, to the last bit, however many instants there are."""
    return np.asarray(np.ascontiguousarray(values.reshape(len(values), math.prod(values.shape[1:]))).sum(axis=1))

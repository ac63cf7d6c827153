"""Accelerations that liaisons admit: a particular one, and independent motions beside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RANK = 1e-10
"""Singular values of the rows below this part of the largest count as none, velocities measured by kinetic energy."""


@dataclass(frozen=True, eq=False)
class Admissible:
    """``v̇ = particular + motions @ ν̇``: particular (k,), motions (k, k − rank)."""

    particular: Array
    motions: Array


def admissible(C: Array, gamma: Array, weight: Array) -> Admissible:
    """All v̇ with ``C v̇ + γ = 0``, by the singular values of C. weight (k,): root of twice the energy of a unit velocity."""
    scaled = C / weight
    size = np.linalg.norm(scaled, axis=1)
    size = np.where(size > 0.0, size, 1.0)
    U, values, Vt = np.linalg.svd(scaled / size[:, None], full_matrices=True)
    rank = int(np.sum(values > RANK * values.max(initial=0.0)))
    particular = -Vt[:rank].T @ ((U[:, :rank].T @ (gamma / size)) / values[:rank])
    return Admissible(particular / weight, Vt[rank:].T / weight[:, None])

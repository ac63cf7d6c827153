"""Shapes of a body from any vectors: orthogonal in mass and stiffness, rigid motions apart, to one scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from maggi.model.errors import ModelError

from .mesh_body import MeshBody

Array = NDArray[np.float64]

# The nine matrices H of T3 are held densely: 9 · 8 · 1500² bytes are 162 MB.
MOST_COORDINATES = 1500


@dataclass(frozen=True, eq=False)
class Shapes:
    """Shapes Ψ that a body's mesh is to move in, and what they were made from.

    basis (nd, n): on the body's freedoms; diagonal in M and K. Columns have the body's mass, ``ψᵀMψ = mass``, so that a
    coordinate is the root mean square displacement, m. On a floating frame they keep to mean axes, Cᵀψ = 0; on a
    prescribed one the first six are the rigid motions: rigid is 0 or 6.
    frequencies (n,): of each shape, in the body that nothing holds, Hz. held (f,): of the modes with all attachments
    held, Hz; interface: the number of independent motions of the attachments.
    """

    method: str
    basis: Array
    rigid: int
    frequencies: Array
    held: Array
    interface: int


def orthogonal_shapes(body: MeshBody, vectors: Array, *, with_rigid: bool) -> tuple[Array, Array, int]:
    """Shapes that span independent vectors (nd, q), their frequencies (Hz), and how many rigid motions are in front.

    with_rigid : the vectors span all rigid motions; otherwise they keep to mean axes.
    """
    mass, J6 = body.inertia.mass, body.J6
    M = body.inertia.matrix
    vectors = vectors / np.sqrt(np.einsum("ij,ij->j", vectors, M @ vectors))
    if with_rigid:
        # the combinations that keep to mean axes
        conditions = (body.C.T @ vectors) / np.sqrt(np.diag(J6))[:, None]
        q, _ = scipy.linalg.qr(conditions.T)
        vectors = vectors @ q[:, 6:]
    vectors = body.without_rigid_motion(vectors)
    k, m = vectors.T @ (body.K.matrix() @ vectors), vectors.T @ (M @ vectors)
    squares, turn = scipy.linalg.eigh(0.5 * (k + k.T), 0.5 * (m + m.T))
    shapes = body.without_rigid_motion(vectors @ turn)
    frequencies = np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi)
    if body.floating:
        return np.sqrt(mass) * shapes, frequencies, 0
    values, axes = np.linalg.eigh(J6)
    motions = body.Phi @ (axes / np.sqrt(values))
    return np.sqrt(mass) * np.hstack([motions, shapes]), np.concatenate([np.zeros(6), frequencies]), 6


def modes_where(body: MeshBody, conditions: Array, count: int) -> tuple[Array, Array]:
    """The `count` lowest modes with ``conditionsᵀ u = 0``, conditions (nd, r), by dense matrices: λ and u (nd, count)."""
    if count == 0:
        return np.empty(0), np.empty((body.size, 0))
    q, _ = scipy.linalg.qr(conditions / np.linalg.norm(conditions, axis=0))
    free = q[:, conditions.shape[1] :]
    k, m = free.T @ (body.K.matrix() @ free), free.T @ (body.inertia.matrix @ free)
    squares, turn = scipy.linalg.eigh(0.5 * (k + k.T), 0.5 * (m + m.T), subset_by_index=(0, count - 1))
    return np.maximum(squares, 0.0), free @ turn


def refuse_many(coordinates: int, path: str, remedy: str) -> None:
    """Raise ModelError for more coordinates than dense constants are kept for."""
    if coordinates > MOST_COORDINATES:
        raise ModelError(
            f"{coordinates:,} elastic coordinates are more than the {MOST_COORDINATES:,} that dense constants are kept for",
            path=path,
            remedy=remedy,
        )

"""Attachments of a mesh: node sets made rigid (RBE2) or averaged (RBE3), both linear liaisons (Theory §3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.model.errors import ModelError

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

FLAT = 1e-6  # a set whose nodes lie within this part of its extent of a line does not fix a rotation


@dataclass(frozen=True, eq=False)
class Coupling:
    """One attachment of a mesh: its name, node indices, point (3,) body frame, and whether it is rigid or averaged."""

    name: str
    nodes: IntArray
    point: Array
    rigid: bool


def make_coupling(name: str, nodes: Array, members: IntArray, rigid: bool, path: str) -> Coupling:
    """An attachment at the centroid of its nodes.

    Raises ModelError if the nodes cannot carry a rotation: fewer than three, or all on one line.
    """
    X = nodes[members]
    point = X.mean(axis=0)
    if len(members) < 3 or np.linalg.svd(X - point, compute_uv=False)[1] < FLAT * np.ptp(X, axis=0).max():
        raise ModelError(
            f"the attachment's {len(members)} nodes lie on one line or are too few to carry a rotation",
            path=path,
            remedy="select at least three nodes that are not on one line, such as those of a face",
        )
    return Coupling(name, members, point, rigid)


def averaging_weights(nodes: Array, coupling: Coupling) -> Array:
    """RBE3: the rows that take nodal displacements of the set to (d, θ): ``(PᵀP)⁻¹Pᵀ``, shape (6, 3 · members).

    P: the rigid motions about the attachment's point, ``u_n = d + θ × (X_n − X_a)``; nodes weigh the same.
    """
    arm = nodes[coupling.nodes] - coupling.point
    count = len(arm)
    P = np.zeros((count, 3, 6))
    P[:, :, :3] = np.eye(3)
    P[:, 0, 4], P[:, 0, 5] = arm[:, 2], -arm[:, 1]
    P[:, 1, 3], P[:, 1, 5] = -arm[:, 2], arm[:, 0]
    P[:, 2, 3], P[:, 2, 4] = arm[:, 1], -arm[:, 0]
    flat = P.reshape(3 * count, 6)
    return np.asarray(np.linalg.solve(flat.T @ flat, flat.T))


def refuse_overlap(couplings: list[Coupling], path: str) -> None:
    """Raise ModelError if a node belongs to two rigid attachments: it cannot follow both."""
    owner: dict[int, str] = {}
    for coupling in couplings:
        if not coupling.rigid:
            continue
        for node in coupling.nodes.tolist():
            if node in owner:
                raise ModelError(
                    f"attachments {owner[node]!r} and {coupling.name!r} share nodes and are both rigid",
                    path=f"{path}.attachments.{coupling.name}",
                    remedy="select disjoint sets, or give one of them `coupling: average`",
                )
            owner[node] = coupling.name

"""Natural modes of one elastic body: free, or clamped at attachments, with the point masses that it carries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, eigsh

from maggi.bodies.mesh_body import MeshBody, build_mesh_body
from maggi.linalg.factor import factorise
from maggi.model.attachments import PointMass
from maggi.model.bodies import ElasticBody
from maggi.model.errors import ModelError
from maggi.model.model import Model

Array = NDArray[np.float64]

SHIFT = 1e-9  # of the highest eigenvalue's estimate: far below any elastic one, far above round-off


@dataclass(frozen=True, eq=False)
class BodyModes:
    """Undamped modes at rest: frequencies (k,), Hz, rising; shapes (nd, k) on the body's freedoms, xᵀMx = 1 kg."""

    frequencies: Array
    shapes: Array


def body_modes(model: Model, name: str, count: int, clamped: Sequence[str] = ()) -> BodyModes:
    """The `count` lowest modes of an elastic body of a model, with its attachments' point masses.

    clamped : attachments that are held; without any, the first six frequencies are those of rigid motions, zero to
    round-off. Joints, forces and the rest of the model play no part.

    Raises ModelError for a body or an attachment that is not there, for a body without a mesh, and for a count that
    the body does not have.
    """
    body = model.bodies.get(name)
    path = f"bodies.{name}"
    if not isinstance(body, ElasticBody):
        raise ModelError(
            f"there is no elastic body {name!r}" if body is None else f"{name!r} is not an elastic body with a mesh",
            path=path,
            remedy="modes are those of one body of `kind: elastic`",
        )
    masses = {key: attachment.point_masses for key, attachment in body.attachments.items()}
    return mesh_modes(build_mesh_body(name, body, model.folder), count, clamped, masses)


def mesh_modes(
    body: MeshBody,
    count: int,
    clamped: Sequence[str] = (),
    point_masses: Mapping[str, Sequence[PointMass]] | None = None,
) -> BodyModes:
    """As `body_modes`, for a body that is built already; point_masses by attachment.

    Shift-invert Lanczos on ``K + sM``, factorised once. The clamps G x = 0 are removed by the same projection as
    liaisons are in a step, ``x − YΛ⁻¹Gx`` with ``Y = (K + sM)⁻¹Gᵀ, Λ = GY``, so that rigid (RBE2) and averaged (RBE3)
    attachments are treated alike, exactly and without a penalty.
    """
    index = {coupling.name: k for k, coupling in enumerate(body.couplings)}
    for key in clamped:
        if key not in index:
            raise ModelError(
                f"body {body.name!r} has no attachment {key!r} to clamp",
                path=f"bodies.{body.name}.attachments",
                remedy=f"it has {', '.join(index)}" if index else "add it under `attachments:`",
            )
    held = [6 * index[key] + i for key in dict.fromkeys(clamped) for i in range(6)]
    if not 1 <= count < body.size - len(held):
        raise ModelError(
            f"{count} modes are asked for; the body has {body.size - len(held)} freedoms",
            path=f"bodies.{body.name}",
            remedy="ask for at least one and fewer than all",
        )
    M = _mass(body, index, point_masses or {})
    K = body.K.matrix().tocsr()
    shift = SHIFT * float(K.diagonal().max() / M.diagonal().max())
    factor = factorise(K + shift * M)
    G = body.B.tocsc()[:, held].T.tocsr()
    Y = factor.solve_many(G.T.toarray()) if held else np.zeros((body.size, 0))
    response = np.linalg.pinv(G @ Y, rcond=1e-12, hermitian=True)

    def solve(force: Array) -> Array:
        x = factor.solve(force)
        for _ in range(2 if held else 0):  # the second removes what the rigid motions in x, of order 1/s, leave
            x -= Y @ (response @ (G @ x))
        return x

    inverse = LinearOperator((body.size, body.size), matvec=solve, dtype=np.float64)
    start = solve(M @ np.random.default_rng(0).standard_normal(body.size))  # in the clamps' null space
    _, shapes = eigsh(K, count, M, sigma=-shift, OPinv=inverse, v0=start)
    # what the shift has cost in digits: the quotient's error is the square of the shape's
    values = np.einsum("ij,ij->j", shapes, K @ shapes) / np.einsum("ij,ij->j", shapes, M @ shapes)
    order = np.argsort(values)
    return BodyModes(np.sqrt(np.maximum(values[order], 0.0)) / (2.0 * np.pi), np.ascontiguousarray(shapes[:, order]))


def _mass(body: MeshBody, index: Mapping[str, int], point_masses: Mapping[str, Sequence[PointMass]]) -> sp.csr_matrix:
    """M of the freedoms with rigid masses on the attachments: M + B M₆ Bᵀ."""
    M = body.inertia.matrix.tocsr()
    for key, masses in point_masses.items():
        B = body.B.tocsc()[:, 6 * index[key] : 6 * index[key] + 6]
        for mass in masses:
            M = M + B @ sp.csr_matrix(_rigid_mass(mass)) @ B.T
    return M.tocsr()


def _rigid_mass(mass: PointMass) -> Array:
    """Mass matrix (6, 6) of a rigid mass on the rates of its attachment's (d, θ)."""
    c = np.array(mass.offset)
    tilde = np.array([[0.0, -c[2], c[1]], [c[2], 0.0, -c[0]], [-c[1], c[0], 0.0]])
    M = np.zeros((6, 6))
    M[:3, :3] = mass.mass * np.eye(3)
    M[:3, 3:] = -mass.mass * tilde
    M[3:, :3] = mass.mass * tilde
    M[3:, 3:] = np.array(mass.inertia) - mass.mass * tilde @ tilde
    return M

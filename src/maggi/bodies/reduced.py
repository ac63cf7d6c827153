"""Elastic bodies whose mesh moves in a few shapes: coordinates e with ``u = Ψ e`` (Theory T2, T3, T5a).

The constants are those of the consistent mass, and nothing but the space of shapes is approximated: with shapes that
span all motions the body is the full mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.model.bodies import RitzTerms

from .basis import Shapes
from .mesh_body import MeshBody

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ReducedBody:
    """A meshed body on n shapes: terms, the constants of its coordinates e (n,); its attachments' (d, θ) = psi e.

    psi: (k, 6, n) in the order of the body's couplings.
    """

    body: MeshBody
    shapes: Shapes
    terms: RitzTerms
    psi: Array

    @property
    def basis(self) -> Array:
        """Ψ (nd, n)."""
        return self.shapes.basis

    def nodal_displacement(self, e: Array) -> Array:
        """Displacements (n_nodes, 3) of the mesh's nodes, body frame."""
        return self.body.nodal_displacement(self.basis @ e)

    def nodal_basis(self) -> Array:
        """Nodal displacements of every coordinate, (n_nodes, 3, n)."""
        return self.body.nodal_displacements(self.basis)

    def static_compliance(self) -> Array:
        """Coordinates (n, n) that static forces on them cause, without rigid motions."""
        first = self.shapes.rigid
        W = np.zeros_like(self.terms.k)
        inverse = np.linalg.inv(self.terms.k[first:, first:])
        W[first:, first:] = 0.5 * (inverse + inverse.T)
        return W

    def rigid_motions(self) -> Array:
        """Coordinates (n, 6) of the rigid motions Φ on a prescribed frame; (n, 0) on a floating one, which has none."""
        first = self.shapes.rigid
        rigid = np.zeros((self.basis.shape[1], first))
        rigid[:first] = np.linalg.solve(self.terms.m[:first, :first], self.basis[:, :first].T @ self.body.C[:, :first])
        return rigid


def reduce_body(body: MeshBody, shapes: Shapes) -> ReducedBody:
    """A body on given shapes."""
    basis = shapes.basis
    constants = body.inertia.constants(basis)
    # K Φ = 0, but for round-off: rigid motions are given none
    elastic = basis.copy()
    elastic[:, : shapes.rigid] = 0.0
    k = elastic.T @ (body.K.matrix() @ elastic)
    k = 0.5 * (k + k.T)
    terms = RitzTerms(
        mass=float(constants.mass),
        S0=constants.S0,
        J0=constants.J0,
        m=constants.m,
        k=k,
        D=body.damping.mass * constants.m + body.damping.stiffness * k,
        m_O=constants.m_O,
        G=constants.G,
        H=constants.H,
        s=constants.s,
        s2=constants.s2,
    )
    return ReducedBody(body, shapes, terms, np.asarray(body.B.T @ basis).reshape(-1, 6, basis.shape[1]))

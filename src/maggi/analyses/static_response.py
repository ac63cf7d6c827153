"""What static forces do to a full-mesh body that nothing holds: P K⁺ Pᵀ, with one factorisation for bodies that are the same."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.mesh_body import MeshBody
from maggi.linalg.factor import FEW, solve_rows
from maggi.stepping.condensation import Condensations
from maggi.stepping.mesh_kernels import inner_product

Array = NDArray[np.float64]

REGULARISATION = (
    1e-10  # of the largest K/M: a shift far below the elastic spectrum; solutions are refined with K itself
)
REFINEMENTS = 4


class StaticResponse:
    """Displacements of a body under forces that its own inertia balances.

    Y (6k, nd): those of unit forces at the attachments, a row for each; W (6k, 6k): BᵀY.
    """

    def __init__(self, body: MeshBody, shared: Condensations) -> None:
        self._body = body
        shift = REGULARISATION * body.K.diagonal().max() / body.inertia.matrix.diagonal().max()
        self._factor = shared.factorise(float(shift), 1.0)
        n = body.B.shape[1]
        self.Y = np.empty((n, body.size))
        for k in range(0, n, FEW):
            self.Y[k : k + FEW] = self.displacements(body.B[:, k : k + FEW].toarray().T)
        W = body.B.T @ self.Y.T
        self.W = 0.5 * (W + W.T)

    def displacements(self, forces: Array) -> Array:
        """P K⁺ Pᵀ of forces (m, nd), a row each, refined; (m, nd)."""
        body, axes = self._body, self._body.axes
        forces = np.array(forces, order="C")
        for force in forces:
            axes.project_forces(force)
        u, product = np.zeros_like(forces), np.empty(body.size)
        for _ in range(REFINEMENTS if len(forces) else 0):
            defects = forces.copy()
            for row, defect in zip(u, defects, strict=True):
                product[:] = 0.0
                body.K.add_product(row, product)
                defect -= product
                axes.project_forces(defect)
            steps = solve_rows(self._factor, defects)
            settled = True
            for row, step in zip(u, steps, strict=True):
                axes.project(step)
                row += step
                settled &= inner_product(step, step) <= 1e-26 * inner_product(row, row)
            if settled:
                break
        return u

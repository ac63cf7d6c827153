"""The mass matrix of a mesh whose interpolation is isotropic, factorised by its scalar part."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.linalg.factor import Factor

Array = NDArray[np.float64]


class IsotropicFactor:
    """M by the factor of the free nodes' scalar μ, three right sides for each, and a border of the attachments' freedoms.

    It has a ninth of the entries that a factor of M itself has.
    """

    def __init__(self, factor: Factor, matrix: sp.csr_matrix | None) -> None:
        self._factor = factor
        self._free = 3 * factor.order
        self.order = self._free if matrix is None else int(matrix.shape[0])
        self._border = self.order - self._free
        self.nbytes = factor.nbytes
        if matrix is not None:
            self._side = matrix[self._free :, : self._free].tocsr()
            self._response = self._interior(self._side.T.toarray())
            corner = matrix[self._free :, self._free :].toarray() - self._side @ self._response
            self._corner = np.linalg.inv(0.5 * (corner + corner.T))

    def solve(self, b: Array) -> Array:
        """See `Factor.solve`."""
        return self.solve_many(b[:, None])[:, 0].copy()

    def solve_many(self, B: Array) -> Array:
        """See `Factor.solve_many`."""
        x = self._interior(B[: self._free])
        if not self._border:
            return x
        y = self._corner @ (B[self._free :] - self._side @ x)
        return np.vstack([x - self._response @ y, y])

    def _interior(self, B: Array) -> Array:
        """μ⁻¹ of the components of fields (3f, k)."""
        k = B.shape[1]
        columns = np.ascontiguousarray(B).reshape(-1, 3 * k)
        return np.ascontiguousarray(self._factor.solve_many(columns)).reshape(-1, k)

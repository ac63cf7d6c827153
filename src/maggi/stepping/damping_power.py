"""The power that a meshed body's damping takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.mesh_body import MeshBody
from maggi.linalg.lanes import WIDTH

Array = NDArray[np.float64]


class DampingPower:
    """u̇ᵀD u̇ of some instants, found for four of them at once: K and M are read once for that."""

    def __init__(self, body: MeshBody) -> None:
        self._body = body
        self._fields = np.zeros((body.size // 3, 3, WIDTH))
        self._columns = self._fields.reshape(-1, WIDTH)
        self._squares = body.K.squares(self._fields)
        self._kept = 0

    def keep(self, velocities: Array) -> None:
        """Of an instant, u̇ (nd,); of four at most before they are found."""
        self._columns[:, self._kept] = velocities
        self._kept += 1

    def find(self) -> Array:
        """Of the instants kept (W), in their order; they are forgotten."""
        d, power = self._body.damping, np.zeros(WIDTH)
        if d.stiffness:
            power += d.stiffness * self._squares.find()
        if d.mass:
            power += d.mass * self._body.inertia.squares(self._fields)
        kept, self._kept = self._kept, 0
        return power[:kept]

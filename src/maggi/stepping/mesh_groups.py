"""Full-mesh bodies that are the same: one assembly, one factor, one pass of it for all of their right sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.projection.relative_system import RelativeSystem
from maggi.system.system import System

from .condensation import Condensations
from .mesh_step import MeshStep

Array = NDArray[np.float64]

# Two right sides cost as much as twice one, three to eight about the same: eight are what the library solves at once.
TOGETHER, FULL = 3, 8


class MeshGroup:
    """The bodies of one likeness, and their back-substitutions."""

    def __init__(self, system: System, relative: RelativeSystem, indices: list[int]) -> None:
        bodies = [system.mesh_bodies[index] for index in indices]
        self.shared = Condensations(bodies[0])
        count, size = len(bodies), bodies[0].size
        # a right side is a row; rows of zeros fill the last eight
        self._forces = np.zeros((count if count < TOGETHER else -(-count // FULL) * FULL, size))
        self.meshes = [
            MeshStep(body, index, system.bodies, relative.place(index), self.shared, force)
            for body, index, force in zip(bodies, indices, self._forces, strict=False)
        ]

    def solve(self) -> None:
        """The solution of every body from its force."""
        factor = self.meshes[0].constants.factor
        assert factor is not None
        if len(self.meshes) < TOGETHER:
            for mesh in self.meshes:
                mesh.solution[:] = factor.solve(mesh.force)
            return
        solutions = factor.solve_many(self._forces.T)
        for k, mesh in enumerate(self.meshes):
            mesh.solution[:] = solutions[:, k]


def mesh_groups(system: System, relative: RelativeSystem) -> list[MeshGroup]:
    """All full-mesh bodies of a system, those that are the same together, in the order of their first."""
    indices: dict[str, list[int]] = {}
    for index, body in system.mesh_bodies.items():
        indices.setdefault(body.likeness, []).append(index)
    return [MeshGroup(system, relative, members) for members in indices.values()]

"""Beams at points of their sections: masses, displacements and strains from the three-dimensional field, nothing assembled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.elements.beam import beam_axes, beam_shapes, shear_flexibilities
from maggi.elements.quadrature import gauss_legendre
from maggi.mesh import Mesh
from maggi.model.materials import Material
from maggi.model.meshes import BeamMesh, Section

from .elasticity import Strains

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Beam:
    """The c cells of a beam: ends (c, 2, 3), cells (c, 2), axes (c, 3, 3) and length (c,).

    places (p, 3): points (x/length, y, z), four in each section at four Gauss points along the cell; they have the
    section's area and second moments, so that integrals of what is quadratic in y and z are exact. weights (p,) sum to 1.
    """

    section: Section
    material: Material
    cells: NDArray[np.int64]
    ends: Array
    axes: Array
    length: Array
    places: Array
    weights: Array

    @staticmethod
    def of(mesh: Mesh, source: BeamMesh, material: Material) -> Beam:
        """The beam of a parametric mesh."""
        section, cells = source.section, mesh.cells["beam2"]
        ends = mesh.nodes[cells]
        spans = ends[:, 1] - ends[:, 0]
        x, w = gauss_legendre(4)
        y, z = np.sqrt(section.Iz / section.area), np.sqrt(section.Iy / section.area)
        corners = np.array([[y, z], [-y, z], [-y, -z], [y, -z]])
        places = np.column_stack([np.repeat(0.5 * (x + 1.0), 4), np.tile(corners, (4, 1))])
        length = np.linalg.norm(spans, axis=1)
        return Beam(section, material, cells, ends, beam_axes(spans), length, places, np.repeat(w, 4) / 8.0)

    def masses(self) -> tuple[Array, Array]:
        """Masses (p,) kg and undeformed positions (p, 3) m of all cells' points."""
        masses = self.material.density * self.section.area * self.length[:, None] * self.weights
        local = np.broadcast_to(self.places, (len(self.cells), *self.places.shape)).copy()
        local[:, :, 0] *= self.length[:, None]
        points = self.ends[:, None, 0] + np.einsum("cij,cpj->cpi", self.axes, local)
        return masses.ravel(), points.reshape(-1, 3)

    def shapes(self, field: Array) -> Array:
        """Displacements (p, 3, n) of the same points for nodal displacements and rotations (nodes, 6, n)."""
        local = np.einsum("cpja,can->cpjn", self._field(self.places), self._nodal(field), optimize=True)
        return np.asarray(np.einsum("cij,cpjn->cpin", self.axes, local)).reshape(-1, 3, field.shape[2])

    def strains(self, field: Array) -> tuple[Strains, ...]:
        """Strain along the beam at the points, and on the axis both shears and the twist: one component each."""
        section, material = self.section, self.material
        E, G = material.young, material.young / (2.0 * (1.0 + material.poisson))
        axis, weights = self.places[::4] * [1.0, 0.0, 0.0], 4.0 * self.weights[::4]
        sideways = np.array([0.0, 1.0, 0.0])
        twist = 0.5 * (self._along(axis + sideways) - self._along(axis - sideways))[:, :, 2]
        laws = (
            (self._along(self.places)[:, :, 0], E, self.weights),
            (self._along(axis)[:, :, 1] + self._across(axis, 1)[:, :, 0], section.ky * G, weights),
            (self._along(axis)[:, :, 2] + self._across(axis, 2)[:, :, 0], section.kz * G, weights),
            (twist, G * section.J / section.area, weights),
        )
        nodal, volume = self._nodal(field), section.area * self.length[:, None]
        return tuple(
            Strains(
                np.einsum("cqa,can->cqn", shapes, nodal).reshape(-1, 1, field.shape[2]),
                (modulus * volume * share).reshape(-1, 1, 1),
            )
            for shapes, modulus, share in laws
        )

    def _nodal(self, field: Array) -> Array:
        """Nodal displacements and rotations in each cell's own axes, (c, 12, n)."""
        count, n = len(self.cells), field.shape[2]
        nodes = field[self.cells].reshape(count, 2, 2, 3, n)
        return np.asarray(np.einsum("cji,cksjn->cksin", self.axes, nodes)).reshape(count, 12, n)

    def _field(self, places: Array) -> Array:
        """N (c, q, 3, 12) at places (q, 3), in the cells' axes."""
        return beam_shapes(places, self.length, *shear_flexibilities(self.length, self.section, self.material))

    def _along(self, places: Array) -> Array:
        """∂N/∂x, by a difference that is exact for polynomials of up to the fourth degree."""
        h = np.array([0.25, 0.0, 0.0])
        near = self._field(places + h) - self._field(places - h)
        far = self._field(places + 2.0 * h) - self._field(places - 2.0 * h)
        return np.asarray((8.0 * near - far) / (3.0 * self.length[:, None, None, None]))

    def _across(self, places: Array, k: int) -> Array:
        """∂N/∂y (k = 1) or ∂N/∂z (k = 2): the field is linear in both."""
        step = np.eye(3)[k]
        return np.asarray(0.5 * (self._field(places + step) - self._field(places - step)))

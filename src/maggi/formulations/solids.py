"""Solid cells at their own quadrature points: masses, displacements and strains, nothing assembled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.elements.solids import SOLIDS
from maggi.mesh import Mesh
from maggi.model.materials import Material

from .elasticity import Strains

Array = NDArray[np.float64]


def solid_masses(mesh: Mesh, material: Material | None) -> tuple[Array, Array]:
    """Masses (p,) kg and undeformed positions (p, 3) m of all cells' points. material None: those of the mesh file."""
    masses, points = [], []
    for kind, cells in mesh.cells.items():
        element, corners = SOLIDS[kind], mesh.nodes[cells]
        rule = element.mass_rule
        density, _, _ = _constants(mesh, kind, len(cells), material)
        jacobian = np.einsum("cki,pkj->cpij", corners, element.gradients(rule.points))
        masses.append((density[:, None] * rule.weights * np.linalg.det(jacobian)).ravel())
        points.append(np.einsum("pk,cki->cpi", element.values(rule.points), corners).reshape(-1, 3))
    return np.concatenate(masses), np.concatenate(points)


def solid_shapes(mesh: Mesh, field: Array) -> Array:
    """Displacements (p, 3, n) of the same points for nodal displacements (nodes, 3, n)."""
    shapes = []
    for kind, cells in mesh.cells.items():
        values = SOLIDS[kind].values(SOLIDS[kind].mass_rule.points)
        shapes.append(np.einsum("pk,ckin->cpin", values, field[cells]).reshape(-1, *field.shape[1:]))
    return np.concatenate(shapes)


def solid_strains(mesh: Mesh, material: Material | None, field: Array) -> tuple[Strains, ...]:
    """Strains, nine components each, for nodal displacements (nodes, 3, n)."""
    result = []
    trace = np.eye(3).reshape(9)
    for kind, cells in mesh.cells.items():
        element = SOLIDS[kind]
        rule = element.stiffness_rule
        reference = element.gradients(rule.points)
        jacobian = np.einsum("cki,qkj->cqij", mesh.nodes[cells], reference)
        slopes = np.einsum("qkj,cqjl->cqkl", reference, np.linalg.inv(jacobian))
        gradient = np.einsum("cqkl,ckin->cqiln", slopes, field[cells], optimize=True)
        strain = 0.5 * (gradient + gradient.transpose(0, 1, 3, 2, 4))
        volumes = rule.weights * np.linalg.det(jacobian)
        _, lame, shear = _constants(mesh, kind, len(cells), material)
        law = lame[:, None, None] * np.outer(trace, trace) + 2.0 * shear[:, None, None] * np.eye(9)
        modulus = volumes[:, :, None, None] * law[:, None]
        result.append(Strains(strain.reshape(-1, 9, field.shape[2]), modulus.reshape(-1, 9, 9)))
    return tuple(result)


def _constants(mesh: Mesh, kind: str, count: int, material: Material | None) -> tuple[Array, Array, Array]:
    """Density and Lamé's constants (count,) of the cells of one type."""
    if material is not None:
        materials = [material] * count
    else:
        table = list(mesh.materials.values())
        materials = [table[index] for index in mesh.cell_materials[kind]]
    E = np.array([m.young for m in materials])
    nu = np.array([m.poisson for m in materials])
    density = np.array([m.density for m in materials])
    return density, E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))

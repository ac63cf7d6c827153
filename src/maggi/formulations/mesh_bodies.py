"""Meshed bodies as mass points: the elements' own quadrature points, displaced by nodal fields."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.elements.beam import beam_axes, beam_shapes, shear_flexibilities
from maggi.elements.quadrature import gauss_legendre
from maggi.elements.solids import SOLIDS
from maggi.mesh import Mesh, load_mesh, select
from maggi.model.bodies import ElasticBody, GivenMotion
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BeamMesh

from .bodies import Elasticity, Marker, PointBody, Rigid, equivalent_points, initial_pose

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StrainLaw:
    """Hooke's law at q quadrature points, and Rayleigh damping.

    strain (q, r, n): r strain components for unit elastic coordinates; modulus (q, r, r): what takes them to the stresses
    times the volume of the point. shapes (p, 3, n), masses (p,): of the mass points, which mass-proportional damping
    holds back where they move in the body's frame.
    """

    strain: Array
    modulus: Array
    shapes: Array
    masses: Array
    damping: Damping

    def force(self, e: Array, rate: Array) -> Array:
        strain = self.strain @ (e + self.damping.stiffness * rate)
        stress = np.einsum("qrs,qs->qr", self.modulus, strain)
        drag = self.damping.mass * self.masses[:, None] * (self.shapes @ rate)
        return np.asarray(-np.einsum("qrn,qr->n", self.strain, stress) - np.einsum("pin,pi->n", self.shapes, drag))


def mesh_body(name: str, body: ElasticBody, folder: str, field: Array | None) -> PointBody:
    """A meshed body in points.

    field : nodal displacements for unit elastic coordinates (nodes, 3, n), of beams with the nodes' rotation vectors
    (nodes, 6, n); None: the body is rigid, and seven points with its mass, centre and inertia stand for it.
    """
    mesh = load_mesh(body.mesh, folder, f"bodies.{name}.mesh")
    n = 0 if field is None else field.shape[2]
    if isinstance(body.mesh, BeamMesh):
        assert body.material is not None
        masses, points, shapes, law = _beam(mesh, body.mesh, body.material, field)
    else:
        masses, points, shapes, law = _solids(mesh, body.material, field)
    origin, rotation = initial_pose(body.pose, body.motion)
    attachments = {}
    for key, attachment in body.attachments.items():
        assert attachment.nodes is not None
        members = select(mesh, attachment.nodes)
        at = mesh.nodes[members].mean(axis=0)
        unit = np.zeros((6, n)) if field is None else _set_motion(mesh.nodes[members] - at, field[members])
        attachments[key] = Marker(name, at, unit[:3], unit[3:])
    if field is None:
        mass = masses.sum()
        center = masses @ points / mass
        second = np.einsum("p,pi,pj->ij", masses, points - center, points - center)
        masses, points = equivalent_points(float(mass), center, np.trace(second) * np.eye(3) - second)
        return PointBody(name, masses, points, np.zeros((len(masses), 3, 0)), origin, rotation, Rigid(), attachments)
    motion = body.motion if isinstance(body.motion, GivenMotion) else None
    return PointBody(name, masses, points, shapes, origin, rotation, law, attachments, motion)


def _set_motion(arms: Array, field: Array) -> Array:
    """The rigid motion (6, n), (d, θ), nearest to a field on a node set; a beam's node has its own."""
    if field.shape[1] == 6:
        return np.asarray(field[0])
    count = len(arms)
    motion = np.zeros((count, 3, 6))
    motion[:, :, :3] = np.eye(3)
    for k in range(3):
        motion[:, :, 3 + k] = np.cross(np.eye(3)[k], arms)
    flat = field.reshape(3 * count, -1)
    return np.asarray(np.linalg.lstsq(motion.reshape(3 * count, 6), flat, rcond=None)[0])


def _solids(mesh: Mesh, material: Material | None, field: Array | None) -> tuple[Array, Array, Array, Elasticity]:
    """Masses, points, shape functions and elastic law of all solid cells."""
    parts = []
    for kind, cells in mesh.cells.items():
        element = SOLIDS[kind]
        density, lame, shear = _constants(mesh, kind, len(cells), material)
        corners = mesh.nodes[cells]
        N, rule = element.values(element.mass_rule.points), element.mass_rule
        jacobian = np.einsum("cki,pkj->cpij", corners, element.gradients(rule.points))
        masses = density[:, None] * rule.weights * np.linalg.det(jacobian)
        points = np.einsum("pk,cki->cpi", N, corners)
        if field is None:
            parts.append((masses.ravel(), points.reshape(-1, 3), np.zeros((masses.size, 3, 0)), None, None))
            continue
        displaced = field[cells]
        shapes = np.einsum("pk,ckin->cpin", N, displaced)
        rule = element.stiffness_rule
        reference = element.gradients(rule.points)
        jacobian = np.einsum("cki,qkj->cqij", corners, reference)
        slopes = np.einsum("qkj,cqjl->cqkl", reference, np.linalg.inv(jacobian))
        gradient = np.einsum("cqkl,ckin->cqiln", slopes, displaced, optimize=True)
        strain = 0.5 * (gradient + gradient.transpose(0, 1, 3, 2, 4))
        volumes = rule.weights * np.linalg.det(jacobian)
        trace = np.eye(3).reshape(9)
        law = lame[:, None, None] * np.outer(trace, trace) + 2.0 * shear[:, None, None] * np.eye(9)
        modulus = volumes[:, :, None, None] * law[:, None]
        n = field.shape[2]
        parts.append(
            (
                masses.ravel(),
                points.reshape(-1, 3),
                shapes.reshape(-1, 3, n),
                strain.reshape(-1, 9, n),
                modulus.reshape(-1, 9, 9),
            )
        )
    masses, points, shapes = (np.concatenate([part[k] for part in parts]) for k in range(3))
    if field is None:
        return masses, points, shapes, Rigid()
    strain, modulus = (np.concatenate([part[k] for part in parts]) for k in (3, 4))
    damping = Damping() if material is None else material.damping
    return masses, points, shapes, StrainLaw(strain, modulus, shapes, masses, damping)


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


def _beam(
    mesh: Mesh, source: BeamMesh, material: Material, field: Array | None
) -> tuple[Array, Array, Array, Elasticity]:
    """Masses, points, shape functions and elastic law of a beam, all from its displacement field in three dimensions.

    Four points of the section have its area and second moments, so that integrals of what is quadratic in y, z are exact.
    """
    section, cells = source.section, mesh.cells["beam2"]
    ends = mesh.nodes[cells]
    spans = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(spans, axis=1)
    axes = beam_axes(spans)
    flexibility = shear_flexibilities(length, section, material)
    x, w = gauss_legendre(4)
    y, z = np.sqrt(section.Iz / section.area), np.sqrt(section.Iy / section.area)
    corners = np.array([[y, z], [-y, z], [-y, -z], [y, -z]])
    places = np.column_stack([np.repeat(0.5 * (x + 1.0), 4), np.tile(corners, (4, 1))])
    share = np.repeat(0.5 * w, 4) / 4.0
    masses = material.density * section.area * length[:, None] * share
    local = np.broadcast_to(places, (len(cells), *places.shape)).copy()
    local[:, :, 0] *= length[:, None]
    points = ends[:, None, 0] + np.einsum("cij,cpj->cpi", axes, local)
    if field is None:
        return masses.ravel(), points.reshape(-1, 3), np.zeros((masses.size, 3, 0)), Rigid()
    n = field.shape[2]
    # nodal displacements and rotations in each beam's own axes, (c, 12, n)
    nodal = np.einsum("cji,cksjn->cksin", axes, field[cells].reshape(len(cells), 2, 2, 3, n)).reshape(-1, 12, n)
    shapes = np.einsum("cij,cpja,can->cpin", axes, beam_shapes(places, length, *flexibility), nodal, optimize=True)

    def at(points: Array) -> Array:
        return beam_shapes(points, length, *flexibility)

    def along(points: Array) -> Array:
        """∂N/∂x: a difference that is exact for polynomials up to the fourth degree."""
        h = np.array([0.25, 0.0, 0.0])
        rise = 8.0 * (at(points + h) - at(points - h)) - (at(points + 2.0 * h) - at(points - 2.0 * h))
        return np.asarray(rise / (3.0 * length[:, None, None, None]))

    def across(points: Array, k: int) -> Array:
        """∂N/∂y or ∂N/∂z: the field is linear in both."""
        step = np.eye(3)[k]
        return np.asarray(0.5 * (at(points + step) - at(points - step)))

    axis = places[::4] * [1.0, 0.0, 0.0]
    volume = section.area * length[:, None]
    E, G = material.young, material.young / (2.0 * (1.0 + material.poisson))
    stretch = along(places)[:, :, 0]
    shear_y = along(axis)[:, :, 1] + across(axis, 1)[:, :, 0]
    shear_z = along(axis)[:, :, 2] + across(axis, 2)[:, :, 0]
    step = np.array([0.0, 1.0, 0.0])
    twist = 0.5 * (along(axis + step) - along(axis - step))[:, :, 2]
    laws = [
        (stretch, E * volume * share),
        (shear_y, section.ky * G * volume * 0.5 * w),
        (shear_z, section.kz * G * volume * 0.5 * w),
        (twist, G * section.J / section.area * volume * 0.5 * w),
    ]
    strain = np.concatenate([np.einsum("cqa,can->cqn", s, nodal).reshape(-1, 1, n) for s, _ in laws])
    modulus = np.concatenate([stiffness.reshape(-1, 1, 1) for _, stiffness in laws])
    flat = shapes.reshape(-1, 3, n)
    law = StrainLaw(strain, modulus, flat, masses.ravel(), material.damping)
    return masses.ravel(), points.reshape(-1, 3), flat, law

"""Meshed bodies as mass points: the elements' own quadrature points, displaced by nodal fields."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.mesh import load_mesh, select
from maggi.model.bodies import ElasticBody, GivenMotion
from maggi.model.materials import Damping
from maggi.model.meshes import BeamMesh

from .beams import Beam
from .bodies import Marker, PointBody, equivalent_points, initial_pose
from .elasticity import HookesLaw, Rigid
from .solids import solid_masses, solid_shapes, solid_strains

Array = NDArray[np.float64]


def mesh_body(name: str, body: ElasticBody, folder: str, field: Array | None) -> PointBody:
    """A meshed body in points.

    field : nodal displacements for unit elastic coordinates (nodes, 3, n), of beams with the nodes' rotation vectors
    (nodes, 6, n); None: the body is rigid, and seven points with its mass, centre and inertia stand for it.
    """
    mesh = load_mesh(body.mesh, folder, f"bodies.{name}.mesh")
    beam = None
    if isinstance(body.mesh, BeamMesh):
        assert body.material is not None  # the program itself refuses beams without
        beam = Beam.of(mesh, body.mesh, body.material)
    masses, points = solid_masses(mesh, body.material) if beam is None else beam.masses()
    origin, rotation = initial_pose(body.pose, body.motion)
    n = 0 if field is None else field.shape[2]
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
    damping = Damping() if body.material is None else body.material.damping
    shapes = solid_shapes(mesh, field) if beam is None else beam.shapes(field)
    strains = solid_strains(mesh, body.material, field) if beam is None else beam.strains(field)
    law = HookesLaw(strains, shapes, masses, damping)
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

"""A square steel rod along x, hinged about z at its first end, released from horizontal: one body for several cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.elements.assembly import assemble_solids
from maggi.model.attachments import Attachment, BoxSet, NamedSet
from maggi.model.bodies import CraigBampton, ElasticBody
from maggi.model.joints import End, Joint
from maggi.model.materials import Material
from maggi.model.meshes import BoxMesh
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.system.system import System
from peers.exudyn_fem import Mesh

from .ours import Ours

Array = NDArray[np.float64]
LENGTH, SIDE = 1.0, 0.02  # m
BALLS = {"lower": (-0.01, 0.49), "upper": (0.51, 1.01)}  # parts of the side that each half spans
STEEL = Material(7850.0, 2.1e11, 0.3)


def rod(cells: tuple[int, int, int], cell: str, h: float, reduction: CraigBampton | None = None) -> Model:
    """The rod at rest and free of strain under gravity along −y; its hinge's face is rigid."""
    hinge = Joint("revolute", End("ground"), End("rod", "hinge"), axis=(0.0, 0.0, 1.0))
    face = Attachment(nodes=NamedSet("x_min"), coupling="rigid")
    return _model(
        ElasticBody(BoxMesh((LENGTH, SIDE, SIDE), cells, cell), STEEL, reduction=reduction),
        {"hinge": face},
        {"hinge": hinge},
        h,
    )


def rod_on_two_balls(cells: tuple[int, int, int], cell: str, h: float) -> Model:
    """The same, but the means of the nodes of either half of its end's face are held: a hinge for programs whose
    full-mesh bodies have no rotations.
    """
    halves = {
        name: Attachment(nodes=BoxSet((-1e-6, -1e-6, low * SIDE), (1e-6, SIDE + 1e-6, high * SIDE)), coupling="average")
        for name, (low, high) in BALLS.items()
    }
    joints = {name: Joint("spherical", End("ground"), End("rod", name)) for name in BALLS}
    return _model(ElasticBody(BoxMesh((LENGTH, SIDE, SIDE), cells, cell), STEEL), halves, joints, h)


def _model(body: ElasticBody, attachments: dict[str, Attachment], joints: dict[str, Joint], h: float) -> Model:
    return Model(
        bodies={"rod": replace(body, attachments=attachments)},
        joints=joints,
        gravity=(0.0, -9.81, 0.0),
        simulation=Simulation(2.0, h, start="undeformed"),
    )


def tip_node(nodes: Array) -> int:
    """The node in the middle of the far face."""
    return int(np.argmin(np.linalg.norm(nodes - [LENGTH, 0.5 * SIDE, 0.5 * SIDE], axis=1)))


def tip_of(ours: Ours) -> Array:
    """Where that node is now (3,), global."""
    stepper = ours.stepper
    system, now = stepper.system, stepper.state.now
    body = system.body("rod").index
    if body in system.reduced:
        first, last = system.bodies.offset[body] + 6, system.bodies.offset[body + 1]
        reduced = system.reduced[body]
        nodes, displaced = reduced.body.mesh.nodes, reduced.nodal_displacement(now.e[first:last])
    else:
        mesh = stepper.meshes[0]
        nodes, displaced = mesh.body.mesh.nodes, mesh.body.nodal_displacement(mesh.u)
    node = tip_node(nodes)
    return np.asarray(now.origin[body] + now.rotation[body] @ (nodes[node] + displaced[node]))


def exported(system: System) -> tuple[Mesh, Array]:
    """The rod for another program, on all its nodes (3n freedoms), and its shapes (3n, m); none of a full mesh."""
    index = system.body("rod").index
    body = system.mesh(index)
    assert body is not None
    mesh = body.mesh
    matrices = assemble_solids(mesh.nodes, mesh.cells, STEEL)
    mass = sp.kron(matrices.mass, sp.identity(3)).tocsr()
    held = tuple(coupling.nodes for coupling in body.couplings)
    shapes = np.empty((3 * mesh.n_nodes, 0))
    if index in system.reduced:
        shapes = system.reduced[index].nodal_basis().reshape(3 * mesh.n_nodes, -1)
    return Mesh(mesh.nodes, mass, matrices.stiffness.tocsr(), held, tip_node(mesh.nodes)), shapes

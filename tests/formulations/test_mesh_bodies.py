"""Meshed bodies in points against the program's matrices: every element, beams, reduced bodies, prescribed frames."""

import numpy as np
import pytest
from random_states import state_in_motion

from maggi.analyses.compare_formulations import MODES, compare_at, compare_formulations
from maggi.bodies.mesh_body import build_mesh_body
from maggi.formulations.mesh_bodies import mesh_body
from maggi.model import (
    Attachment,
    BeamMesh,
    BoxMesh,
    Damping,
    ElasticBody,
    End,
    GivenMotion,
    Joint,
    Material,
    Model,
    NamedSet,
    PointLoad,
    PointMass,
    Pose,
    RigidBody,
    RigidRunMotion,
    Section,
    expression,
)
from maggi.model.bodies import CraigBampton
from maggi.system.build import build_system

T = 0.1
MATERIAL = Material(200.0, 1e6, 0.3, Damping(1.5, 2e-3))
CELLS = ("tet4", "tet10", "hex8", "hex20", "wedge6")
BEAM = BeamMesh(0.6, Section(2e-3, 3e-6, 5e-7, 1e-6, 0.8, 0.7), 3)


def mesh_of(cell):
    if cell == "beam":
        return BEAM
    if cell == "thin beam":
        return BeamMesh(0.6, Section(2e-3, 3e-6, 5e-7, 1e-6), 3)
    return BoxMesh((0.6, 0.3, 0.2), (2, 1, 1) if cell in ("hex8", "wedge6") else (1, 1, 1), cell)


def body_of(cell, **keys):
    sets = ("start", "end") if "beam" in cell else ("x_min", "x_max")
    couplings = ("rigid", "rigid") if "beam" in cell else ("rigid", "average")
    attachments = {
        name: Attachment(nodes=NamedSet(node_set), coupling=coupling)
        for name, node_set, coupling in zip(("p", "q"), sets, couplings, strict=True)
    }
    attachments["q"] = Attachment(
        nodes=attachments["q"].nodes,
        coupling=attachments["q"].coupling,
        point_masses=(PointMass(0.3, (0.1, 0.0, 0.05)),),
    )
    return ElasticBody(mesh_of(cell), MATERIAL, Pose((0.2, -0.1, 0.3)), attachments=attachments, **keys)


def mechanism(body):
    """The elastic body on a universal joint, a rigid one hinged to its other end, a load on it."""
    bodies = {
        "arm": body,
        "end": RigidBody(0.7, (0.1, 0.2, 0.0), ((0.02, 0.0, 0.0), (0.0, 0.03, 0.0), (0.0, 0.0, 0.04))),
    }
    joints = {
        "first": Joint("universal", End("ground"), End("arm", "p"), axes=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))),
        "second": Joint("revolute", End("arm", "q"), End("end"), axis=(0.0, 1.0, 0.3)),
    }
    force = tuple(expression(text) for text in ("2*cos(3*t)", "1", "-1.5"))
    return Model(
        bodies, joints, {"load": PointLoad(End("arm", "q"), "force", force, "body")}, gravity=(1.0, 2.0, -9.81)
    )


def compared(model, **keys):
    system = build_system(model, dense=True, **keys)
    motion = state_in_motion(system, np.random.default_rng(3), T)
    assert motion is not None
    found = compare_at(system, motion, T)
    assert found.agree, found
    return found


@pytest.mark.parametrize("cell", [*CELLS, "beam", "thin beam"])
def test_complete_bodies(cell):
    found = compared(mechanism(body_of(cell)))
    assert found.velocities >= 30


@pytest.mark.parametrize("cell", ["hex8", "beam"])
def test_reduced_bodies(cell):
    found = compared(mechanism(body_of(cell, reduction=CraigBampton(3))))
    assert (
        found.velocities == 6 + (6 + 3) + 6 + 6
    )  # arm, static shapes without rigid motions and modes, end, point mass


@pytest.mark.parametrize("cell", ["hex8", "beam"])
def test_prescribed_frames(cell):
    motion = GivenMotion(
        (expression("0.2 + t**2"), expression("-0.1 + 0.3*sin(t)"), expression("0.3")),
        (0.0, 1.0, 1.0),
        expression("2*t + t**3"),
        held=("p",),
    )
    model = mechanism(body_of(cell, motion=motion))
    del model.joints["first"]
    compared(model)


@pytest.mark.parametrize("cell", [*CELLS, "beam"])
def test_rigid_bodies_of_meshes(cell):
    """Seven points have the mass, centre and inertia that the program integrates from its matrices."""
    body = body_of(cell)
    points = mesh_body("arm", body, ".", None)
    inertia = build_mesh_body("arm", body, ".").inertia
    X, m = points.points, points.masses
    assert m.sum() == pytest.approx(inertia.mass, rel=1e-12)
    np.testing.assert_allclose(m @ X, inertia.S0, atol=1e-12 * inertia.mass)
    second = np.einsum("p,pi,pj->ij", m, X, X)
    np.testing.assert_allclose(np.trace(second) * np.eye(3) - second, inertia.J0, atol=1e-12 * inertia.mass)


def fine_mechanism():
    body = body_of("hex8")
    fine = ElasticBody(BoxMesh((0.6, 0.3, 0.2), (8, 4, 4)), MATERIAL, body.pose, attachments=body.attachments)
    return mechanism(fine), 3 * (9 * 5 * 5 - 25) + 6


def test_large_meshes_are_taken_in_a_few_shapes_and_told():
    model, freedoms = fine_mechanism()
    found = compare_formulations(model)
    assert found.agree
    assert found.velocities == 6 + 6 + MODES + 6 + 6
    assert found.notes == (
        f"arm is taken with {MODES} modes and the shapes of its attachments: its mesh has {freedoms:,} freedoms",
    )


def test_larger_ones_as_rigid(monkeypatch):
    monkeypatch.setattr("maggi.analyses.compare_formulations.REDUCED", 605)
    model, freedoms = fine_mechanism()
    found = compare_formulations(model)
    assert found.agree
    assert found.velocities == 18
    assert found.notes == (f"arm is taken as rigid: its mesh has {freedoms:,} freedoms",)


def test_a_frame_that_follows_a_rigid_run():
    body = body_of("hex8", motion=RigidRunMotion(held=("p",)))
    found = compare_formulations(mechanism(body))
    assert found.agree and not found.notes
    assert found.velocities == 30 + 6 + 6  # eight free nodes and a rigid end, the point mass, the rigid body

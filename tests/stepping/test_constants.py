"""The constants of a step, Ŝ⁻¹ seen from the small system (T12), against dense matrices; steps on SE(3)."""

from dataclasses import replace

import numpy as np
import pytest
from motions import Motion, mesh_body, rigid_body, ritz_body
from scipy.linalg import expm

from maggi.bodies.attachment_kernels import move
from maggi.bodies.mesh_body import MeshBody, build_mesh_body
from maggi.bodies.small_bodies import body_mass
from maggi.integrators.generalized_alpha import generalized_alpha
from maggi.linalg.factor import FEW, RslabFactor
from maggi.linalg.lanes import WIDTH
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody, GivenMotion, RigidBody
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BeamMesh, BoxMesh, Section
from maggi.model.model import Model
from maggi.stepping.allocate import copy_motion, elastic_compliances
from maggi.stepping.block_kernels import compliances
from maggi.stepping.mesh_step import MeshStep
from maggi.system.build import build_system

STEP = generalized_alpha(1e-3, 0.7)
ENDS = {"a": Attachment(nodes=NamedSet("x_min")), "b": Attachment(nodes=NamedSet("x_max"), coupling="average")}
TIPS = {"a": Attachment(nodes=NamedSet("start")), "b": Attachment(nodes=NamedSet("end"))}


def test_compliances_of_ritz_bodies():
    """W = (σM + γhD + βh²K)⁻¹ about the present shape; of frames that are prescribed the coordinates' part."""
    rng = np.random.default_rng(1)
    bodies = {"z": ritz_body(rng, 3), "given": replace(ritz_body(rng, 4), motion=GivenMotion())}
    system = build_system(Model(bodies))
    table = system.bodies
    state = Motion(system, 2).at_rest(0.0)
    W, elastic = np.zeros(table.block[-1]), np.zeros(table.m.size)
    elastic_compliances(table, STEP, elastic)
    compliances(table, state, STEP, system.inertia_floor, elastic, W)
    for b, body in enumerate(bodies.values(), 1):
        o, e = table.offset[b], table.offset[b + 1]
        block = W[table.block[b] : table.block[b + 1]].reshape(e - o, e - o)
        matrix = body_mass(table, b, state.e[o + 6 : e])
        matrix[3:6, 3:6] += system.inertia_floor[b] * np.eye(3)
        matrix *= STEP.sigma
        matrix[6:, 6:] += STEP.gamma * STEP.h * body.terms.D + STEP.beta * STEP.h**2 * body.terms.k
        expected = np.linalg.inv(matrix)
        if b == 2:
            expected = np.zeros_like(matrix)
            expected[6:, 6:] = np.linalg.inv(matrix[6:, 6:])
        np.testing.assert_allclose(block, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def columns(constants, size):
    """Y and Z (nd, 6k) from fours of the freedoms, and nothing behind the last."""
    responses = constants.responses.transpose(0, 2, 1, 3).reshape(-1, 2, 6, WIDTH * constants.responses.shape[1])
    assert 0 <= responses.shape[3] - size < WIDTH
    assert not responses[..., size:].any()
    return (responses[:, which, :, :size].reshape(-1, size).T for which in (0, 1))


@pytest.mark.parametrize("floating", [True, False], ids=["floating", "prescribed"])
@pytest.mark.parametrize("mesh", ["solid", "beam"])
def test_condensation_of_a_meshed_body(mesh, floating):
    """Y = PŜ⁻¹PᵀB, Z = Ŝ⁻¹KY, Z_D = Ŝ⁻¹DY with D = a PᵀMP + bK; W, W_Z, W_D are what attachments see of them."""
    material = Material(1000.0, 1e7, 0.3, Damping(mass=3.0, stiffness=2e-4))
    source = BoxMesh((1.0, 0.2, 0.3), (3, 1, 1)) if mesh == "solid" else BeamMesh(1.0, Section.rectangle(0.1, 0.2), 4)
    description = ElasticBody(
        source, material, attachments=ENDS if mesh == "solid" else TIPS, motion=None if floating else GivenMotion()
    )
    body = build_mesh_body("m", description, ".")
    system = build_system(Model({"m": description}), meshes={"m": body})
    step = MeshStep(body, 1, system.bodies, 0)
    W, W_Z, W_D = np.zeros((3, system.bodies.block[-1]))
    assert step.prepare(STEP, W, W_Z, W_D)
    assert not step.prepare(STEP, W, W_Z, W_D)  # kept
    M, K, B = body.inertia.matrix.toarray(), body.K.matrix().toarray(), body.B.toarray()
    projector = np.eye(body.size)
    if floating:
        projector -= body.Phi @ np.linalg.solve(body.C.T @ body.Phi, body.C.T)
    D = material.damping.mass * projector.T @ M @ projector + material.damping.stiffness * K
    S = STEP.sigma * M + STEP.gamma * STEP.h * D + STEP.beta * STEP.h**2 * K
    Y = projector @ np.linalg.solve(S, projector.T @ B)
    Z, Z_D = np.linalg.solve(S, K @ Y), np.linalg.solve(S, D @ Y)
    width = 6 + B.shape[1]
    y, z = step.constants.damping
    of_Y, of_Z = columns(step.constants, body.size)
    for flat, response, name, found in ((W, Y, "Y", of_Y), (W_Z, Z, "Z", of_Z), (W_D, Z_D, "Z_D", y * of_Y + z * of_Z)):
        np.testing.assert_allclose(found, response, rtol=0, atol=1e-10 * np.abs(response).max(), err_msg=name)
        block = flat[system.bodies.block[1] : system.bodies.block[2]].reshape(width, width)
        expected = B.T @ response
        np.testing.assert_allclose(block[6:, 6:], expected, rtol=0, atol=1e-10 * np.abs(expected).max(), err_msg=name)
        assert not block[:6].any() and not block[:, :6].any()
    if floating:
        np.testing.assert_allclose(body.C.T @ of_Y, 0.0, atol=1e-10)


def test_frame_compliance_is_that_of_the_deformed_body():
    body = build_mesh_body("m", mesh_body(np.random.default_rng(3)), ".")
    system = build_system(Model({"m": mesh_body(np.random.default_rng(3))}), meshes={"m": body})
    step = MeshStep(body, 1, system.bodies, 0)
    step.u_next[:] = 1e-4 * np.random.default_rng(4).normal(size=body.size)
    W, base = np.zeros(system.bodies.block[-1]), np.zeros(system.coordinates)
    step.residual(STEP, Motion(system, 5).at_rest(0.0), np.zeros(3), base, W)
    # J₆(c) = Φ(c)ᵀMΦ(c) by the inertia forces of unit accelerations
    inertia, columns, rest = body.inertia, [], np.zeros(body.size)
    for a in np.eye(6):
        nodal, frame = np.empty(body.size), np.empty(6)
        inertia.forces(step.u_next, rest, rest, nodal).residual(np.array([a[:3], np.zeros(3), a[3:]]), frame)
        columns.append(frame)
    block = W.reshape(18, 18)
    # second moments of u itself are lumped: some (1e-4/0.1)²; without u the difference would be 1e-3
    np.testing.assert_allclose(block[:6, :6] @ (STEP.sigma * np.array(columns).T), np.eye(6), atol=1e-5)
    np.testing.assert_array_equal(block, block.T)
    assert not block[6:].any()


def test_frames_move_by_the_exponential_of_se3():
    """q₁ = q₀ ∘ exp(Δq) against the matrix exponential of the 4×4 twist; elastic coordinates add; ground stays."""
    rng = np.random.default_rng(5)
    bodies = {"a": rigid_body(rng), "z": ritz_body(rng, 2), "given": RigidBody(1.0, motion=GivenMotion())}
    system = build_system(Model(bodies))
    state = Motion(system, 6).at_rest(0.0)
    out = copy_motion(state)
    increment = rng.normal(size=system.coordinates)
    move(system.bodies, state, increment, out)
    for b in (1, 2):
        o = system.bodies.offset[b]
        (q, theta), pose, twist = np.split(increment[o : o + 6], 2), np.eye(4), np.zeros((4, 4))
        pose[:3, :3], pose[:3, 3] = state.rotation[b], state.origin[b]
        twist[:3, :3], twist[:3, 3] = np.cross(theta, np.eye(3)).T, q
        expected = pose @ expm(twist)
        np.testing.assert_allclose(out.rotation[b], expected[:3, :3], atol=1e-13)
        np.testing.assert_allclose(out.origin[b], expected[:3, 3], atol=1e-13)
    o = system.bodies.offset[2]
    np.testing.assert_allclose(out.e[o + 6 : o + 8], state.e[o + 6 : o + 8] + increment[o + 6 : o + 8], atol=1e-15)
    for b in (0, 3):
        np.testing.assert_array_equal(out.origin[b], state.origin[b])
        np.testing.assert_array_equal(out.rotation[b], state.rotation[b])


def test_what_takes_memory_beside_a_factor_is_kept_small(monkeypatch):
    """Matrices are set aside and freed memory given back before one is made; few responses are solved for at once."""
    told, solve_many = [], RslabFactor.solve_many

    def solved(factor, B):
        told.append(B.shape[1])
        return solve_many(factor, B)

    monkeypatch.setattr(RslabFactor, "solve_many", solved)
    for where in ("linalg.factor", "linalg.shifted", "stepping.condensation"):
        monkeypatch.setattr(f"maggi.{where}.give_back", lambda: told.append("given back"))
    monkeypatch.setattr(MeshBody, "set_aside", lambda body: told.append("set aside"))
    description = ElasticBody(BoxMesh((1.0, 0.2, 0.3), (3, 1, 1)), Material(1000.0, 1e7, 0.3), attachments=ENDS)
    body = build_mesh_body("m", description, ".")
    system = build_system(Model({"m": description}), meshes={"m": body})
    assert MeshStep(body, 1, system.bodies, 0).prepare(STEP, *np.zeros((3, system.bodies.block[-1])))
    made = ["set aside", "given back", "given back"]
    assert told == made + 2 * len(ENDS) * [FEW, "set aside", FEW] + ["given back"]

"""Ties of meshed bodies: rigid sets as freedoms, averaged sets as weights, rigid motions exactly."""

import numpy as np
import pytest
import scipy.sparse as sp

from maggi.bodies.couplings import Coupling, averaging_weights, make_coupling, refuse_overlap
from maggi.bodies.freedoms import Freedoms
from maggi.bodies.mesh_body import build_mesh_body
from maggi.mesh.parametric import box
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody
from maggi.model.errors import ModelError
from maggi.model.materials import Material
from maggi.model.meshes import BeamMesh, BoxMesh, Section

MATERIAL = Material(density=1000.0, young=1e9, poisson=0.3)


def ties(count):
    """A box's freedoms with `count` rigid faces; the last is given first, so that the order of sets is not that of nodes."""
    mesh = box((2.0, 1.0, 1.0), (3, 2, 1))
    faces = [mesh.node_sets[name] for name in ("x_max", "x_min")[:count]]
    return mesh.nodes, Freedoms.of(mesh.nodes, [(face, mesh.nodes[face].mean(axis=0) + 0.1) for face in faces])


@pytest.mark.parametrize("count", [0, 1, 2])
def test_reduce_is_the_transpose_of_expand(count):
    nodes, freedoms = ties(count)
    rng = np.random.default_rng(count)
    x, force = rng.normal(size=freedoms.size), rng.normal(size=nodes.shape)
    field = freedoms.expand(x, np.full(nodes.shape, np.nan))
    reduced = np.full(freedoms.size, np.nan)
    freedoms.reduce(force, reduced)
    assert np.sum(field * force) == pytest.approx(x @ reduced, rel=1e-13)
    np.testing.assert_allclose(freedoms.matrix() @ x, field.ravel(), atol=1e-14)
    np.testing.assert_allclose(freedoms.matrix().T @ force.ravel(), reduced, atol=1e-14)


@pytest.mark.parametrize("count", [0, 2])
def test_reduced_matrix(count):
    nodes, freedoms = ties(count)
    X = np.random.default_rng(3).normal(size=(3 * len(nodes),) * 2)
    full = X + X.T
    T = freedoms.matrix().toarray()
    reduced = freedoms.reduce_matrix(sp.bsr_matrix(full, blocksize=(3, 3)))
    assert reduced.blocksize == (3, 3)
    np.testing.assert_array_equal(reduced.toarray(), reduced.toarray().T)
    np.testing.assert_allclose(reduced.toarray(), T.T @ full @ T, atol=1e-12)


def rigid_field(points, origin, d, theta):
    return d + np.cross(theta, points - origin)


@pytest.mark.parametrize("seed", range(2))
def test_a_tied_set_moves_rigidly_about_its_point(seed):
    mesh = box((2.0, 1.0, 1.0), (3, 2, 1))
    face, point = mesh.node_sets["y_max"], np.array([0.3, 2.0, -1.0])
    freedoms = Freedoms.of(mesh.nodes, [(face, point)])
    x = np.random.default_rng(seed).normal(size=freedoms.size)
    field = freedoms.expand(x, np.empty(mesh.nodes.shape))
    d, theta = x[-6:-3], x[-3:]
    np.testing.assert_allclose(field[face], rigid_field(mesh.nodes[face], point, d, theta), atol=1e-14)


def test_averaging_reproduces_rigid_motions_and_is_least_squares():
    rng = np.random.default_rng(4)
    nodes = rng.normal(size=(9, 3))
    coupling = make_coupling("a", nodes, np.array([1, 3, 4, 6, 8]), False, "")
    weights, d, theta = averaging_weights(nodes, coupling), *rng.normal(size=(2, 3))
    members = nodes[coupling.nodes]
    rigid = rigid_field(members, members.mean(axis=0), d, theta)
    np.testing.assert_allclose(weights @ rigid.ravel(), [*d, *theta], atol=1e-13)
    # what is left of any field has no resultant and no moment about the point
    field = rng.normal(size=members.shape)
    left = field - rigid_field(members, coupling.point, *np.split(weights @ field.ravel(), 2))
    np.testing.assert_allclose(left.sum(axis=0), 0.0, atol=1e-13)
    np.testing.assert_allclose(np.cross(members - coupling.point, left).sum(axis=0), 0.0, atol=1e-13)


def solid_body(first="rigid", last="average"):
    body = ElasticBody(
        BoxMesh((2.0, 1.0, 1.0), (3, 2, 1), "hex8"),
        MATERIAL,
        attachments={
            "a": Attachment(nodes=NamedSet("x_min"), coupling=first),
            "b": Attachment(nodes=NamedSet("x_max"), coupling=last),
        },
    )
    return build_mesh_body("arm", body, ".")


def beam_body():
    attachments = {"a": Attachment(nodes=NamedSet("start")), "b": Attachment(nodes=NamedSet("end"))}
    return build_mesh_body(
        "arm", ElasticBody(BeamMesh(2.0, Section.circle(0.1), 3), MATERIAL, attachments=attachments), "."
    )


BODIES = {
    "rigid, average": lambda: solid_body(),
    "average, rigid": lambda: solid_body("average", "rigid"),
    "rigid, rigid": lambda: solid_body("rigid", "rigid"),
    "average, average": lambda: solid_body("average", "average"),
    "beam": beam_body,
}


@pytest.mark.parametrize("build", BODIES.values(), ids=BODIES)
def test_rigid_motions_of_a_meshed_body(build):
    """Φ moves nodes and attachments rigidly, strains nothing, and carries the body's inertia."""
    body = build()
    for motion in np.random.default_rng(5).normal(size=(3, 6)):
        d, theta = motion[:3], motion[3:]
        u = body.Phi @ motion
        np.testing.assert_allclose(body.nodal_displacement(u), rigid_field(body.mesh.nodes, 0.0, d, theta), atol=1e-13)
        for k, coupling in enumerate(body.couplings):
            expected = [*rigid_field(coupling.point, 0.0, d, theta), *theta]
            np.testing.assert_allclose((body.B.T @ u)[6 * k : 6 * k + 6], expected, atol=1e-12)
        assert np.abs(body.K.matrix() @ u).max() < 1e-12 * np.abs(body.K.matrix()).max()
    S = body.inertia.S0
    np.testing.assert_allclose(np.diag(body.J6)[:3], body.inertia.mass, rtol=1e-12)
    np.testing.assert_allclose(body.J6[3:, 3:], body.inertia.J0, rtol=1e-9, atol=1e-9 * body.inertia.J0.max())
    np.testing.assert_allclose([body.J6[5, 1], body.J6[3, 2], body.J6[4, 0]], S, atol=1e-10 * np.abs(S).max())
    np.testing.assert_allclose(body.C, body.inertia.matrix @ body.Phi, rtol=1e-14)


def test_mass_and_inertia_of_the_box():
    """m = ρV, and J about the corner by hand: m (b² + c²)/3 and m a b/4."""
    body = solid_body()
    a, b, c = 2.0, 1.0, 1.0
    m = 1000.0 * a * b * c
    assert body.inertia.mass == pytest.approx(m, rel=1e-13)
    J = m * np.array(
        [
            [(b * b + c * c) / 3.0, -a * b / 4.0, -a * c / 4.0],
            [-a * b / 4.0, (a * a + c * c) / 3.0, -b * c / 4.0],
            [-a * c / 4.0, -b * c / 4.0, (a * a + b * b) / 3.0],
        ]
    )
    np.testing.assert_allclose(body.inertia.J0, J, rtol=1e-12)


@pytest.mark.parametrize("members", [[0, 1], [0, 1, 2], [3]])
def test_sets_that_carry_no_rotation_are_refused(members):
    nodes = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.5, 2.5, 0.0], [0.0, 1.0, 0.0]])
    with pytest.raises(ModelError, match=f"{len(members)} nodes lie on one line or are too few") as error:
        make_coupling("a", nodes, np.array(members), True, "bodies.arm.attachments.a")
    assert error.value.path == "bodies.arm.attachments.a"
    assert "three nodes" in error.value.remedy


def test_overlapping_rigid_sets_are_refused():
    def coupling(name, nodes, rigid):
        return Coupling(name, np.array(nodes), np.zeros(3), rigid)

    refuse_overlap(
        [coupling("a", [1, 2, 3], True), coupling("b", [3, 4], False), coupling("c", [5], True)], "bodies.arm"
    )
    with pytest.raises(ModelError, match="'a' and 'c' share nodes and are both rigid") as error:
        refuse_overlap([coupling("a", [1, 2, 3], True), coupling("c", [5, 3], True)], "bodies.arm")
    assert error.value.path == "bodies.arm.attachments.c"
    assert "average" in error.value.remedy

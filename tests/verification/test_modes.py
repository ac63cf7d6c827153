"""Modes of elastic bodies with clamped attachments and offset masses (NAFEMS FV4), and of both couplings."""

import numpy as np
import pytest
from scipy.linalg import eigh

from maggi.analyses.modal import body_modes, mesh_modes
from maggi.bodies.mesh_body import build_mesh_body
from maggi.model import (
    Attachment,
    BeamMesh,
    BoxMesh,
    ElasticBody,
    Material,
    Model,
    ModelError,
    NamedSet,
    PointMass,
    RigidBody,
    Section,
)

NAFEMS = Material(density=8000.0, young=200e9, poisson=0.3)


def fv4(elements, factor):
    """NAFEMS FV4: cantilever of 10 m, solid circle of 0.5 m; 10 t and 1 t on rigid arms of 2 m to either side of its tip."""
    circle = Section.circle(0.5)
    section = Section(circle.area, circle.Iy, circle.Iz, circle.J, factor, factor)
    masses = (PointMass(10_000.0, (0.0, 2.0, 0.0)), PointMass(1_000.0, (0.0, -2.0, 0.0)))
    attachments = {
        "root": Attachment(nodes=NamedSet("start")),
        "tip": Attachment(nodes=NamedSet("end"), point_masses=masses),
    }
    return Model({"beam": ElasticBody(BeamMesh(10.0, section, elements), NAFEMS, attachments=attachments)})


def independent_fv4(elements, rotary):
    """FV4 by Hermite cubics written out here (SI); rotary: whether sections resist turning with ρI."""
    E, G, rho, length = NAFEMS.young, NAFEMS.young / 2.6, NAFEMS.density, 10.0
    area, inertia = np.pi * 0.5**2 / 4, np.pi * 0.5**4 / 64
    h = length / elements
    bend = np.array([[12, 6 * h, -12, 6 * h], [0, 4 * h**2, -6 * h, 2 * h**2], [0, 0, 12, -6 * h], [0, 0, 0, 4 * h**2]])
    mass = np.array(
        [[156, 22 * h, 54, -13 * h], [0, 4 * h**2, 13 * h, -3 * h**2], [0, 0, 156, -22 * h], [0, 0, 0, 4 * h**2]]
    )
    turn = np.array([[36, 3 * h, -36, 3 * h], [0, 4 * h**2, -3 * h, -(h**2)], [0, 0, 36, -3 * h], [0, 0, 0, 4 * h**2]])
    bend, mass, turn = (np.triu(m) + np.triu(m, 1).T for m in (bend, mass, turn))
    mass = rho * area * h / 420 * mass + (rho * inertia / (30 * h) * turn if rotary else 0.0)
    ends = np.array([[1.0, -1.0], [-1.0, 1.0]])
    shares = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    # freedoms of a node: u, v, w, rotations about x, y, z; in the x-z plane the slope is −(rotation about y)
    sign = np.diag([1.0, -1.0, 1.0, -1.0])
    parts = [
        ([0, 6], E * area / h * ends, rho * area * h * shares),
        ([3, 9], 2 * G * inertia / h * ends, 2 * rho * inertia * h * shares),
        ([1, 5, 7, 11], E * inertia / h**3 * bend, mass),
        ([2, 4, 8, 10], E * inertia / h**3 * sign @ bend @ sign, sign @ mass @ sign),
    ]
    K, M = np.zeros((2, 6 * elements + 6, 6 * elements + 6))
    for e in range(elements):
        for places, k, m in parts:
            at = np.ix_(np.array(places) + 6 * e, np.array(places) + 6 * e)
            K[at] += k
            M[at] += m
    for load, y in ((10_000.0, 2.0), (1_000.0, -2.0)):
        arm = np.hstack([np.eye(3), [[0.0, 0.0, -y], [0.0, 0.0, 0.0], [y, 0.0, 0.0]]])  # d + θ × (0, y, 0)
        M[-6:, -6:] += load * arm.T @ arm
    return np.sqrt(eigh(K[6:, 6:], M[6:, 6:], eigvals_only=True)[:6]) / (2 * np.pi)


@pytest.mark.parametrize(
    ("elements", "without_rotary_inertia"),
    [
        (5, [1.72328, 1.72684, 7.41354, 9.97513, 18.1867, 27.0008]),
        (20, [1.72328, 1.72684, 7.41339, 9.97477, 18.1816, 26.9855]),
    ],
)
def test_fv4_cantilever_with_off_centre_masses(elements, without_rotary_inertia):
    """Against elements written out independently, which without rotary inertia give the column of CASES C12."""
    np.testing.assert_allclose(independent_fv4(elements, rotary=False), without_rotary_inertia, rtol=5e-6)
    modes = body_modes(fv4(elements, 0.0), "beam", 6, ["root"])
    np.testing.assert_allclose(modes.frequencies, independent_fv4(elements, rotary=True), rtol=1e-8)


def test_fv4_has_the_published_frequencies():
    """NAFEMS R0015, all printed digits: Euler–Bernoulli with rotary inertia. Shear (k = 0.9) lowers the last by 1 %."""
    modes = body_modes(fv4(20, 0.0), "beam", 6, ["root"])
    np.testing.assert_allclose(modes.frequencies, [1.723, 1.727, 7.413, 9.972, 18.155, 26.957], atol=5.5e-4)
    modes = body_modes(fv4(20, 0.9), "beam", 6, ["root"])
    # an independent program's Timoshenko elements (CASES C12)
    np.testing.assert_allclose(modes.frequencies, [1.7220, 1.7255, 7.4098, 9.947, 18.044, 26.690], rtol=1e-4)


def test_inertia_of_a_point_mass_counts():
    """A massless-like shaft with a disc: torsional frequency √(GJ/(L I))/2π, corrected by a third of the shaft's inertia."""
    length, disc = 1.0, 40.0
    section = Section.circle(0.02)
    tip = Attachment(
        nodes=NamedSet("end"),
        point_masses=(PointMass(1e-3, inertia=((disc, 0.0, 0.0), (0.0, 1e-6, 0.0), (0.0, 0.0, 1e-6))),),
    )
    root = Attachment(nodes=NamedSet("start"))
    body = ElasticBody(BeamMesh(length, section, 4), NAFEMS, attachments={"root": root, "tip": tip})
    modes = body_modes(Model({"shaft": body}), "shaft", 1, ["root"])
    shear = NAFEMS.young / 2.6
    own = NAFEMS.density * section.J * length
    expected = np.sqrt(shear * section.J / (length * (disc + own / 3.0))) / (2 * np.pi)
    assert own / disc < 1e-5  # so that the next term, (own/disc)², is below round-off
    np.testing.assert_allclose(modes.frequencies, [expected], rtol=1e-9)


@pytest.fixture(scope="module", params=["rigid", "average"])
def block(request):
    """A hex20 cantilever, ν = 0: neither clamp can hinder a contraction."""
    sets = {"root": NamedSet("x_min"), "tip": NamedSet("x_max")}
    attachments = {key: Attachment(nodes=chosen, coupling=request.param) for key, chosen in sets.items()}
    body = ElasticBody(
        BoxMesh((0.6, 0.03, 0.05), (12, 1, 2), "hex20"), Material(8000.0, 200e9, 0.0), attachments=attachments
    )
    return build_mesh_body("block", body, ".")


def test_free_body_has_six_rigid_modes_and_m_orthonormal_shapes(block):
    modes = mesh_modes(block, 10)
    assert (modes.frequencies[:6] < 1e-3 * modes.frequencies[6]).all()
    assert modes.frequencies[6] > 100.0
    M = block.inertia.matrix
    np.testing.assert_allclose(modes.shapes.T @ (M @ modes.shapes), np.eye(10), atol=1e-8)
    # elastic modes are orthogonal to rigid motions: they satisfy the mean-axes conditions by themselves
    elastic = modes.shapes[:, 6:]
    assert np.abs(block.C.T @ elastic).max() < 1e-6 * np.abs(block.C).sum(axis=0).max() * np.abs(elastic).max()


def test_clamped_modes_obey_the_clamp_and_the_equations(block):
    modes = mesh_modes(block, 4, ["root"])
    held = block.B.tocsc()[:, :6]
    tip = block.B.tocsc()[:, 6:]
    assert np.abs(held.T @ modes.shapes).max() < 1e-10 * np.abs(tip.T @ modes.shapes).max()
    # K x − λ M x is a force of the clamp alone
    for k in range(4):
        x = modes.shapes[:, k]
        defect = block.K.matrix() @ x - (2 * np.pi * modes.frequencies[k]) ** 2 * (block.inertia.matrix @ x)
        clamp = held.toarray()
        outside = defect - clamp @ np.linalg.lstsq(clamp, defect, rcond=None)[0]
        assert np.linalg.norm(outside) < 1e-7 * np.linalg.norm(block.K.matrix() @ x)


def test_couplings_differ_by_an_end_effect():
    """RBE3 lets the clamped section warp, RBE2 does not: a difference over a length of the section's size.

    The first frequency goes as (length + end)⁻², so that the relative difference halves when the length is doubled.
    """
    differences = []
    for length, cells in ((0.6, 12), (1.2, 24)):
        found = []
        for coupling in ("rigid", "average"):
            root = Attachment(nodes=NamedSet("x_min"), coupling=coupling)
            mesh = BoxMesh((length, 0.03, 0.05), (cells, 1, 2), "hex20")
            body = ElasticBody(mesh, Material(8000.0, 200e9, 0.0), attachments={"root": root})
            found.append(body_modes(Model({"block": body}), "block", 2, ["root"]).frequencies)
        differences.append(found[0] / found[1] - 1.0)
    assert (np.array(differences) > 0.0).all()
    np.testing.assert_allclose(differences[0] / differences[1], 2.0, rtol=0.05)


def test_mistakes_are_named():
    model = fv4(2, 0.0)
    with pytest.raises(ModelError, match="no elastic body 'mast'"):
        body_modes(model, "mast", 1)
    with pytest.raises(ModelError, match="no attachment 'top' to clamp"):
        body_modes(model, "beam", 1, ["top"])
    with pytest.raises(ModelError, match="12 modes are asked for; the body has 12 freedoms"):
        body_modes(model, "beam", 12, ["root"])
    with pytest.raises(ModelError, match="not an elastic body"):
        body_modes(Model({"lump": RigidBody(1.0)}), "lump", 1)

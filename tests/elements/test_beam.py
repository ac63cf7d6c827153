"""The beam element: its 3-D field integrated by brute force, exact stiffness, orientation, assembly."""

import numpy as np
import pytest
import scipy.sparse as sp

from maggi.elements.beam import assemble_beam, beam_axes, beam_inertia, beam_shapes, beam_stiffness, shear_flexibilities
from maggi.elements.moving_frame import FrameMotion, InertiaConstants, frame_resultants, maggi_vector
from maggi.model.errors import MeshError, ModelError
from maggi.model.materials import Material
from maggi.model.meshes import Section

STEEL = Material(density=7850.0, young=2.1e11, poisson=0.3)
WIDTH, HEIGHT = 0.06, 0.11
SHEAR = Section.rectangle(WIDTH, HEIGHT)
BERNOULLI = Section(SHEAR.area, SHEAR.Iy, SHEAR.Iz, SHEAR.J)
SECTIONS = pytest.mark.parametrize("section", [SHEAR, BERNOULLI], ids=["timoshenko", "bernoulli"])
LENGTH = np.array([0.4, 0.15])


def solid_quadrature(length, section, order=8):
    """Gauss points of the solid rectangle (ξ, y, z) and ρ dV, with more points than any integrand needs."""
    x, w = np.polynomial.legendre.leggauss(order)
    xi, y, z = (a.ravel() for a in np.meshgrid((x + 1) / 2, x * WIDTH / 2, x * HEIGHT / 2, indexing="ij"))
    weights = np.einsum("i,j,k->ijk", w, w, w).ravel() / 8 * STEEL.density * section.area * length
    return np.column_stack([xi, y, z]), weights


def skew(k):
    return np.cross(np.eye(3)[k], np.eye(3)).T


@SECTIONS
def test_constants_against_quadrature_over_the_solid(section):
    """Every constant of T3 and T5a, each from its own formula, over the points of the 3-D body."""
    terms = beam_inertia(LENGTH, section, STEEL)
    flexibilities = shear_flexibilities(LENGTH, section, STEEL)
    for i, length in enumerate(LENGTH):
        points, weights = solid_quadrature(length, section)
        N = beam_shapes(points, LENGTH, *flexibilities)[i]
        r = points * [length, 1.0, 1.0]
        expected = {
            "mass": weights.sum(),
            "S0": weights @ r,
            "J0": np.einsum("p,pij->ij", weights, [x @ x * np.eye(3) - np.outer(x, x) for x in r]),
            "m": np.einsum("p,pia,pib->ab", weights, N, N),
            "m_O": np.einsum("p,pia->ai", weights, N),
            "G": np.array([np.einsum("p,pia,ij,pjb->ab", weights, N, skew(k), N, optimize=True) for k in range(3)]),
            "s": np.array([np.einsum("p,pia,ij,pj->a", weights, N, skew(k), r, optimize=True) for k in range(3)]),
            "H": np.array(
                [
                    [np.einsum("p,pia,ij,pjb->ab", weights, N, skew(k) @ skew(n), N, optimize=True) for n in range(3)]
                    for k in range(3)
                ]
            ),
            "s2": np.array(
                [
                    [np.einsum("p,pia,ij,pj->a", weights, N, skew(k) @ skew(n), r, optimize=True) for n in range(3)]
                    for k in range(3)
                ]
            ),
        }
        assert set(expected) == set(vars(terms))
        for name, value in expected.items():
            actual = getattr(terms, name)[i]
            np.testing.assert_allclose(actual, value, rtol=0, atol=1e-13 * np.abs(value).max(), err_msg=name)


@SECTIONS
def test_rotary_inertia_about_the_axis_is_the_polar_moment(section):
    """Both ends turned about x: ρ (Iy + Iz) L, not ρ J L."""
    turned = np.zeros(12)
    turned[[3, 9]] = 1.0
    polar = STEEL.density * (section.Iy + section.Iz) * LENGTH
    np.testing.assert_allclose(turned @ beam_inertia(LENGTH, section, STEEL).m @ turned, polar, rtol=1e-14)


@SECTIONS
def test_field_reproduces_rigid_motions(section):
    points, _ = solid_quadrature(LENGTH[0], section, 3)
    N = beam_shapes(points, LENGTH, *shear_flexibilities(LENGTH, section, STEEL))
    for i, length in enumerate(LENGTH):
        r = points * [length, 1.0, 1.0]
        for axis in np.eye(3):
            translation = np.concatenate([axis, np.zeros(3)] * 2)
            np.testing.assert_allclose(N[i] @ translation, np.tile(axis, (len(r), 1)), atol=1e-15)
            rotation = np.concatenate([np.zeros(3), axis, np.cross(axis, [length, 0, 0]), axis])
            np.testing.assert_allclose(N[i] @ rotation, np.cross(axis, r), atol=1e-15)
            force = beam_stiffness(LENGTH, section, STEEL)[i] @ np.column_stack([translation, rotation])
            assert np.abs(force).max() < 1e-14 * beam_stiffness(LENGTH, section, STEEL).max()


@SECTIONS
def test_tip_deflections_are_exact(section):
    """A clamped element under end loads: FL³/3EI + FL/kGA, ML²/2EI, ML/EI, TL/GJ, NL/EA."""
    E, G = STEEL.young, STEEL.young / 2.6
    flexibility = np.linalg.inv(beam_stiffness(LENGTH, section, STEEL)[:, 6:, 6:])
    L = LENGTH
    shear_y = L / (section.ky * G * section.area) if section.ky else 0.0
    shear_z = L / (section.kz * G * section.area) if section.kz else 0.0
    for (i, j), expected in {
        (0, 0): L / (E * section.area),
        (1, 1): L**3 / (3 * E * section.Iz) + shear_y,
        (2, 2): L**3 / (3 * E * section.Iy) + shear_z,
        (3, 3): L / (G * section.J),
        (4, 4): L / (E * section.Iy),
        (5, 5): L / (E * section.Iz),
        (1, 5): L**2 / (2 * E * section.Iz),
        (2, 4): -(L**2) / (2 * E * section.Iy),
        (0, 1): 0.0,
    }.items():
        np.testing.assert_allclose(flexibility[:, i, j], expected, rtol=1e-12, atol=1e-25)


def test_stiffness_is_the_strain_energy_of_the_field():
    """K from derivatives of the section's motion: EA u'², EI θ'², GJ θx'², kGA (v' − θz)², by finite differences."""
    xi, weights = np.polynomial.legendre.leggauss(4)
    xi, weights, h = (xi + 1) / 2, weights / 2, 1e-5
    flexibilities = shear_flexibilities(LENGTH, SHEAR, STEEL)
    E, G, i = STEEL.young, STEEL.young / 2.6, 0
    length = LENGTH[i]

    def section_motion(x):
        """(u, v, w, θx, θy, θz) of sections at x, from the field at three points of the section."""
        at = lambda y, z: beam_shapes(  # noqa: E731
            np.column_stack([x, np.full_like(x, y), np.full_like(x, z)]), LENGTH, *flexibilities
        )[i]
        centre, along_y, along_z = at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)
        turn = np.stack([along_y - centre, along_z - centre])
        return np.concatenate([centre, np.stack([turn[0, :, 2], turn[1, :, 0], -turn[0, :, 0]], axis=1)], axis=1)

    middle = section_motion(xi)
    slope = (section_motion(xi + h) - section_motion(xi - h)) / (2 * h * length)
    strains = [slope[:, 0], slope[:, 1] - middle[:, 5], slope[:, 2] + middle[:, 4], *slope[:, 3:].swapaxes(0, 1)]
    laws = [
        E * SHEAR.area,
        SHEAR.ky * G * SHEAR.area,
        SHEAR.kz * G * SHEAR.area,
        G * SHEAR.J,
        E * SHEAR.Iy,
        E * SHEAR.Iz,
    ]
    K = sum(
        law * length * np.einsum("p,pa,pb->ab", weights, strain, strain)
        for law, strain in zip(laws, strains, strict=True)
    )
    exact = beam_stiffness(LENGTH, SHEAR, STEEL)[i]
    # Central differences of cubics at h = 1e-5: h² and round-off/h, both below 1e-9.
    np.testing.assert_allclose(K, exact, rtol=0, atol=1e-7 * exact.max())


def test_straight_beam_along_x_has_the_bodys_axes():
    np.testing.assert_array_equal(beam_axes(np.array([[2.0, 0.0, 0.0]]))[0], np.eye(3))


@pytest.mark.parametrize("direction", [(0, 0, 1), (0, 0, -2), (1, 2, 3), (-1, 0, 0), (1e-9, 0, 1), (0, 1, 0)])
def test_axes_are_right_handed_along_the_beam(direction):
    axes = beam_axes(np.array([direction], dtype=float))[0]
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) > 0
    np.testing.assert_allclose(axes[:, 0] * np.linalg.norm(direction), direction, atol=1e-15)


def frame_mesh():
    """A spatial frame of five beams in all directions, one of them upright."""
    nodes = np.array([[0, 0, 0], [0.5, 0.1, 0.0], [0.5, 0.1, 0.6], [0.9, -0.4, 0.3], [0.2, 0.7, 0.1]])
    return nodes, np.array([[0, 1], [1, 2], [1, 3], [3, 2], [4, 0]])


def dense(terms):
    return InertiaConstants(
        mass=terms.mass,
        S0=terms.S0,
        J0=terms.J0,
        m=terms.M.toarray(),
        m_O=terms.m_O,
        G=np.array([G.toarray() for G in terms.G]),
        H=np.array([[H.toarray() for H in row] for row in terms.H]),
        s=terms.s,
        s2=terms.s2,
    )


@SECTIONS
def test_frame_against_sums_over_the_points_of_the_3d_bodies(section):
    """T2 and T5a of an assembled frame in body axes, against ΣNᵀ dm a, Σ dm a, Σ c × dm a with a from kinematics."""
    nodes, cells = frame_mesh()
    terms = dense(assemble_beam(nodes, cells, section, STEEL))
    rng = np.random.default_rng(4)
    motion = FrameMotion(*rng.normal(size=(3, 3)))
    q, rate, acceleration = rng.normal(size=(3, 6 * len(nodes)))
    vector, force, moment = np.zeros(q.size), np.zeros(3), np.zeros(3)
    for first, second in cells:
        span = nodes[second] - nodes[first]
        length = np.linalg.norm(span)
        points, weights = solid_quadrature(length, section)
        axes = beam_axes(span[None])[0]
        flexibilities = shear_flexibilities(np.array([length]), section, STEEL)
        N = axes @ beam_shapes(points, np.array([length]), *flexibilities)[0] @ np.kron(np.eye(4), axes.T)
        dofs = np.concatenate([6 * first + np.arange(6), 6 * second + np.arange(6)])
        c = nodes[first] + (points * [length, 1, 1]) @ axes.T + N @ q[dofs]
        omega = motion.omega
        a = motion.a_O + np.cross(motion.eps, c) + np.cross(omega, np.cross(omega, c))
        a = a + 2 * np.cross(omega, N @ rate[dofs]) + N @ acceleration[dofs]
        vector[dofs] += np.einsum("p,pia,pi->a", weights, N, a)
        force += weights @ a
        moment += np.cross(c, weights[:, None] * a).sum(axis=0)
    actual = (
        maggi_vector(terms, motion, q, rate, acceleration),
        *frame_resultants(terms, motion, q, rate, acceleration),
    )
    for ours, expected in zip(actual, (vector, force, moment), strict=True):
        np.testing.assert_allclose(ours, expected, rtol=0, atol=3e-14 * np.abs(expected).max())


def test_assembly_is_maggis_projection():
    """``Aᵀ [blockdiag] A`` of paper (28) with elements that are meshes of their own."""
    nodes, cells = frame_mesh()
    ours = assemble_beam(nodes, cells, SHEAR, STEEL)
    alone = [assemble_beam(nodes[cell], np.array([[0, 1]]), SHEAR, STEEL) for cell in cells]
    A = sp.csr_matrix((np.ones(cells.size), (range(cells.size), cells.ravel())))
    A = sp.kron(A, sp.eye(6))
    for pick in (lambda b: b.M, lambda b: b.K, lambda b: b.G[1], lambda b: b.H[2][0]):
        expected = (A.T @ sp.block_diag([pick(b) for b in alone]) @ A).toarray()
        assert np.abs(pick(ours).toarray() - expected).max() <= 1e-15 * np.abs(expected).max()
    for pick in (lambda b: b.m_O, lambda b: b.s.T, lambda b: b.s2[0, 1]):
        expected = A.T @ np.concatenate([pick(b) for b in alone])
        assert np.abs(pick(ours) - expected).max() <= 1e-15 * np.abs(expected).max()
    assert ours.M.blocksize == ours.G[0].blocksize == (3, 3)


def test_rigid_motions_of_a_frame_are_free_of_force():
    nodes, cells = frame_mesh()
    K = assemble_beam(nodes, cells, SHEAR, STEEL).K
    rigid = [np.tile(np.concatenate([axis, np.zeros(3)]), len(nodes)) for axis in np.eye(3)]
    rigid += [np.hstack([np.cross(axis, nodes), np.tile(axis, (len(nodes), 1))]).ravel() for axis in np.eye(3)]
    assert np.abs(K @ np.array(rigid).T).max() < 1e-13 * abs(K).max()


def test_user_mistakes_are_named():
    nodes, cells = frame_mesh()
    with pytest.raises(MeshError, match="beam cell 12 has length 0 m"):
        assemble_beam(nodes, np.array([[0, 1], [2, 2]]), SHEAR, STEEL, {"beam2": [11, 12]})
    with pytest.raises(MeshError, match="node indices 0 to 9"):
        assemble_beam(nodes, np.array([[0, 9]]), SHEAR, STEEL)
    with pytest.raises(MeshError, match="beam cells have shape"):
        assemble_beam(nodes, np.zeros((0, 2), dtype=int), SHEAR, STEEL)
    with pytest.raises(MeshError, match="20001 beam cells are more than 20000"):
        assemble_beam(nodes, np.tile([0, 1], (20001, 1)), SHEAR, STEEL)
    with pytest.raises(ModelError, match="the section has Iy -1"):
        assemble_beam(nodes, cells, Section(1.0, -1.0, 1.0, 1.0), STEEL)
    with pytest.raises(ModelError, match="the section has ky -1"):
        assemble_beam(nodes, cells, Section(1.0, 1.0, 1.0, 1.0, ky=-1.0), STEEL)
    with pytest.raises(ModelError, match=r"beam2 cell at row 0 has density -7"):
        assemble_beam(nodes, cells, SHEAR, Material(-7.0, 1.0, 0.3))

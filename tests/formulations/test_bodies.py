"""Bodies as mass points, against the constants that the program integrates or is given."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from workshop import Workshop

from maggi.analyses.compare_formulations import compare_formulations
from maggi.elements.ritz import ritz_terms
from maggi.formulations.bodies import equivalent_points, ritz_body, with_inertia
from maggi.linalg.rotations import rotation_matrix
from maggi.model import End, Joint, Model, ModelError, RitzBody

SEEDS = st.integers(0, 2**32 - 1)


def inertia_of(masses, points):
    second = np.einsum("p,pi,pj->ij", masses, points, points)
    return np.trace(second) * np.eye(3) - second


@given(SEEDS, st.sampled_from(["solid", "rod", "none", "one axis", "massless"]))
def test_equivalent_points(seed, kind):
    """Mass, centre and tensor come back; of bodies that exist no mass is negative."""
    rng = np.random.default_rng(seed)
    second = rng.uniform(0.01, 1.0, 3)
    if kind == "rod":
        second[1:] = 0.0
    if kind == "none":
        second[:] = 0.0
    moments = np.array([0.0, 0.0, second[0]]) if kind == "one axis" else second.sum() - second
    R = rotation_matrix(rng.normal(size=3))
    J, center = R @ np.diag(moments) @ R.T, rng.normal(size=3)
    mass = 0.0 if kind == "massless" else float(rng.uniform(0.1, 10.0))
    masses, points = equivalent_points(mass, center, J)
    assert masses.sum() == pytest.approx(mass, abs=1e-14)
    np.testing.assert_allclose(masses @ points, mass * center, atol=1e-13)
    np.testing.assert_allclose(inertia_of(masses, points - center), J, atol=1e-13)
    if kind in ("solid", "rod", "none"):
        assert masses.min() >= -1e-15 * mass


@given(SEEDS)
def test_ritz_bodies(seed):
    """Sums over the points are the constants of T3 and T5a, the extra inertia of a line's section with them."""
    shop = Workshop(np.random.default_rng(seed))
    body = shop.bodies[shop.ritz()]
    terms, points = ritz_terms(body.shapes, body.terms), ritz_body("e", body)
    m, X, N = points.masses, points.points, points.shapes
    size = np.abs(terms.J0).max()
    assert m.sum() == pytest.approx(terms.mass, rel=1e-12)
    np.testing.assert_allclose(m @ X, terms.S0, atol=1e-12 * size)
    np.testing.assert_allclose(inertia_of(m, X), terms.J0, atol=1e-12 * size)
    np.testing.assert_allclose(np.einsum("p,pia,pib->ab", m, N, N), terms.m, atol=1e-12 * size)
    np.testing.assert_allclose(np.einsum("p,pia->ai", m, N), terms.m_O, atol=1e-12 * size)
    moment = np.einsum("p,pia->ia", m, np.cross(X[:, :, None], N, axisa=1, axisb=1, axisc=1))
    np.testing.assert_allclose(moment, terms.s, atol=1e-12 * size)
    e, rate = shop.rng.normal(size=(2, N.shape[2]))
    np.testing.assert_allclose(points.elasticity.force(e, rate), -terms.k @ e - terms.D @ rate, atol=1e-10)


def test_a_little_inertia():
    shop = Workshop(np.random.default_rng(1))
    body = ritz_body("e", shop.bodies[shop.ritz()])
    heavier = with_inertia(body, 0.3)
    gained = inertia_of(heavier.masses, heavier.points) - inertia_of(body.masses, body.points)
    np.testing.assert_allclose(gained, 0.3 * np.eye(3), atol=1e-14)
    assert heavier.masses.sum() == pytest.approx(body.masses.sum())


def test_constants_given_as_matrices_are_refused():
    shop = Workshop(np.random.default_rng(1))
    name = shop.ritz()
    body = shop.bodies[name]
    model = Model({name: RitzBody(ritz_terms(body.shapes, body.terms), body.shapes)}, {})
    with pytest.raises(ModelError, match="no mass points") as error:
        compare_formulations(model)
    assert error.value.path == f"bodies.{name}"
    assert "RitzIntegrals" in error.value.remedy


def test_a_particle_has_no_rotation_of_its_own():
    """A body without inertia that is free to turn gets a little, and the comparison says so."""
    shop = Workshop(np.random.default_rng(2))
    name = shop.rigid()
    particle = Model(
        {name: type(shop.bodies[name])(2.0, (0.0, 0.0, 0.0))},
        {"j": Joint("planar", End("ground"), End(name), at=(0.1, 0.2, 0.3), axis=(0.0, 0.6, 0.8))},
        gravity=(0.0, 0.0, -9.81),
    )
    found = compare_formulations(particle)
    assert found.agree
    assert any("without inertia" in note for note in found.notes)

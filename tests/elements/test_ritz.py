"""Ritz terms against independent quadrature, closed forms, and wrong input."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from maggi.elements.ritz import box_quadrature, integrate_ritz, line_quadrature, ritz_terms
from maggi.model.errors import ModelError
from maggi.model.materials import Damping, Material
from maggi.model.shapes import BoxQuadrature, LineQuadrature, RitzIntegrals

LOW, HIGH = np.array([-0.2, 0.1, 0.0]), np.array([0.5, 0.3, 0.4])
ALUMINIUM = Material(density=2700.0, young=70e9, poisson=0.33, damping=Damping(0.5, 1e-5))


def shapes(x):
    """Three polynomial functions of degree 2 in each component, (p, 3, 3)."""
    X, Y, Z = x.T
    zero = np.zeros_like(X)
    return np.stack(
        [np.stack([X * Y, Z**2, zero]), np.stack([Y, X * Z, 1.0 + X**2]), np.stack([Z, zero, X * Y + Z])]
    ).transpose(2, 1, 0)


def gradients(x):
    """∂N_ia/∂x_j of `shapes`, (p, 3, 3, 3)."""
    h = 1e-4
    # Quadratic functions: central differences are exact up to round-off.
    return np.stack([(shapes(x + h * e) - shapes(x - h * e)) / (2 * h) for e in np.eye(3)], axis=2)


def terms(**options):
    points, weights = box_quadrature(LOW, HIGH, 4)
    return integrate_ritz(shapes, points, weights, 2700.0, **({"stiffness": np.eye(3)} | options))


def test_constants_against_a_finer_quadrature_of_each_formula():
    """Nine Gauss points per axis, cross products instead of the constant tensors."""
    ours = terms()
    x, w = np.polynomial.legendre.leggauss(9)
    axes = [(lo + hi) / 2 + (hi - lo) / 2 * x for lo, hi in zip(LOW, HIGH, strict=True)]
    r = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    dm = 2700.0 * np.einsum("i,j,k->ijk", w, w, w).ravel() * np.prod((HIGH - LOW) / 2)
    N = shapes(r)
    cross = lambda k, b: np.cross(np.eye(3)[k], b, axisb=1, axisc=1)  # noqa: E731
    pairs = [(k, n) for k in range(3) for n in range(3)]
    expected = {
        "mass": dm.sum(),
        "S0": dm @ r,
        "J0": sum(m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(dm, r, strict=True)),
        "m": np.einsum("p,pia,pib->ab", dm, N, N),
        "m_O": np.einsum("p,pia->ai", dm, N),
        "G": np.array([np.einsum("p,pia,pib->ab", dm, N, cross(k, N)) for k in range(3)]),
        "s": np.array([np.einsum("p,pia,pi->a", dm, N, cross(k, r)) for k in range(3)]),
        "H": np.array([np.einsum("p,pia,pib->ab", dm, N, cross(k, cross(n, N))) for k, n in pairs]),
        "s2": np.array([np.einsum("p,pia,pi->a", dm, N, cross(k, cross(n, r))) for k, n in pairs]),
    }
    expected["H"] = expected["H"].reshape(3, 3, 3, 3)
    expected["s2"] = expected["s2"].reshape(3, 3, 3)
    for name, value in expected.items():
        np.testing.assert_allclose(getattr(ours, name), value, rtol=0, atol=1e-13 * np.abs(value).max(), err_msg=name)


def test_line_functions_of_a_beam_against_adaptive_quadrature():
    """Lateral sin(πx/l), longitudinal 4ξ(1−ξ): the rod of Simeon's crank (l = 0.3 m, 8 mm square, 7870 kg/m³)."""
    length, area, density = 0.3, 64e-6, 7870.0
    lateral = lambda x: np.sin(np.pi * x / length)  # noqa: E731
    axial = lambda x: 4 * x / length * (1 - x / length)  # noqa: E731

    def rod(points):
        N = np.zeros((len(points), 3, 2))
        N[:, 1, 0], N[:, 0, 1] = lateral(points[:, 0]), axial(points[:, 0])
        return N

    points, weights = line_quadrature(length, area, 16)
    ours = integrate_ritz(rod, points, weights, density, stiffness=np.diag([1.0, 2.0]))
    line = density * area
    integral = lambda f: line * quad(f, 0.0, length, epsabs=1e-15)[0]  # noqa: E731
    assert ours.mass == pytest.approx(line * length, rel=1e-14)
    np.testing.assert_allclose(np.diag(ours.J0), [0.0, line * length**3 / 3, line * length**3 / 3], rtol=1e-14)
    np.testing.assert_allclose(
        np.diag(ours.m), [integral(lambda x: lateral(x) ** 2), integral(lambda x: axial(x) ** 2)]
    )
    np.testing.assert_allclose(ours.m_O[0], [0.0, line * 2 * length / np.pi, 0.0], rtol=1e-13)
    # N₀ᵀ ẽ_z N₁ = lateral·axial: about z, e_z × x = y.
    coupling = integral(lambda x: lateral(x) * axial(x))
    np.testing.assert_allclose(ours.G[2], [[0.0, coupling], [-coupling, 0.0]], rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(ours.s[2, 0], integral(lambda x: lateral(x) * x), rtol=1e-12)


def test_stiffness_from_gradients_is_the_strain_energy():
    """Uniform strains of known energy: uniaxial E_x = λ + 2G, simple shear G; a rotation has none."""
    points, weights = box_quadrature(LOW, HIGH, 2)

    def linear(x):
        X, Y, _ = x.T
        zero = np.zeros_like(X)
        return np.stack([np.stack([X, zero, zero]), np.stack([Y, zero, zero]), np.stack([-Y, X, zero])]).transpose(
            2, 1, 0
        )

    def slopes(x):
        g = np.zeros((len(x), 3, 3, 3))
        g[:, 0, 0, 0] = g[:, 0, 1, 1] = g[:, 1, 0, 2] = 1.0
        g[:, 0, 1, 2] = -1.0
        return g

    E, nu = ALUMINIUM.young, ALUMINIUM.poisson
    k = integrate_ritz(linear, points, weights, 1.0, material=ALUMINIUM, gradients=slopes).k
    volume = np.prod(HIGH - LOW)
    modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    np.testing.assert_allclose(k, np.diag([modulus, E / (2 * (1 + nu)), 0.0]) * volume, atol=1e-14 * modulus)


def test_stiffness_from_gradients_against_stresses():
    """k = ∫ ε:σ dV with σ from Hooke's law written by components, for functions of varying strain."""
    k = terms(stiffness=None, material=ALUMINIUM, gradients=gradients).k
    points, weights = box_quadrature(LOW, HIGH, 6)
    E, nu = ALUMINIUM.young, ALUMINIUM.poisson
    expected = np.zeros((3, 3))
    for g, w in zip(gradients(points), weights, strict=True):
        strains = [(g[:, :, a] + g[:, :, a].T) / 2 for a in range(3)]
        stresses = [E / (1 + nu) * (e + nu / (1 - 2 * nu) * np.trace(e) * np.eye(3)) for e in strains]
        expected += w * np.array([[np.sum(e * s) for s in stresses] for e in strains])
    np.testing.assert_allclose(k, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_damping_given_from_factors_or_from_the_material():
    given = np.diag([1.0, 2.0, 3.0])
    assert np.array_equal(terms(damping=given).D, given)
    rayleigh = terms(damping=Damping(2.0, 3.0))
    np.testing.assert_allclose(rayleigh.D, 2.0 * rayleigh.m + 3.0 * rayleigh.k)
    own = terms(stiffness=None, material=ALUMINIUM, gradients=gradients)
    np.testing.assert_allclose(own.D, 0.5 * own.m + 1e-5 * own.k)
    assert not terms().D.any()


@pytest.mark.parametrize(
    "quadrature", [LineQuadrature(0.3, 64e-6, 6), BoxQuadrature((0.0, 0.0, 0.0), (0.3, 0.1, 0.2), 4)]
)
def test_integrals_that_a_model_describes(quadrature):
    integrals = RitzIntegrals(7870.0, quadrature, np.eye(3))
    ours = ritz_terms(shapes, integrals)
    if isinstance(quadrature, LineQuadrature):
        points, weights = line_quadrature(0.3, 64e-6, 6)
    else:
        points, weights = box_quadrature(np.zeros(3), np.array([0.3, 0.1, 0.2]), 4)
    expected = integrate_ritz(shapes, points, weights, 7870.0, stiffness=np.eye(3))
    for name, value in vars(expected).items():
        assert np.array_equal(getattr(ours, name), value), name
    given = ritz_terms(shapes, replace(integrals, J0=((1.0, 0.1, 0.0), (0.1, 2.0, 0.0), (0.0, 0.0, 3.0))))
    assert given.J0.tolist() == [[1.0, 0.1, 0.0], [0.1, 2.0, 0.0], [0.0, 0.0, 3.0]]
    for wrong in (((1.0, 0.5, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), ((1.0, 0, 0), (0, -1.0, 0), (0, 0, 1.0))):
        with pytest.raises(ModelError, match="J0 is"):
            ritz_terms(shapes, replace(integrals, J0=wrong))


def test_density_may_vary():
    points, weights = box_quadrature(LOW, HIGH, 4)
    varying = integrate_ritz(shapes, points, weights, 1.0 + points[:, 2], stiffness=np.eye(3))
    assert varying.mass == pytest.approx(np.prod(HIGH - LOW) * 1.2, rel=1e-14)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"stiffness": None}, "the stiffness is missing"),
        ({"material": ALUMINIUM, "gradients": gradients}, "given twice"),
        ({"stiffness": np.eye(2)}, r"stiffness has shape \(2, 2\) \(give \(3, 3\)"),
        ({"stiffness": np.triu(np.ones((3, 3)))}, "not symmetric"),
        ({"stiffness": np.full((3, 3), np.nan)}, "stiffness has values that are not finite"),
        ({"damping": np.ones(3)}, r"damping has shape \(3,\)"),
        ({"stiffness": None, "material": ALUMINIUM, "gradients": shapes}, "gradients gave an array of shape"),
        ({"stiffness": None, "material": replace(ALUMINIUM, poisson=0.5), "gradients": gradients}, "poisson 0.5"),
    ],
)
def test_wrong_matrices_are_refused(options, message):
    with pytest.raises(ModelError, match=message):
        terms(**options)


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (
            lambda x: shapes(x)[:, :2],
            r"shapes gave an array of shape \(64, 2, 3\) at 64 points \(return \(64, 3, n\)\)",
        ),
        (lambda x: shapes(x)[:, :, 0], "shapes gave an array of shape"),
        (lambda x: shapes(x)[:1], "shapes gave an array of shape"),
        (lambda x: shapes(x)[:, :, :0], "shapes gave an array of shape"),
        (lambda x: shapes(x) * np.inf, "not finite"),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_wrong_shapes_are_refused(function, message):
    points, weights = box_quadrature(LOW, HIGH, 4)
    with pytest.raises(ModelError, match=message):
        integrate_ritz(function, points, weights, 1.0, stiffness=np.eye(3))


def test_wrong_quadrature_is_refused():
    points, weights = box_quadrature(LOW, HIGH, 2)
    for make, message in (
        (lambda: integrate_ritz(shapes, points, weights[1:], 1.0, stiffness=np.eye(3)), "weights"),
        (
            lambda: integrate_ritz(shapes, points * np.nan, weights, 1.0, stiffness=np.eye(3)),
            "points has values|finite",
        ),
        (lambda: integrate_ritz(shapes, points, weights, -1.0, stiffness=np.eye(3)), "density is -1"),
        (lambda: line_quadrature(0.0, 1.0, 3), "length is 0"),
        (lambda: line_quadrature(1.0, float("nan"), 3), "area is nan"),
        (lambda: line_quadrature(1.0, 1.0, 0), "order is 0"),
        (lambda: box_quadrature(HIGH, LOW, 3), "no volume"),
    ):
        with pytest.raises(ModelError, match=message):
            make()

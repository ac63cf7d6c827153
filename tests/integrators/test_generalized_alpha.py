"""Coefficients of generalised-α: order, spectral radius, and what an increment changes."""

import numpy as np
import pytest

from maggi.integrators.generalized_alpha import generalized_alpha, instantaneous

RADII = [0.0, 0.2, 0.5, 0.8, 0.9, 1.0]


def amplification(c, frequency):
    """The step's matrix on (q, h v, h² a, h² v̇) for v̇ = −ω² q, from the formulas of `GeneralizedAlpha`."""
    square = (frequency * c.h) ** 2
    # implicit part times new values = explicit part times old values
    new = np.array(
        [
            [1.0, 0.0, -c.beta, 0.0],
            [0.0, 1.0, -c.gamma, 0.0],
            [0.0, 0.0, 1.0 - c.alpha_m, -(1.0 - c.alpha_f)],
            [square, 0.0, 0.0, 1.0],
        ]
    )
    old = np.array(
        [
            [1.0, 1.0, 0.5 - c.beta, 0.0],
            [0.0, 1.0, 1.0 - c.gamma, 0.0],
            [0.0, 0.0, -c.alpha_m, c.alpha_f],
            [0.0, 0.0, 0.0, 0.0],
        ]
    )
    return np.linalg.solve(new, old)


@pytest.mark.parametrize("rho", RADII)
def test_order_and_dissipation_conditions(rho):
    """Chung and Hulbert (1993), eqs. 17, 20 and 25."""
    c = generalized_alpha(0.1, rho)
    assert c.gamma == pytest.approx(0.5 + c.alpha_f - c.alpha_m, abs=1e-15)
    assert c.beta == pytest.approx(0.25 * (1.0 + c.alpha_f - c.alpha_m) ** 2, abs=1e-15)
    assert c.alpha_m <= c.alpha_f <= 0.5
    assert c.sigma == pytest.approx((1.0 - c.alpha_m) / (1.0 - c.alpha_f), abs=1e-15)


@pytest.mark.parametrize("rho", RADII)
def test_spectral_radius_at_infinite_frequency(rho):
    """All three eigenvalues tend to −ρ∞, so the characteristic polynomial to λ (λ + ρ∞)³."""
    matrix = amplification(generalized_alpha(1.0, rho), 1e7)
    np.testing.assert_allclose(np.poly(matrix), np.poly([0.0, -rho, -rho, -rho]), atol=1e-11)


@pytest.mark.parametrize("rho", RADII)
def test_never_unstable(rho):
    c = generalized_alpha(1.0, rho)
    radii = [np.abs(np.linalg.eigvals(amplification(c, w))).max() for w in np.logspace(-2, 3, 60)]
    assert max(radii) < 1.0 + 1e-9
    if rho < 1.0:
        assert radii[-1] == pytest.approx(rho, abs=0.02)
    else:
        np.testing.assert_allclose(radii, 1.0, atol=1e-9)


@pytest.mark.parametrize("rho", RADII)
def test_second_order(rho):
    """Position and velocity after one period of an oscillator, started with a₀ = v̇₀."""
    errors = []
    for count in (100, 200):
        c = generalized_alpha(2.0 * np.pi / count, rho)
        state = np.array([1.0, 0.0, -(c.h**2), -(c.h**2)])
        state = np.linalg.matrix_power(amplification(c, 1.0), count) @ state
        errors.append(np.hypot(state[0] - 1.0, state[1] / c.h))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_instantaneous():
    """An instant leaves positions and velocities alone: δ of a₁ changes v̇₁ by σδ = δ only."""
    c = instantaneous()
    assert (c.h, c.beta, c.gamma, c.sigma) == (0.0, 0.0, 0.0, 1.0)


@pytest.mark.parametrize("rho", [-0.1, 1.01, float("nan")])
def test_impossible_radius(rho):
    with pytest.raises(ValueError, match="rho_inf must lie in"):
        generalized_alpha(0.1, rho)

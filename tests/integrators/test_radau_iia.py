"""Radau IIA: its coefficients, order 5, L-stability, accuracy on stiff problems, and agreement with scipy's own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from maggi.integrators.radau_iia import A, C, RadauIIA


def test_coefficients():
    """Those of Hairer and Wanner, table IV.5.6; order conditions B(5), C(3)."""
    r = np.sqrt(6.0)
    expected = [
        [(88 - 7 * r) / 360, (296 - 169 * r) / 1800, (-2 + 3 * r) / 225],
        [(296 + 169 * r) / 1800, (88 + 7 * r) / 360, (-2 - 3 * r) / 225],
        [(16 - r) / 36, (16 + r) / 36, 1 / 9],
    ]
    np.testing.assert_allclose(A, expected, atol=1e-15)
    for k in range(1, 6):
        assert A[2] @ C ** (k - 1) == pytest.approx(1 / k, rel=1e-14)


def fixed(f, jacobian, y0, t1, count):
    """Steps of one size: the tolerance never asks for smaller ones, while stages are solved to 1e-14."""
    h = t1 / count
    huge = 1e10
    solver = RadauIIA(f, 0.0, np.array(y0), t1, rtol=0.5, atol=huge, jacobian=jacobian, first_step=h, max_step=h)
    solver._newton = 1e-14 / huge
    while solver.status == "running":
        solver.step()
    return solver.y


def test_order():
    """Error of fifth order in a rotating nonlinear problem: y'' = −sin y from 1 rad, against a much smaller step."""

    def f(t, y):
        return np.array([y[1], -np.sin(y[0])])

    def jacobian(t, y):
        return np.array([[0.0, 1.0], [-np.cos(y[0]), 0.0]])

    counts = np.array([10, 20, 40])
    exact = solve_ivp(f, (0, 5), [1.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    errors = [np.abs(fixed(f, jacobian, [1.0, 0.0], 5.0, n) - exact).max() for n in counts]
    order = np.polyfit(np.log(5.0 / counts), np.log(errors), 1)[0]
    assert order == pytest.approx(5.0, abs=0.3)


def test_stiff_parts_vanish_in_one_step():
    """y' = −1e9 (y − cos t) from 4 above: after a step −3/(hλ) of that is left (stability function at infinity)."""
    y = fixed(lambda t, y: -1e9 * (y - np.cos(t)), lambda t, y: np.array([[-1e9]]), [5.0], 0.1, 1)
    assert y[0] - np.cos(0.1) == pytest.approx(3.0 / 1e8 * 4.0, rel=0.01)


@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10])
def test_van_der_pol(rtol):
    """Hairer and Wanner's reference for ε = 1e-6 at t = 2: (1.706167732170483, −0.892809701024795)."""

    def f(t, y):
        return np.array([y[1], ((1 - y[0] ** 2) * y[1] - y[0]) * 1e6])

    def jacobian(t, y):
        return np.array([[0.0, 1.0], [(-2 * y[0] * y[1] - 1) * 1e6, (1 - y[0] ** 2) * 1e6]])

    results = solve_ivp(f, (0, 2), [2.0, -0.66], method=RadauIIA, rtol=rtol, atol=rtol, jacobian=jacobian)
    assert results.success
    expected = [1.706167732170483, -0.892809701024795]
    # y(0) is not on the slow manifold exactly as in the reference, which matters at 1e-7 of y
    np.testing.assert_allclose(results.y[:, -1], expected, rtol=max(30 * rtol, 1e-6))
    own = solve_ivp(f, (0, 2), [2.0, -0.66], method="Radau", rtol=1e-12, atol=1e-12, jac=jacobian)
    np.testing.assert_allclose(results.y[:, -1], own.y[:, -1], rtol=100 * rtol)
    other = solve_ivp(f, (0, 2), [2.0, -0.66], method="Radau", rtol=rtol, atol=rtol, jac=jacobian)
    assert results.nfev <= 1.3 * other.nfev


def test_oscillator_with_differences_and_dense_output():
    """Without a Jacobian, backwards in time too; between the steps the polynomial is of third order."""

    def f(t, y):
        return np.array([y[1], -y[0]])

    for t1 in (3.0, -3.0):
        t = np.linspace(0.0, t1, 41)
        results = solve_ivp(f, (0, t1), [1.0, 0.0], method=RadauIIA, rtol=1e-9, atol=1e-9, t_eval=t)
        np.testing.assert_allclose(results.y[0], np.cos(t), atol=2e-5)
        np.testing.assert_allclose(results.y[0, -1], np.cos(t1), atol=1e-8)


def test_a_step_that_cannot_be_made_says_so():
    """y' = y² reaches infinity at t = 1."""
    results = solve_ivp(lambda t, y: y * y, (0, 2), [1.0], method=RadauIIA, rtol=1e-8)
    assert not results.success
    assert results.t[-1] == pytest.approx(1.0, abs=1e-6)

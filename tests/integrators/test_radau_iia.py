"""Radau IIA: its tableau, order five, stiff problems against references and against SciPy's implementation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from transient_runs import orders

from maggi.integrators.radau_iia import GAMMA, PAIR, T_INVERSE, A, C, RadauIIA, T


def test_tableau():
    """Simplifying assumptions C(3) and D(2), and A⁻¹ T = T Λ."""
    b = A[2]
    for k in range(1, 6):
        assert b @ C ** (k - 1) == pytest.approx(1 / k)
    for k in range(1, 4):
        np.testing.assert_allclose(A @ C ** (k - 1), C**k / k)
    for k in range(1, 3):
        np.testing.assert_allclose(b * C ** (k - 1) @ A, b * (1 - C**k) / k, atol=1e-15)
    block = [[GAMMA, 0, 0], [0, PAIR.real, PAIR.imag], [0, -PAIR.imag, PAIR.real]]
    np.testing.assert_allclose(T_INVERSE @ np.linalg.inv(A) @ T, block, atol=1e-12)
    # Hairer and Wanner, IV.8: the eigenvalues of A⁻¹
    assert pytest.approx(3 + 3 ** (2 / 3) - 3 ** (1 / 3)) == GAMMA
    assert pytest.approx(3 + 0.5 * (3 ** (1 / 3) - 3 ** (2 / 3)) + 0.5j * (3 ** (5 / 6) + 3 ** (7 / 6))) == PAIR


def forced(t, y):
    """A pendulum that is shaken."""
    return np.array([y[1], -np.sin(y[0]) + 0.1 * np.cos(t)])


def test_order_five():
    """Steps of fixed size, Newton's iteration to round-off."""
    exact = solve_ivp(forced, (0.0, 5.0), [1.0, 0.3], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]

    def error(h):
        solver = RadauIIA(forced, 0.0, np.array([1.0, 0.3]), 5.0, rtol=1e6, atol=1e6, max_step=h, first_step=h)
        solver._newton_tolerance = 1e-20
        while solver.status == "running":
            solver.h_abs = h
            solver.step()
        return np.abs(solver.y - exact).max()

    _, found = orders(error, [0.25, 0.125, 0.0625])
    np.testing.assert_allclose(found, 5.0, atol=0.15)


@pytest.mark.parametrize("rtol", [1e-5, 1e-8, 1e-11])
def test_errors_follow_the_tolerance(rtol):
    exact = solve_ivp(forced, (0.0, 5.0), [1.0, 0.3], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    found = solve_ivp(forced, (0.0, 5.0), [1.0, 0.3], method=RadauIIA, rtol=rtol, atol=rtol)
    assert np.abs(found.y[:, -1] - exact).max() < 10.0 * rtol


def test_van_der_pol():
    """ε = 1e-6 to t = 2: the reference of the IVP test set (vdpol), y(0) = (2, 0); fewer than 1,000 steps."""
    eps = 1e-6

    def jacobian(t, y):
        return np.array([[0.0, 1.0], [(-2.0 * y[0] * y[1] - 1.0) / eps, (1.0 - y[0] ** 2) / eps]])

    found = solve_ivp(
        lambda t, y: np.array([y[1], ((1.0 - y[0] ** 2) * y[1] - y[0]) / eps]),
        (0.0, 2.0),
        [2.0, 0.0],
        method=RadauIIA,
        rtol=1e-7,
        atol=1e-7,
        jac=jacobian,
    )
    np.testing.assert_allclose(found.y[:, -1], [1.706167732170483, -0.8928097010247975], rtol=2e-6)
    assert len(found.t) < 2000


def robertson(t, y):
    """Three reactions with rates from 0.04 to 3e7."""
    a, b, c = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return np.array([-a + b, a - b - c, c])


def test_the_same_as_scipys():
    """Robertson's reactions to t = 1e5: as accurate, at a similar cost, and the same between the steps."""
    options = {"rtol": 1e-8, "atol": [1e-12, 1e-16, 1e-12], "dense_output": True}
    mine = solve_ivp(robertson, (0.0, 1e5), [1.0, 0.0, 0.0], method=RadauIIA, **options)
    theirs = solve_ivp(robertson, (0.0, 1e5), [1.0, 0.0, 0.0], method="Radau", **options)
    times = np.logspace(-3, 5, 41)
    np.testing.assert_allclose(mine.sol(times), theirs.sol(times), rtol=1e-6)
    assert mine.nfev < 1.5 * theirs.nfev
    assert mine.sol(times[3]).shape == (3,)


def test_backwards_and_nothing_to_do():
    exact = solve_ivp(forced, (5.0, 0.0), [1.0, 0.3], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    found = solve_ivp(forced, (5.0, 0.0), [1.0, 0.3], method=RadauIIA, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(found.y[:, -1], exact, atol=1e-6)
    assert solve_ivp(forced, (1.0, 1.0), [1.0, 0.3], method=RadauIIA).success


def test_steps_away_from_where_f_is_not_a_number():
    """√(1 − y) beyond y = 1 is not: the way to y = 1, which it never passes, is found all the same."""
    found = solve_ivp(
        lambda t, y: np.sqrt(np.where(y < 1.0, 1.0 - y, np.nan)), (0.0, 1.9), [0.0], method=RadauIIA, rtol=1e-6
    )
    assert found.success
    assert found.y[0, -1] == pytest.approx(1.0 - (1.0 - 1.9 / 2.0) ** 2, abs=1e-5)


def test_a_solution_that_ends():
    """y' = y²: y = 1 / (1 − t)."""
    found = solve_ivp(lambda t, y: y**2, (0.0, 2.0), [1.0], method=RadauIIA)
    assert not found.success
    assert found.t[-1] == pytest.approx(1.0, abs=1e-3)

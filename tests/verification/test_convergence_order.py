"""Second order of the transient analysis on rigid systems, against closed forms and independent integrations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from transient_runs import end, joint, orders, simulate

from maggi.model import Model, Pose, RigidBody, SpringDamper, Velocity
from maggi.model.joints import End

# CASES A01: x and y at t = 10 s of a point mass on a massless bar of 1 m, released from the horizontal
# (Jacobi's sn, confirmed by a 20-digit Taylor integration).
A01_AT_10_S = np.array([-0.27508746257611686, -0.961419205099125064])


def a01():
    bob = RigidBody(1.0, pose=Pose((-1.0, 0.0, 0.0)))
    pin = joint("spherical", "ground", "bob", at=(0.0, 0.0, 0.0))
    return Model({"bob": bob}, {"pin": pin}, gravity=(0.0, -9.81, 0.0))


def a01_error(step, rho_inf):
    results, _ = simulate(a01(), 10.0, step, rho_inf=rho_inf)
    return float(np.abs(results.body("bob").origin[-1, :2] - A01_AT_10_S).max())


@pytest.mark.slow
def test_a01_after_ten_seconds():
    """Error 2.3e-7 at h = 1e-4, the order's 2.3e-5 at 1e-3 times 1e-2."""
    results, summary = simulate(a01(), 10.0, 1e-4, rows=10)
    assert np.abs(results.body("bob").origin[-1, :2] - A01_AT_10_S).max() < 1e-6
    assert np.abs(results.energy.balance).max() < 1e-7 * np.ptp(results.energy.kinetic)
    assert (summary.residuals < 1e-11).all()


@pytest.mark.parametrize("rho_inf", [1.0, 0.9])
def test_order_of_a01(rho_inf):
    """ω₀ = 3.13 rad/s: hω₀ = 0.025 … 0.003; the period is 2.4 s, four are passed."""
    errors, order = orders(lambda h: a01_error(h, rho_inf), [8e-3, 4e-3, 2e-3, 1e-3])
    assert errors[-1] < 5e-5
    np.testing.assert_allclose(order, 2.0, atol=0.05)


# A symmetric top: 1 kg, its centre of mass 0.3 m from the fixed point, tilted by 60°, spinning and precessing.
MASS, ARM, ACROSS, ALONG = 1.0, 0.3, 0.004, 0.006  # kg, m, kg m² about the centre of mass
TILT = np.pi / 3
SPIN = np.array([0.5, 0.0, 30.0])  # rad/s, body axes


def tilted():
    c, s = np.cos(TILT), np.sin(TILT)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def top():
    R = tilted()
    body = RigidBody(
        MASS,
        center_of_mass=(0.0, 0.0, ARM),
        inertia=((ACROSS, 0.0, 0.0), (0.0, ACROSS, 0.0), (0.0, 0.0, ALONG)),
        pose=Pose(rotation=tuple(tuple(row) for row in R.tolist())),
        velocity=Velocity(angular=tuple((R @ SPIN).tolist())),
    )
    pin = joint("spherical", "ground", "top", at=(0.0, 0.0, 0.0))
    return Model({"top": body}, {"pin": pin}, gravity=(0.0, 0.0, -9.81))


def matrix_of_quaternion(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def top_by_eulers_equations(duration):
    """Rotation matrix at the end: Euler's equations about the fixed point with a quaternion, DOP853."""
    inertia = np.array([ACROSS + MASS * ARM**2, ACROSS + MASS * ARM**2, ALONG])

    def rates(_, y):
        q, w = y[:4], y[4:]
        weight = matrix_of_quaternion(q).T @ [0.0, 0.0, -9.81 * MASS]
        moment = np.cross([0.0, 0.0, ARM], weight)
        turn = 0.5 * np.array(
            [
                -q[1:] @ w,
                q[0] * w[0] + q[2] * w[2] - q[3] * w[1],
                q[0] * w[1] + q[3] * w[0] - q[1] * w[2],
                q[0] * w[2] + q[1] * w[1] - q[2] * w[0],
            ]
        )
        return np.concatenate([turn, (moment - np.cross(w, inertia * w)) / inertia])

    start = np.concatenate([[np.cos(TILT / 2), np.sin(TILT / 2), 0.0, 0.0], SPIN])
    solution = solve_ivp(rates, (0.0, duration), start, method="DOP853", rtol=1e-13, atol=1e-14)
    return matrix_of_quaternion(solution.y[:4, -1])


@pytest.mark.parametrize("rho_inf", [1.0, 0.9])
def test_order_of_a_spinning_spherical_pendulum(rho_inf):
    """hω = 0.24 … 0.03 for the spin of 30 rad/s; the error is that of the whole rotation matrix after 1 s."""
    expected = top_by_eulers_equations(1.0)

    def error(step):
        results, _ = simulate(top(), 1.0, step, rho_inf=rho_inf)
        return float(np.abs(results.body("top").rotation[-1] - expected).max())

    errors, order = orders(error, [4e-3, 2e-3, 1e-3, 5e-4])
    assert errors[-1] < 1e-3
    np.testing.assert_allclose(order, 2.0, atol=0.05)


# An elastic pendulum: 1 kg on an undamped spring of 100 N/m and 1 m free length, released at rest.
STIFFNESS, LENGTH, RELEASE = 100.0, 1.0, (0.9, 0.0, -0.5)


def elastic_pendulum():
    bob = RigidBody(1.0, pose=Pose(RELEASE))
    spring = SpringDamper(End("ground", point=(0.0, 0.0, 0.0)), end("bob"), stiffness=STIFFNESS, length=LENGTH)
    return Model({"bob": bob}, forces={"spring": spring}, gravity=(0.0, 0.0, -9.81))


def elastic_pendulum_by_its_equations(duration):
    """Position (x, z) at the end by DOP853."""

    def rates(_, y):
        position, velocity = y[:2], y[2:]
        distance = np.hypot(*position)
        return np.concatenate([velocity, -STIFFNESS * (distance - LENGTH) * position / distance + [0.0, -9.81]])

    start = [RELEASE[0], RELEASE[2], 0.0, 0.0]
    return solve_ivp(rates, (0.0, duration), start, method="DOP853", rtol=1e-13, atol=1e-14).y[:2, -1]


@pytest.mark.parametrize("rho_inf", [1.0, 0.9])
def test_order_of_an_elastic_pendulum(rho_inf):
    """hω = 0.1 … 0.0125 for the spring's 10 rad/s."""
    expected = elastic_pendulum_by_its_equations(2.0)

    def error(step):
        results, _ = simulate(elastic_pendulum(), 2.0, step, rho_inf=rho_inf)
        return float(np.abs(results.body("bob").origin[-1, [0, 2]] - expected).max())

    errors, order = orders(error, [1e-2, 5e-3, 2.5e-3, 1.25e-3])
    assert errors[-1] < 1e-3
    np.testing.assert_allclose(order, 2.0, atol=0.05)

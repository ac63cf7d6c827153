"""Every liaison of the library, on every kind of body: A, b and γ against differences along motions that hold it (T7)."""

import numpy as np
import pytest
from motions import derivative, rows_at, second_derivative
from zoo import ENDS, LIAISONS, along, held_state, pair_with

from maggi.bodies.tables import MotionState
from maggi.system.dense import dense_rows

EVERY = pytest.mark.parametrize(
    ("name", "ends"),
    [(name, ends) for name in LIAISONS for ends in ENDS],
    ids=lambda x: x if isinstance(x, str) else "-".join(x),
)
INSTANT = 0.3


def step(name):
    """Of differences: short on splines, whose third derivatives jump, and where a small cam turns quickly."""
    return 1e-3 if "spline" in name or "cam" in name else 0.01


def held(name, ends):
    system = pair_with(name, ends, seed=3)
    for seed in range(10):
        state = held_state(system, seed, INSTANT)
        if state is not None:
            return system, state
    raise AssertionError("no state holds the liaison")


@EVERY
def test_rows_are_the_rates_of_positions(name, ends):
    """Φ̇ = A v + b and Φ̈ = A v̇ + γ along a motion through a state that holds the liaison, for any v̇."""
    system, state = held(name, ends)
    state.vd[:] += np.random.default_rng(5).normal(size=state.vd.size)
    rows = rows_at(system, state, INSTANT)

    def position(dt):
        return rows_at(system, along(system, state, dt), INSTANT + dt).position

    own = system.holonomic
    assert np.abs(rows.position).max() < 1e-12
    np.testing.assert_allclose(rows.velocity[own], derivative(position, h=step(name))[own], atol=1e-9)
    bend = second_derivative(position, h=2.0 * step(name))
    np.testing.assert_allclose(rows.acceleration[own], bend[own], atol=2e-7)


@EVERY
def test_accelerations_are_the_rates_of_velocities(name, ends):
    """A v̇ + γ is the rate of A v + b, rows without position included."""
    system, state = held(name, ends)
    state.vd[:] += np.random.default_rng(6).normal(size=state.vd.size)
    rows = rows_at(system, state, INSTANT)
    rate = derivative(lambda dt: rows_at(system, along(system, state, dt), INSTANT + dt).velocity, h=step(name))
    np.testing.assert_allclose(rows.acceleration, rate, atol=2e-8)


@EVERY
def test_coefficients_are_those_of_the_velocities(name, ends):
    """A v + b = the value of each row for any velocities, with one A and b at one position."""
    system, state = held(name, ends)
    rng = np.random.default_rng(10)
    A = dense_rows(system, state, INSTANT).A
    for _ in range(3):
        moving = MotionState(*state[:3], rng.normal(size=state.v.size), rng.normal(size=state.v.size))
        rows = rows_at(system, moving, INSTANT)
        np.testing.assert_allclose(A @ moving.v + rows.rhs, rows.velocity, atol=1e-12)
        still = MotionState(*state[:3], moving.v, np.zeros(state.v.size))
        gamma = rows_at(system, still, INSTANT).acceleration
        np.testing.assert_allclose(A @ moving.vd + gamma, rows.acceleration, atol=1e-11)

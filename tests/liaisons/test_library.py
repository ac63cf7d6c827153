"""Every liaison of the library, on every kind of body: A, b and γ against differences along motions that hold it (T7)."""

from dataclasses import replace

import numpy as np
import pytest
from liaison_library import LIAISONS
from motions import derivative, rows_at, second_derivative
from random_states import state_in_motion
from workshop import Workshop

from maggi.bodies.attachment_kernels import move
from maggi.bodies.motions import prescribe
from maggi.model import GROUND
from maggi.stepping.allocate import copy_motion
from maggi.system.build import build_system
from maggi.system.dense import dense_rows

T = 0.1
STEP = 2e-3  # s, of differences: small cams turn quickly, and third derivatives of splines jump
EVERY = pytest.mark.parametrize("kind", LIAISONS)
ENDS = pytest.mark.parametrize(
    "ends",
    [("rigid", "rigid"), ("ground", "rigid"), ("given", "rigid"), ("ritz", "rigid"), ("rigid", "box")],
    ids="-".join,
)


def held(kind, ends, seed=3):
    """A system of one liaison between two bodies, in motion at time T, with any accelerations."""
    rng = np.random.default_rng(seed)
    shop = Workshop(rng)
    first, second = (GROUND if end == "ground" else getattr(shop, end)() for end in ends)
    LIAISONS[kind](shop, first, second)
    system = build_system(shop.model())
    state = state_in_motion(system, rng, T)
    assert state is not None
    given = state.vd.copy()
    state.vd[:] = rng.normal(size=state.vd.size)
    for b in np.flatnonzero(system.bodies.floating == 0)[1:]:
        frame = slice(system.bodies.offset[b], system.bodies.offset[b] + 6)
        state.vd[frame] = given[frame]
    return system, state


def along(system, state, dt):
    """The state a little later (or earlier) on a curve with these velocities and accelerations."""
    later = copy_motion(state)
    move(system.bodies, state, dt * state.v + 0.5 * dt * dt * state.vd, later)
    later.v[:] = state.v + dt * state.vd
    prescribe(system.motions, system.bodies, T + dt, later)
    return later


@EVERY
@ENDS
def test_rows_are_rates(kind, ends):
    """Φ̇ = A v + b and Φ̈ = A v̇ + γ through a state that holds the liaison, for any v̇; and A v̇ + γ is the rate of A v + b."""
    system, state = held(kind, ends)
    rows = rows_at(system, state, T)
    own = system.holonomic
    assert np.abs(rows.position).max(initial=0.0) < 1e-11

    def at(dt):
        return rows_at(system, along(system, state, dt), T + dt)

    fast = 1.0 + np.abs(state.v).max() ** 3
    np.testing.assert_allclose(
        rows.velocity[own], derivative(lambda dt: at(dt).position, h=STEP)[own], atol=1e-9 * fast
    )
    bend = second_derivative(lambda dt: at(dt).position, h=2.0 * STEP)
    np.testing.assert_allclose(rows.acceleration[own], bend[own], atol=1e-6 * fast)
    rate = derivative(lambda dt: at(dt).velocity, h=STEP)
    np.testing.assert_allclose(rows.acceleration, rate, atol=1e-8 * fast)


@EVERY
@ENDS
def test_coefficients_are_those_of_the_velocities(kind, ends):
    """A v + b is the value of each row for any velocities, and A v̇ + γ for any accelerations, at one position."""
    system, state = held(kind, ends)
    rng = np.random.default_rng(10)
    A = dense_rows(system, state, T).A
    for _ in range(3):
        moving = replace(state, v=rng.normal(size=state.v.size), vd=rng.normal(size=state.v.size))
        rows = rows_at(system, moving, T)
        np.testing.assert_allclose(A @ moving.v + rows.rhs, rows.velocity, atol=1e-12)
        still = replace(state, v=moving.v, vd=np.zeros(state.v.size))
        gamma = rows_at(system, still, T).acceleration
        np.testing.assert_allclose(A @ moving.vd + gamma, rows.acceleration, atol=1e-11)

"""Charts and the equations on them: liaisons to round-off, rates that are derivatives, accelerations of Maggi (T7–T11)."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_mechanisms import Features, random_model
from random_states import state_in_motion

from maggi.analyses.ode import Ode
from maggi.model.errors import ModelError
from maggi.projection.maggi import accelerations, project
from maggi.system.build import build_system
from maggi.system.dense import dense_mass, dense_rows, velocity_scale

T = 0.1
STRATEGIES = ("lu", "qr", "svd", "tree")


def random_ode(seed, features, strategy):
    """The equations of a random mechanism in motion, or None where it has no state or a force on a massless freedom."""
    rng = np.random.default_rng(seed)
    system = build_system(random_model(rng, features))
    motion = state_in_motion(system, rng, T)
    if motion is None:
        return None
    try:
        return Ode(system, motion, T, strategy=strategy), motion
    except ModelError:  # a force on a freedom without inertia
        return None


def rates_of_motion(system, before, after, dt):
    """Derivatives of origins, rotations, e and v by central differences, from states before and after by dt."""
    return [(b - a) / (2.0 * dt) for a, b in list(zip(before, after, strict=True))[:4]]


@settings(max_examples=20, suppress_health_check=list(HealthCheck))
@given(
    st.integers(0, 2**32 - 1),
    st.builds(Features, *(st.booleans() for _ in range(5))),
    st.sampled_from(STRATEGIES),
)
def test_random_mechanisms(seed, features, strategy):
    """At the start and somewhere else in the chart, every liaison of the library and prescribed frames among them."""
    made = random_ode(seed, features, strategy)
    if made is None:
        return
    ode, motion = made
    system, y = ode.system, ode.y0
    state = ode.state(T, y)
    for name in ("origin", "rotation", "e", "v"):
        np.testing.assert_allclose(getattr(state, name), getattr(motion, name), atol=1e-9)
    rng = np.random.default_rng(seed)
    y = y + 0.02 * ode.typical(y) * rng.normal(size=len(y))
    if not np.isfinite(ode.f(T, y)).all():
        return  # a small part of a mechanism has a small chart
    state = ode.state(T, y)
    rows = dense_rows(system, state, T, ode.coordinates(T, y))
    scale = velocity_scale(system)
    size = np.linalg.norm(rows.A / scale, axis=1) * system.size + 1.0
    fast = 1.0 + np.abs(scale * state.v).max(initial=0.0)
    hard = fast**2 + np.abs(scale * state.vd).max(initial=0.0)
    assert np.abs(np.where(system.holonomic, rows.position, 0.0) / size).max(initial=0.0) < 1e-11
    assert np.abs(rows.velocity / size).max(initial=0.0) < 1e-11 * fast
    assert np.abs(rows.acceleration / size).max(initial=0.0) < 1e-9 * hard
    # the state moves as y does: t and y are moved together along (1, f)
    f, dt = ode.f(T, y), 1e-6 / (1.0 + np.abs(ode.f(T, y) / ode.typical(y)).max(initial=0.0))
    origin, rotation, e, v = rates_of_motion(system, ode.state(T - dt, y - dt * f), ode.state(T + dt, y + dt * f), dt)
    for b in range(1, system.bodies.kind.size):
        o, end = system.bodies.offset[b], system.bodies.offset[b + 1]
        R = state.rotation[b]
        spin = R.T @ rotation[b]
        found = [*(R.T @ origin[b]), spin[2, 1], spin[0, 2], spin[1, 0], *e[o + 6 : end]]
        np.testing.assert_allclose(found, state.v[o:end], atol=1e-6 * hard)
    np.testing.assert_allclose(v, state.vd, atol=1e-5 * hard * fast)


@settings(max_examples=15, suppress_health_check=list(HealthCheck))
@given(st.integers(0, 2**32 - 1), st.builds(Features, *(st.booleans() for _ in range(5))))
def test_accelerations_are_those_of_the_dense_projection(seed, features):
    """`maggi.accelerations` on the whole mechanism, with the forces that the compiled equations put in."""
    made = random_ode(seed, features, None)
    if made is None or made[0].evaluation.state.massless[0] or made[0].system.inertia_floor.any():
        return
    ode, _ = made
    system, unknown = ode.system, ode.chart.table.unknown
    state = ode.at(T, ode.y0).state
    M = dense_mass(system, state.motion)[np.ix_(unknown, unknown)]
    projection = project(state.A, velocity_scale(system)[unknown])
    expected = accelerations(projection, M, state.forces, state.gamma)
    np.testing.assert_allclose(state.vd, expected, atol=1e-7 * (1.0 + np.abs(expected).max(initial=0.0)))
    residual = state.A.T @ ode.liaison_forces(T, ode.y0)
    np.testing.assert_allclose(residual, state.forces - M @ state.vd, atol=1e-7 * (1.0 + np.abs(state.forces).max()))


def test_interpolation_across_a_singular_position_is_exact_for_polynomials():
    from maggi.projection.chart import ACROSS

    nodes = np.array([1, 2, 3, 4])
    for power in range(8):
        value = sum(w * (k**power + (-k) ** power) for k, w in zip(nodes, ACROSS, strict=True))
        assert value == pytest.approx(1.0 if power == 0 else 0.0, abs=1e-11)

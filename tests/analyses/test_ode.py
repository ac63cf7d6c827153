"""The ordinary differential equation of a mechanism, for any integrator: one chart, many charts, mistakes."""

import numpy as np
import pytest
from linkages import four_bar
from motions import mesh_body
from reference_models import disc_in_a_circle, four_bars, pendulum
from scipy.integrate import solve_ivp

import maggi
from maggi.analyses.ode import Ode
from maggi.bodies.small_bodies import SmallBodyEnergies
from maggi.model import End, Model, ModelError, PointLoad, RigidBody, SimulationError, expression
from maggi.system.build import build_system
from maggi.system.dense import dense_rows

STRATEGIES = ("lu", "qr", "svd", "tree")


def energy(equations, state):
    """Kinetic and gravity energy (J)."""
    system = equations.system
    at = state.origin[None], state.rotation[None], state.e[None], state.v[None]
    energies = SmallBodyEnergies(system.bodies, system.forces.gravity).at(*at)[0]
    return energies[0] + energies[2]


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_closed_loop_by_scipy(strategy):
    """Plain `solve_ivp` on f: energy and liaisons are kept, and all strategies give the same motion."""
    equations = maggi.ode(four_bar(), strategy=strategy)
    assert (equations.freedoms, len(equations.y0)) == (1, 2)
    start = energy(equations, equations.state(0.0, equations.y0))
    solution = solve_ivp(equations.f, (0.0, 0.8), equations.y0, method="DOP853", rtol=1e-11, atol=1e-12)
    state = equations.state(0.8, solution.y[:, -1])
    assert energy(equations, state) == pytest.approx(start, rel=1e-11)
    rows = dense_rows(equations.system, state, 0.8)
    assert max(np.abs(rows.position).max(), np.abs(rows.velocity).max(), np.abs(rows.acceleration).max()) < 1e-13
    reference = maggi.ode(four_bar()).solve((0.0, 0.8), rtol=1e-12, t_eval=[0.8])
    np.testing.assert_allclose(state.origin, reference.origin[-1], atol=1e-9)


def test_a_rolling_disc_by_scipy():
    """Nonholonomic: five free positions, three freedoms; half a radian of rolling within one chart."""
    equations = maggi.ode(disc_in_a_circle())
    assert (equations.chart.position_count, equations.freedoms) == (5, 3)
    solution = solve_ivp(equations.f, (0.0, 0.2), equations.y0, method="DOP853", rtol=1e-11, atol=1e-12)
    state = equations.state(0.2, solution.y[:, -1])
    radius, turn = 1.0294384689899563, 1.5 * 0.2
    start = equations.state(0.0, equations.y0).origin[1]
    moved = np.linalg.norm(state.origin[1] - start)
    assert moved == pytest.approx(2.0 * radius * np.sin(turn / 2.0), rel=1e-10)
    assert state.origin[1, 2] == pytest.approx(start[2], abs=1e-11)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_new_chart_changes_nothing(strategy):
    """The same positions, velocities, accelerations and joint coordinates before and after, and at both ends f = y'."""
    equations = maggi.ode(disc_in_a_circle() if strategy == "lu" else four_bars(2), strategy=strategy)
    y = equations.y0 + 0.2 * equations.f(0.0, equations.y0)
    before, coordinates = equations.state(0.2, y), equations.coordinates(0.2, y)
    fresh = equations.reparametrise(0.2, y)
    np.testing.assert_array_equal(fresh[: equations.chart.position_count], 0.0)
    for part, expected in zip(equations.state(0.2, fresh), before, strict=True):
        np.testing.assert_allclose(part, expected, atol=1e-12)
    np.testing.assert_allclose(equations.coordinates(0.2, fresh), coordinates, atol=1e-13)
    assert equations.event(0.2, fresh) == pytest.approx(1.0, abs=1e-9)


def test_the_event_falls_on_the_way_out_of_a_chart():
    equations = maggi.ode(pendulum(), strategy="tree")
    angles = np.linspace(0.0, 2.0, 21)
    values = [equations.event(0.0, np.array([angle, 0.0])) for angle in angles]
    np.testing.assert_allclose(values, 1.0 - angles / 1.5, atol=1e-12)


def test_charts_follow_each_other():
    """The pendulum swings 5.2 rad to and fro in several charts; by t_eval or at the steps' ends, the same motion."""
    at_steps = maggi.ode(pendulum()).solve((0.0, 2.0), rtol=1e-11)
    assert at_steps.charts > 1
    assert len(at_steps.t) == at_steps.steps + 1
    wanted = at_steps.t[1::3] + 1e-3
    wanted = wanted[wanted <= 2.0]
    given_times = maggi.ode(pendulum()).solve((0.0, 2.0), rtol=1e-11, t_eval=wanted)
    np.testing.assert_array_equal(given_times.t, wanted)
    np.testing.assert_allclose(np.linalg.norm(given_times.origin[:, 1], axis=1), 1.0, atol=1e-14)
    again = maggi.ode(pendulum()).solve((0.0, wanted[-1]), rtol=1e-12, t_eval=wanted)
    np.testing.assert_allclose(given_times.origin, again.origin, atol=1e-8)
    angle = np.unwrap(np.arctan2(given_times.origin[:, 1, 1], given_times.origin[:, 1, 0]))
    np.testing.assert_allclose(np.diff(given_times.coordinates[:, 0]), np.diff(angle), atol=1e-12)


@pytest.mark.parametrize("method", ["RK45", "Radau", "BDF", "LSODA"])
def test_other_integrators(method):
    end = maggi.ode(four_bar()).solve((0.0, 0.5), method=method, rtol=1e-7, t_eval=[0.5])
    reference = maggi.ode(four_bar()).solve((0.0, 0.5), rtol=1e-12, t_eval=[0.5])
    np.testing.assert_allclose(end.origin, reference.origin, atol=2e-5)


def test_jacobian_orders():
    """Differences of order 2 and 4 against order 6, about a moving state of a nonholonomic mechanism."""
    equations = maggi.ode(disc_in_a_circle())
    exact = equations.jacobian(0.0, equations.y0, order=6)
    size = np.abs(exact).max()
    for order, error in ((2, 1e-8), (4, 1e-10)):
        np.testing.assert_allclose(equations.jacobian(0.0, equations.y0, order), exact, atol=error * size)


def test_outside_a_chart_f_is_nan():
    """A four-bar's coupler cannot turn by 3 rad: NaN for integrators, a message for who asks for the state."""
    equations = maggi.ode(four_bar())
    y = np.array([1e3, 0.0])
    assert np.isnan(equations.f(0.0, y)).all()
    with pytest.raises(ValueError, match="does not reach the state at t = 0 s"):
        equations.state(0.0, y)
    assert np.isfinite(equations.f(0.0, equations.y0)).all()


def test_point_masses_do_not_spin():
    """A free point mass has three freedoms with inertia; the others keep their velocity."""
    model = Model({"m": RigidBody(2.0)}, gravity=(0.0, 0.0, -9.81))
    equations = maggi.ode(model)
    f = equations.f(0.0, equations.y0)
    np.testing.assert_allclose(np.sort(f[6:]), [-9.81, 0, 0, 0, 0, 0], atol=1e-14)


def test_a_force_on_a_freedom_without_inertia_is_refused():
    torque = PointLoad(End("m"), "torque", (expression(1.0), expression(0.0), expression(0.0)))
    with pytest.raises(ModelError, match="without inertia: m"):
        maggi.ode(Model({"m": RigidBody(2.0)}, forces={"torque": torque}))


def test_meshed_bodies_are_refused():
    model = Model({"beam": mesh_body(np.random.default_rng(0))})
    with pytest.raises(ModelError, match="'beam' has too many freedoms") as error:
        Ode(build_system(model))
    assert error.value.path == "bodies.beam"


def test_a_motion_that_ends_is_told():
    """A force that becomes infinite."""
    load = PointLoad(End("m"), "force", (expression("1/(1 - t)**2"), expression(0.0), expression(0.0)))
    body = RigidBody(1.0, inertia=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    with pytest.raises(SimulationError, match="cannot be continued beyond t = "):
        maggi.ode(Model({"m": body}, forces={"push": load})).solve((0.0, 2.0), "RK45", rtol=1e-4)

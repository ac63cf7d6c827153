"""Redundant joints: a four-bar linkage in space, with more rows than rank, against one without and against its own equation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from transient_runs import extrapolated, joint, simulate

from maggi.model import Model, Pose, RigidBody, Velocity

LENGTHS = {"crank": 0.2, "coupler": 0.5, "rocker": 0.4}  # m; the ground link is 0.5 m along x
MASSES = {"crank": 0.4, "coupler": 1.0, "rocker": 0.8}  # kg, uniform bars
GROUND, START, SPEED = 0.5, 1.2, 6.0  # m, rad, rad/s
GRAVITY = np.array([0.0, -9.81])


def unit(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def pivots():
    """The hinges ground–crank, crank–coupler, coupler–rocker, ground–rocker at the start, in the plane."""
    one, end = LENGTHS["crank"] * unit(START), np.array([GROUND, 0.0])
    span = end - one
    distance = np.hypot(*span)
    along = (distance**2 + LENGTHS["coupler"] ** 2 - LENGTHS["rocker"] ** 2) / (2 * distance)
    height = np.sqrt(LENGTHS["coupler"] ** 2 - along**2)
    two = one + (along * span + height * np.array([-span[1], span[0]])) / distance
    return np.array([[0.0, 0.0], one, two, end])


def bars():
    """The links with frames on their first hinges (the rocker's on the ground), axes parallel to the global ones."""
    at = pivots()
    bodies = {}
    for name, first, second in (("crank", at[0], at[1]), ("coupler", at[1], at[2]), ("rocker", at[3], at[2])):
        mass, half = MASSES[name], (second - first) / 2
        J = mass * LENGTHS[name] ** 2 / 12
        bodies[name] = RigidBody(
            mass,
            center_of_mass=(*half.tolist(), 0.0),
            inertia=((J / 2, 0.0, 0.0), (0.0, J / 2, 0.0), (0.0, 0.0, J)),
            pose=Pose((*first.tolist(), 0.0)),
            velocity=Velocity(angular=(0.0, 0.0, SPEED)) if name == "crank" else Velocity(),
        )
    return bodies


def crank_angle(times):
    """The crank's turn by the planar equations in three link angles with two closure conditions, DOP853."""
    at = pivots()
    directions = (at[1] - at[0], at[2] - at[1], at[2] - at[3])
    start = np.array([np.arctan2(d[1], d[0]) for d in directions])
    a, b, c = LENGTHS.values()
    mass = list(MASSES.values())
    # a centre of mass, and the closing vector, is Σ arm_j e(θ_j) + const
    arms = np.array([[a / 2, 0, 0], [a, b / 2, 0], [0, 0, c / 2]])
    closing = np.array([a, b, -c])
    J = np.diag([m * length**2 / 12 for m, length in zip(mass, (a, b, c), strict=True)])

    def partials(arm, theta):
        return arm * np.array([-np.sin(theta), np.cos(theta)]), -arm * np.array([np.cos(theta), np.sin(theta)])

    def rates(_, y):
        theta, w = y[:3], y[3:]
        M, f = J.copy(), np.zeros(3)
        for m, arm in zip(mass, arms, strict=True):
            first, second = partials(arm, theta)
            M += m * first.T @ first
            f += m * first.T @ (GRAVITY - second @ w**2)
        first, second = partials(closing, theta)
        matrix = np.block([[M, first.T], [first, np.zeros((2, 2))]])
        return np.concatenate([w, np.linalg.solve(matrix, np.concatenate([f, -second @ w**2]))[:3]])

    first, _ = partials(closing, start)
    others = np.linalg.solve(first[:, 1:], -first[:, 0] * SPEED)
    initial = np.concatenate([start, [SPEED], others])
    solution = solve_ivp(rates, (0.0, times[-1]), initial, method="DOP853", t_eval=times, rtol=1e-12, atol=1e-13)
    return solution.y[0] - start[0]


def run(kinds, step=2.5e-4):
    at, z = pivots(), (0.0, 0.0, 1.0)
    axes = [{} if kind == "spherical" else {"axis": z} for kind in kinds]
    joints = {
        "a": joint("revolute", "ground", "crank", at=(*at[0], 0.0), axis=z),
        "b": joint(kinds[0], "crank", "coupler", at=(*at[1], 0.0), **axes[0]),
        "c": joint(kinds[1], "coupler", "rocker", at=(*at[2], 0.0), **axes[1]),
        "d": joint("revolute", "ground", "rocker", at=(*at[3], 0.0), axis=z),
    }
    return simulate(Model(bars(), joints, gravity=(*GRAVITY, 0.0)), 1.0, step, rows=20)


@pytest.mark.parametrize("kinds", [("revolute", "revolute"), ("spherical", "cylindrical")], ids=["20 rows", "17 rows"])
def test_four_bar_linkage(kinds):
    """Rank 17 either way; the same motion to the step's error, hinges closed as the stored poses alone show."""
    results, summary = run(kinds)
    assert (summary.residuals < 1e-10).all()
    bodies, at = {name: results.body(name) for name in LENGTHS}, pivots()
    for one, two, point in (("crank", "coupler", at[1]), ("coupler", "rocker", at[2])):
        ends = [
            bodies[name].origin + bodies[name].rotation @ np.append(point - bodies[name].origin[0, :2], 0.0)
            for name in (one, two)
        ]
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-12)
    R = bodies["crank"].rotation
    turned = np.unwrap(np.arctan2(R[:, 1, 0], R[:, 0, 0]))
    assert np.ptp(turned) > 2 * np.pi
    # 3e-5 rad of second-order error in two turns of the crank, gone by extrapolation
    coarse, _ = run(kinds, 5e-4)
    R = coarse.body("crank").rotation
    before = np.unwrap(np.arctan2(R[:, 1, 0], R[:, 0, 0]))
    balance = extrapolated([coarse.energy.balance, results.energy.balance], [1, 2])
    assert np.abs(balance).max() < 1e-6 * np.ptp(results.energy.kinetic)
    np.testing.assert_allclose(extrapolated([before, turned], [1, 2]), crank_angle(results.time), atol=1e-6)


def test_redundant_rows_do_not_change_motion_or_forces_in_the_plane():
    # the coupler hangs on the crank in both, so that they step in the same coordinates
    redundant, _ = run(("revolute", "revolute"))
    minimal, _ = run(("cylindrical", "spherical"))
    for name in LENGTHS:
        np.testing.assert_allclose(redundant.body(name).origin, minimal.body(name).origin, atol=1e-10)
        np.testing.assert_allclose(redundant.body(name).rotation, minimal.body(name).rotation, atol=1e-10)
    for name in "abcd":
        force = minimal.joint(name).force
        np.testing.assert_allclose(redundant.joint(name).force, force, atol=1e-8 * np.abs(force).max())

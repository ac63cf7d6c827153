"""Coordinates near a base state: positions, and rates against differences of them."""

import numpy as np
import pytest
from motions import Motion, axial, derivative, rigid_body, ritz_body

from maggi.model.model import Model
from maggi.projection.tangent import displace, on_coordinates, rates_of_coordinates
from maggi.stepping.allocate import copy_motion
from maggi.system.build import build_system


def system_of_two():
    rng = np.random.default_rng(1)
    return build_system(Model({"rigid": rigid_body(rng), "ritz": ritz_body(rng, 3)}))


@pytest.mark.parametrize("size", [0.0, 0.3, 1.0, 2.0])
def test_rates_belong_to_the_velocities(size):
    """x(t) → pose → twist by differences; the inverse gives ẋ again, and rows on v become rows on ẋ."""
    system = system_of_two()
    base = Motion(system, 2).at_rest(0.3)
    rng = np.random.default_rng(4)
    n, b = system.coordinates, system.bodies.kind.size
    x, xd = size * rng.normal(size=n), rng.normal(size=n)
    trial, turns = copy_motion(base), np.zeros((b, 3, 3))

    def pose(t):
        displace(system.bodies, base, x + t * xd, turns, trial)
        return trial.origin.copy(), trial.rotation.copy(), trial.e.copy()

    v = np.zeros(n)
    for k in range(1, b):
        o, e = system.bodies.offset[k], system.bodies.offset[k + 1]
        R = pose(0.0)[1][k]
        v[o : o + 3] = R.T @ derivative(lambda t, k=k: pose(t)[0][k], 0.0)
        v[o + 3 : o + 6] = axial(R.T @ derivative(lambda t, k=k: pose(t)[1][k], 0.0))
        v[o + 6 : e] = derivative(lambda t: pose(t)[2], 0.0)[o + 6 : e]
    pose(0.0)
    found = np.empty(n)
    rates_of_coordinates(system.bodies, x, turns, v, found)
    np.testing.assert_allclose(found, xd, atol=1e-8)
    rows = rng.normal(size=(4, n))
    expected = rows @ v
    on_coordinates(system.bodies, np.arange(n), x, turns, rows)
    np.testing.assert_allclose(rows @ xd, expected, atol=1e-8)


def test_no_displacement_is_the_base():
    system = system_of_two()
    base = Motion(system, 2).at_rest(0.3)
    trial, turns = copy_motion(base), np.zeros((system.bodies.kind.size, 3, 3))
    trial.origin[1:] = 0.0
    displace(system.bodies, base, np.zeros(system.coordinates), turns, trial)
    for name in ("origin", "rotation", "e"):
        np.testing.assert_array_equal(getattr(trial, name), getattr(base, name))

"""The example of computed-torque control: errors with the right controller and with the wrong one."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import maggi

FOLDER = Path(__file__).parents[2] / "examples" / "two_link_arm"


@pytest.fixture(scope="module")
def arm():
    spec = importlib.util.spec_from_file_location("two_link_arm", FOLDER / "two_link_arm.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_tracking_errors(arm):
    """Feedback linearisation tracks to the integrator's tolerance, rigid or elastic; a rigid controller does not."""
    model = maggi.load(FOLDER / "two_link_arm.yml")
    _, errors, bending = arm.simulate(arm.build_rigid(model), False)
    assert np.abs(errors).max() < 1e-6
    assert bending.max() < 1e-9
    _, errors, bending = arm.simulate(model, False, duration=0.25)
    assert np.abs(errors).max() < 1e-6
    # the weight of motor, load and links on two cantilevers, by beam theory, before anything moves
    assert bending[0] == pytest.approx(arm_sag(), rel=0.03)
    _, errors, _ = arm.simulate(model, True, duration=0.25)
    assert 1e-4 < np.abs(errors).max() < 1e-2


def arm_sag():
    """Tip deflection (m) of the horizontal arm under its weight: Euler–Bernoulli, clamped at the shoulder."""
    E, g, rho = 70e9, 9.81, 2700.0
    x = np.linspace(0.0, 1.4, 14001)
    upper = x < 0.8
    inertia = np.where(upper, 0.04 * 0.012**3, 0.03 * 0.008**3) / 12.0
    line = rho * g * np.where(upper, 0.04 * 0.012, 0.03 * 0.008)
    dx = x[1] - x[0]
    beyond = lambda load: np.cumsum(load[::-1])[::-1] * dx  # noqa: E731
    shear = beyond(line) + g * (0.4 + 0.5 * upper)
    moment = beyond(shear)
    slope = np.cumsum(moment / (E * inertia)) * dx
    return float(np.sum(slope) * dx)

"""An elastic rod made stiffer and stiffer tends to the rigid slider-crank, whose motion and forces have a closed form."""

import numpy as np
import pytest
from elastic_models import STEEL, simulate, slider_crank

from maggi.model import Material, Simulation

CRANK, ROD, SPEED = 0.075, 0.3, 150.0
PISTON_MASS, ROD_MASS, SIDE = 0.8, 7850.0 * 0.02**2 * 0.3, 0.02
GRAVITY = 9.81


def analytic(t):
    """Piston position, and the forces (x, z) of the rod on the piston and of the crank on the rod, (n,) and (n, 2)."""
    phi = SPEED * t
    # rod's inclination ψ to the x axis: the crank pin is at (R cos φ, −R sin φ) for a positive turn about y
    sine = CRANK / ROD * np.sin(phi)
    psi = np.arcsin(sine)
    rate = SPEED * CRANK / ROD * np.cos(phi) / np.cos(psi)
    acceleration = (rate**2 - SPEED**2) * np.tan(psi)
    position = CRANK * np.cos(phi) + ROD * np.cos(psi)
    piston = -CRANK * SPEED**2 * np.cos(phi) - ROD * (acceleration * np.sin(psi) + rate**2 * np.cos(psi))
    pin = -CRANK * SPEED**2 * np.column_stack([np.cos(phi), -np.sin(phi)])
    centre = 0.5 * (pin + np.column_stack([piston, np.zeros_like(t)]))
    inertia = ROD_MASS * (ROD**2 + SIDE**2) / 12.0
    along = PISTON_MASS * piston
    # moment of the rod about its crank pin; the end is at ROD (cos ψ, sin ψ), angles counted from x to z
    arm = ROD * np.column_stack([np.cos(psi), np.sin(psi)])
    force = ROD_MASS * (centre + [0.0, GRAVITY])
    moment = inertia * acceleration + 0.5 * (arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])
    # −(force on piston) acts on the rod's end: moment = arm × (−F)
    across = (arm[:, 1] * along - moment) / arm[:, 0]
    on_piston = np.column_stack([along, across])
    return position, on_piston, force + on_piston


@pytest.fixture(scope="module")
def runs():
    """Results for Young's modulus 10, 100 and 1000 times that of steel."""
    return {
        factor: simulate(
            slider_crank(
                SPEED,
                Simulation(4e-3, 2e-5, 0.9),
                cells=4,
                material=Material(STEEL.density, factor * STEEL.young, STEEL.poisson),
            )
        )[0]
        for factor in (10, 100, 1000)
    }


def test_positions_tend_to_the_rigid_mechanism(runs):
    """The piston's error is the rod's axial strain: it falls as 1/E, to 1e-8 m of 0.45 m."""
    errors = []
    for results in runs.values():
        position, _, _ = analytic(results.time)
        errors.append(np.abs(results.body("piston").origin[:, 0] - position).max())
    assert errors[-1] < 2e-8
    np.testing.assert_allclose(np.array(errors[:-1]) / np.array(errors[1:]), 10.0, rtol=1e-2)


def test_joint_forces_tend_to_the_rigid_mechanism(runs):
    """At t = 0, in balance: an error of first order in 1/E. Later: within what the step's error leaves of vibrations."""
    errors = []
    for results in runs.values():
        _, on_piston, on_rod = analytic(results.time)
        difference = np.hstack(
            [
                results.joint("wristpin").force[:, [0, 2]] - on_piston,
                results.joint("crankpin").force[:, [0, 2]] - on_rod,
            ]
        )
        errors.append(np.linalg.norm(difference, axis=1) / np.linalg.norm(on_rod[0]))
    starts = np.array([error[0] for error in errors])
    assert starts[-1] < 1e-6
    np.testing.assert_allclose(starts[:-1] / starts[1:], 10.0, rtol=0.05)
    assert errors[-1].max() < 2e-4

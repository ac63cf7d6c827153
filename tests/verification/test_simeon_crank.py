"""CASES C1: a slider-crank with an elastic rod given by shape functions (Simeon 1996; IVP test set "crank")."""

from dataclasses import replace

import numpy as np
import pytest
from transient_runs import extrapolated, simulate

from maggi.analyses.prepare import prepare
from maggi.analyses.snapshot import Snapshots
from maggi.model import Simulation
from maggi.modelfile import read
from simeon_crank import (
    CONSISTENT,
    INTEGRATED,
    PHI2D0,
    Q0,
    QD0,
    SPEED,
    TABULATED,
    X3D0,
    accelerations,
    closed,
    final_positions,
    model,
    motion,
)

# At t = 0.1 s: φ₁, φ₂, x₃, q₁ … q₄ and λ, recomputed by extrapolation in long double from the case's equations
# (CASES C1, 13 digits; they agree with the test set's own reference to the test set's 10).
WITH_TABULATED_CONSTANTS = np.array(
    [
        15,
        -0.3311734988255,
        0.1697373328431,
        1.893192899703e-4,
        2.375751249987e-5,
        -5.323896770748e-6,
        -8.363313278807e-6,
    ]
)
MULTIPLIERS = np.array([-62.32935832768, -163.7920993237, 25.29857947000])
# The same with consistent integrals of the stated shape functions and exact π (CASES C1; two independent integrators).
WITH_CONSISTENT_INTEGRALS = np.array(
    [15, -0.33117343033, 0.16973739583, 1.8930813742e-4, 2.376201180e-5, -5.28102478e-6, -8.30355447e-6]
)

STATES = [
    (0.0, Q0, QD0),
    (1.1, np.array([2e-3, -4e-4, 3e-5, -5e-5]), np.array([0.9, -1.2, 0.02, 0.05])),
    (4.0, np.array([-1e-3, 7e-4, -2e-5, 4e-5]), np.array([-0.3, 0.8, -0.04, 0.01])),
]


def final_multipliers(results):
    """The case's λ at the end: wrist pin force (−λ₂, λ₁) of the rod on the block, motor torque −λ₃ on the crank."""
    pin = results.joint("wristpin").force[-1]
    return np.array([pin[1], -pin[0], -results.joint("motor").torque[-1, 2]])


@pytest.mark.parametrize("case", [TABULATED, CONSISTENT], ids=["tabulated", "integrated"])
@pytest.mark.parametrize(("phi1", "q", "qd"), STATES)
def test_accelerations_and_forces_are_those_of_the_cases_own_equations(case, phi1, q, qd):
    _, phi2d, _, x3d = closed(phi1, q, SPEED, qd)
    described = model(phi1, q, SPEED, qd, phi2d, x3d)
    if case is CONSISTENT:
        given, _ = read(INTEGRATED)
        rod = replace(described.bodies["rod"], terms=given.bodies["rod"].terms, shapes=given.bodies["rod"].shapes)
        described = replace(described, bodies=described.bodies | {"rod": rod})
    stepper, _, notes, _ = prepare(replace(described, simulation=Simulation(1e-3, 1e-6)))
    system, state = stepper.system, stepper.state
    rate = {name: state.now.vd[system.bodies.offset[system.body(name).index] :] for name in described.bodies}
    found = np.array([rate["crank"][5], rate["rod"][5], rate["block"][0], *rate["rod"][6:10]])
    expected, multipliers = accelerations(case, phi1, q, SPEED, qd)
    # the crank's own acceleration is zero; the shape functions' are compared together
    scale = np.array([SPEED**2, SPEED**2, SPEED**2, *np.full(4, np.abs(expected[3:]).max())])
    np.testing.assert_allclose(found / scale, expected / scale, atol=1e-10)
    snapshots = Snapshots(stepper)
    snapshots.take(0)
    torques = dict(zip(described.joints, snapshots.rows(1e-6).torque[0], strict=True))
    assert torques["motor"][2] == pytest.approx(-multipliers[2], rel=1e-9)
    assert not notes


@pytest.mark.slow
def test_tabulated_constants():
    """mescd 8.8 from a single run at h = 1e-6, where hω is 0.02 for the highest mode.

    The longitudinal coordinates carry the step's error (1e-4 relative); extrapolation of three steps leaves 6e-7.
    """
    described = model(0.0, Q0, SPEED, QD0, PHI2D0, X3D0)
    counts = [50_000, 75_000, 100_000]
    runs = [simulate(described, 0.1, 0.1 / count, tolerance=1e-9) for count in counts]
    for _, summary in runs:
        assert summary.restarts == 0
        assert (summary.residuals < 1e-9).all()
        # the printed velocities violate the constraints by 1.2e-8 m/s (CASES C1)
        assert any("initial velocities were changed" in text for text in summary.warnings)
    positions = [final_positions(results) for results, _ in runs]
    error = np.abs(positions[-1] - WITH_TABULATED_CONSTANTS) / (1.0 + np.abs(WITH_TABULATED_CONSTANTS))
    assert error.max() <= 1e-7  # mescd ≥ 7
    best = extrapolated(positions, counts)
    np.testing.assert_allclose(best[3:], WITH_TABULATED_CONSTANTS[3:], rtol=1e-6)
    forces = extrapolated([final_multipliers(results) for results, _ in runs], counts)
    np.testing.assert_allclose(forces, MULTIPLIERS, rtol=5e-6)


@pytest.mark.slow
def test_the_programs_own_integrals_follow_the_equations_for_a_while():
    """0.02 s, against DOP853 on the case's equations with consistent constants; benchmarks/simeon_crank.py goes on to 0.1 s."""
    described, _ = read(INTEGRATED)
    counts = [30_000, 40_000]
    best = extrapolated(
        [final_positions(simulate(described, 0.02, 0.02 / count, tolerance=1e-9)[0]) for count in counts], counts
    )
    expected = motion(CONSISTENT, np.array([0.02]))[0]
    np.testing.assert_allclose(best[:3], expected[:3], rtol=1e-9)
    np.testing.assert_allclose(best[3:], expected[3:], rtol=1e-6)


@pytest.mark.slow
def test_the_equations_written_here_give_the_reference():
    """What the test above compares with goes on to the published numbers: DOP853 to 2e-8."""
    found = motion(CONSISTENT, np.array([0.1]))[0]
    np.testing.assert_allclose(found, WITH_CONSISTENT_INTEGRALS, rtol=1e-7)

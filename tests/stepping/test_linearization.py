"""Rows that have long depended on others are left out of the step's factor: nothing else changes, and they come back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linkages import four_bar

from maggi.analyses.prepare import prepare
from maggi.analyses.snapshot import Snapshots
from maggi.model.bodies import RigidBody
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.stepping.linearization import BETWEEN, STEADILY, UNMOVED
from maggi.stepping.stepper import Stepper
from maggi.stepping.tables import LOOSE, SINE, STEADY

STEP, STEPS = 1e-3, 120
REDUNDANT = 3  # of the five rows of the hinge that closes a plane loop


def start() -> Stepper:
    """A four-bar of revolutes in space, released."""
    model = replace(four_bar(), gravity=(1.0, 0.5, -9.81), simulation=Simulation(1.0, STEP, tolerance=1e-11))
    stepper, _, _, _ = prepare(model)
    stepper.set_step(STEP)
    return stepper


def run(*, whole: bool) -> Stepper:
    stepper = start()
    for k in range(STEPS):
        if whole:
            stepper.work.flags[STEADY] = 0  # so that all rows are looked at in every step
        assert stepper.advance(k * STEP, 1) == 1
    return stepper


def test_steps_are_the_same_with_and_without_dependent_rows() -> None:
    short, whole = run(whole=False), run(whole=True)
    assert (whole.work.pivot > 0.0).sum() == (short.work.pivot > 0.0).sum() == short.work.kept.size - REDUNDANT
    for one, other in zip(short.state.now, whole.state.now, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-10 * max(1.0, float(np.abs(other).max(initial=0.0))))
    forces = []
    for stepper in (short, whole):
        snapshots = Snapshots(stepper)
        snapshots.take(STEPS)
        forces.append(snapshots.rows(STEP).force)
    np.testing.assert_allclose(*forces, rtol=0, atol=1e-7)


def test_rows_are_left_out_after_a_while_and_looked_at_now_and_then() -> None:
    stepper = start()
    seen = []
    for k in range(3 * (STEADILY + BETWEEN)):
        assert stepper.advance(k * STEP, 1) == 1
        seen.append(int(stepper.work.flags[STEADY]))
    assert max(seen) == STEADILY + BETWEEN - 1
    assert seen[:STEADILY] == sorted(seen[:STEADILY])
    assert seen.count(STEADILY - 1) + seen.count(STEADILY) >= 2  # from the last without them to the next look
    assert stepper.work.kept.sum() == stepper.work.kept.size - REDUNDANT


def test_rows_that_no_longer_hold_by_themselves_come_back() -> None:
    stepper = start()
    assert stepper.advance(0.0, 2 * STEADILY) == 2 * STEADILY
    work = stepper.work
    assert work.flags[STEADY] > STEADILY and work.numbers[LOOSE] <= UNMOVED
    left_out = np.flatnonzero(work.kept == 0)
    # as if the rows left out were others: those that are then kept are not all
    work.kept[:] = 1
    work.kept[(left_out - 1) % work.kept.size] = 0
    work.numbers[LOOSE] = 10.0 * UNMOVED
    assert stepper.advance(2 * STEADILY * STEP, 1) == 1
    assert work.flags[STEADY] == 1
    assert (np.flatnonzero(work.kept == 0) == left_out).all()


def almost_flat(angle: float, masses: tuple[float, float, float]) -> Stepper:
    """A parallelogram of 1 x 2 m whose cranks are at `angle` (rad) to the base, after a step at rest."""
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    corners = np.array([np.zeros(3), along, along + [2.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    names = ("ground", "crank", "coupler", "rocker", "ground")
    bodies = {}
    for k, mass in enumerate(masses):
        rod = corners[k + 1] - corners[k]
        inertia = mass * (rod @ rod) / 12.0 * np.eye(3)
        bodies[names[k + 1]] = RigidBody(mass, tuple(0.5 * rod), tuple(map(tuple, inertia)), Pose(tuple(corners[k])))
    joints = {
        f"j{k}": Joint("revolute", End(names[k]), End(names[k + 1]), at=tuple(corners[k]), axis=(0.0, 0.0, 1.0))
        for k in range(4)
    }
    stepper, _, _, _ = prepare(Model(bodies, joints, simulation=Simulation(1.0, 1e-7)))
    stepper.set_step(1e-7)
    assert stepper.advance(0.0, 1) == 1
    return stepper


@pytest.mark.parametrize("masses", [(1.0, 1e4, 1e-4), (1e-4, 1.0, 1e4), (1e4, 1e-4, 1.0)])
def test_how_close_a_singular_position_is_does_not_depend_on_masses(masses) -> None:
    even, uneven = (almost_flat(1e-3, each) for each in ((1.0, 1.0, 1.0), masses))
    assert even.work.numbers[SINE] < 1e-3
    assert uneven.work.numbers[SINE] == pytest.approx(even.work.numbers[SINE], rel=1e-6, abs=0.0)
    np.testing.assert_array_equal(uneven.work.active, even.work.active)


def test_the_sine_is_in_proportion_to_the_distance_from_a_singular_position() -> None:
    near, far = almost_flat(2e-3, (1.0, 1e4, 1e-4)), almost_flat(4e-3, (1.0, 1e4, 1e-4))
    assert far.work.numbers[SINE] == pytest.approx(2.0 * near.work.numbers[SINE], rel=1e-3, abs=0.0)

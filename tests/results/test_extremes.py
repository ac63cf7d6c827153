"""Extremes of the fake run, whose answers are its formulas."""

import math

import fake_runs
import numpy as np
import pytest

from maggi.results.extremes import deflection_extremes, deflection_history, elastic_bodies, joint_extremes
from maggi.results.memory import MemoryRecorder

ROWS = 401  # 200 rows a turn: the quarter turns are among them


@pytest.fixture(scope="module")
def results():
    recorder = MemoryRecorder()
    fake_runs.record(recorder, ROWS)
    return recorder.results()


def test_joint_extremes(results):
    found = {extreme.name: extreme for extreme in joint_extremes(results)}
    assert list(found) == list(results.joints)
    crankpin = found["crankpin"].force
    assert crankpin.magnitude == pytest.approx(fake_runs.FORCE, rel=1e-12)
    assert crankpin.components == pytest.approx((fake_runs.FORCE, 0.0, 0.0), abs=1e-9)
    assert crankpin.time == 0.0
    motor = found["motor"].torque
    assert motor.magnitude == pytest.approx(12.0, rel=1e-12)
    assert motor.time == pytest.approx(math.pi / 2 / fake_runs.SPEED)
    assert found["crankpin"].torque.magnitude == 0.0


def test_deflection_is_measured_from_the_line_between_the_attachments(results):
    # Bending of a half sine, tilted by a slope that the line between the ends follows.
    (rod,) = deflection_extremes(results)
    assert rod.body == "rod"
    assert rod.ends == ("big_end", "small_end")
    assert rod.deflection == pytest.approx(fake_runs.BENDING, rel=1e-6)
    assert abs(math.sin(fake_runs.SPEED * rod.deflection_time)) == pytest.approx(1.0, abs=1e-12)
    x = np.linspace(0.0, fake_runs.ROD, 33)
    bending = fake_runs.BENDING * np.sin(np.pi * x / fake_runs.ROD) + fake_runs.TILT * x
    section = fake_runs.HALF_HEIGHT * fake_runs.BENDING * np.pi / fake_runs.ROD * np.cos(np.pi * x / fake_runs.ROD)
    assert rod.displacement == pytest.approx(np.hypot(bending, section).max(), rel=1e-12)


def test_deflection_over_time(results):
    history = deflection_history(results, "rod")
    expected = fake_runs.BENDING * np.abs(np.sin(fake_runs.SPEED * history.time))
    assert history.deflection == pytest.approx(expected, rel=1e-5, abs=1e-12)


def test_thinned_history(results):
    history = deflection_history(results, "rod", step=5)
    assert len(history.time) == 81  # every fifth row
    whole = deflection_history(results, "rod")
    assert np.array_equal(history.displacement, whole.displacement[::5])
    assert np.allclose(history.deflection, whole.deflection[::5], atol=1e-15)


def test_without_attachments_there_is_no_deflection():
    recorder = MemoryRecorder(("displacement",))
    fake_runs.record(recorder, 5)
    (rod,) = deflection_extremes(recorder.results())
    assert rod.deflection is None and rod.ends is None
    assert rod.displacement > 0.0
    assert joint_extremes(recorder.results()) == ()


def test_a_run_without_rows():
    recorder = MemoryRecorder()
    recorder.begin(fake_runs.layout(5))
    recorder.end("failed: at once")
    assert joint_extremes(recorder.results()) == ()
    assert deflection_extremes(recorder.results()) == ()
    assert elastic_bodies(recorder.results()) == ("rod",)

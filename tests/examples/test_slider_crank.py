"""The example: liaisons recomputed from the stored motion, closed-form kinematics and forces, and its Python twin."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import maggi
from maggi.analyses.transient import run
from maggi.results.memory import MemoryRecorder

FOLDER = Path(__file__).parents[2] / "examples" / "slider_crank"
R, L = 0.075, 0.300  # crank and rod, m
PISTON = 0.8  # kg
OMEGA = 3000 * 2 * np.pi / 60  # rad/s
SPEED = R * OMEGA  # of the crank pin, m/s
SIZE = 0.4  # about the mechanism's extent, m; smaller than the program's own
EVERY, STEP = 10, 4e-5
Y = np.array([0.0, 1.0, 0.0])


def model_in_python(**options):
    return runpy.run_path(str(FOLDER / "slider_crank.py"))["model"](**options)


@pytest.fixture(scope="module")
def finished():
    """The whole run: results and summary."""
    model = maggi.load(FOLDER / "slider_crank.yml")
    recorder = MemoryRecorder()
    summary = run(model, recorder)
    return recorder.results(), summary


def piston_position(angle):
    """Closed form of the rigid slider-crank: x of the wrist pin (n,)."""
    return R * np.cos(angle) + np.sqrt(L**2 - (R * np.sin(angle)) ** 2)


def piston_acceleration(angle):
    """Its second derivative at constant speed, (n,)."""
    s, c = R * np.sin(angle), R * np.cos(angle)
    root = np.sqrt(L**2 - s**2)
    # x = c + root(s²), with s' = c, c' = −s by the angle
    return OMEGA**2 * (-c - (c**2 - s**2) / root - (s * c) ** 2 / root**3)


def test_the_python_model_is_the_models_files():
    """Entry by entry; only the text that the file is kept with is not there."""
    written, read = model_in_python(), maggi.load(FOLDER / "slider_crank.yml")
    for name in ("title", "gravity", "bodies", "joints", "forces", "outputs", "simulation"):
        assert getattr(written, name) == getattr(read, name), name


def test_the_python_model_is_about_as_long_as_the_file():
    def lines(path):
        text = (line.strip() for line in (FOLDER / path).read_text().splitlines())
        return sum(1 for line in text if line and not line.startswith("#") and set(line) - set("(){}[],"))

    assert lines("slider_crank.py") < 2 * lines("slider_crank.yml")


@pytest.mark.slow
def test_both_give_the_same_results():
    written = maggi.run(model_in_python(duration=20 * STEP))
    read = maggi.run(maggi.load(FOLDER / "slider_crank.yml", [f"simulation.duration={20 * STEP}"]))
    assert len(written.time) == len(read.time) == 3
    for path in ("joints/wristpin/force", "bodies/rod/displacement", "energy/work"):
        expected = read.series(path)  # sums in the factorisation's threads come in any order: 3e-12 was seen
        np.testing.assert_allclose(written.series(path), expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.slow
def test_three_turns_are_run(finished):
    results, summary = finished
    np.testing.assert_allclose(results.time, EVERY * STEP * np.arange(151), atol=1e-15)
    assert results.time[-1] * OMEGA == pytest.approx(3 * 2 * np.pi, rel=1e-12)
    assert summary.steps == 1500
    assert summary.restarts == 0
    assert summary.back_substitutions <= 1.3 * summary.steps
    assert summary.factorisations == 1


@pytest.mark.slow
def test_joints_hold_at_position_level(finished):
    """Points coincide and axes are parallel in the stored attachment poses, to 1e-9 of the mechanism's size (and of 1)."""
    results, _ = finished
    crank, rod, piston = (results.body(name) for name in ("crank", "rod", "piston"))
    for one, other in (
        (crank.attachment("pin"), rod.attachment("big_end")),
        (rod.attachment("small_end"), piston.attachment("pin")),
    ):
        assert np.abs(one.position - other.position).max() <= 1e-9 * SIZE
        assert np.abs(np.cross(one.rotation @ Y, other.rotation @ Y)).max() <= 1e-9
    # bearing at the crank's origin, its axis y; slide along x without any turn
    assert np.abs(crank.origin).max() <= 1e-9 * SIZE
    assert np.abs(crank.rotation @ Y - Y).max() <= 1e-9
    assert np.abs(piston.attachment("pin").position[:, 1:]).max() <= 1e-9 * SIZE
    assert np.abs(piston.rotation - np.eye(3)).max() <= 1e-9
    # the motor: a turn about y takes x to −z
    angle = OMEGA * results.time
    np.testing.assert_allclose(crank.rotation[:, 0, 0], np.cos(angle), atol=1e-9)
    np.testing.assert_allclose(crank.rotation[:, 2, 0], -np.sin(angle), atol=1e-9)
    np.testing.assert_allclose(results.joint("bearing").coordinate[:, 0], angle, atol=1e-9 * angle[-1])


@pytest.mark.slow
def test_joints_hold_at_velocity_level(finished):
    """Velocities of joined points agree, and angular velocities but for the part about the joint's axis."""
    results, _ = finished
    crank, rod, piston = (results.body(name) for name in ("crank", "rod", "piston"))
    for one, other in (
        (crank.attachment("pin"), rod.attachment("big_end")),
        (rod.attachment("small_end"), piston.attachment("pin")),
    ):
        assert np.abs(one.velocity - other.velocity).max() <= 1e-9 * SPEED
        assert np.abs(np.cross(one.angular_velocity - other.angular_velocity, one.rotation @ Y)).max() <= 1e-9 * OMEGA
    pin, slide = crank.attachment("pin"), piston.attachment("pin")
    assert np.abs(pin.angular_velocity - OMEGA * Y).max() <= 1e-9 * OMEGA
    assert np.abs(pin.velocity - np.cross(OMEGA * Y, pin.position)).max() <= 1e-9 * SPEED
    assert np.abs(slide.velocity[:, 1:]).max() <= 1e-9 * SPEED
    assert np.abs(slide.angular_velocity).max() <= 1e-9 * OMEGA


@pytest.mark.slow
def test_reported_residuals(finished):
    """The program's own account, all three levels, agrees that they are small."""
    results, summary = finished
    for name in ("position", "velocity", "acceleration"):
        assert results.series(f"residuals/{name}").max() <= 1e-9
    assert (summary.residuals <= 1e-9).all()


@pytest.mark.slow
def test_stored_velocities_are_the_rates_of_stored_positions(finished):
    """Central differences of fourth order, whose error is (kωΔ)⁴/30 for the k-th harmonic: 8e-6, 1.3e-4, …"""
    results, _ = finished
    for path in ("rod/attachments/small_end", "rod/attachments/big_end", "piston/attachments/pin"):
        x, v = (results.series(f"bodies/{path}/{name}") for name in ("position", "velocity"))
        rate = (8 * (x[3:-1] - x[1:-3]) - (x[4:] - x[:-4])) / (12 * EVERY * STEP)
        assert np.abs(rate - v[2:-2]).max() <= 1e-4 * SPEED


@pytest.mark.slow
def test_piston_follows_the_closed_form(finished):
    """But for the rod's stretch, at most F L / (E A): the outer dead centre pulls with 7.4 kN at the wrist pin and 19 kN at
    the crank pin; two flanges of 5.5 × 24 mm and a web of 7 × 21 mm make A = 411 mm², hence 26 to 66 µm.
    """
    results, _ = finished
    angle = OMEGA * results.time
    x = results.body("piston").attachment("pin").position[:, 0]
    stretch = x - piston_position(angle)
    assert 26e-6 < stretch[0] < 66e-6
    assert stretch[25] < 0.0  # pushed at the inner dead centre
    assert np.abs(stretch).max() <= 66e-6
    v = results.body("piston").attachment("pin").velocity[:, 0]
    acceleration = (8 * (v[3:-1] - v[1:-3]) - (v[4:] - v[:-4])) / (12 * EVERY * STEP)
    peak = R * OMEGA**2 * (1 + R / L)
    np.testing.assert_allclose(acceleration, piston_acceleration(angle[2:-2]), atol=2e-3 * peak)


@pytest.mark.slow
def test_wrist_pin_force_is_the_pistons_inertia(finished):
    """Rod on piston, along x: m a of the rigid mechanism, at its largest m r ω² (1 + r/l) = 7402 N at the dead centre."""
    results, _ = finished
    force = results.joint("wristpin").force
    expected = PISTON * piston_acceleration(OMEGA * results.time)
    peak = PISTON * R * OMEGA**2 * (1 + R / L)
    assert np.abs(expected).max() == pytest.approx(peak, rel=1e-12)
    assert np.linalg.norm(force, axis=1).max() == pytest.approx(peak, rel=2e-3)
    assert np.abs(force[:, 0] - expected).max() <= 2e-3 * peak
    # the pin's other components and the slide's carry gravity and what bends the rod: nothing along y
    assert np.abs(force[:, 1]).max() <= 1e-6 * peak
    weight = PISTON * 9.81
    side = results.joint("cylinder").force[:, 2]
    np.testing.assert_allclose(force[:, 2] + side, weight, atol=1e-6 * peak)


@pytest.mark.slow
def test_energy_closes(finished):
    """To the error of the work's integral over steps, (2ωh)²/12 = 5e-5 of what is exchanged twice a turn."""
    results, summary = finished
    assert summary.energy_balance <= 2e-4
    # the driver does no net work over whole turns but for damping: after three, the mechanism is as at the start
    kinetic = results.energy.kinetic
    assert kinetic[-1] == pytest.approx(kinetic[0], rel=1e-4)
    assert 0.0 < results.energy.dissipated[-1] < 0.01

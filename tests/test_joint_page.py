"""docs/joints.md: its models run, its table counts right, its lines are those of the models, what it states is so."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

import maggi
from maggi.cli.main import main
from maggi.modelfile import json_schema
from maggi.results.results import Results
from maggi.system.build import build_system

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGE = (DOCS / "joints.md").read_text(encoding="utf-8")
MODELS = sorted((DOCS / "joints").glob("*.yml"))
SECTIONS = dict(re.findall(r"^## (\S+)\n(.*?)(?=^##? |\Z)", PAGE, re.DOTALL | re.MULTILINE))
TABLE = {
    kind: (int(rows), int(held), left)
    for kind, rows, held, left in re.findall(
        r"^\| \[`([\w-]+)`\]\(#[\w-]+\) \| (\d) \| (\d) \| ([^|]+) \|", PAGE, re.MULTILINE
    )
}
RELATIONS = ("driver", "gear", "rack", "belt", "coupler")


def of(name: str, *overrides: str) -> maggi.Model:
    return maggi.load(DOCS / "joints" / f"{name}.yml", overrides)


def run(name: str, *overrides: str) -> Results:
    results = maggi.run(of(name, *overrides))
    assert results.status == "complete"
    return results


# the page and the files


def test_all_types_have_a_row_a_section_and_a_model() -> None:
    defs = json_schema()["$defs"]
    names = {
        name for name in defs if name.endswith("Section") and not re.match("Load|SpringDamper|TorsionSpring", name)
    }
    types = [defs[name].get("properties", {}).get("type", {}) for name in names]
    kinds = {kind for one in types for kind in one.get("enum", [one.get("const")])} - {None}
    assert set(TABLE) == set(SECTIONS) == kinds
    assert kinds <= {path.stem for path in MODELS}


@pytest.mark.parametrize("kind", TABLE)
def test_the_table_counts_rows_and_freedoms(kind: str) -> None:
    system = build_system(of(kind))
    rows, held, left = TABLE[kind]
    entry = next(one for one in system.liaison_entries if one.kind == kind)
    assert len(entry.rows) == rows
    assert int(system.holonomic[entry.rows].sum()) == held
    if kind in RELATIONS:
        assert (rows, left) == (1, "one less")
    else:
        assert left == (f"{6 - rows}" if held == rows else f"{6 - rows} ({6 - held})")


@pytest.mark.parametrize("kind", SECTIONS)
def test_sections_show_lines_of_their_models(kind: str) -> None:
    text = SECTIONS[kind]
    models = re.findall(r"\]\((joints/[\w-]+\.yml)\)", text)
    assert f"joints/{kind}.yml" in models
    lines = [line for model in models for line in (DOCS / model).read_text(encoding="utf-8").splitlines()]
    shown = [line for block in re.findall(r"```yaml\n(.*?)```", text, re.DOTALL) for line in block.splitlines()]
    assert shown
    assert {line.strip() for line in shown} <= {line.strip() for line in lines}
    assert "![" in text and f"](pictures/joints/{kind}.png)" in text


@pytest.mark.parametrize("path", sorted((DOCS / "pictures" / "joints").glob("*.png")), ids=lambda path: path.stem)
def test_pictures_are_small(path: Path) -> None:
    assert path.stat().st_size < 25_000
    with Image.open(path) as picture:
        assert picture.width == 480
    assert f"pictures/joints/{path.name}" in PAGE
    assert (DOCS / "joints" / f"{path.stem}.yml").exists()


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_models_are_checked_and_run(path: Path, tmp_path: Path) -> None:
    """By the command line, for 20 steps; no row is redundant."""
    assert f"joints/{path.name}" in PAGE
    model = maggi.load(path)
    audit = maggi.check(model)
    assert audit.problems == () and audit.mobility.redundant == ()
    checked = CliRunner().invoke(main, ["check", str(path)])
    assert checked.exit_code == 0, checked.output
    short = f"simulation.duration={20 * model.simulation.step}"
    ran = CliRunner().invoke(main, ["run", str(path), "-o", str(tmp_path / "run.h5"), "--set", short])
    assert ran.exit_code == 0, ran.output
    with maggi.open(tmp_path / "run.h5") as results:
        assert results.status == "complete" and len(results.time) > 1
        for level in ("position", "velocity", "acceleration"):
            assert getattr(results.residuals, level).max() < 1e-9


# what it says


def test_four_revolutes_repeat_each_other() -> None:
    three = ["joints.rocker_pin={type: revolute, between: [rod.right, rocker.pin], axis: [0, 1, 0]}"]
    three.append("joints.pivot.type=revolute")
    all_revolutes, better = (maggi.check(of("four-bar", *overrides)).mobility for overrides in (three, []))
    assert (all_revolutes.velocities, all_revolutes.rows, len(all_revolutes.redundant)) == (18, 20, 3)
    assert (better.rows, len(better.redundant)) == (17, 0)
    assert all_revolutes.freedoms == better.freedoms == 1


def test_torques_of_lower_pairs() -> None:
    assert np.abs(run("revolute").joint("hinge").torque[:, 1]).max() < 1e-12
    assert np.abs(run("spherical").joint("ball").torque).max() == 0.0
    assert (
        np.abs(run("prismatic").joint("rail").force @ [np.cos(np.radians(25)), 0, -np.sin(np.radians(25))]).max()
        < 1e-12
    )
    thread = run("screw").joint("thread")
    assert thread.force[0, 2] > 1.0
    np.testing.assert_allclose(thread.torque[:, 2], -0.15 / (2 * np.pi) * thread.force[:, 2], rtol=1e-9)
    # right-handed: down by a pitch for a turn about −z
    assert thread.coordinate[-1, 0] < -0.3
    np.testing.assert_allclose(thread.coordinate[:, 0], 0.15 / (2 * np.pi) * thread.coordinate[:, 1], atol=1e-12)


def spin(results: Results, body: str) -> np.ndarray:
    """Angular velocity (n − 2, 3) by central differences of the rotation, second order."""
    rotation = results.body(body).rotation
    turn = np.einsum("nij,nkj->nik", rotation[2:], rotation[:-2])
    vector = 0.5 * np.stack(
        [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1
    )
    sine = np.linalg.norm(vector, axis=1)
    return vector * (np.arcsin(sine) / sine / (results.time[2:] - results.time[:-2]))[:, None]


def test_shafts_bent_by_40_degrees() -> None:
    bend = np.radians(40)
    second = np.array([np.cos(bend), np.sin(bend), 0.0])
    load = "forces={brake: {type: torque, on: output, value: [cos(bend), sin(bend), 0]}}"
    results = run("universal", load)
    ratio = spin(results, "output") @ second / 10.0
    assert (ratio.min(), ratio.max()) == pytest.approx((np.cos(bend), 1 / np.cos(bend)), rel=1e-4)
    # the torque is along the normal of both pins
    pins = results.body("input").rotation[:, :, 2], results.body("output").rotation @ [0.0, 1.0, 0.0]
    for pin in pins:
        start = pin[0]
        assert abs(start @ results.joint("cross").torque[0]) < 1e-12
    results = run("constant-velocity", load)
    np.testing.assert_allclose(spin(results, "output") @ second, 10.0, rtol=1e-4)
    torque = results.joint("cv").torque
    bisector = np.array([1.0, 0.0, 0.0]) + second
    assert np.linalg.norm(np.cross(torque, bisector), axis=1).max() < 1e-9 * np.linalg.norm(torque, axis=1).max()


def test_gears_load_shafts_with_torques_only() -> None:
    results = run("gear")
    # J = 1e-3 + 1.6e-2/4 kg m² under 0.1 N m: 20 rad/s²; the wheel −10 rad/s²
    np.testing.assert_allclose(
        results.joint("teeth").torque, np.tile([0, -0.16, 0], (len(results.time), 1)), atol=1e-12
    )
    for bearing in ("shaft", "output"):
        assert np.abs(results.joint(bearing).force).max() < 1e-12
    results = run("rack")
    force = results.joint("teeth").force
    guide = 0.05 * np.gradient(np.gradient(results.joint("shaft").coordinate[:, 0], results.time), results.time)
    np.testing.assert_allclose(force[5:-5, 0], guide[5:-5], atol=2e-3)  # 1 kg; numerical differences
    # the motor drives the pinion's inertia and, against the teeth's torque of −radius times the force, the rack
    motor = results.joint("motor").torque[:, 1]
    np.testing.assert_allclose(motor[5:-5], (6e-4 / 0.05 * guide + 0.05 * force[:, 0])[5:-5], atol=2e-4)


def test_a_planetary_gear() -> None:
    """Willis: sun : carrier = 1 + ring/sun; the planet's mark ends on a hypocycloid inside the ring."""
    results = run("planetary")
    carrier = results.joint("output").coordinate[:, 0]
    sun = carrier + results.joint("sun_pin").coordinate[:, 0]
    assert carrier[-1] > 1.0
    np.testing.assert_allclose(sun, (1 + 100 / 40) * carrier, atol=1e-12)
    # where the planet touches the ring it stands still: v = ω_c × arm + ω_p × r_p = 0
    planet = carrier + results.joint("planet_pin").coordinate[:, 0]
    np.testing.assert_allclose(0.07 * carrier + 0.03 * planet, 0.0, atol=1e-12)


def test_a_rope_pulls() -> None:
    results = run("distance")
    rope, place = results.joint("rope"), results.body("load").origin
    along = np.einsum("ni,ni->n", rope.force, -place) / np.linalg.norm(place, axis=1)
    assert along.min() > 50.0
    np.testing.assert_allclose(along, np.linalg.norm(rope.force, axis=1), rtol=1e-12)
    assert np.abs(rope.torque).max() == 0.0


def test_followers() -> None:
    results = run("cam")
    rolls, presses = results.joint("rolls"), results.joint("presses")
    assert np.abs(rolls.torque).max() == 0.0
    # the face touches where the profile reaches farthest: its lever arm is the height of that point
    s = np.linspace(0, 2 * np.pi, 20001)
    radius = 0.04 + 0.012 * np.cos(s)
    for row in range(0, len(results.time), 100):
        angle = s + 2 * np.pi * results.time[row]
        height = (radius * np.sin(angle))[np.argmin(radius * np.cos(angle))]
        np.testing.assert_allclose(presses.torque[row], [0, height * presses.force[row, 0], 0], atol=1e-6)
    assert np.abs(presses.torque[:, 1]).max() > 1e-4


def test_a_curve_ends() -> None:
    short = "joints.wire.curve.points=[[-0.1, 0, 0.56], [0, 0, 0.5], [0.25, 0, 0.1], [0.5, 0, 0.2]]"
    with pytest.raises(maggi.SimulationError, match="beyond an end"):
        run("point-on-curve", short)


def test_forces_of_a_rolling_disc() -> None:
    results = run("rolling-disc")
    rolls, body = results.joint("rolls"), results.body("disc")
    axis = body.rotation[:, :, 1]
    arm = -0.1 * (np.array([0, 0, 1.0]) - axis[:, 2:] * axis) / np.sqrt(1 - axis[:, 2:] ** 2)
    np.testing.assert_allclose(rolls.torque, np.cross(arm, rolls.force), atol=1e-12)
    np.testing.assert_allclose(rolls.position, body.origin, atol=1e-15)
    np.testing.assert_allclose((body.origin + arm)[:, 2], 0.0, atol=1e-14)


def test_a_disc_that_falls_flat() -> None:
    with pytest.raises(maggi.SimulationError, match="about to lie flat"):
        run("rolling-disc", "parameters.speed=0")
    with pytest.raises(maggi.ModelError, match="lies flat"):
        run("rolling-disc", "parameters.lean=90 deg")


@pytest.mark.parametrize(("step", "error"), [(1e-3, 6e-4), (5e-4, 1.5e-4)])
def test_a_ball_on_a_turntable(step: float, error: float) -> None:
    """Its centre goes round at 2/7 of the table's speed, on a circle; second order: the ball spins at up to 70 rad/s."""
    results = run("rolling-sphere", f"simulation.step={step}")
    t, rate = results.time, 2 / 7 * 6.0
    # p = c + R(rate t) a with p(0) = (0.2, 0) and p'(0) = (0, 0.6): a = (0.35, 0), c = (−0.15, 0)
    wanted = [-0.15, 0.0] + 0.35 * np.column_stack([np.cos(rate * t), np.sin(rate * t)])
    np.testing.assert_allclose(results.body("ball").origin[:, :2], wanted, atol=error)


def test_a_skate_runs_through_a_cycloid() -> None:
    results = run("knife-edge")
    t, w, g = results.time, 3.0, 9.81 * np.sin(np.radians(5))
    x = g / (2 * w**2) * np.sin(w * t) ** 2
    y = g / (2 * w**2) * (w * t - 0.5 * np.sin(2 * w * t))
    np.testing.assert_allclose(results.body("skate").origin[:, :2], np.column_stack([x, y]), atol=5e-6)


def test_a_dog_runs_towards_a_hare(tmp_path: Path) -> None:
    """At constant speed; a quantity of pursuit curves: d + (u/v)·(distance run along the hare's line) shrinks linearly."""
    results = run("pfaffian")
    hare, dog = (results.body(name).origin for name in ("hare", "dog"))
    away = np.linalg.norm(hare - dog, axis=1)
    # d/dt(|h − d| v + (h − d)·u) = u² − v² where d runs at v towards h, which runs at the constant velocity u
    invariant = 5.0 * away + (hare - dog)[:, 1] * 4.0
    np.testing.assert_allclose(invariant, 50.0 - 9.0 * results.time, atol=2e-3)
    (snippet,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    found = subprocess.run(
        [sys.executable, "-c", snippet], cwd=DOCS, capture_output=True, text=True, env={**os.environ}
    )
    assert found.returncode == 0, found.stderr
    end = np.array(found.stdout.strip(" []\n").split(), dtype=float)
    np.testing.assert_allclose(end, dog[-1], atol=1e-6)

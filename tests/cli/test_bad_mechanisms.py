"""Mechanisms that cannot be, cannot move or come to an end: what is said names the joint and the remedy.

Each through the package's functions and through the command, whose exit status is 2 for a mistake, 1 for a run that failed, and 0
where there is only something to be told; never a traceback.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import pytest
from click.testing import CliRunner
from model_texts import FOUR_BAR, PENDULUM

import maggi
from maggi.cli.main import main

SIMULATION = "simulation: {duration: 0.5, step: 1e-3}\n"
RIGID = "kind: rigid, mass: 1, inertia: [0.1, 0.1, 0.1]"
LEG = PENDULUM.replace("joints:", f"  leg: {{{RIGID}}}\njoints:")
SECOND = LEG + "  other: {type: revolute, between: [ground, leg], at: [0, 0, 0], axis: [0, 1, 0]}\n"
# Crank and coupler in one line: the rocker is as far out as it can be.
TOGGLE = """\
maggi: 1
bodies:
  crank: {kind: rigid, mass: 1, attachments: {end: {at: [1, 0, 0]}}}
  coupler: {kind: rigid, mass: 1, pose: {origin: [1, 0, 0]}, attachments: {start: {at: [0, 0, 0]}, end: {at: [3, 0, 0]}}}
  rocker: {kind: rigid, mass: 1, pose: {origin: [4, 0, 3]}, attachments: {end: {at: [0, 0, -3]}}}
joints:
  a: {type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 1, 0]}
  b: {type: revolute, between: [crank.end, coupler.start], axis: [0, 1, 0]}
  c: {type: revolute, between: [coupler.end, rocker.end], axis: [0, 1, 0]}
  d: {type: revolute, between: [ground, rocker], at: [4, 0, 3], axis: [0, 1, 0]}
"""
# Bars of 1, 1 and 0.2 m between points 3 m apart.
SHORT = FOUR_BAR.replace("end: {at: [0, 0, 2]}", "end: {at: [0, 0, 0.2]}").replace(
    "end: {at: [3, 0, 1]}", "end: {at: [1, 0, 0]}"
)


def alone(joint, keys="", gravity="[0, 0, -9.81]"):
    """A body on one joint."""
    return f"maggi: 1\ngravity: {gravity}\nbodies:\n  a: {{{RIGID}{keys}}}\njoints:\n  {joint}\n"


@dataclass(frozen=True)
class Refused:
    """A model that is refused: at which joint, with what in the message, in the remedy."""

    text: str
    joint: str
    message: str
    remedy: str


REFUSED = {
    "two drivers, one freedom": Refused(
        FOUR_BAR + "  m: {type: driver, joint: a, angle: t**2}\n  n: {type: driver, joint: d, speed: 0}\n",
        "n",
        "driver 'n' is one too many: the joints together with m leave its coordinate no freedom",
        "remove a driver, or free a joint",
    ),
    "drivers of two wheels of one gear": Refused(
        SECOND
        + "  pair: {type: gear, joints: [hinge, other], ratio: 2}\n"
        + "  m: {type: driver, joint: hinge, speed: 1}\n  n: {type: driver, joint: other, speed: 3}\n",
        "n",
        "driver 'n' is one too many: the joints together with pair, m leave its coordinate no freedom",
        "remove a driver",
    ),
    "a driver of what the joints lock": Refused(
        PENDULUM.replace("  hinge", "  weld: {type: weld, between: [ground, arm], at: [0, 0, 1]}\n  hinge")
        + "  m: {type: driver, joint: hinge, angle: 0*t}\n",
        "m",
        "driver 'm' is one too many: the joints (weld) leave its coordinate no freedom",
        "free a joint so that every driver has a motion of its own",
    ),
    "a dead centre with a driver through it": Refused(
        TOGGLE + "  m: {type: driver, joint: d, angle: 0.1*t**2}\n",
        "m",
        "the mechanism starts in a dead centre of 'd', where driver 'm' cannot move it",
        "start it a little beside, or drive another joint",
    ),
    "poses that are not quite right": Refused(
        FOUR_BAR.replace("end: {at: [0, 0, 2]}", "end: {at: [0, 0, 2.05]}"),
        "c",
        # the coupler, 3.16 m long, turns by 0.05/3 to first order
        "off by 0.05 m; all joints would close if bodies moved by up to 0.0031 m and 0.0167 rad (coupler most)",
        "let `simulation: {assemble: true}` move the bodies",
    ),
    "bars that are too short": Refused(
        SHORT,
        "c",
        # 3 m less the three bars' 2.2 m
        "the mechanism cannot be assembled: the smallest gap reached is 0.8 m at c",
        "correct the dimensions: attachments, joints' places or axes",
    ),
}


@dataclass(frozen=True)
class Told:
    """A mechanism that may be what is meant: a note names what is odd about it."""

    text: str
    note: str


TOLD = {
    "locked by an axis that is not parallel": Told(
        FOUR_BAR.replace("coupler.start], axis: [0, 1, 0]}", "coupler.start], axis: [0, 1, 0.1]}"),
        "crank, coupler, rocker cannot move: the joints a, b, c, d lock them by over-constraint (20 rows on 18 velocities); "
        "a spherical joint in place of the revolute b would free a motion",
    ),
    "a loose part": Told(LEG, "no joint or spring holds leg: it flies free"),
    "a loose pair": Told(
        LEG.replace("joints:", f"  foot: {{{RIGID}}}\njoints:\n  ankle: {{type: distance, between: [leg, foot]}}").replace(
            f"  foot: {{{RIGID}}}", f"  foot: {{{RIGID}, pose: {{origin: [1, 0, 0]}}}}"
        ),
        "leg, foot are joined to each other but not to ground: they fly free",
    ),
    "bars in one line": Told(
        TOGGLE.replace("origin: [4, 0, 3]", "origin: [4, 0, 0]").replace("at: [4, 0, 3]", "at: [6, 0, 0]").replace(
            "end: {at: [0, 0, -3]}", "end: {at: [0, 0, 0]}"
        ),
        "the joints admit a velocity of the rigid bodies in the initial pose, but no motion along it (a shaky structure)",
    ),
}  # fmt: skip

FAILING = {
    "a disc that falls flat": (
        # let go 0.06 rad above the plane
        alone(
            "coin: {type: rolling-disc, between: [ground, a], radius: 0.05, axis: [0, 'sin(0.06)', 'cos(0.06)']}",
            ", pose: {origin: [0, 0, 0.05*sin(0.06)], rotation: {axis: [1, 0, 0], angle: pi/2 - 0.06}}",
        ).replace("[0.1, 0.1, 0.1]", "[6.25e-4, 12.5e-4, 6.25e-4]"),
        "the disc 'coin' is about to lie flat on its plane",
    ),
    "a point that leaves its curve": (
        alone(
            "slot: {type: point-on-curve, between: [ground, a], at: [0, 0, 0], curve: {points: [[-0.1, 0, 0], [0, 0, 0], [0.1, 0, -0.05]]}}"
        ),
        "the point of 'slot' has left its curve: it is beyond an end",
    ),
    "a point that leaves its surface": (
        alone(
            "bowl: {type: point-on-surface, between: [ground, a], at: [0, 0, 0], "
            "surface: {x: [-0.2, 0, 0.2], y: [-1, 0, 1], z: [[0, 0, 0], [0, 0, 0], [0, 0, 0]]}}",
            ", velocity: {linear: [1, 0, 0]}",
        ),
        "the point of 'bowl' has left its surface: it is beyond the grid",
    ),
    "a formula that ends": (
        alone(
            "row: {type: pfaffian, between: {k: a}, rows: [k.v.y*sqrt(0.1 - k.x)]}", ", velocity: {linear: [1, 0, 0]}"
        ),
        "a function of 'row' has no finite value, at t = 0.1 s",
    ),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MAGGI_DEBUG", raising=False)
    return tmp_path


def command(*arguments):
    found = CliRunner().invoke(main, list(arguments))
    assert "Traceback" not in found.output + found.stderr
    return found


@pytest.mark.parametrize("name", REFUSED)
def test_refused(folder, name):
    case = REFUSED[name]
    (folder / "model.yml").write_text(case.text + SIMULATION)
    model = maggi.load("model.yml")
    with pytest.raises(maggi.ModelError) as caught:
        maggi.run(model)
    (problem,) = maggi.check(model).problems
    for error in (caught.value, problem):
        assert error.path.split(".")[:2] == ["joints", case.joint]
        assert case.message in error.message
        assert case.remedy in error.remedy
    line = next(k for k, text in enumerate(case.text.splitlines(), 1) if text.startswith(f"  {case.joint}: {{type"))
    for verb in ("check", "run"):
        found = command(verb, "model.yml")
        assert found.exit_code == 2
        (told,) = [text for text in found.stderr.splitlines() if text.startswith("model.yml:")]
        assert told.startswith(f"model.yml:{line}:")
        assert case.message in told
        assert case.remedy in told
    (said,) = json.loads(command("check", "model.yml", "--json").stdout)["errors"]
    assert (said["line"], said["path"].split(".")[1]) == (line, case.joint)
    assert not list(folder.glob("*.h5"))


@pytest.mark.parametrize("name", TOLD)
def test_told(folder, name):
    case = TOLD[name]
    (folder / "model.yml").write_text(case.text + SIMULATION)
    found = maggi.check(maggi.load("model.yml"))
    assert found.problems == ()
    assert any(case.note in note for note in found.notes), found.notes
    printed = command("check", "model.yml")
    assert printed.exit_code == 0
    assert case.note in printed.stdout
    said = json.loads(command("check", "model.yml", "--json").stdout)
    assert any(case.note in note for note in said["model"]["notes"])


@pytest.mark.parametrize("name", FAILING)
def test_failing_runs(folder, name):
    text, message = FAILING[name]
    (folder / "model.yml").write_text(text + SIMULATION)
    with pytest.raises(maggi.SimulationError) as caught:
        maggi.run(maggi.load("model.yml"))
    assert message in str(caught.value)
    found = command("run", "model.yml", "--quiet")
    assert found.exit_code == 1
    assert message in found.stderr
    assert "model.h5 keeps" in found.stderr  # what was computed stays


def test_a_function_that_raises(folder):
    """Rows from Python: what the function raised is what ends the run."""
    (folder / "model.yml").write_text(f"maggi: 1\nbodies: {{a: {{{RIGID}}}}}\n{SIMULATION}")
    model = maggi.load("model.yml")

    def rows(t, position, rotation):
        if t > 0.05:
            raise ZeroDivisionError("too late")
        return [[[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]]], [0.0]

    joints = {"mine": maggi.PfaffianFunction({"a": maggi.End("a")}, 1, rows)}
    model = maggi.Model(model.bodies, joints, simulation=model.simulation)
    with pytest.raises(
        maggi.SimulationError, match=r"the function of 'mine' raised ZeroDivisionError: too late, at t = 0\.0"
    ):
        maggi.run(model)


def test_assembled_on_request(folder):
    """The same gap, closed: positions hold from the first row on, and the user is told."""
    text = FOUR_BAR.replace("end: {at: [0, 0, 2]}", "end: {at: [0, 0, 2.05]}")
    (folder / "model.yml").write_text(text + "simulation: {duration: 0.01, step: 1e-3, assemble: true}\n")
    model = maggi.load("model.yml")
    found = maggi.check(model)
    assert found.problems == ()
    assert any(note.startswith("the joints were assembled: bodies moved by up to") for note in found.notes)
    with pytest.warns(UserWarning, match="the joints were assembled|repeat each other"):
        results = maggi.run(model)
    assert results.residuals.position[:].max() < 1e-12
    ends = [results.body(body).attachment("end").position[0] for body in ("coupler", "rocker")]
    assert ends[0] == pytest.approx(ends[1], abs=1e-11)

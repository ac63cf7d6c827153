"""Wrong input from end to end: the command's message has file, line, column and remedy; no traceback; exit status 2.

``§`` in the changed text stands before the character that the message must point at; it is removed before the run.
The core is the real one.
"""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from maggi.cli.main import main

# A crank that carries an elastic bar of two hex8 cells at its end.
MODEL = """\
maggi: 1
title: A bar on a crank
gravity: [0, 0, -9.81]
parameters: {speed: 60 rpm}
materials:
  steel: {density: 7850, young: 210 GPa, poisson: 0.3}
bodies:
  crank:
    kind: rigid
    mass: 1
    inertia: [1e-3, 1e-3, 1e-3]
    attachments: {pin: {at: [0.1, 0, 0]}}
  bar:
    kind: elastic
    mesh: {file: bar.inp}
    material: steel
    pose: {origin: [0.1, -0.01, -0.01]}
    attachments:
      root: {nodes: root}
      tip: {nodes: tip}
joints:
  bearing: {type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 1, 0]}
  weld: {type: weld, between: [crank.pin, bar.root]}
  motor: {type: driver, joint: bearing, angle: speed*t}
simulation: {duration: 4e-3, step: 1e-3}
"""
MESH = """\
*NODE
1, 0, 0, 0
2, 0, 0, 0.02
3, 0, 0.02, 0
4, 0, 0.02, 0.02
5, 0.1, 0, 0
6, 0.1, 0, 0.02
7, 0.1, 0.02, 0
8, 0.1, 0.02, 0.02
9, 0.2, 0, 0
10, 0.2, 0, 0.02
11, 0.2, 0.02, 0
12, 0.2, 0.02, 0.02
*ELEMENT, TYPE=C3D8, ELSET=all
1, 1, 5, 7, 3, 2, 6, 8, 4
2, 5, 9, 11, 7, 6, 10, 12, 8
*NSET, NSET=root
1, 2, 3, 4
*NSET, NSET=tip
9, 10, 11, 12
"""
# A loop: crank, coupler and rocker of a four-bar in the x-z plane have one freedom between them.
FOUR_BAR = """\
maggi: 1
bodies:
  crank: {kind: rigid, mass: 1, attachments: {end: {at: [0, 0, 1]}}}
  coupler: {kind: rigid, mass: 1, pose: {origin: [0, 0, 1]}, attachments: {start: {at: [0, 0, 0]}, end: {at: [3, 0, 1]}}}
  rocker: {kind: rigid, mass: 1, pose: {origin: [3, 0, 0]}, attachments: {end: {at: [0, 0, 2]}}}
joints:
  a: {type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 1, 0]}
  b: {type: revolute, between: [crank.end, coupler.start], axis: [0, 1, 0]}
  c: {type: revolute, between: [coupler.end, rocker.end], axis: [0, 1, 0]}
  d: {type: revolute, between: [ground, rocker], at: [3, 0, 0], axis: [0, 1, 0]}
  motor: {type: driver, joint: a, angle: t}
  brake: §{type: driver, joint: d, angle: 0*t}
simulation: {duration: 1, step: 0.1}
"""

# name: (text of the model, what replaces it, path, part of the message, part of the remedy)
MISTAKES = {
    "missing mesh": ("bar.inp", "§bra.inp", "bodies.bar.mesh.file", "no mesh file 'bra.inp'", "model file's folder"),
    "unknown key": ("mass: 1", "§mas: 1", "bodies.crank.mas", "unknown key 'mas'; did you mean 'mass'?", "write 'mass'"),
    "unknown node set": ("nodes: root", "nodes: §roott", "bodies.bar.attachments.root.nodes", "unknown node set 'roott'", "did you mean 'root'?"),
    "negative density": ("7850", "§-7850", "materials.steel.density", "greater than 0, found -7850", "density (kg/m³)"),
    "elastic body joined without attachment": ("bar.root]", "§bar]", "joints.weld.between.1", "held at attachments only", "bar.root, bar.tip"),
    "reduction": ("  material: steel", "  reduction: {method: craig-bampton, modes: §900}\n    material: steel", "bodies.bar.reduction.modes", "900 modes are asked for; with its attachments held the body has", "fewer"),
    "geometric stiffening": ("  material: steel", "  geometric_stiffening: §true\n    material: steel", "bodies.bar.geometric_stiffening", "not built yet", "geometric_stiffening: false"),
    "accuracy of fixed steps": ("step: 1e-3", "step: 1e-3, accuracy: §1e-6", "simulation.accuracy", "have no accuracy", "step: auto"),
    "run shorter than a step": ("duration: 4e-3, step: 1e-3", "duration: 4e-4, step: §1e-3", "simulation.step", "longer than the duration 0.0004 s", "shorten the step"),
    "driver that starts off zero": ("angle: speed*t", "angle: §speed*t + 0.1", "joints.motor.angle", "is 0.1 rad at t = 0", "subtract it"),
    "initial velocity against the joints": ("    mass: 1", "    mass: 1\n    velocity: §{linear: [1, 0, 0]}", "bodies.crank.velocity", "contradicts the joints", "fewer bodies"),
    "two drivers of one joint": ("motor: {type: driver, joint: bearing,", "brake: {type: driver, joint: bearing, speed: 1}\n  motor: {type: driver, joint: §bearing,", "joints.motor.joint", "driven twice, by 'brake' and 'motor'", "remove one"),
    "gap between two attachments": ("weld: {type: weld, between: [crank.pin, bar.root]}", "weld: §{type: weld, between: [crank.pin, bar.tip]}", "joints.weld", "do not meet", "maggi check"),
}  # fmt: skip
# what only the mesh shows: (text of the mesh, what replaces it, text of the model, what replaces it, …)
BAD_MESHES = {
    "disconnected part": (
        ("*ELEMENT", "13, 5, 0, 0\n14, 5.1, 0, 0\n15, 5, 0.1, 0\n16, 5, 0, 0.1\n*ELEMENT, TYPE=C3D4\n3, 13, 14, 15, 16\n*ELEMENT"),
        ("bar.inp", "§bar.inp"), "bodies.bar.mesh.file", "bar.inp: the mesh falls into 2 parts that share no node", "make one body of each part",
    ),
    "inverted element": (
        ("2, 5, 9, 11, 7, 6", "2, 9, 5, 7, 11, 6"),
        ("bar.inp", "§bar.inp"), "bodies.bar.mesh.file", "bar.inp: hex8 cell 2 is inverted", "order of its nodes",
    ),
    "empty node set": (
        ("*NSET, NSET=root", "*NSET, NSET=none\n*NSET, NSET=root"),
        ("nodes: root", "nodes: §none"), "bodies.bar.attachments.root.nodes", "the node set 'none'", "in the mesher",
    ),
}  # fmt: skip


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MAGGI_DEBUG", raising=False)
    (tmp_path / "bar.inp").write_text(MESH)
    return tmp_path


def maggi(*arguments):
    return CliRunner().invoke(main, list(arguments))


def written(text):
    """Writes the model; line and column of the mark that it had."""
    before, mark, after = text.partition("§")
    assert mark, "no place is marked"
    assert "§" not in after
    Path("model.yml").write_text(before + after)
    return before.count("\n") + 1, len(before) - before.rfind("\n")


def refuses(place, path, message, remedy):
    """`run` and `check` refuse the model at the place, in words and as JSON, and leave nothing behind."""
    line, column = place
    for command in ("run", "check"):
        found = maggi(command, "model.yml")
        assert found.exit_code == 2, found.output
        assert "Traceback" not in found.stderr
        (told,) = [text for text in found.stderr.splitlines() if text.startswith("model.yml:")]
        assert told.startswith(f"model.yml:{line}:{column}: {path}: ")
        assert message in told
        assert remedy in told
        as_json = maggi(command, "model.yml", "--json")
        assert as_json.exit_code == 2
        (said,) = json.loads(as_json.stdout)["errors"]
        assert (said["file"], said["line"], said["column"], said["path"]) == ("model.yml", line, column, path)
        assert message in said["message"]
        assert remedy in said["remedy"]
    assert not Path("model.h5").exists()


def test_the_model_without_mistakes(folder):
    Path("model.yml").write_text(MODEL)
    assert maggi("run", "model.yml").exit_code == 0
    assert maggi("check", "model.yml").exit_code == 0


@pytest.mark.parametrize("name", MISTAKES)
def test_mistake_in_the_model(folder, name):
    old, new, *expected = MISTAKES[name]
    assert MODEL.count(old) == 1
    refuses(written(MODEL.replace(old, new)), *expected)


@pytest.mark.parametrize("name", BAD_MESHES)
def test_mistake_in_the_mesh(folder, name):
    (old_mesh, new_mesh), (old, new), *expected = BAD_MESHES[name]
    assert MESH.count(old_mesh) == 1
    assert MODEL.count(old) == 1
    (folder / "bar.inp").write_text(MESH.replace(old_mesh, new_mesh))
    refuses(written(MODEL.replace(old, new)), *expected)


def test_over_driven_loop(folder):
    """Two drivers on two joints, one too many for the loop's one freedom."""
    refuses(written(FOUR_BAR), "joints.brake", "driver 'brake' is one too many", "remove a driver")


def test_a_disconnected_body_is_a_note_not_a_mistake(folder):
    """A part that nothing holds flies free, which may be meant: `maggi check` says so."""
    Path("model.yml").write_text(MODEL.replace("joints:\n", "  stone: {kind: rigid, mass: 1}\njoints:\n"))
    found = maggi("check", "model.yml")
    assert found.exit_code == 0
    assert "no joint or spring holds stone" in found.stdout


def test_check_shows_where_the_attachments_are_beside_a_gap(folder):
    old, new, *_ = MISTAKES["gap between two attachments"]
    written(MODEL.replace(old, new))
    found = maggi("check", "model.yml")
    assert "attachment pin  at [0.1, 0, 0] m (global)" in found.stdout
    assert "attachment tip   at [0.3, 0, 0] m (global)" in found.stdout
    # the tip is 20 cm from the pin
    assert "off by 0.2 m" in found.stderr
    said = json.loads(maggi("check", "model.yml", "--json").stdout)
    assert said["model"]["problems"][0]["path"] == "joints.weld"


def test_missing_model(folder):
    found = maggi("run", "modle.yml")
    assert found.exit_code == 2
    assert found.stderr == "modle.yml: no such file (check the path)\n"
    (said,) = json.loads(maggi("run", "modle.yml", "--json").stdout)["errors"]
    assert (said["file"], said["line"], said["message"]) == ("modle.yml", None, "no such file")


def test_missing_output_folder(folder):
    Path("model.yml").write_text(MODEL)
    found = maggi("run", "model.yml", "-o", "runs/first.h5")
    assert found.exit_code == 2
    assert (
        found.stderr
        == "maggi: there is no folder runs (make it first (mkdir -p runs), or choose another file with -o)\n"
    )
    assert (
        "mkdir -p runs"
        in json.loads(maggi("run", "model.yml", "-o", "runs/first.h5", "--json").stdout)["errors"][0]["remedy"]
    )
    assert not Path("runs").exists()


def test_several_mistakes_are_told_at_once_in_the_order_of_the_file(folder):
    text = MODEL.replace("7850", "-7850").replace("mass: 1", "mas: 1").replace("step: 1e-3", "step: soon")
    Path("model.yml").write_text(text)
    found = maggi("run", "model.yml")
    assert found.exit_code == 2
    assert [line.split(": ")[0] for line in found.stderr.splitlines()] == [
        "model.yml:6:20",
        "model.yml:10:5",
        "model.yml:25:36",
    ]

"""Every kind of mistake in a model file: exact line and column, path, message.

In the changed text ``§`` stands before the character that the message must point at; it is removed before reading.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from maggi.model.errors import MeshError, ModelError, ModelErrors
from maggi.modelfile import read, read_text

from .marks import mark
from .samples import CONTRACT, EVERYTHING, SIMEON_ROD

MATERIAL = "steel: {density: 7850, young: 210 GPa, poisson: 0.3, damping: {mass: 0, stiffness: 1e-6}}"
PIN = "crankpin: {type: revolute, between: [crank.pin, rod.big_end], axis: [0, 1, 0]}"
BEARING = "bearing: {type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 1, 0]}"
MOTOR = 'motor: {type: driver, joint: bearing, angle: "speed*t"}'
INERTIA = "[1e-4, 4e-4, 4e-4]"
ROTATION = '{axis: [0, 1, 0], angle: "30 deg"}'
MESH = "{file: rod.msh, unit: mm}"
QUANTITIES = "[bodies, joints]"

# (text of the contract's example, what replaces it, path, part of the message, part of the remedy)
CASES = [
    # numbers and units
    ("density: 7850", "density: §-1", "materials.steel.density", "Input should be greater than 0, found -1", ""),
    ("poisson: 0.3", "poisson: §0.7", "materials.steel.poisson", "Input should be less than 0.5, found 0.7", ""),
    ("poisson: 0.3", "poisson: §0.5", "materials.steel.poisson", "Input should be less than 0.5", ""),
    ("210 GPa", "§70 mm", "materials.steel.young", "expected a pressure, got a length: 70 mm", '"210 GPa"'),
    ("210 GPa", "§210 GPA", "materials.steel.young", "unknown unit 'GPA'", "did you mean 'GPa'?"),
    ("210 GPa", "§speed", "materials.steel.young", "expected a pressure, got an angular velocity: speed", ""),
    ("mass: 0.4", "mass: §0", "bodies.crank.mass", "greater than 0, found 0", ""),
    ("mass: 0.4", "mass: §true", "bodies.crank.mass", "expected a mass, found true", '"0.4 kg"'),
    ("mass: 0.4", "mass: §[1]", "bodies.crank.mass", "expected a mass, found a list of 1", ""),
    ("mass: 0.4", "mass: §{a: 1}", "bodies.crank.mass", "expected a mass, found a mapping", ""),
    ("mass: 0.4", "§mass:", "bodies.crank.mass", "expected a mass, found nothing", ""),
    ("mass: 0.4", "mass: §sped", "bodies.crank.mass", "unknown name 'sped'", "did you mean 'speed'?"),
    ("mass: 0.4", "mass: §t", "bodies.crank.mass", "the time t cannot stand here", ""),
    ("mass: 0.4", "mass: §1/0", "bodies.crank.mass", "expression '1/0': division by zero", ""),
    ("mass: 0.4", "mass: §.nan", "", "the number .nan is not finite", ""),
    ("mass: 0.4", "mass: §1e999", "", "the number 1e999 is not finite", ""),
    ("[0.1, 0, 0]", "[0.1, §1 kg, 0]", "bodies.crank.attachments.pin.at.1", "expected a length, got a mass: 1 kg", ""),
    ("unit: mm", "unit: §mmm", "bodies.rod.mesh.unit", "unknown unit 'mmm'", "did you mean"),
    ("unit: mm", "unit: §kg", "bodies.rod.mesh.unit", "expected a length, got a mass", ""),
    ('"30 deg"', '§"30 degr"', "bodies.crank.pose.rotation.angle", "unknown unit 'degr'", "did you mean"),
    # keys
    ("density: 7850", "§densty: 7850", "materials.steel.densty", "unknown key 'densty'; did you mean 'density'?", ""),
    ("mass: 0.4", "mass: 0.4\n    §colour: red", "bodies.crank.colour", "unknown key 'colour'", "known keys are pose"),
    ("mass: 0.4", "mass: 0.4\n    §<rigid>: red", "bodies.crank.<rigid>", "unknown key '<rigid>'", ""),
    ("  crank:\n    kind: rigid\n    mass: 0.4\n", "  §crank:\n    kind: rigid\n", "bodies.crank.mass", "missing key 'mass'", "mass (kg)"),
    (MATERIAL, "steel: §{density: 1, young: 1}", "materials.steel.poisson", "missing key 'poisson'", ""),
    ("maggi: 1\n", "", "maggi", "missing key 'maggi'", "version"),
    ("maggi: 1\n", "maggi: §2\n", "maggi", "unknown version of the format: 2", "maggi: 1"),
    ("  rod:\n", "  §crank:\n", "", "key 'crank' is given twice (first in line 8, column 3)", "keep one"),
    ("  rod:\n", "  §ground:\n", "bodies.ground", "'ground' is reserved for the global frame", "rename"),
    ("  rod:\n", "  §a rod:\n", "bodies.a rod", "'a rod' cannot be a name", "letters, digits, _ and -"),
    ("  rod:\n", "  §a.rod:\n", "bodies.a.rod", "'a.rod' cannot be a name", ""),
    ("  steel:", "  §st/eel:", "materials.st/eel", "'st/eel' cannot be a name", ""),
    # vectors, rotations, inertia
    ("[0, 0, -9.81]", "§[0, -9.81]", "gravity", "expected a list of 3 components, found a list of 2", "[x, y, z]"),
    ("[0, 0, -9.81]", "§-9.81", "gravity", "expected a list of 3 components, found -9.81", ""),
    ("[0, 0, -9.81]", "[0, 0, §9.81 m/s]", "gravity.2", "expected an acceleration, got a velocity: 9.81 m/s", ""),
    (ROTATION, "{axis: §[0, 0, 0], angle: 1}", "bodies.crank.pose.rotation.axis", "a direction cannot be zero", ""),
    (ROTATION, "{axis: [0, 0, 1], §angel: 1}", "bodies.crank.pose.rotation.angel", "unknown key 'angel'; did you mean 'angle'?", ""),
    (ROTATION, "§[[1, 0, 0], [0, 1, 0], [0, 0, 2]]", "bodies.crank.pose.rotation", "not a rotation matrix", "axis and angle"),
    (ROTATION, "§[[1, 0, 0], [0, 1, 0], [0, 0, -1]]", "bodies.crank.pose.rotation", "a reflection", "right-handed"),
    (ROTATION, "[[1, 0, 0], §[0, 1], [0, 0, 1]]", "bodies.crank.pose.rotation.1", "expected a list of 3", ""),
    (ROTATION, "§30 deg", "bodies.crank.pose.rotation", "expected {axis, angle} or a 3x3 matrix", ""),
    (INERTIA, "§[1e-4, 4e-4, 6e-4]", "bodies.crank.inertia", "no body has this tensor of inertia", "centre of mass"),
    (INERTIA, "§[1e-4, 4e-4, -1e-4]", "bodies.crank.inertia", "not positive: principal moments -0.0001, 0.0001, 0.0004", ""),
    (INERTIA, "§[[2, 0, 0], [1, 2, 0], [0, 0, 2]]", "bodies.crank.inertia", "not symmetric: 0 and 1 stand opposite", ""),
    (INERTIA, "§[1, 2]", "bodies.crank.inertia", "expected 3 principal moments or a 3x3 tensor", ""),
    (INERTIA, "[1e-4, 4e-4, §4 kg]", "bodies.crank.inertia.2", "expected a moment of inertia, got a mass", "kg m^2"),
    # parameters
    ('"1500 rpm"', '§"1500 rppm"', "parameters.speed", "unknown unit 'rppm'", "did you mean 'rpm'?"),
    ('"1500 rpm"', "§[1]", "parameters.speed", "expected a number or an expression", ""),
    ('{speed: "1500 rpm"}', "{speed: §1 + n}", "parameters.speed", "unknown name 'n'", ""),
    ('{speed: "1500 rpm"}', "{speed: 1, §2x: 1}", "parameters.2x", "'2x' cannot name a parameter", ""),
    ('{speed: "1500 rpm"}', "{speed: 1, §sin: 1}", "parameters.sin", "'sin' has a meaning in expressions", ""),
    ('{speed: "1500 rpm"}', "§3", "parameters", "Input should be a valid dictionary, found 3", ""),
    # kinds
    ("kind: elastic", "kind: §elastc", "bodies.rod.kind", "unknown kind 'elastc'", "did you mean 'elastic'?"),
    ("  rod:\n    kind: elastic\n", "  §rod:\n", "bodies.rod.kind", "missing key 'kind'", "rigid, elastic or ritz"),
    ("type: revolute", "type: §revolut", "joints.bearing.type", "unknown type 'revolut'", "did you mean 'revolute'?"),
    ("coupling: average", "coupling: §averge", "bodies.rod.attachments.small_end.coupling", "found 'averge'", "did you mean 'average'?"),
    # reductions
    ("reduction: none", "reduction: §guyan", "bodies.rod.reduction", "unknown reduction 'guyan'", "{method: craig-bampton, modes: 12}"),
    ("reduction: none", "reduction: §3", "bodies.rod.reduction", "unknown reduction 3", "write none"),
    ("reduction: none", "reduction: §{modes: 3}", "bodies.rod.reduction.method", "missing key 'method'", "craig-bampton"),
    ("reduction: none", "reduction: {method: §guyan, modes: 3}", "bodies.rod.reduction.method", "unknown method 'guyan'", "craig-bampton"),
    ("reduction: none", "reduction: §{method: craig-bampton}", "bodies.rod.reduction.modes", "missing key 'modes'", ""),
    ("reduction: none", "reduction: {method: craig-bampton, modes: §-1}", "bodies.rod.reduction.modes", "whole number from 0 to 1000, found -1", ""),
    ("reduction: none", "reduction: {method: craig-bampton, modes: §1.5}", "bodies.rod.reduction.modes", "found 1.5", ""),
    # not built yet
    ("stiffening: false", "stiffening: §true", "bodies.rod.geometric_stiffening", "geometric stiffening is not built yet, found true", "false"),
    ("step: 1e-5", "step: 1e-5, accuracy: §1e-6", "simulation.accuracy", "steps of 1e-05 s have no accuracy", "step: auto"),
    ("generalized-alpha", "§euler", "simulation.method", "'dop853' or 'radau', found 'euler'", ""),
    ("method: generalized-alpha, rho_inf: 0.9", "method: radau, rho_inf: §0.9", "simulation.rho_inf", "radau has no rho_inf", "leave it out"),
    (QUANTITIES, "[bodies, §stress]", "outputs.quantities.1", "unknown quantity 'stress'", "bodies, attachments"),
    # simulation and outputs
    ("step: 1e-5", "step: §0", "simulation.step", "greater than 0", ""),
    ("step: 1e-5", "step: §0.3", "simulation.step", "the step 0.3 s is longer than the duration 0.1 s", ""),
    ("step: 1e-5", "step: §1e-300", "simulation.step", "steps are more than 1e+09", ""),
    ("step: 1e-5", "step: §1 mm", "simulation.step", "expected a time, got a length", ""),
    ("duration: 0.1", "duration: §-1", "simulation.duration", "greater than 0, found -1", ""),
    ("rho_inf: 0.9", "rho_inf: §1.1", "simulation.rho_inf", "less than or equal to 1, found 1.1", ""),
    ("tolerance: 1e-8", "tolerance: §0", "simulation.tolerance", "greater than 0", ""),
    ("every: 10", "every: §0", "outputs.every", "expected a whole number from 1", ""),
    ("every: 10", "every: §2.5", "outputs.every", "found 2.5", ""),
    (QUANTITIES, "§joints", "outputs.quantities", "expected a list of quantities or all", ""),
    # meshes and attachments
    (MESH, "§{}", "bodies.rod.mesh", "expected one of the keys file, box, beam, found none", ""),
    (MESH, "{file: a, box: §{}}", "bodies.rod.mesh.box", "file and box exclude each other", ""),
    (MESH, "{file: §rd.msh}", "bodies.rod.mesh.file", "no mesh file", "model file's folder"),
    (MESH, "{file: §3}", "bodies.rod.mesh.file", "Input should be a valid string, found 3", ""),
    (MESH, "{box: {size: [1, §0, 1], cells: [1, 1, 1]}}", "bodies.rod.mesh.box.size.1", "greater than 0", ""),
    (MESH, "{box: {size: [1, 1, 1], cells: [1, §1.5, 1]}}", "bodies.rod.mesh.box.cells.1", "found 1.5", ""),
    (MESH, "{box: {size: [1, 1, 1], cells: §[999, 999, 999]}}", "bodies.rod.mesh.box.cells", "997002999 cells are more", ""),
    (MESH, "{box: {size: [1, 1, 1], cells: [1, 1, 1], cell: §hex9}}", "bodies.rod.mesh.box.cell", "found 'hex9'", "did you mean 'hex8'?"),
    (MESH, "{beam: {length: 1, elements: 3, section: {circle: {diameter: §-1 mm}}}}", "bodies.rod.mesh.beam.section.circle.diameter", "greater than 0, found -0.001", ""),
    ("nodes: big_end", "nodes: §3", "bodies.rod.attachments.big_end.nodes", "expected the name of a node set", ""),
    ("nodes: big_end", "nodes: {box: §[[0, 0, 0]]}", "bodies.rod.attachments.big_end.nodes.box", "expected two corners", ""),
    ("nodes: big_end", "nodes: {box: §[[0, 0, 1], [1, 1, 0]]}", "bodies.rod.attachments.big_end.nodes.box", "the lower one", ""),
    ("material: steel", "material: §stel", "bodies.rod.material", "unknown material 'stel'", "did you mean 'steel'?"),
    ("material: steel", "material: {density: 1, young: 1, poisson: §1}", "bodies.rod.material.poisson", "less than 0.5", ""),
    ("{at: [0.1, 0, 0]}", "{at: [0.1, 0, 0], point_masses: [{mass: §0}]}", "bodies.crank.attachments.pin.point_masses.0.mass", "greater than 0", ""),
    ("    material: steel\n", "    material: steel\n    frame: {motion: rigid-run, held: [big_end, §smal_end]}\n", "bodies.rod.frame.held.1", "unknown attachment 'smal_end'", "did you mean 'small_end'?"),
    ("    material: steel\n", "    material: steel\n    frame: §{held: [big_end]}\n", "bodies.rod.frame", "a prescribed frame needs origin, or axis and angle", ""),
    ("    material: steel\n", "    material: steel\n    frame: §{axis: [0, 0, 1]}\n", "bodies.rod.frame", "angle is missing", ""),
    ("    material: steel\n", "    material: steel\n    frame: {motion: §rigid}\n", "bodies.rod.frame.motion", "found 'rigid'", ""),
    # joints
    ("[crank.pin, rod.big_end]", "[§crnk.pin, rod.big_end]", "joints.crankpin.between.0", "unknown body 'crnk'", "did you mean 'crank'?"),
    ("[crank.pin, rod.big_end]", "[crank.pin, §rod.bigend]", "joints.crankpin.between.1", "body 'rod' has no attachment 'bigend'", "did you mean 'big_end'?"),
    ("[crank.pin, rod.big_end]", "[crank.pin, §rod]", "joints.crankpin.between.1", "held at attachments only", "rod.big_end, rod.small_end"),
    ("[crank.pin, rod.big_end]", "[crank.pin, §ground.x]", "joints.crankpin.between.1", "ground has no attachments", ""),
    ("[crank.pin, rod.big_end]", "§[crank.pin, crank]", "joints.crankpin.between", "both ends are on 'crank'", "two different bodies"),
    ("[crank.pin, rod.big_end]", "§[crank.pin]", "joints.crankpin.between", "expected two ends, found a list of 1", ""),
    ("[crank.pin, rod.big_end]", "[crank.pin, §3]", "joints.crankpin.between.1", "Input should be a valid string, found 3", ""),
    (PIN, PIN.replace("axis:", "at: §[0, 0, 0], axis:"), "joints.crankpin.at", "two attachments are named", "remove at"),
    (BEARING, BEARING.replace(" at: [0, 0, 0],", "").replace("{", "§{"), "joints.bearing.at", "missing key 'at'", ""),
    (BEARING, BEARING.replace(", axis: [0, 1, 0]", "").replace("{", "§{"), "joints.bearing.axis", "missing key 'axis'", ""),
    (BEARING, BEARING.replace("axis: [0, 1, 0]", "axis: §[0, 0, 0]"), "joints.bearing.axis", "a direction cannot be zero", ""),
    (BEARING, BEARING.replace("revolute", "weld").replace("axis:", "§axis:"), "joints.bearing.axis", "unknown key 'axis'", ""),
    (BEARING, BEARING.replace("revolute", "universal").replace("axis: [0, 1, 0]", "axes: §[[0, 1, 0], [0, -2, 0]]"), "joints.bearing.axes", "cannot be parallel", ""),
    # drivers
    (MOTOR, MOTOR.replace("bearing", "§baring"), "joints.motor.joint", "unknown joint 'baring'", "did you mean 'bearing'?"),
    (MOTOR, MOTOR.replace("bearing", "§motor"), "joints.motor.joint", "'motor' is a driver, not a joint", "bearing, crankpin"),
    (MOTOR, MOTOR.replace('"speed*t"', '§"speed*t + 1"'), "joints.motor.angle", "'speed*t + 1' is 1 rad at t = 0", "subtract it"),
    (MOTOR, MOTOR.replace('angle: "', 'displacement: §"'), "joints.motor.displacement", "'bearing' is revolute and has no displacement to drive", "drive its angle"),
    (MOTOR, MOTOR.replace('"}', '", speed: §3}'), "joints.motor.speed", "exactly one of angle, displacement and speed, found angle and speed", ""),
    (MOTOR, "motor: §{type: driver, joint: bearing}", "joints.motor", "found none", ""),
    (MOTOR, MOTOR.replace('angle: "speed*t"', "speed: §3 m/s"), "joints.motor.speed", "expected an angular velocity (revolute), got a velocity: 3 m/s", ""),
    (MOTOR, MOTOR.replace('angle: "speed*t"', "speed: §50 Hz"), "joints.motor.speed", "got a frequency: 50 Hz", "rev/s"),
    (MOTOR, MOTOR.replace('"speed*t"', '§"2t"'), "joints.motor.angle", "expected an angle, got a mass: 2t", "write 2*t"),
    (MOTOR, MOTOR.replace('"speed*t"', '§"spead*t"'), "joints.motor.angle", "unknown name 'spead'", "did you mean 'speed'?"),
    (MOTOR, MOTOR.replace('"speed*t"', '§"t*sqrt(0.05 - t)"'), "joints.motor.angle", "no finite value at t = 0.0505 s", ""),
    (MOTOR, MOTOR.replace('"speed*t"', '§"log(t)"'), "joints.motor.angle", "no finite value at t = 0 s", ""),
    (MOTOR, MOTOR.replace('"speed*t"', '§"open(1)"'), "joints.motor.angle", "unknown function 'open'", ""),
    (MOTOR, MOTOR + "\n  second: {type: driver, joint: §bearing, speed: 3}", "joints.second.joint", "driven twice, by 'motor' and 'second'", "remove one"),
    # forces
    ("[crank.pin, [0, 0, 0.3]]", "[crank.pin, §ground]", "forces.spring.between.1", "ground has no point of its own", "[x, y, z]"),
    ("[crank.pin, [0, 0, 0.3]]", "§[[0, 0, 1], [0, 0, 0.3]]", "forces.spring.between", "both ends are fixed points", ""),
    ("[crank.pin, [0, 0, 0.3]]", "§[crank.pin, crank.pin]", "forces.spring.between", "both ends are 'crank.pin'", ""),
    ("[crank.pin, [0, 0, 0.3]]", "[crank.pin, §[0, 0]]", "forces.spring.between.1", "expected a list of 3", ""),
    ("[crank.pin, [0, 0, 0.3]]", "[crank.pin, §rod]", "forces.spring.between.1", "held at attachments only", ""),
    ("stiffness: 1e4, damping: 10", "stiffness: §-1", "forces.spring.stiffness", "greater than or equal to 0", ""),
    ("spring: {type: spring-damper, between: [crank.pin, [0, 0, 0.3]], stiffness: 1e4, damping: 10, ", "spring: §{type: spring-damper, between: [crank.pin, [0, 0, 0.3]], ", "forces.spring", "neither stiffness nor damping", ""),
    ("forces:\n", "forces:\n  f: {type: force, on: §ground, value: [0, 0, 1]}\n", "forces.f.on", "ground cannot stand here", ""),
    ("forces:\n", "forces:\n  f: {type: force, on: crank.pin, value: [0, 0, §3 N m]}\n", "forces.f.value.2", "expected a force (force), got a torque: 3 N m", ""),
    ("forces:\n", "forces:\n  f: {type: torsion-spring, joint: §motor, stiffness: 1}\n", "forces.f.joint", "'motor' is a driver, not a joint", ""),
    ("forces:\n", "forces:\n  f: {type: §magnet}\n", "forces.f.type", "unknown type 'magnet'", ""),
    # text that is not a model
    ("gravity: [0, 0, -9.81]\nparameters", "gravity: [0, 0, -9.81\nparameters§", "", "not valid YAML", "every [ and { is closed"),
    ("gravity:", "§\tgravity:", "", "not valid YAML", "indent with spaces"),
    ("gravity:", "§<<: {a: 1}\ngravity:", "", "merge keys", "repeat"),
    ("[0, 0, -9.81]", "§!!python/object/apply:os.system [ls]", "", "the tag !!python/object/apply:os.system is not accepted", "runs no code"),
    ("[0, 0, -9.81]", "§*g", "", "unknown alias '*g'", ""),
    ("[0, 0, -9.81]", "&g [§*g]", "", "unknown alias '*g'", ""),
    ("gravity:", "? §[a]\n: 1\ngravity:", "", "a key must be a name", ""),
    ("gravity:", "§---\ngravity:", "", "a second document begins here", ""),
    ("title: Slider-crank with an", 'title: §"a\\0b" #', "title", "holds the control character '\\x00'", ""),
    ("title: Slider-crank", "title: §[a]\nx: Slider-crank", "title", "Input should be a valid string, found a list of 1", ""),
]  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rod.msh").write_text("")
    return tmp_path


@pytest.mark.parametrize(
    ("old", "new", "path", "message", "remedy"), CASES, ids=[f"{case[2]}:{case[3][:30]}" for case in CASES]
)
def test_line_column_path_message_remedy(
    folder: Path, old: str, new: str, path: str, message: str, remedy: str
) -> None:
    assert CONTRACT.count(old) >= 1
    text, line, column = mark(CONTRACT.replace(old, new, 1))
    (folder / "model.yml").write_text(text, encoding="utf-8")
    with pytest.raises(ModelError) as caught:
        read(folder / "model.yml")
    error = caught.value
    errors = error.errors if isinstance(error, ModelErrors) else (error,)
    found = [e for e in errors if e.path == path and message in e.message]
    assert found, str(error)
    assert (found[0].line, found[0].column) == (line, column), str(error)
    assert remedy in found[0].remedy
    assert found[0].file == str(folder / "model.yml")


def test_the_format_of_a_line() -> None:
    text = "maggi: 1\nbodies:\n  arm:\n    kind: elastic\n    mesh: {file: arm.msh}\n    material: {density: 1, young: 1, poisson: 0.6}\n"
    with pytest.raises(ModelErrors) as caught:
        read_text(text, name="model.yml")
    wanted = "model.yml:6:47: bodies.arm.material.poisson: Input should be less than 0.5, found 0.6"
    wanted += " ('poisson' means: Poisson's ratio)"
    assert str(caught.value) == wanted


def test_all_mistakes_are_collected_in_the_order_of_the_file(folder: Path) -> None:
    text = (
        CONTRACT.replace("density: 7850", "density: -1").replace("mass: 0.4", "mas: 0.4").replace("[0, 0, -9.81]", "3")
    )
    with pytest.raises(ModelErrors) as caught:
        read_text(text, folder=str(folder))
    assert [error.path for error in caught.value.errors] == ["gravity", "materials.steel.density", "bodies.crank.mas"]
    assert len(str(caught.value).splitlines()) == 3
    assert caught.value.path == "gravity"
    text = (
        CONTRACT.replace("joint: bearing", "joint: x")
        .replace("material: steel", "material: x")
        .replace("crank.pin, rod", "crank.x, rod")
    )
    with pytest.raises(ModelErrors) as caught:
        read_text(text, folder=str(folder))
    assert [error.path for error in caught.value.errors] == [
        "bodies.rod.material",
        "joints.crankpin.between.0",
        "joints.motor.joint",
    ]


@pytest.mark.parametrize(
    ("old", "new", "path", "message"),
    [
        ("joint: b, speed", "joint: a, speed", "joints.push.speed", "'a' is cylindrical: speed of its angle or of its displacement?"),
        ("joint: b, speed", "joint: c, speed", "joints.push.speed", "'c' is spherical and has no speed to drive"),
        ("joint: b, speed", "joint: e, angle", "joints.push.angle", "expected an angle, got a velocity"),
        ('"1 m/s"', "1 rad/s", "joints.push.speed", "expected a velocity (prismatic), got an angular velocity"),
        ("torsion-spring, joint: a", "torsion-spring, joint: b", "forces.coil.joint", "'b' is prismatic and has no angle"),
        ("nodes: x_min", "nodes: xmin", "bodies.block.attachments.left.nodes", "unknown node set 'xmin'"),
        ("nodes: start}", "nodes: strat}", "bodies.beam.attachments.root.nodes", "unknown node set 'strat'"),
        ("on: beam.tip", "on: beam", "forces.load.on", "held at attachments only"),
        ("table: {kind: rigid,", "table: {kind: rigid, velocity: {linear: [0, 0, 0]},", "bodies.table.velocity", "has its velocity from it"),
        ('frame: {axis: [0, 0, 1], angle: "t"}', 'frame: {axis: [0, 0, 1], angle: "t", held: [x]}', "bodies.table.frame.held", "holds nothing"),
        ('frame: {axis: [0, 0, 1], angle: "t"}', "pose: {origin: [1, 0, 0]}, frame: {origin: [t, 0, 0]}", "bodies.table.pose.origin", "the frame's origin begins at [0.0, 0.0, 0.0]"),
        ('frame: {axis: [0, 0, 1], angle: "t"}', "frame: {origin: [0, 0, 1/t]}", "bodies.table.frame.origin.2", "no finite value at t = 0 s"),
        ("    material: steel\n    frame:", "    frame:", "bodies.beam.material", "missing key 'material'"),
    ],
)  # fmt: skip
def test_other_kinds_of_parts(old: str, new: str, path: str, message: str) -> None:
    assert EVERYTHING.count(old) >= 1
    with pytest.raises(ModelErrors) as caught:
        read_text(EVERYTHING.replace(old, new, 1))
    assert [error for error in caught.value.errors if error.path == path and message in error.message], str(
        caught.value
    )


@pytest.mark.parametrize(
    ("old", "new", "path", "message"),
    [
        ('y: ["sin(pi*x/l)", ', "y: [", "shapes.y", "found 4 and 3"),
        ('"sin(pi*x/l)"', '"sin(pi*u/l)"', "shapes.y.0", "unknown name 'u'"),
        ('"sin(pi*x/l)"', '"sin(pi*t/l)"', "shapes.y.0", "the time t cannot stand here"),
        ('"sin(pi*x/l)"', '"1/x"', "shapes", "no finite value at attachment 'pin'"),
        ("line: {length: l, area: h*h, order: 24}", "", "integrals", "exactly one of line and box"),
        ("order: 24", "order: 1000", "integrals.line.order", "from 1 to 64"),
        ("16*K11, 0, 0]", "16*K11, 0]", "integrals.stiffness.1", "expected a list of 4 as in the first row"),
        ("[K11, 0, 0, 0]", "[K11, 1, 0, 0]", "integrals.stiffness", "stiffness is not symmetric"),
        ("rates: [0, 0, 0, 0]", "rates: [0, 0]", "initial.rates", "2 rates for 4 shape functions"),
        ("    initial", "    constants: 3\n    initial", "constants", "expected keys and values"),
    ],
)
def test_ritz_bodies(old: str, new: str, path: str, message: str) -> None:
    assert old in SIMEON_ROD
    with pytest.raises(ModelErrors) as caught:
        read_text(SIMEON_ROD.replace(old, new, 1))
    assert [e for e in caught.value.errors if e.path == f"bodies.rod.{path}" and message in e.message], str(
        caught.value
    )


def test_later_errors_are_given_their_place(folder: Path) -> None:
    (folder / "model.yml").write_text(CONTRACT, encoding="utf-8")
    _, source = read(folder / "model.yml")
    located = source.locate(MeshError("no node set 'big_end'", path="bodies.rod.attachments.big_end.nodes"))
    assert isinstance(located, MeshError)
    assert (located.file, located.line, located.column) == (str(folder / "model.yml"), 23, 26)
    beyond = source.locate(ModelError("x", path="bodies.rod.attachments.big_end.nodes.box.7"))
    assert (beyond.line, beyond.column) == (23, 26)
    block = source.locate(ModelError("x", path="bodies.rod"))
    assert (block.line, block.column) == (16, 3)
    in_mesh = source.locate(MeshError("bad cell", path="bodies.rod.mesh.file", file="rod.msh", line=7))
    assert (in_mesh.file, in_mesh.line) == ("rod.msh", 7)
    both = source.locate(ModelErrors([ModelError("x", path="title"), ModelError("y", path="gravity.2")]))
    assert isinstance(both, ModelErrors)
    assert [(e.line, e.column) for e in both.errors] == [(2, 8), (3, 17)]
    assert (both.line, both.column) == (2, 8)


def test_files_that_are_no_model_files(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="no such file"):
        read(tmp_path / "none.yml")
    with pytest.raises(ModelError, match="a folder"):
        read(tmp_path)
    with pytest.raises(ModelError, match="cannot be read"):
        read("a\0b")
    (tmp_path / "latin.yml").write_bytes("maggi: 1\ntitle: Gehäuse\n".encode("latin-1"))
    with pytest.raises(ModelError, match="byte 0xe4 is not UTF-8") as caught:
        read(tmp_path / "latin.yml")
    assert (caught.value.line, caught.value.column) == (2, 11)
    (tmp_path / "empty.yml").write_bytes(b"")
    with pytest.raises(ModelError, match="the file is empty"):
        read(tmp_path / "empty.yml")
    (tmp_path / "large.yml").write_bytes(b"#" * 2_000_001)
    with pytest.raises(ModelError, match="more than 2000000"):
        read(tmp_path / "large.yml")
    (tmp_path / "binary.yml").write_bytes(b"\x00\x01\x02")
    with pytest.raises(ModelError, match="not valid YAML"):
        read(tmp_path / "binary.yml")


BOMB = "maggi: 1\na: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"{new}: &{new} [{', '.join([f'*{old}'] * 10)}]\n" for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BOMB, "more than 100000 values"),
        ("[" * 100_000, "nested more than 40 deep"),
        ("- " * 100_000, "nested more than 40 deep"),
        ("a: {" * 100_000, "nested more than 40 deep"),
        ("[" + "1," * 150_000 + "]", "more than 100000 values"),
        ("[" + "".join(f"&a{n} 1," for n in range(2000)) + "]", "more than 1000 anchors"),
        ('{"a": "\\ud800"}', "lone surrogate"),
        ("%YAML 9.9\n---\na", "not valid YAML"),
    ],
    ids=lambda value: value[:12],
)
def test_floods_are_stopped(text: str, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        read_text(text)


def test_thousands_of_mistakes_are_cut(folder: Path) -> None:
    text = "maggi: 1\nbodies:\n" + "".join(f"  b{n}: {{kind: rigid, mass: -1}}\n" for n in range(1000))
    with pytest.raises(ModelErrors) as caught:
        read_text(text)
    assert len(caught.value.errors) == 101
    assert [error.line for error in caught.value.errors[:100]] == list(range(3, 103))
    assert str(caught.value.errors[-1]) == "model: and 900 more mistakes"


def test_a_character_written_as_two_json_escapes() -> None:
    model, _ = read_text('{"maggi": 1, "title": "\\ud83d\\ude00", "bodies": {"a": {"kind": "rigid", "mass": 1}}}')
    assert model.title == "\U0001f600"

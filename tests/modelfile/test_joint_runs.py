"""Every type of joint from a model file to numbers: small mechanisms whose motion is known in closed form."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import maggi
from maggi.modelfile import read_text
from maggi.results.results import Results

Run = Callable[..., Results]
HEAD = "maggi: 1\n"
G = 9.81


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """The results of a model file's text; `files` are written beside it."""

    def simulate(text: str, **files: str) -> Results:
        (tmp_path / "model.yml").write_text(HEAD + text, encoding="utf-8")
        for name, content in files.items():
            (tmp_path / f"{name}.csv").write_text(content, encoding="utf-8")
        model = maggi.load(tmp_path / "model.yml")
        assert maggi.check(model).problems == ()
        results = maggi.run(model)
        assert results.status == "complete"
        return results

    return simulate


TRAIN = """\
bodies:
  one: {kind: rigid, mass: 1, inertia: [1, 1, 2e-3]}
  two: {kind: rigid, mass: 1, inertia: [1, 1, 3e-3], pose: {origin: [1, 0, 0]}}
  three: {kind: rigid, mass: 1, inertia: [1, 1, 1e-3], pose: {origin: [2, 0, 0]}}
  table: {kind: rigid, mass: 0.7, pose: {origin: [0, 1, 0]}}
  nut: {kind: rigid, mass: 50, inertia: [1, 1, 4e-3], pose: {origin: [3, 0, 0]}}
joints:
  shaft: {type: revolute, between: [ground, one], at: [0, 0, 0], axis: [0, 0, 1]}
  second: {type: cylindrical, between: [ground, two], at: [1, 0, 0], axis: [0, 0, 1]}
  third: {type: revolute, between: [ground, three], at: [2, 0, 0], axis: [0, 0, 1]}
  guide: {type: prismatic, between: [ground, table], at: [0, 1, 0], axis: [1, 0, 0]}
  spindle: {type: screw, between: [ground, nut], at: [3, 0, 0], axis: [0, 0, 1], pitch: 20 mm}
  teeth: {type: gear, joints: [shaft, second.angle], ratio: -2}
  hold: {type: driver, joint: second, displacement: 0}
  feed: {type: rack, joints: [shaft, guide], radius: 50 mm}
  strap: {type: belt, joints: [second, third], radii: [0.2, 0.1], crossed: true}
  ratio: {type: coupler, joints: {third: 1, spindle.angle: -2}}
forces:
  drive: {type: torque, on: one, value: [0, 0, 0.5]}
simulation: {duration: 0.2, step: 1e-3}
"""


def test_a_train_of_gears_rack_belt_and_screw(run: Run) -> None:
    """All coordinates are multiples of the first: constant acceleration T / Σ J_k ratio_k²."""
    results = run(TRAIN)
    lead = 0.02 / (2 * np.pi)
    ratios = {"one": 1.0, "two": -2.0, "three": 4.0, "nut": 2.0}
    inertia = 2e-3 * 1 + 3e-3 * 4 + 1e-3 * 16 + 4e-3 * 4 + 0.7 * 0.05**2 + 50 * (2 * lead) ** 2
    angle = 0.5 * (0.5 / inertia) * results.time**2
    assert angle[-1] > 0.15
    for joint, body in (("shaft", "one"), ("third", "three")):
        np.testing.assert_allclose(results.joint(joint).coordinate[:, 0], ratios[body] * angle, atol=1e-9)
    np.testing.assert_allclose(results.joint("second").coordinate[:, 1], -2 * angle, atol=1e-9)
    np.testing.assert_allclose(results.joint("guide").coordinate[:, 0], 0.05 * angle, atol=1e-10)
    np.testing.assert_allclose(results.joint("spindle").coordinate[:, 0], 2 * lead * angle, atol=1e-10)
    np.testing.assert_allclose(results.joint("spindle").coordinate[:, 1], 2 * angle, atol=1e-9)


STEERING = """\
parameters: {track: 1.2 m, base: 2.5 m}
bodies:
  left: {kind: rigid, mass: 10, inertia: [0.2, 0.2, 0.2]}
  right: {kind: rigid, mass: 10, inertia: [0.2, 0.2, 0.2]}
  flap: {kind: rigid, mass: 1, inertia: [0.01, 0.01, 0.01]}
  reel: {kind: rigid, mass: 1, inertia: [0.01, 0.01, 0.01]}
joints:
  l: {type: revolute, between: [ground, left], at: [0, 0, 0], axis: [0, 0, 1]}
  r: {type: revolute, between: [ground, right], at: [0, 0, 0], axis: [0, 0, 1]}
  f: {type: revolute, between: [ground, flap], at: [0, 0, 0], axis: [0, 0, 1]}
  w: {type: revolute, between: [ground, reel], at: [0, 0, 0], axis: [0, 0, 1]}
  wheel: {type: driver, joint: l, angle: 0.6*sin(3*t)}
  steering: {type: coupler, joints: {l: l, r: r}, relation: tan(l) - tan(r) - track/base*tan(l)*tan(r)}
  servo: {type: coupler, joints: {l: l, q: f}, relation: "q - 0.5*l - 0.1*t*sin(20*t)"}
  winch: {type: coupler, joints: {a: w, b: l}, rates: true, relation: a - (2 + sin(5*t))*b - 0.3}
simulation: {duration: 0.5, step: 5e-4}
"""


def test_steering_servo_and_a_relation_of_speeds(run: Run) -> None:
    results = run(STEERING)
    t = results.time[1:]
    left, right, flap, reel = (results.joint(name).coordinate[1:, 0] for name in "lrfw")
    np.testing.assert_allclose(left, 0.6 * np.sin(3 * t), atol=1e-13)
    # Ackermann: cot r - cot l = track/base
    np.testing.assert_allclose(1 / np.tan(right) - 1 / np.tan(left), 1.2 / 2.5, rtol=1e-9)
    np.testing.assert_allclose(flap, 0.3 * np.sin(3 * t) + 0.1 * t * np.sin(20 * t), atol=1e-13)
    # ∫ (2 + sin 5t) 1.8 cos 3t + 0.3 dt; of speeds only, so that the method's error of second order is in the angle
    integral = 1.2 * np.sin(3 * t) + 0.3 * t + 0.9 * ((1 - np.cos(8 * t)) / 8 + (1 - np.cos(2 * t)) / 2)
    np.testing.assert_allclose(reel, integral, atol=2e-6)


SHAFTS = """\
parameters: {bend: 30 deg}
bodies:
  drive: {kind: rigid, mass: 1, inertia: [1e-3, 1e-3, 1e-3]}
  driven: {kind: rigid, mass: 1, inertia: [1e-3, 1e-3, 1e-3]}
joints:
  input: {type: revolute, between: [ground, drive], at: [0, 0, 0], axis: [1, 0, 0]}
  output: {type: revolute, between: [ground, driven], at: [0, 0, 0], axis: [cos(bend), sin(bend), 0]}
  cv: {type: constant-velocity, between: [drive, driven], at: [0, 0, 0], axes: [[1, 0, 0], [cos(bend), sin(bend), 0]]}
  motor: {type: driver, joint: input, angle: 20*t}
simulation: {duration: 0.5, step: 1e-3}
"""


@pytest.mark.filterwarnings("ignore:joints repeat each other")
def test_bent_shafts_turn_alike(run: Run) -> None:
    results = run(SHAFTS)
    np.testing.assert_allclose(results.joint("output").coordinate[:, 0], 20 * results.time, atol=1e-11)


FALLING = """\
gravity: [0, 0, -9.81]
bodies:
  stone: {kind: rigid, mass: 1, inertia: [1, 1, 1]}
  nut: {kind: rigid, mass: 2, inertia: [1e-3, 1e-3, 1e-3]}
joints:
  path: {type: free, between: [ground, stone], at: [0, 0, 0]}
  thread: {type: screw, between: [ground, nut], at: [0, 0, 0], axis: [0, 0, 1], pitch: 200 mm}
simulation: {duration: 0.3, step: 1e-3}
"""


def test_free_fall_and_a_nut_that_runs_down(run: Run) -> None:
    results = run(FALLING)
    drop = -0.5 * G * results.time**2
    np.testing.assert_allclose(results.joint("path").coordinate[:, 2], drop, atol=1e-12)
    np.testing.assert_allclose(results.joint("path").coordinate[:, [0, 1, 3, 4, 5]], 0.0, atol=1e-15)
    slowed = drop / (1 + 1e-3 * (2 * np.pi / 0.2) ** 2 / 2)
    np.testing.assert_allclose(results.joint("thread").coordinate[:, 0], slowed, atol=1e-12)


PENDULUM = """\
gravity: [0, 0, -9.81]
parameters: {L: 1 m, phi: 30 deg, r: L*sin(phi), omega: sqrt(9.81/(L*cos(phi)))}
bodies:
  bob: {kind: rigid, mass: 2, pose: {origin: [r, 0, -L*cos(phi)]}, velocity: {linear: [0, r*omega, 0]}}
  load: {kind: rigid, mass: 3, pose: {origin: [5, 0, 0]}, velocity: {linear: [0, 0, 0]}}
joints:
  rod: {type: distance, between: [[0, 0, 0], bob]}
  rope: {type: distance, between: [[5, 0, 2], load], length: 2 - 0.5*t**2}
simulation: {duration: 0.5, step: 1e-3}
"""


def test_a_conical_pendulum_and_a_hoisted_load(run: Run) -> None:
    results = run(PENDULUM)
    t, r, c = results.time, 0.5, np.sqrt(0.75)
    omega = np.sqrt(G / c)
    wanted = np.column_stack([r * np.cos(omega * t), r * np.sin(omega * t), np.full_like(t, -c)])
    np.testing.assert_allclose(results.body("bob").origin, wanted, atol=3e-6)
    np.testing.assert_allclose(np.linalg.norm(results.joint("rod").force, axis=1), 2 * G / c, rtol=1e-5)
    np.testing.assert_allclose(results.body("load").origin[:, 2], 0.5 * t**2, atol=1e-12)
    np.testing.assert_allclose(results.joint("rope").force[:, 2], 3 * (G + 1.0), rtol=1e-9)


BEADS = """\
gravity: [0, 0, -9.81]
bodies:
  spiral: {kind: rigid, mass: 1, pose: {origin: [1, 0, 0]}}
  a: {kind: rigid, mass: 1, inertia: [1, 1, 1], pose: {origin: [2, 0, 0]}}
  b: {kind: rigid, mass: 1, inertia: [1, 1, 1]}
  c: {kind: rigid, mass: 1, inertia: [1, 1, 1]}
  d: {kind: rigid, mass: 1, inertia: [1, 1, 1]}
  e: {kind: rigid, mass: 1, inertia: [1, 1, 1]}
joints:
  foot: {type: weld, between: [ground, spiral], at: [1, 0, 0]}
  helix: {type: point-on-curve, between: [spiral, a], at: [2, 0, 0], curve: {x: cos(s), y: sin(s), z: -s/2, s: [-1, 1 rev]}}
  wire: {type: point-on-curve, between: [ground, b], at: [0, 0, 0], curve: {points: [[-1, 0, 0.75], [0, 0, 0], [1, 0, -0.75], [4, 0, -3]]}}
  ramp: {type: point-on-surface, between: [ground, c], at: [0, 0, 0], surface: {z: -0.75*x}}
  slope: {type: point-on-surface, between: [ground, d], at: [0, 0, 0], surface: {implicit: 3*x + 4*z}}
  field: {type: point-on-surface, between: [ground, e], at: [0, 0, 0], surface: {x: [-1, 0, 2], y: [-1, 1], z: [[0.75, 0.75], [0, 0], [-1.5, -1.5]]}}
simulation: {duration: 0.4, step: 1e-3}
"""


def test_beads_slide_down(run: Run) -> None:
    """On a helix of radius 1 and slope 1/2: s̈ = (g/2) / (1 + 1/4); on slopes of 3 : 4: ẍ = 12/25 g."""
    results = run(BEADS)
    s = 0.5 * (0.5 * G / 1.25) * results.time**2
    helix = np.column_stack([1 + np.cos(s), np.sin(s), -s / 2])
    np.testing.assert_allclose(results.joint("helix").coordinate[:, 0], s, atol=2e-6)
    assert abs(results.joint("helix").coordinate[0, 0]) < 1e-15
    np.testing.assert_allclose(results.body("a").origin, helix, atol=2e-6)
    x = 0.5 * 12 / 25 * G * results.time**2
    for body in "bcde":
        slope = np.column_stack([x, np.zeros_like(x), -0.75 * x])
        np.testing.assert_allclose(results.body(body).origin, slope, atol=1e-9, err_msg=body)
    np.testing.assert_allclose(results.joint("wire").coordinate[:, 0], 1.25 * x, atol=1e-9)


CAMS = """\
parameters: {R: 30 mm, e: 10 mm, r: 5 mm}
bodies:
  shaft: {kind: rigid, mass: 1, inertia: [1, 1, 1e-3], pose: {rotation: {axis: [1, 0, 0], angle: 90 deg}}}
  a: {kind: rigid, mass: 0.1, pose: {origin: [R + e + r, 0, 0]}}
  b: {kind: rigid, mass: 0.1, pose: {origin: [R + e, 0, 0]}}
  c: {kind: rigid, mass: 0.1, pose: {origin: [R + e, 0, 0]}}
  d: {kind: rigid, mass: 0.1, pose: {origin: [R + e, 0, 0]}}
joints:
  bearing: {type: revolute, between: [ground, shaft], at: [0, 0, 0], axis: [0, 1, 0]}
  ga: {type: prismatic, between: [ground, a], at: [0, 0, 0], axis: [1, 0, 0]}
  gb: {type: prismatic, between: [ground, b], at: [0, 0, 0], axis: [1, 0, 0]}
  gc: {type: prismatic, between: [ground, c], at: [0, 0, 0], axis: [1, 0, 0]}
  gd: {type: prismatic, between: [ground, d], at: [0, 0, 0], axis: [1, 0, 0]}
  motor: {type: driver, joint: bearing, angle: 8*t + 20*t**2}
  ca: {type: cam, between: [shaft, a], at: [R + e + r, 0, 0], axis: [0, 1, 0], profile: {radius: "e*cos(s) + sqrt(R**2 - (e*sin(s))**2)"}, roller: r}
  cb: {type: cam, between: [shaft, b], at: [R + e, 0, 0], axis: [0, 1, 0], profile: {x: e + R*cos(s), y: R*sin(s), s: [0, 1 rev]}, face: [1, 0, 0]}
  cc: {type: cam, between: [shaft, c], at: [R + e, 0, 0], axis: [0, -1, 0], profile: {radius: "e*cos(s) + sqrt(R**2 - (e*sin(s))**2)"}}
  cd: {type: cam, between: [shaft, d], at: [R + e, 0, 0], axis: [0, 1, 0], profile: {file: circle.csv, unit: mm}, face: [1, 0, 0]}
simulation: {duration: 0.4, step: 1e-3}
"""


def test_an_eccentric_circle_as_cam(run: Run) -> None:
    """Its centre stays at the distance R + roller from a roller's centre, and R from a face."""
    angles = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    points = "\n".join(f"{10 + 30 * np.cos(s):.9f},{30 * np.sin(s):.9f}" for s in angles)
    results = run(CAMS, circle=points)
    R, e = 0.03, 0.01
    q = 8 * results.time + 20 * results.time**2
    assert q[-1] > 2 * np.pi

    def reach(r: float) -> np.ndarray:
        return e * np.cos(q) + np.sqrt((R + r) ** 2 - (e * np.sin(q)) ** 2)

    x = {body: results.body(body).origin[:, 0] for body in "abcd"}
    np.testing.assert_allclose(x["a"], reach(0.005), atol=1e-12)
    np.testing.assert_allclose(x["b"], e * np.cos(q) + R, atol=1e-12)
    np.testing.assert_allclose(x["c"], reach(0.0), atol=1e-12)
    # the spline through 60 points of the circle is off by R (2π/60)⁴/384 = 1e-8 m
    np.testing.assert_allclose(x["d"], e * np.cos(q) + R, atol=2e-8)


ROLLING = """\
parameters: {alpha: 20 deg}
gravity: [9.81*sin(alpha), 0, -9.81*cos(alpha)]
bodies:
  disc: {kind: rigid, mass: 2, inertia: [0.005, 0.01, 0.005], pose: {origin: [0, 0, 0.1]}}
  ball: {kind: rigid, mass: 3, inertia: [0.012, 0.012, 0.012], pose: {origin: [0, 1, 0.1]}}
  skate: {kind: rigid, mass: 1, inertia: [0.1, 0.1, 0.1], velocity: {linear: [0, 0, 0], angular: [0, 0, 3]}, attachments: {blade: {at: [0, 0, 0]}}}
  boat: {kind: rigid, mass: 1, inertia: [0.1, 0.1, 0.1], velocity: {linear: [0, 0, 0], angular: [0, 0, 3]}, attachments: {keel: {at: [0, 0, 0]}}}
joints:
  rolls: {type: rolling-disc, between: [ground, disc], radius: 10 cm, axis: [0, 1, 0]}
  runs: {type: rolling-sphere, between: [ground, ball], radius: 10 cm}
  ice: {type: planar, between: [ground, skate.blade], axis: [0, 0, 1]}
  edge: {type: knife-edge, between: [ground, skate.blade], direction: [1, 0, 0]}
  water: {type: planar, between: [ground, boat.keel], axis: [0, 0, 1]}
  keel: {type: pfaffian, between: {k: boat.keel}, rows: [k.v.y*k.r11 - k.v.x*k.r21]}
simulation: {duration: 0.5, step: 1e-3}
"""


def test_rolling_and_skating_down_a_slope(run: Run) -> None:
    """A disc with 2/3, a ball with 5/7 of g sin α; a skate that turns at ω on a cycloid, by its blade or by a row."""
    results = run(ROLLING)
    t, g = results.time, G * np.sin(np.radians(20))
    # the method's error of second order: 6e-6 m at this step, a quarter of it at half the step
    np.testing.assert_allclose(results.body("disc").origin[:, 0], 0.5 * 2 / 3 * g * t**2, atol=7e-6)
    np.testing.assert_allclose(results.body("ball").origin[:, 0], 0.5 * 5 / 7 * g * t**2, atol=7e-6)
    for body in ("disc", "ball"):
        np.testing.assert_allclose(results.body(body).origin[:, 2], 0.1, atol=1e-14)
    w = 3.0
    x = g / (2 * w**2) * np.sin(w * t) ** 2
    y = g / (2 * w**2) * (w * t - 0.5 * np.sin(2 * w * t))
    for body in ("skate", "boat"):
        np.testing.assert_allclose(results.body(body).origin[:, :2], np.column_stack([x, y]), atol=1e-6, err_msg=body)


def test_the_command_line_runs_them(tmp_path: Path) -> None:
    (tmp_path / "train.yml").write_text(HEAD + TRAIN, encoding="utf-8")
    command = [sys.executable, "-m", "maggi", "run", "train.yml", "--json"]
    found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    said = json.loads(found.stdout)
    assert said["status"] == "complete"
    assert said["residuals"]["position"] < 1e-12


WRONG_STARTS = {
    "rolling-disc, between: [ground, a], radius: 0.2, axis: [0, 1, 0]": "height above the plane is off by 0.1 m",
    "rolling-sphere, between: [ground, a], radius: 0.2": "height above the plane is off by 0.1 m",
    "point-on-curve, between: [ground, b], at: [1, 0.01, 0], curve: {points: [[0, 0], [2, 0]]}": "off by 0.01 m",
    "point-on-surface, between: [ground, b], at: [1, 0, 0.01], surface: {z: 0}": "offset from the surface is off by 0.01 m",
    "cam, between: [ground, b], at: [1, 0, 0], axis: [0, 0, 1], profile: {radius: 0.9}, roller: 0.05": "off by 0.05 m",
    "distance, between: [[1, 0, 1], b], length: 1.2 + t": "distance is off by 0.2 m",
    "point-on-surface, between: [ground, b], at: [1, 0, 0], surface: {implicit: y**2}": "has no finite value in the initial pose",
    "pfaffian, between: [b], rows: [first.v.x/first.y]": "row 1 has no finite value in the initial pose",
}


@pytest.mark.parametrize(("joint", "message"), WRONG_STARTS.items(), ids=[key.split(",")[0] for key in WRONG_STARTS])
def test_starts_that_do_not_fit(joint: str, message: str) -> None:
    """Checked and run, a joint whose ends do not meet is refused by name."""
    bodies = "bodies: {a: {kind: rigid, mass: 1, pose: {origin: [0, 0, 0.3]}}, b: {kind: rigid, mass: 1, pose: {origin: [1, 0, 0]}}}"
    text = f"{HEAD}{bodies}\njoints:\n  j: {{type: {joint}}}\nsimulation: {{duration: 0.1, step: 1e-3}}\n"
    model, source = read_text(text, name="model.yml")
    with pytest.raises(maggi.ModelError, match=message) as caught:
        maggi.run(model)
    located = source.locate(caught.value)
    assert (located.path, located.line) == ("joints.j", 4)
    try:
        problems = maggi.check(model).problems
    except maggi.ModelError as error:
        problems = (error,)
    assert [problem for problem in problems if message in str(problem)]


def test_a_bead_that_reaches_the_end_of_its_wire(run: Run) -> None:
    text = BEADS.replace("[4, 0, -3]", "[1.2, 0, -0.9]").replace("duration: 0.4", "duration: 0.8")
    with pytest.raises(maggi.SimulationError) as caught:
        run(text)
    # x = 12/50 g t² = 1.2 at t = 0.714
    assert "0.71" in str(caught.value)

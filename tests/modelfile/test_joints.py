"""The joint library: every type becomes its description, every mistake is found at its place.

In a changed text ``§`` stands before the character that the message must point at; it is removed before reading.
"""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from maggi.model import (
    Cam,
    Coupler,
    Distance,
    End,
    ExpressionCurve,
    ExpressionSurface,
    Formula,
    Joint,
    JointCoordinate,
    KnifeEdge,
    Model,
    ModelErrors,
    Pfaffian,
    Plane,
    PointOnCurve,
    PointOnSurface,
    RollingDisc,
    RollingSphere,
    SplineCurve,
    SplineSurface,
)
from maggi.model.expression import value_at
from maggi.model.joint_kinds import JOINT_COORDINATES
from maggi.model.operations import evaluate
from maggi.modelfile import read_text

from .marks import mark
from .samples import LIBRARY

GROUND = End("ground")


@pytest.fixture(scope="module")
def library() -> Model:
    return read_text(LIBRARY)[0]


def at(f: Formula, **known: float) -> float:
    return float(evaluate(f.codes, f.values, [np.array([known.get(name, 0.0)]) for name in f.variables])[0])


def test_joints_proper(library: Model) -> None:
    joints = library.joints
    o, z = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    assert joints["loose"] == Joint("free", GROUND, End("ball"), o)
    assert joints["inline"] == Joint("constant-velocity", End("shaft"), End("wheel"), o, z)
    bent = joints["bent"]
    assert isinstance(bent, Joint)
    assert (bent.first, bent.at, bent.axis) == (End("shaft", "hub"), None, None)
    np.testing.assert_allclose(bent.axes, [[0, 0, 1], [0, math.sqrt(0.5), math.sqrt(0.5)]], atol=1e-15)
    assert joints["nut"] == Joint("screw", End("shaft"), End("lever", "tip"), None, z, pitch=0.005)


def test_couplers(library: Model) -> None:
    gear, rack, belt = (library.joints[name] for name in ("mesh", "bar", "chain"))
    assert isinstance(gear, Coupler) and isinstance(rack, Coupler) and isinstance(belt, Coupler)
    assert (gear.kind, rack.kind, belt.kind) == ("gear", "rack", "belt")
    assert list(gear.coordinates.values()) == [JointCoordinate("crank"), JointCoordinate("rocker", "angle")]
    assert at(gear.relation, a=2.0, b=-6.0) == 0.0
    assert list(rack.coordinates.values()) == [
        JointCoordinate("crank", "angle"),
        JointCoordinate("slider", "displacement"),
    ]
    assert at(rack.relation, a=2.0, b=0.04) == 0.0
    assert list(belt.coordinates.values()) == [JointCoordinate("crank", "angle"), JointCoordinate("rocker", "angle")]
    assert at(belt.relation, a=1.0, b=-2.0) == 0.0


def test_relations(library: Model) -> None:
    steering, balance, sides, speeds = (library.joints[name] for name in ("steering", "balance", "sides", "speeds"))
    assert isinstance(steering, Coupler) and isinstance(balance, Coupler)
    assert isinstance(sides, Coupler) and isinstance(speeds, Coupler)
    assert steering.coordinates == {"a": JointCoordinate("crank"), "b": JointCoordinate("rocker", "angle")}
    # Ackermann's condition: cot b - cot a = w/base with the track w = 1.2 m and the wheelbase 2.5 m
    a = 0.5
    b = math.atan(1.0 / (1.0 / math.tan(a) + 1.2 / 2.5))
    assert at(steering.relation, a=a, b=b) == pytest.approx(0.0, abs=1e-15)
    assert not steering.rates
    assert at(balance.relation, crank=1.0, slider=6.0) == pytest.approx(0.0, abs=1e-15)
    assert sides.rates
    assert list(sides.coordinates.values()) == [
        JointCoordinate("rocker", "displacement"),
        JointCoordinate("rocker", "angle"),
    ]
    assert speeds.rates
    assert at(speeds.relation, t=0.5, a=0.3, d=0.1) == pytest.approx(0.4 * math.cos(0.5) + 0.05)


def test_rods(library: Model) -> None:
    assert library.joints["rod"] == Distance(End("shaft", "hub"), End("lever", "tip"))
    string = library.joints["string"]
    assert isinstance(string, Distance) and string.length is not None
    assert (string.first, string.second) == (End("ball"), End("ground", point=(0.0, 0.0, 2.0)))
    assert value_at(string.length, [math.pi / 2]) == [2.1]


def test_curves(library: Model) -> None:
    slot, loop, helix = (library.joints[name] for name in ("slot", "loop", "helix"))
    assert slot == PointOnCurve(
        End("shaft"), End("ball"), SplineCurve(((0.0, 0.0, 0.0), (0.1, 0.02, 0.0), (0.2, 0.0, 0.1))), (0.0, 0.0, 0.0)
    )
    assert isinstance(loop, PointOnCurve)
    assert loop.curve == SplineCurve(((0.0, 0.1, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), closed=True)
    assert isinstance(helix, PointOnCurve) and isinstance(helix.curve, ExpressionCurve)
    assert (helix.curve.interval, helix.curve.closed) == ((0.0, 4 * math.pi), False)
    assert [at(f, s=math.pi) for f in (helix.curve.x, helix.curve.z)] == pytest.approx([-1.0, 0.1 * math.pi])


def test_surfaces(library: Model) -> None:
    hill, bowl, ground = (library.joints[name] for name in ("hill", "bowl", "ground"))
    assert isinstance(hill, PointOnSurface) and isinstance(hill.surface, ExpressionSurface)
    assert isinstance(bowl, PointOnSurface) and isinstance(bowl.surface, ExpressionSurface)
    assert at(hill.surface.F, x=1.0, y=2.0, z=0.2 * math.sin(1.0)) == pytest.approx(0.0, abs=1e-16)
    assert at(bowl.surface.F, x=0.6, y=0.0, z=-0.8) == pytest.approx(0.0, abs=1e-15)
    assert bowl.at == (0.0, 0.0, -1.0)
    assert isinstance(ground, PointOnSurface)
    assert ground.surface == SplineSurface((-1.0, 0.0, 1.0), (-1.0, 1.0), ((0.0, 0.0), (0.001, 0.01), (0.0, 0.0)))


def test_cams(library: Model) -> None:
    lift, press, trace = (library.joints[name] for name in ("lift", "press", "trace"))
    assert isinstance(lift, Cam) and isinstance(press, Cam) and isinstance(trace, Cam)
    assert (lift.radius, lift.face, lift.axis) == (0.004, None, (0.0, 1.0, 0.0))
    assert isinstance(lift.profile, ExpressionCurve) and lift.profile.closed
    # The cam's body is turned by 90° about x, so that the global y axis is its -z axis: angles run from x to -y.
    s = 0.7
    radius = 0.02 + 0.005 * math.cos(s)
    found = [at(f, s=s) for f in (lift.profile.x, lift.profile.y, lift.profile.z)]
    assert found == pytest.approx([radius * math.cos(s), -radius * math.sin(s), 0.0], abs=1e-16)
    assert isinstance(press.profile, ExpressionCurve) and press.profile.closed
    assert press.radius == 0.0
    assert press.face == pytest.approx((math.sqrt(0.5), 0.0, math.sqrt(0.5)))
    assert isinstance(trace.profile, SplineCurve) and trace.profile.closed
    assert (trace.radius, trace.face, trace.at) == (0.0, None, (0.01, 0.0, 0.0))


def test_a_polar_profile_on_a_turned_frame() -> None:
    """The angle that a prescribed frame begins with counts: global z is the body's y."""
    text = LIBRARY.replace(
        "pose: {rotation: {axis: [1, 0, 0], angle: 90 deg}}", "frame: {axis: [1, 0, 0], angle: pi/2 + t}"
    )
    text = text.replace("axis: [0, 1, 0], profile: {radius:", "axis: [0, 0, 1], profile: {radius:")
    text = "\n".join(line for line in text.splitlines() if not line.startswith(("  press:", "  trace:")))
    lift = read_text(text)[0].joints["lift"]
    assert isinstance(lift, Cam) and isinstance(lift.profile, ExpressionCurve)
    # about y from x: towards -z
    found = [at(f, s=math.pi / 2) for f in (lift.profile.x, lift.profile.y, lift.profile.z)]
    assert found == pytest.approx([0.0, 0.0, -0.02], abs=1e-16)


def test_contacts_without_slip(library: Model) -> None:
    joints = library.joints
    assert joints["tyre"] == RollingDisc(GROUND, End("wheel"), 0.3, (0.0, 1.0, 0.0), Plane())
    assert joints["roll"] == RollingSphere(
        End("shaft"), End("ball"), 0.1, Plane((0.0, 0.0, 0.2), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.3)
    )
    assert joints["skate"] == KnifeEdge(GROUND, End("sled", "front"), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert joints["blade"] == KnifeEdge(GROUND, End("sled"), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0))


def test_pfaffian_rows(library: Model) -> None:
    side, rows = library.joints["side"], library.joints["rows"]
    assert isinstance(side, Pfaffian) and isinstance(rows, Pfaffian)
    assert side.ends == {"blade": End("sled", "front"), "g": GROUND}
    (row,) = side.rows
    known = {"t": 2.0, "blade.r11": 0.5}
    assert {key: at(f, **known) for key, f in row.coefficients.items()} == pytest.approx(
        {("blade", "v.x"): -0.5 * math.sin(0.1), ("blade", "v.y"): 0.5}
    )
    assert row.constant is not None and at(row.constant, **known) == pytest.approx(0.2)
    assert rows.ends == {"first": End("sled"), "second": End("ball")}
    first, second = rows.rows
    known = {"t": 2.0, "first.r11": 0.8, "first.r21": 0.6}
    assert {key: at(f, **known) for key, f in first.coefficients.items()} == pytest.approx(
        {("first", "v.y"): 0.8, ("first", "v.x"): -0.6}
    )
    assert {key: at(f) for key, f in second.coefficients.items()} == pytest.approx(
        {("first", "w.z"): 2 / 3, ("second", "w.z"): -2 / 3}
    )
    assert second.constant is None


def test_every_kind_of_joint_can_be_written() -> None:
    """As far as its keys go: axes are the only thing that kinds differ in."""
    for kind in JOINT_COORDINATES:
        keys = {"type": kind, "between": ["ground", "a"], "at": [0, 0, 0]}
        if kind == "universal":
            keys["axes"] = [[1, 0, 0], [0, 1, 0]]
        elif kind not in ("spherical", "weld", "free"):
            keys["axis"] = [0, 0, 1]
        if kind == "screw":
            keys["pitch"] = 0.01
        model = {"maggi": 1, "bodies": {"a": {"kind": "rigid", "mass": 1}}, "joints": {"j": keys}}
        joint = read_text(json.dumps(model))[0].joints["j"]
        assert isinstance(joint, Joint)
        assert joint.kind == kind


# (text of LIBRARY, what replaces it, path below joints, part of the message, part of the remedy)
MISTAKES = [
    # joints proper
    ("pitch: 5 mm", "pitch: §0", "nut.pitch", "a screw needs a pitch, found 0", "revolute"),
    ("pitch: 5 mm", "pitch: §5 deg", "nut.pitch", "expected a length, got an angle: 5 deg", "70 mm"),
    ("axis: [0, 0, 1], pitch: 5 mm", "axis: [0, 0, 1], §pich: 5 mm", "nut.pich", "unknown key 'pich'; did you mean 'pitch'?", ""),
    ("type: constant-velocity, between: [shaft, wheel], at: [0, 0, 0], axis: [0, 0, 1]", "type: constant-velocity, between: [shaft, wheel], at: [0, 0, 0], axis: [0, 0, 1], axes: §[[1, 0, 0], [1, 0, 0]]", "inline.axes", "either axis or axes, found both", ""),
    ("inline: {type: constant-velocity, between: [shaft, wheel], at: [0, 0, 0], axis: [0, 0, 1]}", "inline: §{type: constant-velocity, between: [shaft, wheel], at: [0, 0, 0]}", "inline", "either axis or axes, found none", "in line"),
    ("[[0, 0, 1], [0, 1, 1]]", "§[[0, 0, 1], [0, 1, -1]]", "bent.axes", "the shafts make an angle of 135°", "the same way"),
    ("[[0, 0, 1], [0, 1, 1]]", "§[[0, 0, 1]]", "bent.axes", "expected two axes, found a list of 1", ""),
    ("type: free", "type: §fre", "loose.type", "unknown type 'fre'", "did you mean 'free'?"),
    ("loose: {type: free, between: [ground, ball], at: [0, 0, 0]}", "loose: §{type: free, between: [ground, ball]}", "loose.at", "missing key 'at'", ""),
    ("driver, joint: nut, angle: 10*t", "driver, joint: nut, speed: §10", "feed.speed", "'nut' is screw: speed of its angle or of its displacement?", ""),
    ("driver, joint: nut", "driver, joint: §mesh", "feed.joint", "'mesh' is a gear, not a joint", ""),
    ("driver, joint: nut, angle: 10*t", "driver, joint: loose, angle: §10*t", "feed.angle", "'loose' is free and has no angle to drive", ""),
    # gears, racks, belts
    ("joints: [crank, rocker.angle]", "joints: [§crnk, rocker.angle]", "mesh.joints.0", "unknown joint 'crnk'", "did you mean 'crank'?"),
    ("joints: [crank, rocker.angle]", "joints: [crank, §rocker]", "mesh.joints.1", "'rocker' is cylindrical: its angle or its displacement?", "rocker.angle or rocker.displacement"),
    ("joints: [crank, rocker.angle]", "joints: [crank, §rocker.turn]", "mesh.joints.1", "'rocker.turn' names no coordinate", "rocker.angle"),
    ("joints: [crank, rocker.angle]", "joints: [§crank.displacement, rocker.angle]", "mesh.joints.0", "'crank' is revolute and has no displacement to couple", "crank.angle"),
    ("joints: [crank, rocker.angle]", "joints: [crank, §loose]", "mesh.joints.1", "'loose' is free and has no coordinate to couple", "revolute"),
    ("joints: [crank, rocker.angle]", "joints: [crank, §crank.angle]", "mesh.joints.1", "the angle of 'crank' stands here twice", ""),
    ("joints: [crank, rocker.angle]", "joints: §[crank]", "mesh.joints", "expected two joints, found a list of 1", ""),
    ("joints: [crank, rocker.angle]", "joints: [crank, §feed]", "mesh.joints.1", "'feed' is a driver, not a joint", ""),
    ("ratio: -n", "ratio: §0", "mesh.ratio", "the ratio of a gear cannot be 0", ""),
    ("ratio: -n", "ratio: §3 mm", "mesh.ratio", "expected a number without unit, got a length", ""),
    ("radius: 20 mm", "radius: §0", "bar.radius", "greater than 0, found 0", ""),
    ("radius: 20 mm", "radius: §20 kg", "bar.radius", "expected a length, got a mass: 20 kg", ""),
    ("joints: [crank, slider], radius", "joints: [crank, §rocker.angle], radius", "bar.joints.1", "expected the displacement of a joint, found its angle", ""),
    ("joints: [crank, slider], radius", "joints: [§slider, crank], radius", "bar.joints.0", "'slider' is prismatic and has no angle", ""),
    ("radii: [0.1, 0.05]", "radii: [0.1, §-0.05]", "chain.radii.1", "greater than 0", ""),
    ("radii: [0.1, 0.05]", "radii: §[0.1]", "chain.radii", "expected two radii, found a list of 1", ""),
    ("crossed: true", "crossed: §yes", "chain.crossed", "valid boolean, found 'yes'", ""),
    # relations
    ("relation: tan(a) - tan(b)", "relation: §1 + tan(a) - tan(b)", "steering.relation", "is 1 with all coordinates zero at t = 0", "- (1)"),
    ("relation: tan(a) - tan(b)", "relation: §1/tan(a) - tan(b)", "steering.relation", "no finite value with all coordinates zero", "division"),
    ("relation: tan(a) - tan(b)", "relation: §tan(a) - tan(c)", "steering.relation", "unknown name 'c'", "known names"),
    ("w/base*tan(a)*tan(b)}", "w/base*tan(a)*tan(b), §relatoin: a}", "steering.relatoin", "unknown key 'relatoin'; did you mean 'relation'?", ""),
    ("{a: crank, b: rocker.angle}", "{a: crank, b: rocker.angle, §c: slider}", "steering.joints.c", "'c' does not occur in the relation", "remove"),
    ("{a: crank, b: rocker.angle}", "{a: crank, §t: rocker.angle}", "steering.joints.t", "'t' has a meaning in expressions and cannot name a coordinate", "rename"),
    ("{a: crank, b: rocker.angle}", "{a: crank, b: §rockr.angle}", "steering.joints.b", "unknown joint 'rockr'", "did you mean 'rocker'?"),
    ("{a: crank, b: rocker.angle}", "§{}", "steering.joints", "a coupler needs joints", ""),
    ("{w: 1.2 m,", "{a: 1, w: 1.2 m,", "steering.relation", "'a' is both a parameter and a coordinate", "rename"),
    ("{crank: 2, slider: -1/n}", "{crank: 2, slider: §0}", "balance.joints.slider", "a coefficient cannot be 0", ""),
    ("{crank: 2, slider: -1/n}", "{a: §crank, b: 2}", "balance.joints.a", "unknown name 'crank'", "with a relation they name joints"),
    ("{crank: 2, slider: -1/n}", "§{crank: 2}", "balance.joints", "expected two or more joints", ""),
    ("{crank: 2, slider: -1/n}", "{crank: 2, slidr: §-1}", "balance.joints.slidr", "unknown joint 'slidr'", "did you mean 'slider'?"),
    ("2*(a - d)*cos(t) + 0.1*t", "§2*(a*d)*cos(t)", "speeds.relation", "is not linear in a", "factors without speeds"),
    ("2*(a - d)*cos(t) + 0.1*t", "§(a - d)/(0.5 - t)", "speeds.relation", "has no finite value at t = 0.5 s", ""),
    # rods
    ('length: "2 + 0.1*sin(t)"', 'length: §"2 + 3*sin(-t)"', "string.length", "is -0.0", "it must stay above 0"),
    ('length: "2 + 0.1*sin(t)"', "length: §2 kg", "string.length", "expected a length, got a mass", ""),
    ('length: "2 + 0.1*sin(t)"', 'length: §"log(t)"', "string.length", "no finite value at t = 0 s", ""),
    ("[shaft.hub, lever.tip]}", "§[shaft.hub, shaft.hub]}", "rod.between", "both ends are 'shaft.hub'", ""),
    ("[shaft.hub, lever.tip]}", "[shaft.hub, §ground]}", "rod.between.1", "ground has no point of its own", "[x, y, z]"),
    # curves
    ("[[0, 0], [10 cm, 0.02, 0], [0.2, 0, 0.1]]", "[[0, 0], §[0, 0, 0], [0.2, 0, 0.1]]", "slot.curve.points.1", "points 1 and 2 are the same", "remove"),
    ("[[0, 0], [10 cm, 0.02, 0], [0.2, 0, 0.1]]", "[[0, 0]]", "slot.curve", "a curve needs at least 2 points, found 1", "2 or more"),
    ("[[0, 0], [10 cm, 0.02, 0], [0.2, 0, 0.1]]", "[[0, 0], [§1 s, 0], [1, 0]]", "slot.curve.points.1.0", "expected a length, got a time", ""),
    ("[[0, 0], [10 cm, 0.02, 0], [0.2, 0, 0.1]]", "[[0, 0], §[1], [1, 0]]", "slot.curve.points.1", "expected a point, found a list of 1", ""),
    ("[[0, 0.1], [1, 0], [0, 1]]", "[[0, 0.1], [1, 0]]", "loop.curve", "a closed curve needs at least 3 points, found 2", ""),
    ("[[0, 0.1], [1, 0], [0, 1]]", "[[0, 0.1], [1, 0], [0, 1], §[0, 0.1]]", "loop.curve.points.3", "the last point is the first again", "leave it out"),
    ("curve: {points: [[0, 0.1], [1, 0], [0, 1]], closed: true}", "curve: §{closed: true}", "loop.curve", "expected one of the keys points, file, x, found closed", ""),
    ("s: [0, 720 deg]", "s: §[1, 1]", "helix.curve.s", "the interval from 1 to 1 is empty", ""),
    ("s: [0, 720 deg]", "s: [0, §3 kg]", "helix.curve.s.1", "expected a number without unit or an angle or a length, got a mass", ""),
    ("x: cos(s), y: sin(s), z: 0.1*s", "x: §1/s, y: sin(s), z: 0.1*s", "helix.curve.x", "no finite value at s = 0", ""),
    ("x: cos(s), y: sin(s), z: 0.1*s", "x: §cos(u), y: sin(s), z: 0.1*s", "helix.curve.x", "unknown name 'u'", ""),
    ("x: cos(s), y: sin(s), z: 0.1*s", 'x: 1, y: "max(s - 1, 0)", z: 0', "helix.curve", "the curve stands still near s = 0", ""),
    ("s: [0, 720 deg]", "s: §[0, 720 deg], closed: true", "helix.curve.s", "is closed, but its end is 1.25664 m from its start", ""),
    ("slot: {type: point-on-curve, between: [shaft, ball], at: [0, 0, 0],", "slot: §{type: point-on-curve, between: [shaft, ball],", "slot.at", "missing key 'at'", "attachment of the second"),
    ("slot: {type: point-on-curve, between: [shaft, ball], at: [0, 0, 0],", "slot: §{type: point-on-curve, between: [shaft.hub, ball],", "slot.at", "missing key 'at'", "attachment of the second"),
    ("[shaft, ball], at: [0, 0, 0], curve", "[shaft.hub, lever.tip], at: §[0, 0, 0], curve", "slot.at", "two attachments are named", ""),
    # surfaces
    ('{z: "0.1*sin(x)*y"}', '{z: §"0.1*sin(x)*z"}', "hill.surface.z", "unknown name 'z'", ""),
    ('{z: "0.1*sin(x)*y"}', "{implicit: §3}", "hill.surface.implicit", "'3' is the same everywhere", ""),
    ('{z: "0.1*sin(x)*y"}', "§{}", "hill.surface.z", "missing key 'z'", ""),
    ("x: [-1, 0, 1], y: [-1, 1]", "x: [-1, 0, §0], y: [-1, 1]", "ground.surface.x.2", "x must increase, found 0 after 0", ""),
    ("x: [-1, 0, 1], y: [-1, 1]", "x: [-1, 0, 1], y: §[-1]", "ground.surface.y", "two or more values of y, found 1", ""),
    ("[1 mm, 0.01], [0, 0]]", "[1 mm, 0.01], §[0]]", "ground.surface.z.2", "1 heights for 2 values of y", ""),
    ("z: [[0, 0], [1 mm, 0.01], [0, 0]]", "z: §[[0, 0], [1 mm, 0.01]]", "ground.surface.z", "2 rows of heights for 3 values of x", ""),
    # cams
    ("roller: 4 mm", "roller: §0", "lift.roller", "greater than 0, found 0", ""),
    ("roller: 4 mm", "roller: §4 N", "lift.roller", "expected a length, got a force", ""),
    ("roller: 4 mm", "roller: 4 mm, face: §[1, 0, 0]", "lift.face", "roller and face exclude each other", ""),
    ("face: [1, 0, 1]", "face: §[1, 1, 0]", "press.face", "at right angles to the axis, the cosine is 0.707107", ""),
    ('{radius: "0.02 + 0.005*cos(s)"}', '{radius: §"0.02 + 0.03*cos(s)"}', "lift.profile.radius", "the radius is -0.01 m at s = 3.14159", ""),
    ('{radius: "0.02 + 0.005*cos(s)"}', '{radius: §"0.02 + 0.005*s"}', "lift.profile.radius", "the profile does not close", "period 2 pi"),
    ('{radius: "0.02 + 0.005*cos(s)"}', '{radius: §"20 kg"}', "lift.profile.radius", "expected a length, got a mass", ""),
    ('axis: [0, 1, 0], profile: {radius: "0.02', 'axis: §[0, 0, 0], profile: {radius: "0.02', "lift.axis", "a direction cannot be zero", ""),
    ("axis: [0, 1, 0], profile: {x: 0.02*cos(s), y: 0.02*sin(s), s: [0, 2*pi]}, face: [1, 0, 1]", "axis: [1, 0, 0], profile: §{x: 0.02*cos(s), y: 0.02*sin(s), s: [0, 2*pi]}, face: [0, 0, 1]", "press.profile", "leaves the plane normal to the axis, [1.0, 0.0, 0.0] in its body's frame", "global"),
    ("[0.01, 0, 1], [0, 0.02, 1]", "[0.01, 0, 1.001], [0, 0.02, 1]", "trace.profile", "leaves the plane normal to the axis, [0.0, 0.0, 1.0] in its body's frame, by 0.001 m", ""),
    ("[0, -0.02, 1]]}", "[0, -0.02, 1]], closed: §false}", "trace.profile.closed", "a cam's profile is closed", "remove closed"),
    # contacts without slip
    ("radius: 0.3, axis: [0, 1, 0]", "radius: §0, axis: [0, 1, 0]", "tyre.radius", "greater than 0", ""),
    ("radius: 0.3, axis: [0, 1, 0]", "radius: §0.3 Hz, axis: [0, 1, 0]", "tyre.radius", "expected a length, got a frequency", ""),
    ("radius: 0.3, axis: [0, 1, 0]", "radius: 0.3, axis: §[0, 0, -2]", "tyre.axis", "the disc lies flat", "axis of revolution"),
    ("[ground, wheel], radius", "[wheel, §ground], radius", "tyre.between.1", "ground cannot roll or slide", ""),
    ("[ground, wheel], radius", "[ground, §wheel.rm], radius", "tyre.between.1", "body 'wheel' has no attachment 'rm'", "did you mean 'rim'?"),
    ("normal: [0, 0, 2]}", "normal: §[0, 0, 0]}", "roll.plane.normal", "a direction cannot be zero", ""),
    ("normal: [0, 0, 2]}", "§nrmal: [0, 0, 2]}", "roll.plane.nrmal", "did you mean 'normal'?", ""),
    ("direction: [1, 0, 0]}", "direction: §[0, 0, 1]}", "skate.direction", "direction and normal are parallel", ""),
    ("direction: [0, 0, 1], normal: [0, 1, 0]", "normal: [0, 1, 0]", "blade.direction", "missing key 'direction'", "permitted motion"),
    # rows
    ("{blade: sled.front, g: ground}", "{blade: §sled.frnt, g: ground}", "side.between.blade", "body 'sled' has no attachment 'frnt'", "did you mean 'front'?"),
    ("{blade: sled.front, g: ground}", "{blade: sled.front, §pi: ground}", "side.between.pi", "'pi' has a meaning in expressions and cannot name an end", ""),
    ("{blade: sled.front, g: ground}", "§sled.front", "side.between", "expected named ends, found 'sled.front'", "{blade: sled.front"),
    ("blade.v.y: blade.r11", "§blad.v.y: blade.r11", "side.rows.0.blad.v.y", "no end is called 'blad'", "did you mean 'blade'?"),
    ("blade.v.y: blade.r11", "§blade.v: blade.r11", "side.rows.0.blade.v", "'blade.v' names no velocity component", "v.x, v.y"),
    ("blade.v.y: blade.r11", "blade.v.y: §blade.r14", "side.rows.0.blade.v.y", "unknown name 'blade.r14'", "did you mean 'blade.r"),
    ("constant: 0.1*t", "§constnt: 0.1*t", "side.rows.0.constnt", "no end is called 'constnt'", "did you mean 'constant'?"),
    ("blade.v.y: blade.r11, constant: 0.1*t", "blade.v.y: 1/(t - 1)", "side.rows.0", "no finite value at t = 1 s", ""),
    ("constant: 0.1*t", "constant: §[1]", "side.rows.0.constant", "expected a number or an expression, found a list of 1", ""),
    ("[first.v.y*first.r11 - first.v.x*first.r21 + 0.1*t, ", "[§first.v.y*first.v.x, ", "rows.rows.0", "is not linear in first.v.y", ""),
    ("[first.v.y*first.r11 - first.v.x*first.r21 + 0.1*t, ", "[§third.v.y, ", "rows.rows.0", "unknown name 'third.v.y'", ""),
    ("[first.v.y*first.r11 - first.v.x*first.r21 + 0.1*t, ", "[§0.1*t, ", "rows.rows.0", "the row holds no velocity", "first.v.x"),
    ("[first.v.y*first.r11 - first.v.x*first.r21 + 0.1*t, ", "[§{}, ", "rows.rows.0", "the row holds no velocity", ""),
    ("[first.v.y*first.r11 - first.v.x*first.r21 + 0.1*t, ", "[§3, ", "rows.rows.0", "expected a row, found 3", ""),
]  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "path", "message", "remedy"), MISTAKES, ids=[f"{case[2]}:{case[3][:40]}" for case in MISTAKES]
)
def test_mistakes(old: str, new: str, path: str, message: str, remedy: str) -> None:
    assert LIBRARY.count(old) >= 1
    text, line, column = mark(LIBRARY.replace(old, new, 1))
    with pytest.raises(ModelErrors) as caught:
        read_text(text)
    found = [e for e in caught.value.errors if e.path == f"joints.{path}" and message in e.message]
    assert found, str(caught.value)
    assert remedy in found[0].remedy, found[0].remedy
    if "§" in new:
        assert (found[0].line, found[0].column) == (line, column), str(found[0])
    assert len(caught.value.errors) <= 3, str(caught.value)

"""The audit: masses, node sets, rank and freedoms against counts made by hand."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from model_texts import FOUR_BAR, PENDULUM, VELOCITY_ROWS, elastic

from maggi.analyses.audit import audit
from maggi.analyses.build_scene import build_scene
from maggi.analyses.modal import body_modes
from maggi.modelfile import read, read_text

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "slider_crank" / "slider_crank.yml"


def audited(text, **more):
    return audit(read_text(text, **more)[0])


def test_pendulum():
    found = audited(PENDULUM)
    counts = found.mobility
    assert (counts.velocities, counts.rows, counts.rank, counts.freedoms) == (6, 5, 5, 1)
    assert (counts.rigid_velocities, counts.rigid_mobility, counts.gruebler, counts.drivers) == (6, 1, 1, 0)
    assert counts.redundant == counts.rigid_redundant == ()
    (arm,) = found.bodies
    assert (arm.kind, arm.frame, arm.mass, arm.freedoms) == ("rigid", "floating", 2.0, 6)
    np.testing.assert_allclose(arm.center_of_mass, [0.5, 0, 1])
    np.testing.assert_allclose(arm.inertia, np.diag([0, 0.1, 0.1]), atol=1e-15)
    assert arm.bounding_box is None
    (hinge,) = found.liaisons
    assert (hinge.kind, hinge.first, hinge.second, hinge.rows) == ("revolute", "ground", "arm", 5)
    np.testing.assert_allclose(hinge.position, [0, 0, 1])
    np.testing.assert_allclose(hinge.axis, [0, 1, 0])
    assert found.problems == found.unused == ()


def test_four_bar_is_three_times_redundant():
    """18 velocities − 17: a planar loop of revolutes repeats its offset along the axis and its two tilts."""
    counts = audited(FOUR_BAR).mobility
    assert (counts.velocities, counts.rows, counts.rank, counts.freedoms, counts.gruebler) == (18, 20, 17, 1, -2)
    assert counts.largest_dropped < 1e-14 < 0.01 < counts.smallest_kept
    assert len(counts.redundant) == 3
    for one in counts.redundant:
        assert one.row.startswith(f"{one.liaison}: ")
        # what closes the loop involves every joint in it
        assert {one.liaison, *one.repeats} == {"a", "b", "c", "d"}
    # A joint's z is its axis; x and y are the tilts, and the plane's own motions (offsets along x and y) are not there.
    assert sorted(one.row.split(": ")[1] for one in counts.redundant) == [
        "offset along its z axis",
        "rotation about its x axis",
        "rotation about its y axis",
    ]


def test_four_bar_made_of_fitting_joints():
    """RSUR: 5 + 3 + 4 + 5 rows, all independent; Grübler's count is the mobility."""
    text = FOUR_BAR.replace(
        "b: {type: revolute, between: [crank.end, coupler.start], axis: [0, 1, 0]}",
        "b: {type: spherical, between: [crank.end, coupler.start]}",
    )
    text = text.replace("rocker.end], axis: [0, 1, 0]}", "rocker.end], axes: [[0, 1, 0], [0, 0, 1]]}").replace(
        "c: {type: revolute", "c: {type: universal"
    )
    counts = audited(text).mobility
    assert (counts.rows, counts.rank, counts.freedoms, counts.gruebler, counts.redundant) == (17, 17, 1, 1, ())
    assert counts.largest_dropped == 0.0


def test_a_pose_close_to_a_singular_one_is_noted():
    """All bars in one line, but for 1e-7 rad: there the loop could also fold."""
    text = FOUR_BAR.replace("end: {at: [0, 0, 1]}}}\n  coupler", "end: {at: [1, 0, 0]}}}\n  coupler")
    text = text.replace("origin: [0, 0, 1]", "origin: [1, 0, 0]").replace(
        "end: {at: [3, 0, 1]}", "end: {at: [4, 0, 3e-7]}"
    )
    text = text.replace("end: {at: [0, 0, 2]}", "end: {at: [2, 0, 3e-7]}")
    found = audited(text)
    assert found.problems == ()
    assert any("close to a singular one" in note for note in found.notes)
    assert not any("singular" in note for note in audited(FOUR_BAR).notes)


def test_drivers_count_as_rows():
    text = PENDULUM + '  motor: {type: driver, joint: hinge, angle: "3*t"}\n'
    found = audited(text)
    assert (found.mobility.rows, found.mobility.drivers, found.mobility.freedoms) == (6, 1, 0)
    assert found.liaisons[1].drives == ("hinge", "angle", "3*t")


@pytest.mark.parametrize(("coupling", "freedoms"), [("rigid", 4 * 3 + 2 * 6), ("average", 12 * 3)])
def test_meshed_body(coupling, freedoms):
    """Four free nodes and two rigid sets, or twelve nodes, all with their motions in space; the hinge takes five."""
    found = audited(elastic(coupling))
    (bar,) = found.bodies
    assert (bar.kind, bar.freedoms, bar.nodes, dict(bar.cells)) == ("mesh", freedoms, 12, {"hex8": 2})
    assert bar.mass == pytest.approx(8000 * 2 * 0.1 * 0.1, rel=1e-12)
    np.testing.assert_allclose(bar.center_of_mass, [1, 0.05, 0.05], rtol=1e-12)
    box = 160 / 12 * np.array([0.02, 4.01, 4.01])
    np.testing.assert_allclose(bar.inertia, np.diag(box), rtol=1e-12, atol=1e-12)
    assert bar.bounding_box is not None
    np.testing.assert_allclose(bar.bounding_box, [[0, 0, 0], [2, 0.1, 0.1]])
    assert [(one.name, one.nodes, one.coupling) for one in bar.attachments] == [("a", 4, coupling), ("b", 4, coupling)]
    np.testing.assert_allclose(bar.attachments[1].position, [2, 0.05, 0.05], rtol=1e-12)
    sets = {one.name: one for one in bar.node_sets}
    assert list(sets) == ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"]
    assert (sets["x_max"].nodes, sets["x_max"].kind, sets["x_max"].radius) == (4, "plane", None)
    np.testing.assert_allclose(sets["x_max"].axis, [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(sets["x_max"].centroid, [2, 0.05, 0.05], rtol=1e-12)
    counts = found.mobility
    assert (counts.velocities, counts.rank, counts.freedoms) == (freedoms, 5, freedoms - 5)
    assert (counts.rigid_velocities, counts.rigid_rank, counts.rigid_mobility) == (6, 5, 1)
    assert found.unused == ("bar.b",)


def test_reduced_body():
    """Twelve interface motions less the six rigid ones, and modes; the text says what was kept."""
    found = audited(elastic(reduction="{method: craig-bampton, modes: 5}"))
    (bar,) = found.bodies
    assert (bar.kind, bar.freedoms, bar.nodes) == ("reduced", 6 + 6 + 5, 12)
    assert bar.mass == pytest.approx(160.0, rel=1e-12)
    reduction = bar.reduction
    assert reduction is not None and reduction.range is not None and reduction.highest is not None
    assert (reduction.freedoms, reduction.modes, reduction.interface, reduction.coordinates) == (24, 5, 12, 11)
    # the same body's modes by another way, which has 2e-8 of round-off
    body = read_text(elastic())[0]
    modes = body_modes(body, "bar", 5, ("a", "b")).frequencies
    assert reduction.highest == pytest.approx(modes[-1], rel=1e-7)
    assert found.mobility.freedoms == 12
    text = found.text()
    assert "bar (elastic, reduced): 17 freedoms" in text
    assert (
        f"craig-bampton, 24 freedoms to 11 coordinates: 5 modes with the attachments held up to {modes[-1]:.5g} Hz"
        in text
    )
    assert json.loads(json.dumps(found.data()))["bodies"][0]["reduction"]["interface"] == 12


def test_reduced_body_without_modes():
    found = audited(elastic(reduction="{method: craig-bampton, modes: 0}"))
    assert found.bodies[0].reduction is not None and found.bodies[0].reduction.highest is None
    assert "0 modes with the attachments held, 12 interface freedoms" in found.text()


def test_a_scene_needs_no_reduction(monkeypatch):
    """Undeformed bodies look the same, so that nothing is factorised for a drawing."""
    monkeypatch.delattr("maggi.bodies.craig_bampton.craig_bampton")
    scene = build_scene(read_text(elastic(reduction="{method: craig-bampton, modes: 5}"))[0])
    assert scene.bodies[0].nodes is not None and len(scene.bodies[0].nodes) == 12


def test_beam():
    text = elastic(mesh="{beam: {length: 2, section: {circle: {diameter: 0.1}}, elements: 3}}")
    found = audited(text.replace("x_min", "start").replace("x_max", "end"))
    assert found.bodies[0].freedoms == found.mobility.velocities == 4 * 6
    assert found.bodies[0].mass == pytest.approx(8000 * 2 * math.pi * 0.05**2, rel=1e-12)
    assert dict(found.bodies[0].cells) == {"beam2": 3}


def test_point_masses_are_welded_bodies():
    text = PENDULUM.replace(
        "pose: {origin: [0, 0, 1]}",
        "attachments: {tip: {at: [1, 0, 0], point_masses: [{mass: 1}]}}, pose: {origin: [0, 0, 1]}",
    )
    found = audited(text)
    assert [body.name for body in found.bodies] == ["arm"]
    assert [one.name for one in found.liaisons] == ["hinge"]
    assert (found.mobility.velocities, found.mobility.rows, found.mobility.freedoms) == (12, 11, 1)
    assert found.unused == ()


@pytest.mark.parametrize("frame", ['{axis: [0, 1, 0], angle: "3*t", held: [a]}', "{motion: rigid-run, held: [a]}"])
def test_prescribed_frames_have_no_velocities(frame):
    """24 elastic freedoms (see above), six taken by the clamp; of the rigid run's hinge nothing is left to decide."""
    text = elastic(frame=frame)
    text = text[: text.index("joints:")]
    if "rigid-run" in frame:
        text += (
            "joints:\n  hinge: {type: revolute, between: [ground, bar.a], axis: [0, 1, 0]}\n"
            '  motor: {type: driver, joint: hinge, angle: "3*t"}\n'
        )
    found = audited(text)
    (bar,) = found.bodies
    assert (bar.frame, bar.freedoms) == ("prescribed", 24)
    assert found.mobility.freedoms == 24 - 6
    assert (found.mobility.rigid_velocities, found.mobility.rigid_mobility, found.mobility.gruebler) == (0, 0, 0)
    assert found.mobility.rigid_redundant == ()
    assert found.problems == ()


def test_a_joint_between_prescribed_motions_has_nothing_to_act_on():
    text = PENDULUM.replace(
        "joints:\n", '  fan: {kind: rigid, mass: 1, frame: {axis: [0, 1, 0], angle: "2*t"}}\njoints:\n'
    )
    text += "  bush: {type: revolute, between: [ground, fan], at: [0, 0, 0], axis: [0, 1, 0]}\n"
    found = audited(text)
    assert (found.mobility.rows, found.mobility.rank, found.mobility.freedoms, found.mobility.gruebler) == (10, 5, 1, 1)
    assert {(one.liaison, one.repeats) for one in found.mobility.redundant} == {("bush", ())}
    assert "bush: offset along its z axis has nothing free to act on" in found.text()


def test_shape_functions():
    text = """\
maggi: 1
bodies:
  rod:
    kind: ritz
    shapes: {x: [0, 0], y: [x, x**2], z: [0, 0]}
    integrals: {density: 8000, line: {length: 1, area: 1e-4}, stiffness: [[1, 0], [0, 1]]}
    attachments: {start: {at: [0, 0, 0]}}
joints:
  hinge: {type: spherical, between: [ground, rod.start]}
"""
    found = audited(text)
    (rod,) = found.bodies
    assert (rod.kind, rod.freedoms) == ("ritz", 6 + 2)
    assert rod.mass == pytest.approx(0.8, rel=1e-12)
    assert found.mobility.freedoms == 8 - 3


def test_loose_parts_and_unused_attachments():
    text = PENDULUM.replace(
        "joints:\n",
        "  stone: {kind: rigid, mass: 1}\n"
        "  hook: {kind: rigid, mass: 1, attachments: {eye: {at: [0, 0, 0]}, tip: {at: [0, 0, 1]}}}\n"
        "  load: {kind: rigid, mass: 1}\n"
        "  bob: {kind: rigid, mass: 1, attachments: {eye: {at: [0, 0, 0]}}}\n"
        "joints:\n  pin: {type: spherical, between: [hook.eye, load]}\n",
    )
    text += "forces: {spring: {type: spring-damper, between: [bob.eye, [0, 0, 5]], stiffness: 1}}\n"
    found = audited(text)
    assert found.notes[:2] == (
        "no joint or spring holds stone: it flies free",
        "hook, load are joined to each other but not to ground: they fly free",
    )
    assert found.unused == ("hook.tip",)
    assert [(force.name, force.kind, force.on) for force in found.forces] == [
        ("spring", "spring-damper", ("bob.eye", "[0.0, 0.0, 5.0]"))
    ]
    assert any("simulation" in note for note in found.notes)


def test_what_stands_against_a_run_is_told_beside_everything_else():
    """A gap of 5 cm between pins: the counts and where the attachments are can still be read."""
    text = FOUR_BAR.replace("end: {at: [0, 0, 2]}", "end: {at: [0, 0, 2.05]}")
    found = audited(text)
    (problem,) = found.problems
    assert problem.path == "joints.c"
    assert "0.05" in problem.message
    assert found.mobility.rank == 17
    positions = {f"{body.name}.{one.name}": one.position for body in found.bodies for one in body.attachments}
    np.testing.assert_allclose(positions["rocker.end"] - positions["coupler.end"], [0, 0, 0.05], atol=1e-15)
    assert json.loads(json.dumps(found.data()))["problems"][0]["path"] == "joints.c"


def test_example():
    """Crank and piston 6 + 6; four joints of five rows and a driver; the bores as cylinders of the drawing's radii."""
    model, _ = read(EXAMPLE)
    found = audit(model)
    assert found.problems == found.unused == found.notes == ()
    crank, rod, piston = found.bodies
    assert (crank.freedoms, piston.freedoms) == (6, 6)
    # nodes that are free, three motions each, and two bores that move as one piece, six each
    assert rod.freedoms == 3 * (5905 - 360 - 288) + 2 * 6
    counts = found.mobility
    assert (counts.rows, counts.drivers, counts.rank) == (21, 1, 21)
    assert counts.velocities == 12 + rod.freedoms
    assert counts.freedoms == counts.velocities - 21
    assert counts.redundant == ()
    # with the rod rigid: 18 velocities; a planar loop of three revolutes and a slide repeats three rows
    assert (counts.rigid_velocities, counts.rigid_rank, counts.rigid_mobility, counts.gruebler) == (18, 18, 0, -3)
    assert len(counts.rigid_redundant) == 3
    sets = {one.name: one for one in rod.node_sets}
    for name, radius, x in (("big_end", 0.020, 0.0), ("small_end", 0.0125, 0.3)):
        assert sets[name].kind == "cylinder"
        assert sets[name].radius == pytest.approx(radius, rel=1e-3)
        np.testing.assert_allclose(sets[name].axis, [0, 1, 0], atol=1e-6)
        np.testing.assert_allclose(sets[name].centroid, [x, 0, 0], atol=1e-12)
    text = found.text()
    for line in (
        "rod (elastic, full mesh): 15,783 freedoms",
        "= 15,774 true freedoms",
        "with every elastic body rigid: 18 velocities − 18 independent rows = mobility 0",
        "Grübler's count, which takes no notice of redundancy: -3",
        "motor     driver     angle of bearing = speed*t",
    ):
        assert line in text, text
    data = json.loads(json.dumps(found.data()))
    assert data["bodies"][1]["node_sets"][0]["axis"] == pytest.approx([0, 1, 0], abs=1e-6)
    assert data["mobility"]["rank"] == 21


def test_progress_is_told():
    class Told(list):
        stage = list.append

        def advance(self, step, steps, time, note):
            raise AssertionError("nothing is stepped")

    told = Told()
    audit(read_text(elastic())[0], told)
    assert told == ["assembling bar"]


def keys(value):
    """All keys of nested dictionaries and lists."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield key
            if key != "cells":  # named by the types of cells
                yield from keys(entry)
    elif isinstance(value, list):
        for entry in value:
            yield from keys(entry)


def test_every_key_of_the_data_is_in_the_document():
    page = (ROOT / "docs" / "check.md").read_text(encoding="utf-8")
    page = page[page.index("## `--json`") :]
    four_bar = FOUR_BAR + "  motor: {type: driver, joint: a, angle: t}\n"
    reduced = elastic(reduction="{method: craig-bampton, modes: 2}")
    blade = PENDULUM.replace(
        "joints:", "joints:\n  edge: {type: knife-edge, between: [ground, arm], at: [1, 0, 1], direction: [0, 1, 0]}"
    )
    found = {
        key
        for text in (four_bar, reduced, blade, FOUR_BAR.replace("[0, 0, 2]", "[0, 0, 9]"))
        for key in keys(audited(text).data())
    }
    assert {key for key in found if f"`{key}`" not in page} == set()
    assert {"replacements", "reachable", "responses", "range", "remedy"} <= found


def test_the_document_quotes_what_is_told():
    page = (ROOT / "docs" / "check.md").read_text(encoding="utf-8")
    quoted = page.split("```text\n")[1].split("```")[0]
    told = audit(read(ROOT / "examples" / "bicycle" / "bicycle.yml")[0]).text()
    assert [line for line in quoted.splitlines() if line not in told.splitlines()] == []


def test_what_is_told_of_a_slider_crank():
    text = audit(read(EXAMPLE)[0]).text()
    for line in (
        "the 3 redundant rows of bearing, crankpin, wristpin, cylinder would go with a spherical joint in place of the revolute "
        "crankpin and a cylindrical joint in place of the revolute wristpin",
        # 75 mm over 300 mm, at the outer dead centre
        "bearing: angle, driven by motor  with it crankpin -1.25, wristpin 0.25",
        "rod bends: 15,777 elastic freedoms",
        "of the elastic freedoms the joints hold 3",
    ):
        assert line in text, line
    assert "Rows that hold no position" not in text


@pytest.mark.parametrize(
    ("name", "verdicts"),
    [
        (
            "disc",
            [
                "r  rolling-disc  nonholonomic (|dα|",
                "5 freedoms of position, 3 of velocity; 5 of position can be reached",
            ],
        ),
        ("wheel in a plane", ["r  rolling-disc  holonomic in disguise: integrates to 1 relation of positions"]),
        ("skates in tandem", ["together (", "holonomic in disguise: integrate to 2 relations of positions"]),
        (
            "skates side by side",
            ["nonholonomic (|dα|", "3 freedoms of position, 2 of velocity; 3 of position can be reached"],
        ),
        ("driven speed", ["m  driver  holonomic in disguise: integrates to 1 relation of positions (|dα| 0)"]),
    ],
)
def test_what_is_told_of_rows_without_a_position(name, verdicts):
    text = audited(VELOCITY_ROWS[name][0]).text()
    section = text[text.index("Rows that hold no position") :]
    for verdict in verdicts:
        assert verdict in section, section


def test_rows_that_take_nothing_away_are_told_to_be_so():
    """A speed of zero along what the hinge holds."""
    text = audited(PENDULUM + "  row: {type: pfaffian, between: {k: arm}, rows: [k.v.y]}\n").text()
    assert "row  pfaffian  follows from what the joints hold anyway" in text

"""Which motions the freedoms are, against gear ratios worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from model_texts import FLAT, FOUR_BAR, PENDULUM, RIGID, VELOCITY_ROWS, blade, elastic, model

from maggi.analyses.audit import audit
from maggi.analyses.coordinates import coordinate_rates, joint_coordinate_list
from maggi.analyses.initial import initial_motion
from maggi.modelfile import read_text
from maggi.system.build import build_system

# A slider-crank at 30°: crank 0.1 m, rod 0.3 m.
ANGLE, CRANK, ROD = math.radians(30.0), 0.1, 0.3
TILT = math.asin(CRANK * math.sin(ANGLE) / ROD)
# with each radian of the crank, from r sin φ = l sin τ and x = r cos φ + l cos τ
TILTING = CRANK * math.cos(ANGLE) / (ROD * math.cos(TILT))
PISTON = -CRANK * math.sin(ANGLE) - ROD * math.sin(TILT) * TILTING
SLIDER_CRANK = f"""\
maggi: 1
bodies:
  crank: {{kind: rigid, mass: 1, attachments: {{pin: {{at: [{CRANK * math.cos(ANGLE)}, {CRANK * math.sin(ANGLE)}, 0]}}}}}}
  rod:
    kind: rigid
    mass: 1
    pose: {{origin: [{CRANK * math.cos(ANGLE)}, {CRANK * math.sin(ANGLE)}, 0]}}
    attachments: {{big: {{at: [0, 0, 0]}}, small: {{at: [{ROD * math.cos(TILT)}, {-ROD * math.sin(TILT)}, 0]}}}}
  piston: {{kind: rigid, mass: 1, pose: {{origin: [{CRANK * math.cos(ANGLE) + ROD * math.cos(TILT)}, 0, 0]}}, attachments: {{pin: {{at: [0, 0, 0]}}}}}}
joints:
  bearing: {{type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 0, 1]}}
  crankpin: {{type: revolute, between: [crank.pin, rod.big], axis: [0, 0, 1]}}
  wristpin: {{type: revolute, between: [rod.small, piston.pin], axis: [0, 0, 1]}}
  cylinder: {{type: prismatic, between: [ground, piston.pin], axis: [1, 0, 0]}}
"""


def motions(text):
    return {(one.name, one.quantity): one for one in audit(read_text(text)[0]).motions}


def responses(one):
    return {(response.name, response.quantity): response.rate for response in one.responses}


def test_slider_crank():
    (one,) = motions(SLIDER_CRANK).values()
    assert (one.of, one.name, one.quantity, one.unit, one.driver) == ("joint", "bearing", "angle", "rad", None)
    expected = {
        ("crankpin", "angle"): -TILTING - 1.0,
        ("wristpin", "angle"): TILTING,
        ("cylinder", "displacement"): PISTON,
    }
    found = responses(one)
    assert found == pytest.approx(expected, rel=1e-9)
    assert {response.unit for response in one.responses} == {"rad", "m"}


def test_a_driven_coordinate_names_the_motion_even_where_another_would():
    (one,) = motions(SLIDER_CRANK + "  motor: {type: driver, joint: cylinder, speed: 0.1}\n").values()
    assert (one.name, one.quantity, one.unit, one.driver) == ("cylinder", "displacement", "m", "motor")
    assert responses(one)["bearing", "angle"] == pytest.approx(1.0 / PISTON, rel=1e-9)


def test_open_trees_have_a_coordinate_for_each_freedom():
    text = PENDULUM.replace("joints:", "  leg: {kind: rigid, mass: 1, inertia: [1, 1, 1]}\njoints:")
    text += "  knee: {type: cylindrical, between: [arm, leg], at: [1, 0, 1], axis: [0, 1, 0]}\n"
    found = motions(text)
    assert list(found) == [("hinge", "angle"), ("knee", "displacement"), ("knee", "angle")]
    assert all(one.responses == () for one in found.values())


def test_gears_respond():
    text = PENDULUM.replace("joints:", "  leg: {kind: rigid, mass: 1, inertia: [1, 1, 1]}\njoints:")
    text += "  other: {type: revolute, between: [ground, leg], at: [0, 0, 0], axis: [0, 1, 0]}\n"
    text += "  pair: {type: gear, joints: [hinge, other], ratio: -2.5}\n"
    (one,) = motions(text).values()
    assert responses(one) == pytest.approx({("other", "angle"): -2.5})


def test_a_body_without_joints_flies():
    found = motions(PENDULUM.replace("joints:", "  stone: {kind: rigid, mass: 1, inertia: [1, 1, 1]}\njoints:"))
    assert [key for key in found if key[0] == "stone"] == [
        *(("stone", f"displacement along {axis}") for axis in "xyz"),
        *(("stone", f"rotation about {axis}") for axis in "xyz"),
    ]
    text = audit(
        read_text(PENDULUM.replace("joints:", "  stone: {kind: rigid, mass: 1, inertia: [1, 1, 1]}\njoints:"))[0]
    ).text()
    assert "  stone flies free  6 freedoms" in text


def test_a_rolling_sphere_turns_as_it_goes():
    """v = ω × r n: rolling along x turns it about y by 1/r, along y about −x; it may spin about z."""
    found = motions(VELOCITY_ROWS["sphere"][0])
    assert {key: responses(one) for key, one in found.items()} == {
        ("a", "displacement along x"): pytest.approx({("a", "rotation about y"): 20.0}),
        ("a", "displacement along y"): pytest.approx({("a", "rotation about x"): -20.0}),
        ("a", "rotation about z"): {},
    }


def test_a_blade_slides_forward_and_turns():
    """0.25 m ahead of the joint: turning by one radian takes the joint's point 0.25 m to the other side."""
    found = motions(model({"a": ""}, FLAT, blade("k", "[0.25, 0, 0]")))
    assert list(found) == [("p", "displacement along x"), ("p", "displacement along y")]
    assert responses(found["p", "displacement along y"]) == pytest.approx({("p", "angle"): -4.0})


def test_motions_are_those_of_rigid_bodies_and_what_bends_is_counted():
    found = audit(read_text(elastic())[0])
    assert [(one.name, one.quantity) for one in found.motions] == [("hinge", "angle")]
    (bar,) = found.elastic
    assert (bar.body, bar.kind, bar.freedoms, bar.range) == ("bar", "mesh", 4 * 3 + 2 * 6 - 6, None)
    counts = found.mobility
    assert len(found.motions) + bar.freedoms - (counts.rank - counts.rigid_rank) == counts.freedoms
    reduced = audit(read_text(elastic(reduction="{method: craig-bampton, modes: 4}"))[0])
    (bar,) = reduced.elastic
    assert (bar.kind, bar.freedoms) == ("reduced", 2 * 6 + 4 - 6)
    assert bar.range is not None
    assert 0.0 < bar.range[0] < bar.range[1]


def test_numbers_of_motions_are_the_mobility():
    for text in (FOUR_BAR, SLIDER_CRANK, PENDULUM, *(text for text, *_ in VELOCITY_ROWS.values())):
        found = audit(read_text(text)[0])
        assert (
            len(found.motions) - sum(one.driver is not None for one in found.motions) == found.mobility.rigid_mobility
        )


def test_coordinates_are_named_apart():
    for kind, keys, expected in (
        ("universal", "axes: [[1, 0, 0], [0, 1, 0]]", ["angle about its x axis", "angle about its y axis"]),
        ("cylindrical", "axis: [0, 0, 1]", ["displacement", "angle"]),
        ("planar", "axis: [0, 0, 1]", ["displacement along x", "displacement along y", "angle"]),
        ("spherical", "", ["rotation about x", "rotation about y", "rotation about z"]),
    ):
        text = f"maggi: 1\nbodies: {{a: {{{RIGID}}}}}\njoints:\n  u: {{type: {kind}, between: [ground, a], at: [0, 0, 0], {keys}}}\n"
        system = build_system(read_text(text)[0])
        listed = joint_coordinate_list(system)
        assert [one.quantity for one in listed] == expected
        # in the joint's own axes those are the components of the twist
        rates = coordinate_rates(system, initial_motion(system, []), np.eye(6))
        assert np.linalg.matrix_rank(rates) == len(expected)

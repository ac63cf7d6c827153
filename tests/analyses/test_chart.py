"""Increments about a place: brackets against motions, derivatives against polynomials, places that hold the liaisons."""

from __future__ import annotations

import numpy as np
import pytest
from linkages import four_bar

from maggi.analyses.chart import Place, at_rest, chart, kernel
from maggi.analyses.initial import initial_motion
from maggi.analyses.nearby import nearby_poses
from maggi.analyses.parts import parts, unknown_velocities
from maggi.modelfile import read_text
from maggi.system.build import build_system

# Bars of 1 and 2 m between points that are 3 m apart: they only just reach.
TAUT = """\
maggi: 1
bodies: {a: {kind: rigid, mass: 1}, b: {kind: rigid, mass: 1}}
joints:
  x: {type: revolute, between: [ground, a], at: [0, 0, 0], axis: [0, 1, 0]}
  y: {type: revolute, between: [a, b], at: [1, 0, 0], axis: [0, 1, 0]}
  z: {type: revolute, between: [b, ground], at: [3, 0, 0], axis: [0, 1, 0]}
"""
DRIVEN = """\
maggi: 1
bodies: {a: {kind: rigid, mass: 1}, b: {kind: rigid, mass: 1, frame: {axis: [0, 0, 1], angle: 2*t}}}
joints:
  x: {type: prismatic, between: [b, a], at: [0, 0, 0], axis: [1, 0, 0]}
  m: {type: driver, joint: x, displacement: sin(300*t)}
"""


def about(model, **keys):
    system = build_system(model)
    here = at_rest(system, initial_motion(system, []))
    return system, here, chart(system, unknown_velocities(system), here, **keys)


def test_a_bracket_is_the_gap_that_a_round_trip_leaves():
    """exp(hx) exp(hy) exp(−hx) exp(−hy) = exp(h² [x, y]) to third order: the definition, on frames of a moved loop."""
    _, here, around = about(four_bar())
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=(2, len(around.unit)))
    x[-1] = y[-1] = 0.0
    here = around.moved(here, 0.3 * rng.normal(size=len(around.unit)))
    gaps = []
    for h in (1e-2, 5e-3):
        there = here
        for step in (x, y, -x, -y):
            there = around.moved(there, h * step)
        expected = around.moved(here, h * h * around.bracket(x, y))
        gaps.append(around.distance(there, expected) / around.distance(there, here))
    assert gaps[0] < 0.2
    assert gaps[1] == pytest.approx(gaps[0] / 2.0, rel=0.1)


def test_derivatives_are_of_fourth_order():
    """Of Φ, along an increment, it is the row itself, to the rounding of its step."""
    _, here, around = about(four_bar())
    rng = np.random.default_rng(4)
    x = rng.normal(size=len(around.unit))
    here = around.moved(here, 0.1 * rng.normal(size=len(around.unit)))
    forms, _ = around.rows(here)
    found = sum(weight * around.rows(there)[1] for weight, there in around.derivative(here, x))
    np.testing.assert_allclose(found, forms @ x, rtol=0.0, atol=1e-9)


def test_time_is_a_coordinate_in_a_unit_in_which_drivers_are_gentle():
    system, here, around = about(read_text(DRIVEN)[0])
    assert around.unit[-1] < 0.02
    driven = np.flatnonzero(system.driven)
    later = around.moved(here, np.append(np.zeros(len(around.unit) - 1), 0.5))
    assert later.time == pytest.approx(0.5 * around.unit[-1])
    forms, _ = around.rows(later)
    # Φ = x − sin 300 t, whose form is dx − 300 cos(300 t) dt
    assert forms[driven[0], -1] == pytest.approx(-300.0 * np.cos(300.0 * later.time) * around.unit[-1])


def test_places_held_and_nearby():
    system, here, around = about(four_bar(), time=False)
    rng = np.random.default_rng(5)
    rows = np.arange(system.rows)
    away = around.moved(here, 0.02 * rng.normal(size=len(around.unit)))
    assert np.abs(around.rows(away)[1]).max() > 1e-3
    held = around.held(away, rows)
    assert isinstance(held, Place)
    assert np.abs(around.rows(held)[1]).max() < 1e-11 * system.size
    near = around.nearby(here, rows, rng, 0.1)
    assert near is not None
    assert np.abs(around.rows(near)[1]).max() < 1e-11 * system.size
    assert 0.01 < around.distance(here, near) < 1.0
    assert around.admitted(near, rows) == 1


def test_a_shaky_structure_has_no_poses_nearby():
    """Bars of 1 and 2 m between points 3 m apart: y can move at right angles for an instant, not at all in fact."""
    system = build_system(read_text(TAUT)[0])
    found = nearby_poses(system, initial_motion(system, []))
    assert found.shaky
    assert found.places == ()
    moving = nearby_poses(system := build_system(four_bar()), initial_motion(system, []))
    assert not moving.shaky
    assert len(moving.places) == 3


def test_parts_share_no_body():
    text = TAUT.replace("between: [a, b]", "between: [ground, b]").replace("[b, ground]", "[a, ground]")
    system = build_system(read_text(text)[0])
    found = parts(system)
    assert [part.bodies.tolist() for part in found] == [[1], [2]]
    assert [len(part.rows) for part in found] == [10, 5]
    assert sorted(np.concatenate([part.columns for part in found]).tolist()) == unknown_velocities(system).tolist()


def test_kernel():
    """Rows of zeros do not count, and dependent ones once."""
    rows = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1e-6, 1e-6, 0.0]])
    found = kernel(rows)
    assert found.shape == (3, 2)
    np.testing.assert_allclose(rows @ found, 0.0, atol=1e-15)
    np.testing.assert_allclose(found.T @ found, np.eye(2), atol=1e-15)

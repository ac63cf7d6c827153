"""Starts that cannot be: every message with its line and column, from the text of a model to the refused run."""

from dataclasses import replace

import pytest

from maggi.analyses.transient import run
from maggi.model import Driver, expression
from maggi.model.errors import ModelError
from maggi.modelfile import read_text
from maggi.results.memory import MemoryRecorder

MODEL = """\
maggi: 1
bodies:
  crank:
    kind: rigid
    mass: 1
    inertia: [0.1, 0.1, 0.1]
    attachments: {pin: {at: [0.1, 0, 0]}}
  rod:
    kind: rigid
    mass: 1
    inertia: [0.1, 0.1, 0.1]
    pose: {origin: [0.1, 0, 0]}
    attachments: {big: {at: [0, 0, 0]}, small: {at: [0.3, 0, 0]}}
  piston:
    kind: rigid
    mass: 1
    inertia: [0.1, 0.1, 0.1]
    pose: {origin: [0.4, 0, 0]}
    attachments: {pin: {at: [0, 0, 0]}}
joints:
  bearing: {type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 0, 1]}
  crankpin: {type: revolute, between: [crank.pin, rod.big], axis: [0, 0, 1]}
  wristpin: {type: revolute, between: [rod.small, piston.pin], axis: [0, 0, 1]}
  cylinder: {type: prismatic, between: [ground, piston.pin], axis: [1, 0, 0]}
  motor: {type: driver, joint: bearing, angle: 10*t}
simulation: {duration: 0.01, step: 1e-3}
"""


def refused(old, new):
    """The located error of the model with one change."""
    assert MODEL.count(old) == 1
    model, source = read_text(MODEL.replace(old, new), name="model.yml")
    recorder = MemoryRecorder()
    with pytest.raises(ModelError) as caught:
        run(model, recorder)
    return source.locate(caught.value)


def place(error):
    return error.file, error.line, error.column


def test_the_model_itself_runs():
    model, _ = read_text(MODEL)
    recorder = MemoryRecorder()
    run(model, recorder)
    assert recorder.results().status == "complete"


def test_driver_that_does_not_start_at_zero():
    """Noticed by the reader at the function itself; in a model that was not read, when the run begins."""
    with pytest.raises(ModelError) as caught:
        read_text(MODEL.replace("angle: 10*t", "angle: 0.25 + 10*t"), name="model.yml")
    assert place(caught.value) == ("model.yml", 25, 48)
    assert "is 0.25 rad at t = 0" in caught.value.message
    model, source = read_text(MODEL, name="model.yml")
    motor = Driver("bearing", "angle", expression("0.25 + 10*t"))
    with pytest.raises(ModelError) as caught:
        run(replace(model, joints={**model.joints, "motor": motor}), MemoryRecorder())
    error = source.locate(caught.value)
    assert place(error) == ("model.yml", 25, 10)
    assert "starts at 0.25 instead of 0" in error.message
    assert "subtract" in error.remedy


def test_gap_between_two_named_attachments():
    error = refused("{at: [0.3, 0, 0]}", "{at: [0.299, 0, 0]}")
    assert place(error) == ("model.yml", 23, 13)
    assert "'wristpin' (rod.small, piston.pin) do not meet" in error.message
    assert "off by 0.001 m" in error.message


def test_initial_velocity_that_the_joints_do_not_admit():
    error = refused(
        "    pose: {origin: [0.4, 0, 0]}\n", "    pose: {origin: [0.4, 0, 0]}\n    velocity: {linear: [0, 0.5, 0]}\n"
    )
    assert place(error) == ("model.yml", 19, 15)
    assert "contradicts the joints" in error.message
    assert "fewer bodies" in error.remedy


def test_initial_velocity_against_the_driver():
    error = refused(
        "    inertia: [0.1, 0.1, 0.1]\n    attachments: {pin: {at: [0.1",
        "    inertia: [0.1, 0.1, 0.1]\n    velocity: {angular: [0, 0, 9]}\n    attachments: {pin: {at: [0.1",
    )
    assert place(error) == ("model.yml", 7, 15)
    assert "contradicts the joints" in error.message


def test_a_second_driver_in_a_mechanism_of_one_freedom():
    error = refused("simulation:", "  second: {type: driver, joint: wristpin, angle: 5*t}\nsimulation:")
    assert place(error) == ("model.yml", 26, 11)
    assert "one too many: the joints together with motor leave its coordinate no freedom" in error.message


def test_a_driver_at_a_dead_centre():
    """With rod and crank in one line the piston cannot move at all."""
    error = refused("joint: bearing, angle: 10*t", "joint: cylinder, displacement: -0.1*t**2")
    assert place(error) == ("model.yml", 25, 10)
    assert "starts in a dead centre of 'cylinder', where driver 'motor' cannot move it" in error.message
    assert error.remedy == "start it a little beside, or drive another joint"

"""``--set key=value``."""

from __future__ import annotations

import pytest

from maggi.model import Driver, Joint, Model, ModelError, RigidBody
from maggi.model.expression import value_at
from maggi.modelfile import read_text

from .samples import EVERYTHING


def change(*overrides: str) -> Model:
    return read_text(EVERYTHING, overrides=overrides)[0]


def test_values_are_replaced() -> None:
    model = change("simulation.step=1e-6", "bodies.disc.mass=2 kg", "joints.a.axis.1=1", "joints.push.speed=2*t")
    assert model.simulation is not None
    assert model.simulation.step == 1e-6
    disc, a, push = model.bodies["disc"], model.joints["a"], model.joints["push"]
    assert isinstance(disc, RigidBody) and isinstance(a, Joint) and isinstance(push, Driver)
    assert disc.mass == 2.0
    assert a.axis == pytest.approx((0.0, 0.5**0.5, 0.5**0.5))
    assert value_at(push.function, [3.0]) == [6.0]


def test_parameters_are_replaced_before_they_are_used() -> None:
    mesh = change("parameters.length=1 m").bodies["beam"].mesh  # type: ignore[union-attr]
    assert mesh.length == 1.0  # type: ignore[union-attr]


def test_the_last_of_two_counts() -> None:
    model = change("title=one", "title=two words")
    assert model.title == "two words"


def test_missing_sections_and_keys_are_made() -> None:
    text = "maggi: 1\nbodies: {a: {kind: rigid, mass: 1}}\n"
    model, _ = read_text(
        text, overrides=["simulation={duration: 1, step: 0.1}", "outputs.every=5", "bodies.a.pose.origin=[1, 2, 3]"]
    )
    assert model.simulation is not None
    assert model.outputs.every == 5
    assert model.bodies["a"].pose.origin == (1.0, 2.0, 3.0)


def test_the_model_keeps_a_record_that_reads_as_a_comment() -> None:
    model = change("simulation.step=1e-6", "title=x")
    assert model.text == EVERYTHING + "\n# --set simulation.step=1e-6\n# --set title=x"
    assert read_text(model.text)[0].title == "One of each"


@pytest.mark.parametrize(
    ("override", "path", "message", "remedy"),
    [
        ("simulation.step", "", "cannot read this option", "write key=value"),
        ("=3", "", "cannot read this option", ""),
        ("a..b=3", "", "cannot read this option", ""),
        ("title=", "", "cannot read this option", ""),
        ("simulation.stp=1", "simulation.stp", "unknown key 'stp'; did you mean 'step'?", ""),
        ("simulation.step=-1", "simulation.step", "greater than 0, found -1", ""),
        ("simulation.step=1 kg", "simulation.step", "expected a time, got a mass", ""),
        ("parameters.lenght=1", "parameters.lenght", "nothing named 'lenght' in parameters", "did you mean 'length'?"),
        ("parameters.length=1 mmm", "parameters.length", "unknown unit 'mmm'", ""),
        ("bodies.dsc.mass=1", "bodies.dsc", "nothing named 'dsc' in bodies", "did you mean 'disc'?"),
        ("joints.a.axis.3=1", "joints.a.axis.3", "'3' is not a place in a list of 3", "count from 0"),
        ("joints.a.axis.x=1", "joints.a.axis.x", "'x' is not a place", ""),
        ("title.x=1", "title.x", "title is a single value", ""),
        ("simulation.step=[1", "", "not valid YAML", ""),
        ("simulation.step=!!python/name:os.system 1", "", "the tag !!python/name:os.system", ""),
    ],
)
def test_wrong_overrides_are_named(override: str, path: str, message: str, remedy: str) -> None:
    with pytest.raises(ModelError) as caught:
        change(override)
    assert caught.value.path == path
    assert message in caught.value.message
    assert remedy in caught.value.remedy
    assert caught.value.file == f"--set {override}"
    assert caught.value.line == 0

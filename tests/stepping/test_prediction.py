"""Predictions save corrections and change nothing else: a step ends where it would without any."""

from __future__ import annotations

import numpy as np
import pytest

from maggi.analyses.prepare import prepare
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import CraigBampton, ElasticBody, RigidBody
from maggi.model.expression import expression
from maggi.model.forces import SpringDamper
from maggi.model.geometry import Pose
from maggi.model.joints import Driver, End, Joint
from maggi.model.materials import Material
from maggi.model.meshes import BoxMesh
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.stepping.stepper import Stepper
from maggi.stepping.tables import BEST, HIGHEST_ORDER

STEP, STEPS = 1e-3, 100
AXIS = (0.0, 1.0, 0.0)
UPRIGHT = ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
INERTIA = ((2e-3, 0.0, 0.0), (0.0, 3e-3, 0.0), (0.0, 0.0, 4e-3))


def link(x: float, z: float, *, upright: bool = False) -> RigidBody:
    pose = Pose((x, 0.0, z), UPRIGHT) if upright else Pose((x, 0.0, z))
    return RigidBody(1.0, (0.05, 0.0, 0.0), INERTIA, pose)


def loop(coupler: RigidBody | ElasticBody) -> Model:
    """A four-bar of unequal lengths in space, whose coupler may be elastic, with a spring across; it falls."""
    sides = {"left": link(0.0, 0.0, upright=True), "right": link(0.2, 0.0, upright=True)}
    first, second = (
        (End("coupler", "a"), End("coupler", "b")) if isinstance(coupler, ElasticBody) else (End("coupler"),) * 2
    )
    return Model(
        {**sides, "coupler": coupler},
        {
            "a": Joint("revolute", End("ground"), End("left"), at=(0.0, 0.0, 0.0), axis=AXIS),
            "b": Joint("revolute", End("ground"), End("right"), at=(0.2, 0.0, 0.0), axis=AXIS),
            "c": Joint("revolute", End("left"), first, at=(0.0, 0.0, 0.1), axis=AXIS),
            "d": Joint("revolute", End("right"), second, at=(0.2, 0.0, 0.1), axis=AXIS),
        },
        {"spring": SpringDamper(End("left"), End("ground", point=(0.4, 0.0, 0.0)), 500.0, 1.0)},
        gravity=(1.0, 0.5, -9.81),
        simulation=Simulation(1.0, STEP, tolerance=1e-11),
    )


def shafts() -> Model:
    """Two shafts with a universal joint between them, the first driven: a closure whose rows turn with both."""
    bend = 0.7
    c, s = float(np.cos(bend)), float(np.sin(bend))
    second = Pose((0.0, 0.0, 0.0), ((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c)))
    return Model(
        {"in": RigidBody(1.0, inertia=INERTIA), "out": RigidBody(1.0, inertia=INERTIA, pose=second)},
        {
            "first": Joint("revolute", End("ground"), End("in"), at=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0)),
            "second": Joint("cylindrical", End("ground"), End("out"), at=(0.0, 0.0, 0.0), axis=(s, 0.0, c)),
            "cross": Joint(
                "universal", End("in"), End("out"), at=(0.0, 0.0, 0.0), axes=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
            ),
            "motor": Driver("first", "angle", expression("20*t + 3*t*t")),
        },
        simulation=Simulation(1.0, STEP, tolerance=1e-11),
    )


def elastic() -> ElasticBody:
    sets = {"a": Attachment(nodes=NamedSet("x_min")), "b": Attachment(nodes=NamedSet("x_max"))}
    return ElasticBody(
        BoxMesh((0.2, 0.02, 0.02), (4, 1, 1), "hex20"),
        Material(2700.0, 7e8, 0.3),
        pose=Pose((0.0, -0.01, 0.09)),
        attachments=sets,
        reduction=CraigBampton(4),
    )


def run(model: Model, *, predicted: bool) -> Stepper:
    stepper, _, _, _ = prepare(model)
    stepper.set_step(STEP)
    for k in range(STEPS):
        if not predicted:
            stepper._alike = 0  # as if every step were the first of its size
        assert stepper.advance(k * STEP, 1) == 1
    return stepper


@pytest.mark.parametrize(
    "model", [loop(link(0.0, 0.1)), loop(elastic()), shafts()], ids=["four-bar", "elastic", "shafts"]
)
def test_steps_end_where_they_would_without_predictions(model: Model) -> None:
    predicted, plain = run(model, predicted=True), run(model, predicted=False)
    assert predicted.work.flags[BEST] >= 2  # high orders were used: the motion is smooth
    assert predicted.counts.corrections < 0.8 * plain.counts.corrections
    for one, other in zip(predicted.state.now, plain.state.now, strict=True):
        scale = max(1.0, float(np.abs(other).max(initial=0.0)))
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-9 * scale)
    assert (predicted.state.residuals < 2e-12).all()


def test_unresolved_oscillations_are_predicted_by_what_they_were() -> None:
    """A step that is long against the period: accelerations change sign, and polynomials through them would explode."""
    bodies = {"ball": RigidBody(1.0, inertia=INERTIA)}
    spring = SpringDamper(End("ground", point=(0.0, 0.0, 1.0)), End("ball"), 1e8, 0.0, 0.99)
    held = {"guide": Joint("prismatic", End("ground"), End("ball"), at=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0))}
    stepper, _, _, _ = prepare(Model(bodies, held, {"spring": spring}, simulation=Simulation(1.0, STEP, rho_inf=1.0)))
    stepper.set_step(STEP)
    assert stepper.advance(0.0, 200) == 200
    assert stepper.work.flags[BEST] < HIGHEST_ORDER
    assert abs(float(stepper.state.now.origin[-1, 2])) <= 0.0201

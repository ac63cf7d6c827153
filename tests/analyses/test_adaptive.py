"""Steps as long as an error allows: fewer for the same error, aligned rows, and nothing lost by changing back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from maggi.analyses.adaptive import AdaptiveSteps
from maggi.analyses.prepare import prepare
from maggi.analyses.transient import run
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody, RigidBody
from maggi.model.expression import expression
from maggi.model.forces import PointLoad
from maggi.model.joints import End, Joint
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BoxMesh
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.results.memory import MemoryRecorder

INERTIA = ((1e-3, 0.0, 0.0), (0.0, 0.02, 0.0), (0.0, 0.0, 0.02))
# a blow of 0.2 N s in 3 ms, half a second into the run
BLOW = "100*sin(pi*min(1, max(0, (t - 0.5003)/0.0031)))"


def struck(simulation: Simulation) -> Model:
    """A pendulum that hangs at rest and is struck once."""
    nothing = expression(0.0)
    return Model(
        bodies={"rod": RigidBody(1.0, (0.0, 0.0, -0.25), INERTIA, attachments={"tip": Attachment(at=(0, 0, -0.5))})},
        joints={"hinge": Joint("revolute", End("ground"), End("rod"), at=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0))},
        forces={"blow": PointLoad(End("rod", "tip"), "force", (expression(BLOW), nothing, nothing))},
        gravity=(0.0, 0.0, -9.81),
        simulation=simulation,
    )


def angle(model: Model) -> tuple[np.ndarray, np.ndarray, object]:
    recorder = MemoryRecorder()
    summary = run(model, recorder)
    results = recorder.results()
    return results.time[:], results.joint("hinge").coordinate[:, 0], summary


def auto(accuracy: float, longest: float = 0.02) -> Simulation:
    return Simulation(1.0, longest, accuracy=accuracy)


@pytest.fixture(scope="module")
def reference() -> float:
    """The last angle by steps of 10 µs, extrapolated with those of 20 µs: second order."""
    fine, coarse = (angle(struck(Simulation(1.0, h)))[1][-1] for h in (1e-5, 2e-5))
    return fine + (fine - coarse) / 3.0


def test_a_short_blow_takes_a_third_of_the_steps_for_the_same_error(reference: float) -> None:
    _, adaptive, summary = angle(struck(auto(1e-7)))
    error = abs(adaptive[-1] - reference)
    assert summary.rejected > 0
    # steps of one size by halves until they are as accurate
    h = 4e-3
    while abs(angle(struck(Simulation(1.0, h)))[1][-1] - reference) > error:
        h /= 2.0
    assert 1.0 / h >= 3.0 * (summary.steps + summary.rejected)


def test_the_error_follows_the_accuracy(reference: float) -> None:
    """Local errors of third order: an eighth of the accuracy halves the steps, which leaves a quarter of the error."""
    errors, steps = [], []
    for accuracy in (8e-7, 1e-7, 1.25e-8):
        _, found, summary = angle(struck(auto(accuracy)))
        errors.append(abs(found[-1] - reference))
        steps.append(summary.steps)
    assert 1.5 < steps[1] / steps[0] < 2.7 and 1.5 < steps[2] / steps[1] < 2.7
    assert errors[2] < errors[0] / 4.0


def test_rows_stand_at_the_nominal_steps(reference: float) -> None:
    time, _, _ = angle(struck(auto(1e-6, 0.05)))
    np.testing.assert_allclose(time, np.arange(21) * 0.05, rtol=0, atol=1e-15)


def test_steps_of_one_size_come_out_as_without_an_accuracy() -> None:
    """Where every nominal step is accurate enough, nothing is subdivided and not a bit differs."""
    plain = angle(struck(Simulation(0.4, 0.02)))
    loose = angle(struck(replace(auto(0.5), duration=0.4)))
    np.testing.assert_array_equal(plain[1], loose[1])
    assert loose[2].rejected == 0 and loose[2].steps == 20


def test_a_blow_between_two_nominal_steps_is_not_missed(reference: float) -> None:
    """All is at rest at both ends of the nominal step that the blow, a fifth of it, falls into."""
    _, found, _ = angle(struck(auto(1e-6, 0.02)))
    assert abs(found[-1] - reference) < 1e-3


@pytest.mark.slow
def test_a_mesh_is_factorised_once_for_each_size_of_step() -> None:
    """Going back to a size that is kept costs no factorisation."""
    bar = ElasticBody(
        BoxMesh((0.5, 0.05, 0.05), (10, 1, 1), "hex8"),
        Material(1000.0, 1e8, 0.3, Damping(stiffness=2e-2)),
        attachments={"root": Attachment(nodes=NamedSet("x_min")), "tip": Attachment(nodes=NamedSet("x_max"))},
    )
    blows = expression("100*exp(-((t - 0.1)/0.01)**2) + 100*exp(-((t - 0.4)/0.01)**2)")
    model = Model(
        bodies={"bar": bar},
        joints={"hinge": Joint("revolute", End("ground"), End("bar", "root"), axis=(0.0, 1.0, 0.0))},
        forces={"blow": PointLoad(End("bar", "tip"), "force", (expression(0.0), expression(0.0), blows))},
        simulation=Simulation(0.6, 1e-3, accuracy=2e-6),
    )
    stepper, _, _, _ = prepare(model)
    sizes: list[float] = []
    set_step = stepper.set_step

    def counted(h: float) -> None:
        sizes.append(h)
        set_step(h)

    stepper.set_step = counted  # type: ignore[method-assign]
    steps = AdaptiveSteps(stepper, 1e-3, 2e-6)
    for k in range(600):
        steps.steps(k, 1)
    assert 2 <= len(set(sizes)) <= 3
    assert len(sizes) >= 2 * len(set(sizes))
    assert stepper.counts.factorisations == len(set(sizes))

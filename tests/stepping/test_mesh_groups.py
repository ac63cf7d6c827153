"""Full-mesh bodies that are the same share their factor, and move as they would by themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from maggi.analyses.prepare import prepare
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.materials import Material
from maggi.model.meshes import BoxMesh
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.stepping.stepper import Stepper

STEP, STEPS = 1e-3, 30
BAR = ElasticBody(
    BoxMesh((0.5, 0.02, 0.03), (8, 1, 1), "hex20"),
    Material(2700.0, 7e10, 0.3),
    attachments={"root": Attachment(nodes=NamedSet("x_min")), "tip": Attachment(nodes=NamedSet("x_max"))},
)


def bars(bodies: list[ElasticBody]) -> Model:
    """Bars side by side, hinged at their roots, each turned further out of the vertical."""
    placed, joints = {}, {}
    for i, body in enumerate(bodies):
        c, s = np.cos(0.3 * i), np.sin(0.3 * i)
        turn = ((float(c), 0.0, float(s)), (0.0, 1.0, 0.0), (-float(s), 0.0, float(c)))
        placed[f"bar{i}"] = replace(body, pose=Pose((0.0, 0.2 * i, 0.0), turn))
        joints[f"hinge{i}"] = Joint("revolute", End("ground"), End(f"bar{i}", "root"), axis=(0.0, 1.0, 0.0))
    return Model(placed, joints, gravity=(0.0, 0.0, -9.81), simulation=Simulation(1.0, STEP))


def moved(model: Model) -> Stepper:
    stepper, _, _, _ = prepare(model, exact=True)
    stepper.set_step(STEP)
    assert stepper.advance(0.0, STEPS) == STEPS
    return stepper


@pytest.mark.parametrize("count", [2, 5])
def test_bodies_that_are_the_same_share_a_factor_and_move_alike(count: int) -> None:
    """By value: every bar has a description of its own. From three on they are solved together."""
    together = moved(bars([replace(BAR, material=replace(BAR.material)) for _ in range(count)]))
    assert len(together.meshes) == count
    assert together.counts.factorisations == 1
    for i in range(count):
        # the same bar alone, among others that are none of its kind
        others = [replace(BAR, material=Material(2800.0 + k, 7e10, 0.3)) for k in range(count)]
        others[i] = BAR
        if i in (0, count - 1):
            alone = moved(bars(others))
            assert alone.counts.factorisations == count
            one, other = together.meshes[i], alone.meshes[i]
            # round-off of the joints' positions (m), to which stiff bodies answer, and of velocities over a step (m/s)
            np.testing.assert_allclose(one.u, other.u, rtol=0, atol=1e-12)
            np.testing.assert_allclose(one.ud, other.ud, rtol=0, atol=1e-12 / STEP)
            np.testing.assert_allclose(
                together.state.now.origin[i + 1], alone.state.now.origin[i + 1], rtol=0, atol=1e-12
            )


@pytest.mark.parametrize(
    "change",
    [
        {"material": Material(2700.0, 7.1e10, 0.3)},
        {"mesh": BoxMesh((0.5, 0.02, 0.03), (9, 1, 1), "hex20")},
        {"attachments": {**BAR.attachments, "tip": Attachment(nodes=NamedSet("x_max"), coupling="average")}},
    ],
    ids=["material", "mesh", "coupling"],
)
def test_bodies_that_differ_do_not_share(change: dict[str, object]) -> None:
    stepper, _, _, _ = prepare(bars([BAR, replace(BAR, **change)]))
    stepper.set_step(STEP)
    assert stepper.counts.factorisations == 2
    assert len(stepper.mesh_groups) == 2

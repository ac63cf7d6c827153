"""Liaisons of meshed bodies are met to round-off at all three levels, and nothing adds up from step to step."""

from __future__ import annotations

import numpy as np
import pytest

from maggi.analyses.prepare import prepare
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody
from maggi.model.joints import End, Joint
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BoxMesh
from maggi.model.model import Model
from maggi.model.simulation import Simulation

STEP, STEPS = 1e-3, 100


@pytest.mark.parametrize("damping", [None, Damping(stiffness=1e-6)], ids=["undamped", "damped"])
def test_residuals_of_a_mesh_do_not_grow(damping: Damping | None) -> None:
    """A soft bar hinged at one end falls. The small system's copies of nodal values follow the nodes' own history."""
    body = ElasticBody(
        BoxMesh((0.5, 0.02, 0.02), (10, 1, 1), "hex20"),
        Material(2700.0, 7e10, 0.3, *(() if damping is None else (damping,))),
        attachments={"root": Attachment(nodes=NamedSet("x_min")), "tip": Attachment(nodes=NamedSet("x_max"))},
    )
    hinge = Joint("revolute", End("ground"), End("bar", "root"), axis=(0.0, 1.0, 0.0))
    model = Model({"bar": body}, {"hinge": hinge}, gravity=(0.0, 0.0, -9.81), simulation=Simulation(1.0, STEP))
    stepper, _, _, _ = prepare(model)
    stepper.set_step(STEP)
    found = []
    for k in range(4):
        assert stepper.advance(k * STEPS * STEP, STEPS) == STEPS
        found.append(stepper.state.residuals.copy())
    assert (np.array(found) < (1e-14, 1e-12, 2e-11)).all(), found
    assert found[-1][2] < 4.0 * found[0][2], found

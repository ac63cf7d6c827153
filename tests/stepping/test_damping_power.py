"""The power of damping of several instants against dense matrices."""

import numpy as np
import pytest

from maggi.bodies.mesh_body import build_mesh_body
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BeamMesh, BoxMesh, Section
from maggi.stepping.damping_power import DampingPower

MESHES = {
    "solid": (BoxMesh((0.5, 0.1, 0.2), (3, 1, 1), "tet10"), NamedSet("x_min")),
    "beam": (BeamMesh(0.5, Section.rectangle(0.02, 0.03), 4), NamedSet("start")),
}


@pytest.mark.parametrize("damping", [Damping(stiffness=1e-3), Damping(mass=2.0), Damping(2.0, 1e-3)], ids=str)
@pytest.mark.parametrize("kind", MESHES)
def test_powers_of_the_instants_kept(kind, damping):
    mesh, root = MESHES[kind]
    description = ElasticBody(mesh, Material(2700.0, 1e6, 0.3, damping), attachments={"root": Attachment(nodes=root)})
    body = build_mesh_body("m", description, ".")
    D = damping.mass * body.inertia.matrix + damping.stiffness * body.K.matrix()
    power, rng = DampingPower(body), np.random.default_rng(0)
    assert power.find(0).size == 0
    for count in (4, 1, 3):
        velocities = rng.normal(size=(count, body.size))
        for place, ud in enumerate(velocities):
            power.keep(place, ud)
        np.testing.assert_allclose(power.find(count), [ud @ (D @ ud) for ud in velocities], rtol=1e-12)

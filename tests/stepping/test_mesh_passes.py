"""Passes compiled before there is a body are those that bodies use."""

import pytest

from maggi.bodies import isotropic_kernels
from maggi.elements import products
from maggi.stepping import nodal_kernels
from maggi.stepping.mesh_passes import compile_passes

PASSES = [
    *(isotropic_kernels.accelerations, isotropic_kernels.inertia_forces, isotropic_kernels.gather_tied),
    *(products._multiply, products._add_up),
    *(nodal_kernels.predict_nodal, nodal_kernels.correct_nodal),
]


@pytest.mark.parametrize("rigid", [True, False], ids=["tied nodes", "free nodes"])
def test_a_body_needs_no_others(rigid, monkeypatch):
    from maggi.analyses.transient import run
    from maggi.model.attachments import Attachment, NamedSet
    from maggi.model.bodies import ElasticBody
    from maggi.model.joints import End, Joint
    from maggi.model.materials import Damping, Material
    from maggi.model.meshes import BoxMesh
    from maggi.model.model import Model
    from maggi.model.simulation import Simulation
    from maggi.results.memory import MemoryRecorder

    for shared in PASSES:
        monkeypatch.setattr(shared, "_addresses", {})
    compile_passes()
    compiled = [set(shared._addresses) for shared in PASSES]
    assert all(len(kinds) == 1 for kinds in compiled)
    attachment = Attachment(nodes=NamedSet("x_min"), coupling="rigid" if rigid else "average")
    body = ElasticBody(
        BoxMesh((0.4, 0.1, 0.1), (2, 1, 1), "tet10"),
        Material(7800.0, 2e11, 0.3, Damping(0.1, 1e-6)),
        attachments={"a": attachment},
    )
    joint = Joint("revolute", End("ground"), End("bar", "a"), axis=(0.0, 1.0, 0.0))
    run(Model({"bar": body}, {"hinge": joint}, simulation=Simulation(0.002, 1e-3)), MemoryRecorder())
    assert [set(shared._addresses) for shared in PASSES] == compiled

"""Passes compiled before there is a body are those that bodies use."""

import pytest

from maggi.analyses.transient import run
from maggi.bodies import isotropic_kernels
from maggi.elements import products
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody
from maggi.model.joints import End, Joint
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BeamMesh, BoxMesh, Section
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.results.memory import MemoryRecorder
from maggi.stepping import nodal_kernels
from maggi.stepping.mesh_passes import compile_passes

SOLIDS = [isotropic_kernels.accelerations, isotropic_kernels.inertia_forces]
ALL = [products._multiply, products._add_up, nodal_kernels.predict_nodal, nodal_kernels.correct_nodal]
BOX = BoxMesh((0.4, 0.1, 0.1), (2, 1, 1), "tet10")
MATERIAL = Material(7800.0, 2e11, 0.3, Damping(0.1, 1e-6))


@pytest.mark.parametrize(
    ("mesh", "attachment"),
    [
        (BOX, Attachment(nodes=NamedSet("x_min"), coupling="rigid")),
        (BOX, Attachment(nodes=NamedSet("x_min"), coupling="average")),
        (BeamMesh(0.4, Section.circle(0.05), 3), Attachment(nodes=NamedSet("start"))),
    ],
    ids=["tied nodes", "free nodes", "beam"],
)
def test_a_body_needs_no_others(mesh, attachment, monkeypatch):
    for shared in SOLIDS + ALL:
        monkeypatch.setattr(shared, "_addresses", {})
    compile_passes(solids=mesh is BOX)
    compiled = [set(shared._addresses) for shared in SOLIDS + ALL]
    assert [len(kinds) for kinds in compiled] == [int(mesh is BOX)] * len(SOLIDS) + [1] * len(ALL)
    body = ElasticBody(mesh, MATERIAL, attachments={"a": attachment})
    joint = Joint("revolute", End("ground"), End("body", "a"), axis=(0.0, 1.0, 0.0))
    run(Model({"body": body}, {"hinge": joint}, simulation=Simulation(0.002, 1e-3)), MemoryRecorder())
    assert [set(shared._addresses) for shared in SOLIDS + ALL] == compiled

"""Runs do not depend on how many threads share the work: not in a single bit."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

RUN = """
import hashlib

import numpy as np

import maggi
from maggi.stepping import mesh_step

AXIS = (0.0, 1.0, 0.0)


def bar(place, reduction=None):
    sets = {"root": maggi.NamedSet("x_min"), "tip": maggi.NamedSet("x_max")}
    return maggi.ElasticBody(
        maggi.BoxMesh((0.5, 0.04, 0.04), CELLS, "tet10"),
        maggi.Material(2700.0, 7e10, 0.3, damping=maggi.Damping(stiffness=1e-6)),
        pose=maggi.Pose((place, 0.0, 0.0)),
        attachments={name: maggi.Attachment(nodes=nodes) for name, nodes in sets.items()},
        reduction=reduction,
    )


model = maggi.Model(
    bodies={"one": bar(0.0), "two": bar(0.5), "three": bar(1.0), "reduced": bar(1.5, maggi.CraigBampton(4))},
    joints={
        "a": maggi.Joint("revolute", maggi.End("ground"), maggi.End("one", "root"), axis=AXIS),
        "b": maggi.Joint("revolute", maggi.End("one", "tip"), maggi.End("two", "root"), axis=AXIS),
        "c": maggi.Joint("spherical", maggi.End("two", "tip"), maggi.End("three", "root"), axis=AXIS),
        "d": maggi.Joint("revolute", maggi.End("three", "tip"), maggi.End("reduced", "root"), axis=AXIS),
    },
    gravity=(0.0, 0.0, -9.81),
    simulation=maggi.Simulation(0.02, 1e-3),
)
mesh_step.THREADED = 0
results = maggi.run(model)
for name in model.bodies:
    body = results.body(name)
    # displacements of the reduced body are products made on reading
    parts = (body.modal, body.basis) if name == "reduced" else (body.displacement,)
    parts = body.origin, body.rotation, *parts
    print(name, hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).hexdigest())
for name in model.joints:
    joint = results.joint(name)
    print(name, hashlib.sha256(joint.force[:].tobytes() + joint.torque[:].tobytes()).hexdigest())
"""
VARIABLES = ("NUMBA_NUM_THREADS", "RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def digests(threads: int, cells: str) -> str:
    """What a process with so many threads computes."""
    environment = {**os.environ, **dict.fromkeys(VARIABLES, str(threads))}
    script = RUN.replace("CELLS", cells)
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


# the second is ordered by nested dissection, whose branches are solved by a thread each
@pytest.mark.parametrize("cells", ["(6, 1, 1)", pytest.param("(40, 4, 4)", marks=pytest.mark.slow)])
def test_runs_are_the_same_for_any_number_of_threads(cells: str) -> None:
    one = digests(1, cells)
    assert len(one.splitlines()) == 8
    assert digests(2, cells) == one

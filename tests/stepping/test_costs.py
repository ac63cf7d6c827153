"""What a step costs in counts that no machine changes: corrections, factorisations, back-substitutions, allocations.

Bounds are a little above what was counted when they were written; a change that lifts one has made steps dearer.
"""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit
from numba.core.runtime import _nrt_python, rtsys

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

STEP, STEPS = 1e-3, 200
AXIS = (0.0, 1.0, 0.0)


def link(x: float, z: float = 0.0, turn: np.ndarray | None = None) -> RigidBody:
    """A slender link of 0.1 m and 1 kg along its own x axis, from its hinge at (x, 0, z)."""
    J = 0.1**2 / 12.0
    rotation = np.eye(3) if turn is None else turn
    pose = Pose((x, 0.0, z), tuple(map(tuple, rotation.tolist())))
    return RigidBody(1.0, (0.05, 0.0, 0.0), ((J / 10, 0.0, 0.0), (0.0, J, 0.0), (0.0, 0.0, J)), pose=pose)


def chain(count: int) -> Model:
    """Links in line, released under gravity."""
    names = ["ground", *(f"link{i}" for i in range(count))]
    return Model(
        bodies={f"link{i}": link(0.1 * i) for i in range(count)},
        joints={
            f"joint{i}": Joint("revolute", End(names[i]), End(names[i + 1]), at=(0.1 * i, 0.0, 0.0), axis=AXIS)
            for i in range(count)
        },
        gravity=(0.0, 0.0, -9.81),
        simulation=Simulation(1.0, STEP),
    )


def four_bar() -> Model:
    """A parallelogram of revolutes in space, three of whose rows are redundant, driven, with a spring across."""
    up = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    bodies = {"left": link(0.0, turn=up), "right": link(0.1, turn=up), "top": link(0.0, 0.1)}
    joints = {
        "a": Joint("revolute", End("ground"), End("left"), at=(0.0, 0.0, 0.0), axis=AXIS),
        "b": Joint("revolute", End("ground"), End("right"), at=(0.1, 0.0, 0.0), axis=AXIS),
        "c": Joint("revolute", End("left"), End("top"), at=(0.0, 0.0, 0.1), axis=AXIS),
        "d": Joint("revolute", End("right"), End("top"), at=(0.1, 0.0, 0.1), axis=AXIS),
        "motor": Driver("a", "angle", expression("0.5*t*t")),
    }
    forces = {"spring": SpringDamper(End("ground", point=(0.2, 0.0, 0.0)), End("top"), 1e4, 1.0)}
    return Model(bodies, joints, forces, gravity=(0.0, 0.0, -9.81), simulation=Simulation(1.0, STEP))


def bar(reduction: CraigBampton | None) -> Model:
    """A soft bar hinged at one end, released under gravity: full mesh or reduced."""
    body = ElasticBody(
        BoxMesh((0.5, 0.02, 0.02), (10, 1, 1), "hex20"),
        Material(2700.0, 7e10, 0.3),
        attachments={"root": Attachment(nodes=NamedSet("x_min")), "tip": Attachment(nodes=NamedSet("x_max"))},
        reduction=reduction,
    )
    return Model(
        bodies={"bar": body},
        joints={"hinge": Joint("revolute", End("ground"), End("bar", "root"), axis=AXIS)},
        gravity=(0.0, 0.0, -9.81),
        simulation=Simulation(1.0, STEP),
    )


def run(model: Model) -> Stepper:
    """A stepper after STEPS steps; its counts are of those alone."""
    stepper, _, _, _ = prepare(model)
    stepper.set_step(STEP)
    stepper.counts.corrections = stepper.counts.back_substitutions = 0
    assert stepper.advance(0.0, STEPS) == STEPS
    return stepper


# counted: chain 1.1, four-bar 1.1, reduced bar 2.0
@pytest.mark.parametrize(
    ("model", "corrections"),
    [(chain(10), 1.4), (four_bar(), 1.4), (bar(CraigBampton(6)), 2.3)],
    ids=["chain", "four-bar", "reduced bar"],
)
def test_corrections_a_step(model: Model, corrections: float) -> None:
    assert run(model).counts.corrections / STEPS <= corrections


def test_back_substitutions_and_factorisations_of_a_mesh() -> None:
    """One solve a step but for checks, and one factor for a size of step however far the body turns."""
    counts = run(bar(None)).counts
    assert counts.factorisations == 1
    assert counts.back_substitutions / STEPS <= 1.15


@njit
def _wasteful() -> float:
    return np.zeros(1000).sum()


def test_allocations_of_kernels_are_noticed() -> None:
    """What the next test counts with."""
    _wasteful()
    _nrt_python.memsys_enable_stats()
    try:
        before = rtsys.get_allocation_stats().alloc
        _wasteful()
        assert rtsys.get_allocation_stats().alloc > before
    finally:
        _nrt_python.memsys_disable_stats()


@pytest.mark.parametrize("model", [chain(10), four_bar()], ids=["chain", "four-bar"])
def test_steps_allocate_nothing(model: Model) -> None:
    """Twice as many steps, not one allocation more."""
    stepper = run(model)
    _nrt_python.memsys_enable_stats()
    try:
        spent = []
        for k in (1, 2):
            before = rtsys.get_allocation_stats().alloc
            stepper.advance(STEPS * STEP, 50 * k)
            spent.append(rtsys.get_allocation_stats().alloc - before)
    finally:
        _nrt_python.memsys_disable_stats()
    assert spent[0] == spent[1]

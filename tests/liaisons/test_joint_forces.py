"""The sign of joint forces: by first on second, about the joint's point on second, in global axes (T11)."""

import numpy as np
import pytest
from motions import rows_at

import maggi
from maggi.bodies.small_bodies import body_residual
from maggi.model.bodies import RigidBody
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.projection.maggi import liaison_forces, project
from maggi.system.build import build_system
from maggi.system.dense import dense_rows

MASS, GRAVITY = 3.0, 9.0
CENTER, PIN = np.array([0.5, 0.2, -0.1]), np.array([0.1, 0.0, 0.4])
TURN = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


@pytest.mark.parametrize("order", [("ground", "body"), ("body", "ground")])
@pytest.mark.parametrize("name", ["weld", "revolute", "prismatic"])
def test_joint_carries_a_body_at_rest(name, order):
    """Ground pushes up with m g and holds the moment of the weight; as second, ground feels the opposite."""
    body = RigidBody(MASS, tuple(CENTER), pose=Pose((1.0, 2.0, 3.0), TURN))
    place = np.array([1.0, 2.0, 3.0]) + np.array(TURN) @ PIN
    # axes about and along which the weight does nothing
    axis = (0.0, 0.0, 1.0) if name == "revolute" else (1.0, 0.0, 0.0)
    joint = Joint(name, End(order[0]), End(order[1]), at=tuple(place), axis=axis)
    system = build_system(Model({"body": body}, {"joint": joint}, gravity=(0.0, 0.0, -GRAVITY)))
    state = system.start
    weight = body_residual(system.bodies, 1, state, system.forces.gravity)
    rows = rows_at(system, state, 0.0)
    multipliers = liaison_forces(project(dense_rows(system, state, 0.0).A), -weight)
    wrench = -multipliers @ rows.wrench[1::2]
    force, torque = wrench[:3], wrench[3:]
    up = np.array([0.0, 0.0, MASS * GRAVITY])
    holding = np.cross(np.array(TURN) @ (CENTER - PIN), up)
    sign = 1.0 if order[0] == "ground" else -1.0
    np.testing.assert_allclose(force, sign * up, atol=1e-12)
    np.testing.assert_allclose(torque, sign * holding, atol=1e-12)


def test_two_hinges_share_a_load_and_are_marked():
    """A door on two equal hinges in line: half of the weight along the axis each, not unique; across it unique.

    Statics: the couple of the weight is taken by horizontal forces ± m g c / d at distance d; hinges' torques repeat
    each other's forces and get nothing beyond the least norm.
    """
    door = RigidBody(MASS, (0.4, 0.0, 0.5))
    hinges = {
        name: Joint("revolute", End("ground"), End("door"), at=(0.0, 0.0, z), axis=(0, 0, 1))
        for name, z in (("low", 0.0), ("high", 1.0))
    }
    model = Model({"door": door}, hinges, gravity=(0.0, 0.0, -GRAVITY), simulation=Simulation(1e-2, 1e-2))
    with pytest.warns(UserWarning, match="the forces of low, high are not unique"):
        results = maggi.run(model)
    low, high = results.joint("low"), results.joint("high")
    assert not low.unique.any() and not high.unique.any()
    np.testing.assert_allclose(low.force[-1, 2], high.force[-1, 2], rtol=1e-12)
    np.testing.assert_allclose(low.force[-1] + high.force[-1], [0.0, 0.0, MASS * GRAVITY], atol=1e-9)
    single = maggi.run(
        Model({"door": door}, {"low": hinges["low"]}, gravity=model.gravity, simulation=model.simulation)
    )
    assert single.joint("low").unique.all()

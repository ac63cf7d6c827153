"""Prescribed frames: given functions against differences of the pose, recorded motions between their instants."""

import numpy as np
import pytest
from motions import axial, derivative, rigid_body, second_derivative

from maggi.bodies.motions import prescribe
from maggi.bodies.tables import MotionState
from maggi.linalg.rotations import rotation_matrix
from maggi.model.bodies import ElasticBody, GivenMotion, RigidBody, RigidRunMotion
from maggi.model.expression import expression
from maggi.model.geometry import Pose
from maggi.model.materials import Material
from maggi.model.meshes import BoxMesh
from maggi.model.model import Model
from maggi.system.build import RecordedMotion, build_system

ORIGIN = ("0.3*sin(3*t)", "t*t - 0.5*t", "exp(-t)")
AXIS = np.array([1.0, -2.0, 2.0])
TURN = rotation_matrix(np.array([0.3, -0.8, 0.5]))
POSE = Pose((9.0, 9.0, 9.0), tuple(tuple(row) for row in TURN))


def at(system, t):
    state = MotionState(*(part.copy() for part in system.start))
    prescribe(system.motions, system.bodies, t, state)
    return state


def test_given_functions():
    """Pose by its definition; twist (Rᵀṙ, ω) and its rate by differences of the pose."""
    given = GivenMotion(tuple(expression(text) for text in ORIGIN), tuple(AXIS), expression("2*t + sin(t)"))
    bodies = {
        "free": rigid_body(np.random.default_rng(0)),
        "held": RigidBody(1.0, pose=POSE, motion=given),
        "still": RigidBody(1.0, pose=POSE, motion=GivenMotion()),
    }
    system = build_system(Model(bodies))
    t = 0.4
    state = at(system, t)
    np.testing.assert_allclose(state.origin[2], [0.3 * np.sin(1.2), -0.04, np.exp(-0.4)], atol=1e-15)
    angle = 2.0 * t + np.sin(t)
    np.testing.assert_allclose(state.rotation[2], TURN @ rotation_matrix(angle * AXIS / 3.0), atol=1e-15)
    R, o = state.rotation[2], system.bodies.offset[2]
    v, w = state.v[o : o + 3], state.v[o + 3 : o + 6]
    np.testing.assert_allclose(v, R.T @ derivative(lambda s: at(system, s).origin[2], t), atol=1e-11)
    np.testing.assert_allclose(w, axial(R.T @ derivative(lambda s: at(system, s).rotation[2], t)), atol=1e-11)
    acceleration = R.T @ second_derivative(lambda s: at(system, s).origin[2], t)
    np.testing.assert_allclose(state.vd[o : o + 3], acceleration - np.cross(w, v), atol=1e-10)
    rate = axial(R.T @ second_derivative(lambda s: at(system, s).rotation[2], t))
    np.testing.assert_allclose(state.vd[o + 3 : o + 6], rate, atol=1e-10)
    # the free body and the one without functions stay where they were
    np.testing.assert_array_equal(state.origin[[1, 3]], system.start.origin[[1, 3]])
    np.testing.assert_allclose(state.rotation[[1, 3]], system.start.rotation[[1, 3]], atol=1e-15)
    assert not state.v[: system.bodies.offset[2]].any() and not state.v[system.bodies.offset[3] :].any()


def exact(t):
    """A motion to record: origin, rotation, twist and rate at time t, ω about an axis that does not stay."""

    def origin(s):
        return np.array([np.sin(3.0 * s), 0.5 * s * s, np.cos(2.0 * s)])

    def rotation(s):
        return (
            TURN @ rotation_matrix(np.array([np.sin(2.0 * s), 0.0, s])) @ rotation_matrix(np.array([0.0, s * s, 0.0]))
        )

    R = rotation(t)
    v, w = R.T @ derivative(origin, t), axial(R.T @ derivative(rotation, t))
    rate = axial(R.T @ second_derivative(rotation, t))
    vd = R.T @ second_derivative(origin, t) - np.cross(w, v)
    return origin(t), R, np.concatenate([v, w]), np.concatenate([vd, rate])


def recorded_system(step, count):
    values = [exact(k * step) for k in range(count)]
    record = RecordedMotion(step, *(np.array(part) for part in zip(*values, strict=True)))
    body = ElasticBody(BoxMesh((1.0, 1.0, 1.0), (1, 1, 1)), Material(1.0, 1.0, 0.3), motion=RigidRunMotion())
    return build_system(Model({"part": body}), recorded={"part": record})


def test_recorded_instants_are_met_exactly():
    system = recorded_system(0.1, 4)
    for k in range(4):
        state = at(system, k * 0.1)
        origin, rotation, twist, rate = exact(k * 0.1)
        o = system.bodies.offset[1]
        np.testing.assert_allclose(state.origin[1], origin, atol=1e-14)
        np.testing.assert_allclose(state.rotation[1], rotation, atol=1e-14)
        np.testing.assert_allclose(state.v[o : o + 6], twist, atol=1e-13)
        np.testing.assert_allclose(state.vd[o : o + 6], rate, atol=1e-13)
        # the helper that attachments are held by moves along
        np.testing.assert_array_equal(state.origin[1], state.origin[2])
        np.testing.assert_array_equal(state.rotation[1], state.rotation[2])


@pytest.mark.parametrize(("what", "order"), [("pose", 3), ("rates", 2)])
def test_order_between_recorded_instants(what, order):
    """Half-way between two instants: positions err with the third power of the step, twists and rates with the second."""
    errors = []
    for step in (0.04, 0.02, 0.01):
        system = recorded_system(step, 3)
        state = at(system, 1.5 * step)
        origin, rotation, twist, rate = exact(1.5 * step)
        o = system.bodies.offset[1]
        pose = max(np.abs(state.origin[1] - origin).max(), np.abs(state.rotation[1] - rotation).max())
        rates = max(np.abs(state.v[o : o + 6] - twist).max(), np.abs(state.vd[o : o + 6] - rate).max())
        errors.append(pose if what == "pose" else rates)
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert slopes[-1] == pytest.approx(order, abs=0.15)

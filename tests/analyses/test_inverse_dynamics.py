"""Actuator forces against the closed form of the two-link arm, drivers in a closed loop, and the forward problem."""

import numpy as np
import pytest

import maggi
from maggi.analyses.initial import initial_motion
from maggi.analyses.inverse_dynamics import coordinate_numbers, coordinates_at, inverse_dynamics
from maggi.model import Driver, End, Joint, Model, ModelError, Pose, RigidBody, Simulation, Velocity, expression
from maggi.system.build import build_system

L1, L2, C1, C2, M1, M2, I1, I2, G = 0.8, 0.6, 0.35, 0.25, 3.0, 2.0, 0.2, 0.1, 9.81


def arm(q1=0.0, q2=0.0, w1=0.0, w2=0.0):
    """Two links in the x-y plane, gravity along −y; angles from the pose along x that the model has at q1 = q2 = 0."""

    def link(mass, center, inertia, origin, angle, velocity, spin):
        c, s = np.cos(angle), np.sin(angle)
        rotation = ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))
        tensor = ((0.01, 0.0, 0.0), (0.0, inertia, 0.0), (0.0, 0.0, inertia))
        return RigidBody(mass, (center, 0.0, 0.0), tensor, Pose(origin, rotation), Velocity(velocity, (0.0, 0.0, spin)))

    elbow = (L1 * np.cos(q1), L1 * np.sin(q1), 0.0)
    speed = (-L1 * w1 * np.sin(q1), L1 * w1 * np.cos(q1), 0.0)
    bodies = {
        "upper": link(M1, C1, I1, (0.0, 0.0, 0.0), q1, (0.0, 0.0, 0.0), w1),
        "lower": link(M2, C2, I2, elbow, q1 + q2, speed, w1 + w2),
    }
    axis = (0.0, 0.0, 1.0)
    joints = {
        "shoulder": Joint("revolute", End("ground"), End("upper"), at=(0.0, 0.0, 0.0), axis=axis),
        "elbow": Joint("revolute", End("upper"), End("lower"), at=elbow, axis=axis),
    }
    return Model(bodies, joints, gravity=(0.0, -G, 0.0))


def torques(q, w, a):
    """The manipulator equation of the two-link arm, from Lagrange's equations."""
    c2, s2 = np.cos(q[1]), np.sin(q[1])
    m11 = I1 + I2 + M1 * C1**2 + M2 * (L1**2 + C2**2 + 2 * L1 * C2 * c2)
    m12 = I2 + M2 * (C2**2 + L1 * C2 * c2)
    m22 = I2 + M2 * C2**2
    h = M2 * L1 * C2 * s2
    g2 = M2 * G * C2 * np.cos(q[0] + q[1])
    g1 = (M1 * C1 + M2 * L1) * G * np.cos(q[0]) + g2
    return np.array(
        [
            m11 * a[0] + m12 * a[1] - h * (2 * w[0] * w[1] + w[1] ** 2) + g1,
            m12 * a[0] + m22 * a[1] + h * w[0] ** 2 + g2,
        ]
    )


@pytest.mark.parametrize("seed", range(5))
def test_two_link_arm(seed):
    """Shoulder and elbow torques for any state and accelerations: the manipulator equation."""
    q1, q2, w1, w2, a1, a2 = np.random.default_rng(seed).normal(size=6)
    system = build_system(arm(q1, q2, w1, w2))
    motion = initial_motion(system, [])
    found = inverse_dynamics(system, motion, 0.0, ["shoulder", "elbow"], ["shoulder", "elbow"], np.array([a1, a2]))
    np.testing.assert_allclose(found.forces, torques((q1, q2), (w1, w2), (a1, a2)), rtol=1e-10)
    at = coordinates_at(system, motion, 0.0, coordinate_numbers(system, ["shoulder", "elbow"]))
    np.testing.assert_allclose(at.rates, [w1, w2], atol=1e-12)
    np.testing.assert_allclose(at.G @ found.accelerations + at.g, [a1, a2], atol=1e-10)


def test_motors_in_a_closed_loop_are_what_a_driver_exerts():
    """A four-bar's crank driven by a function: the driver's torque is that which inverse dynamics finds."""
    bodies = {
        "crank": RigidBody(1.0, (0.05, 0.0, 0.0), ((0.001, 0, 0), (0, 0.002, 0), (0, 0, 0.002))),
        "coupler": RigidBody(2.0, (0.1, 0.1, 0.0), ((0.01, 0, 0), (0, 0.01, 0), (0, 0, 0.02)), Pose((0.1, 0.0, 0.0))),
        "rocker": RigidBody(1.5, (0.0, 0.1, 0.0), ((0.01, 0, 0), (0, 0.002, 0), (0, 0, 0.01)), Pose((0.35, 0.0, 0.0))),
    }
    axis = (0.0, 0.0, 1.0)
    joints = {
        "a": Joint("revolute", End("ground"), End("crank"), at=(0.0, 0.0, 0.0), axis=axis),
        "b": Joint("revolute", End("crank"), End("coupler"), at=(0.1, 0.0, 0.0), axis=axis),
        "c": Joint("revolute", End("coupler"), End("rocker"), at=(0.35, 0.25, 0.0), axis=axis),
        "d": Joint("revolute", End("rocker"), End("ground"), at=(0.35, 0.0, 0.0), axis=axis),
    }
    free = Model(bodies, joints, gravity=(0.0, -G, 0.0), simulation=Simulation(1e-3, 1e-3))
    driven = Model(bodies, {**joints, "motor": Driver("a", "angle", expression("5*t + 20*t**2"))}, free.gravity)
    driven = Model(bodies, driven.joints, gravity=free.gravity, simulation=free.simulation)
    with pytest.warns(UserWarning, match="not unique"):
        torque = maggi.run(driven).joint("motor").torque[0]
    motion = initial_motion(build_system(driven), [])
    system = build_system(free)
    found = inverse_dynamics(system, motion, 0.0, ["a"], ["a"], np.array([40.0]))
    assert found.forces[0] == pytest.approx(torque[2], rel=1e-9)
    # the same motion by a motor at the rocker's bearing: other torque, same power
    other = inverse_dynamics(system, motion, 0.0, ["d"], ["a"], np.array([40.0]))
    at = coordinates_at(system, motion, 0.0, coordinate_numbers(system, ["a", "d"]))
    assert other.forces[0] * at.rates[1] == pytest.approx(found.forces[0] * at.rates[0], rel=1e-9)
    np.testing.assert_allclose(other.accelerations, found.accelerations, atol=1e-9)


def test_outputs_at_the_tip():
    """The tip's acceleration as output: the torques that its joint accelerations need."""
    q, w, tip = np.array([0.4, 0.9]), np.array([1.0, -0.5]), np.array([0.7, -1.2])
    model = arm(*q, *w)
    at = (L1 * np.cos(q[0]) + L2 * np.cos(q.sum()), L1 * np.sin(q[0]) + L2 * np.sin(q.sum()), 0.0)
    joints = {**model.joints, "tip": Joint("free", End("ground"), End("lower"), at=at)}
    system = build_system(Model(model.bodies, joints, gravity=model.gravity))
    motion = initial_motion(system, [])
    found = inverse_dynamics(system, motion, 0.0, ["shoulder", "elbow"], ["tip.0", "tip.1"], tip)
    s1, c1, s, c = np.sin(q[0]), np.cos(q[0]), np.sin(q.sum()), np.cos(q.sum())
    J = np.array([[-L1 * s1 - L2 * s, -L2 * s], [L1 * c1 + L2 * c, L2 * c]])
    centripetal = -np.array([L1 * c1 * w[0] ** 2 + L2 * c * w.sum() ** 2, L1 * s1 * w[0] ** 2 + L2 * s * w.sum() ** 2])
    accelerations = np.linalg.solve(J, tip - centripetal)
    np.testing.assert_allclose(found.forces, torques(q, w, accelerations), rtol=1e-10)


def test_what_cannot_be_produced_is_refused():
    system = build_system(arm())
    motion = initial_motion(system, [])
    with pytest.raises(ModelError, match="1 actuators, 2 outputs"):
        inverse_dynamics(system, motion, 0.0, ["elbow"], ["elbow", "shoulder"], np.zeros(2))
    with pytest.raises(ModelError, match="do not move them, or not apart"):
        inverse_dynamics(system, motion, 0.0, ["elbow", "elbow"], ["elbow", "shoulder"], np.zeros(2))
    with pytest.raises(ModelError, match="no joint 'wrist'"):
        inverse_dynamics(system, motion, 0.0, ["wrist"], ["elbow"], np.zeros(1))

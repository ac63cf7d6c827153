"""Every formulation, Maggi's own among them, against accelerations and joint forces known in closed form."""

import numpy as np
import pytest

from maggi.analyses.compare_formulations import by_projection
from maggi.analyses.initial import initial_motion
from maggi.formulations import FORMULATIONS, question_at
from maggi.model import (
    Coupler,
    End,
    Joint,
    JointCoordinate,
    KnifeEdge,
    Model,
    Plane,
    Pose,
    RigidBody,
    RollingDisc,
    RollingSphere,
    Velocity,
    formula,
)
from maggi.system.build import build_system

EVERY = pytest.mark.parametrize("formulation", [by_projection, *FORMULATIONS.values()], ids=lambda f: f.__name__)
G = 9.81


def answer(model, formulation):
    """A formulation's answer at the initial state, and the state."""
    system = build_system(model)
    motion = initial_motion(system, [])
    return formulation(question_at(system, motion, 0.0)), motion


def diagonal(*moments):
    return tuple(tuple(float(x) for x in row) for row in np.diag(moments))


def turned_to(axis):
    """A rotation matrix whose third column is `axis`."""
    z = np.asarray(axis) / np.linalg.norm(axis)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


@EVERY
def test_free_body(formulation):
    """Euler's equations: J ε = −ω × J ω; the centre of mass falls."""
    J, w = np.diag([0.2, 0.3, 0.4]), np.array([1.0, -2.0, 3.0])
    body = RigidBody(2.0, inertia=diagonal(0.2, 0.3, 0.4), velocity=Velocity((0.1, 0.2, 0.3), tuple(w)))
    found, motion = answer(Model({"b": body}, gravity=(0.0, 0.0, -G)), formulation)
    # v̇ is the rate of body components: R(v̇ + ω × v) = g
    np.testing.assert_allclose(found.accelerations[:3], [0.0, 0.0, -G] - np.cross(w, motion.v[:3]), atol=1e-13)
    np.testing.assert_allclose(found.accelerations[3:], -np.linalg.solve(J, np.cross(w, J @ w)), atol=1e-13)
    np.testing.assert_allclose(found.joint_forces, 0.0, atol=1e-13)


@EVERY
def test_physical_pendulum(formulation):
    """About a horizontal axis, centre of mass at a: ε = m g a cos φ / J; the bearing holds weight and centripetal force."""
    m, a, J, w = 3.0, 0.4, 0.55, 2.0
    body = RigidBody(
        m, (a, 0.0, 0.0), diagonal(0.0, J - m * a**2, J - m * a**2), velocity=Velocity(None, (0.0, w, 0.0))
    )
    model = Model(
        {"b": body},
        {"j": Joint("revolute", End("ground"), End("b"), at=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0))},
        gravity=(0.0, 0.0, -G),
    )
    found, _ = answer(model, formulation)
    eps = m * G * a / J
    np.testing.assert_allclose(found.accelerations, [0.0, 0.0, 0.0, 0.0, eps, 0.0], atol=1e-12)
    # m a_C = F − m g; a_C = −ω² a along x, −ε a along z
    np.testing.assert_allclose(found.joint_forces, [-m * w**2 * a, 0.0, m * (G - eps * a), 0.0, 0.0, 0.0], atol=1e-11)


@EVERY
def test_steady_rolling_disc(formulation):
    """A thin disc in a steady circle (CASES B1): it turns about the vertical as a whole, at constant ψ̇."""
    m, r, psi = 1.0, 0.5, 1.5
    theta = np.radians(70.0)
    A, C = m * r**2 / 4.0, m * r**2 / 2.0
    # A ψ̇² sinθ cosθ − (C + m r²) ω₃ ψ̇ sinθ − m g r cosθ = 0
    w3 = (A * psi**2 * np.sin(theta) * np.cos(theta) - m * G * r * np.cos(theta)) / (
        (C + m * r**2) * psi * np.sin(theta)
    )
    assert w3 == pytest.approx(-3.0883154069698686, rel=1e-12)
    n = np.array([np.sin(theta), 0.0, np.cos(theta)])
    omega = psi * np.array([0.0, 0.0, 1.0]) + (w3 - psi * np.cos(theta)) * n
    e = np.array([0.0, 0.0, 1.0]) - np.cos(theta) * n
    contact = -r * e / np.linalg.norm(e)
    velocity = np.cross(contact, omega)
    centre = (0.0, 0.0, r * np.sin(theta))
    R = turned_to(n)
    body = RigidBody(
        m,
        inertia=diagonal(A, A, C),
        pose=Pose(centre, tuple(map(tuple, R))),
        velocity=Velocity(tuple(velocity), tuple(omega)),
    )
    model = Model(
        {"disc": body}, {"roll": RollingDisc(End("ground"), End("disc"), r, tuple(n), Plane())}, gravity=(0.0, 0.0, -G)
    )
    found, _ = answer(model, formulation)
    up = np.array([0.0, 0.0, psi])
    a, eps = np.cross(up, velocity), np.cross(up, omega)
    np.testing.assert_allclose(R @ found.accelerations[3:], eps, atol=1e-11)
    np.testing.assert_allclose(R @ (found.accelerations[:3] + np.cross(R.T @ omega, R.T @ velocity)), a, atol=1e-11)
    # the ground's force on the disc: m (a − g), at the contact
    force = m * (a + [0.0, 0.0, G])
    np.testing.assert_allclose(R @ found.joint_forces[:3], force, atol=1e-11)
    np.testing.assert_allclose(R @ found.joint_forces[3:], np.cross(contact, force), atol=1e-11)


@EVERY
def test_chaplygin_sleigh(formulation):
    """Blade speed v and turn w (CASES B2): v̇ = a w², ẇ = −a v w / k², k² = (I + m a²)/m."""
    m, I, a, v, w = 1.0, 0.13, 0.3, 0.2, 2.0
    body = RigidBody(m, (a, 0.0, 0.0), diagonal(0.05, 0.1, I), velocity=Velocity((v, 0.0, 0.0), (0.0, 0.0, w)))
    joints = {
        "plane": Joint("planar", End("ground"), End("sleigh"), at=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0)),
        "blade": KnifeEdge(End("ground"), End("sleigh"), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)),
    }
    found, _ = answer(Model({"sleigh": body}, joints), formulation)
    turn = -a * v * w / ((I + m * a**2) / m)
    # the origin is the blade's point; its speed stays along the body's x axis
    np.testing.assert_allclose(found.accelerations, [a * w**2, 0.0, 0.0, 0.0, 0.0, turn], atol=1e-13)
    np.testing.assert_allclose(found.joint_forces[1], m * (v * w + turn * a), atol=1e-13)


@EVERY
def test_ball_on_a_turntable(formulation):
    """A homogeneous ball on a table that turns at Ω (CASES B3): r̈ = (2/7) Ω e_z × ṙ."""
    m, R, W, x, v = 1.0, 0.1, 3.0, np.array([0.4, 0.0]), np.array([0.1, 0.5])
    J = 0.4 * m * R**2
    spin = (-(v[1] - W * x[0]) / R, (v[0] + W * x[1]) / R, 0.0)
    bodies = {
        "table": RigidBody(1.0, inertia=diagonal(1.0, 1.0, 1e9), velocity=Velocity(None, (0.0, 0.0, W))),
        "ball": RigidBody(m, inertia=diagonal(J, J, J), pose=Pose((*x, R)), velocity=Velocity((*v, 0.0), spin)),
    }
    joints = {
        "axle": Joint("revolute", End("ground"), End("table"), at=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0)),
        "roll": RollingSphere(End("table"), End("ball"), R, Plane()),
    }
    found, motion = answer(Model(bodies, joints, gravity=(0.0, 0.0, -G)), formulation)
    acceleration = found.accelerations[6:9] + np.cross(motion.v[9:12], motion.v[6:9])
    # the table is so heavy that its speed stays
    np.testing.assert_allclose(acceleration, [*(2.0 / 7.0 * W * np.array([-v[1], v[0]])), 0.0], atol=1e-9)


@EVERY
def test_geared_wheels(formulation):
    """Two wheels, b = −2 a, an unbalanced first: (J₁ + 4 J₂) ε₁ = m g c."""
    J1, J2, m, c = 0.3, 0.05, 2.0, 0.1
    bodies = {
        "a": RigidBody(m, (c, 0.0, 0.0), diagonal(0.1, J1 - m * c**2, 0.3)),
        "b": RigidBody(1.0, inertia=diagonal(0.1, J2, 0.1)),
    }
    joints = {
        name: Joint("revolute", End("ground"), End(name), at=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0)) for name in bodies
    }
    joints = {f"axle_{name}": joint for name, joint in joints.items()}
    coordinates = {name: JointCoordinate(f"axle_{name}", "angle") for name in bodies}
    joints["gear"] = Coupler("gear", coordinates, formula("b + 2*a", ("t", "a", "b")))
    found, _ = answer(Model(bodies, joints, gravity=(0.0, 0.0, -G)), formulation)
    eps = m * G * c / (J1 + 4.0 * J2)
    np.testing.assert_allclose(found.accelerations[[4, 10]], [eps, -2.0 * eps], atol=1e-12)
    if found.liaisons:
        np.testing.assert_allclose(found.liaisons["gear"][[4, 10]], [-4.0 * J2 * eps, -2.0 * J2 * eps], atol=1e-12)

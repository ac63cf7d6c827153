"""Drivers, springs, dampers, loads and prescribed frames on rigid bodies, against closed forms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from transient_runs import end, joint, simulate

from maggi.model import (
    Attachment,
    Driver,
    GivenMotion,
    Model,
    PointLoad,
    Pose,
    RigidBody,
    SpringDamper,
    TorsionSpring,
    Velocity,
    expression,
)
from maggi.model.joints import End

INERTIA = ((0.1, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.3))
ORIGIN = (0.0, 0.0, 0.0)


def functions(*texts):
    return tuple(expression(text) for text in texts)


def test_driven_angle_its_torque_and_several_turns():
    """θ = 5t + sin 3t about z through the body's centre: torque J θ̈, coordinate unwrapped over four turns."""
    body = RigidBody(2.0, inertia=INERTIA)
    joints = {
        "axle": joint("revolute", "ground", "wheel", at=ORIGIN, axis=(0, 0, 1)),
        "motor": Driver("axle", "angle", expression("5*t + sin(3*t)")),
    }
    results, summary = simulate(Model({"wheel": body}, joints), 5.0, 1e-2, rows=50)
    t = results.time
    np.testing.assert_allclose(results.joint("axle").coordinate[:, 0], 5 * t + np.sin(3 * t), atol=1e-10)
    np.testing.assert_allclose(results.joint("motor").coordinate[:, 0], 5 * t + np.sin(3 * t), atol=1e-10)
    np.testing.assert_allclose(results.joint("motor").torque[:, 2], -0.3 * 9 * np.sin(3 * t), atol=1e-9)
    # the bearing carries no torque about its own axis
    np.testing.assert_allclose(results.joint("axle").torque[:, 2], 0.0, atol=1e-12)
    assert (summary.residuals < 1e-10).all()


def test_first_and_second_exchanged_turn_signs():
    """The coordinate is second relative to first, force and torque are those of first on second."""

    def run(first, second):
        joints = {
            "axle": joint("revolute", first, second, at=ORIGIN, axis=(0, 0, 1)),
            "motor": Driver("axle", "angle", expression("2*t**2" if first == "ground" else "-2*t**2")),
        }
        body = RigidBody(2.0, center_of_mass=(0.3, 0.0, 0.0), inertia=INERTIA)
        return simulate(Model({"arm": body}, joints, gravity=(0, 0, -9.81)), 1.0, 1e-2, rows=5)[0]

    forward, backward = run("ground", "arm"), run("arm", "ground")
    np.testing.assert_allclose(forward.body("arm").rotation, backward.body("arm").rotation, atol=1e-12)
    np.testing.assert_allclose(forward.joint("axle").coordinate, -backward.joint("axle").coordinate, atol=1e-12)
    for name in ("axle", "motor"):
        np.testing.assert_allclose(forward.joint(name).force, -backward.joint(name).force, atol=1e-9)
        np.testing.assert_allclose(forward.joint(name).torque, -backward.joint(name).torque, atol=1e-9)
    # about the fixed axis: (J + m a²) θ̈ from the motor, m g upwards from the bearing
    np.testing.assert_allclose(forward.joint("motor").torque[:, 2], (0.3 + 2.0 * 0.09) * 4.0, atol=1e-9)
    np.testing.assert_allclose(forward.joint("axle").force[:, 2], 2.0 * 9.81, atol=1e-9)


def test_driven_displacement_and_speed():
    """A slide driven in place, a second upon it driven in speed: forces m s̈."""
    bodies = {"slide": RigidBody(2.0, inertia=INERTIA), "rider": RigidBody(3.0, inertia=INERTIA)}
    joints = {
        "rail": joint("prismatic", "ground", "slide", at=ORIGIN, axis=(1, 0, 0)),
        "track": joint("prismatic", "slide", "rider", at=ORIGIN, axis=(0, 1, 0)),
        "push": Driver("rail", "displacement", expression("0.1*(1 - cos(4*t))")),
        "pull": Driver("track", "speed", expression("0.5*sin(2*t)")),
    }
    results, _ = simulate(Model(bodies, joints), 3.0, 1e-3, rows=10)
    t = results.time
    np.testing.assert_allclose(results.joint("rail").coordinate[:, 0], 0.1 * (1 - np.cos(4 * t)), atol=1e-11)
    # a speed is integrated by the method: (hω)²/12
    np.testing.assert_allclose(results.joint("track").coordinate[:, 0], 0.25 * (1 - np.cos(2 * t)), atol=1e-6)
    np.testing.assert_allclose(results.joint("push").force[:, 0], 5.0 * 1.6 * np.cos(4 * t), atol=1e-9)
    np.testing.assert_allclose(results.joint("pull").force[:, 1], 3.0 * np.cos(2 * t), atol=1e-9)


@pytest.mark.parametrize("coordinate", ["angle", "displacement"])
def test_cylindrical_joint_driven_in_one_coordinate(coordinate):
    """The other coordinate stays free: it falls, or keeps still about the axis."""
    body = RigidBody(2.0, inertia=INERTIA)
    joints = {
        "sleeve": joint("cylindrical", "ground", "body", at=ORIGIN, axis=(0, 0, 1)),
        "motor": Driver("sleeve", coordinate, expression("3*t**2")),
    }
    results, _ = simulate(Model({"body": body}, joints, gravity=(0, 0, -9.81)), 1.0, 1e-2, rows=5)
    t = results.time
    motor = results.joint("motor")
    slid, turned = results.joint("sleeve").coordinate.T
    if coordinate == "angle":
        np.testing.assert_allclose(slid, -0.5 * 9.81 * t**2, atol=1e-11)
        np.testing.assert_allclose(turned, 3 * t**2, atol=1e-11)
        np.testing.assert_allclose(motor.torque[:, 2], 0.3 * 6.0, atol=1e-10)
        np.testing.assert_allclose(motor.force, 0.0, atol=1e-12)
    else:
        np.testing.assert_allclose(slid, 3 * t**2, atol=1e-11)
        np.testing.assert_allclose(turned, 0.0, atol=1e-12)
        np.testing.assert_allclose(motor.force[:, 2], 2.0 * (6.0 + 9.81), atol=1e-9)
        np.testing.assert_allclose(motor.torque, 0.0, atol=1e-12)


def decaying(t, start, omega, ratio):
    """Free vibration from rest at `start`."""
    damped = omega * np.sqrt(1 - ratio**2)
    return start * np.exp(-ratio * omega * t) * (np.cos(damped * t) + ratio * omega / damped * np.sin(damped * t))


def test_spring_damper_decays():
    """m = 2, k = 200, c = 4 along x, released 0.05 m from the free length 0.5 m."""
    body = RigidBody(2.0, inertia=INERTIA, pose=Pose((0.55, 0.0, 0.0)))
    spring = SpringDamper(End("ground", point=ORIGIN), end("mass"), 200.0, 4.0, 0.5)
    results, _ = simulate(Model({"mass": body}, forces={"spring": spring}), 2.0, 1e-3, rows=10)
    expected = 0.5 + decaying(results.time, 0.05, 10.0, 0.1)
    # the method's phase error is 0.05 e⁻ᵗ (hω)² ωt/12 ≤ 1.5e-6
    np.testing.assert_allclose(results.body("mass").origin[:, 0], expected, atol=2e-6)
    np.testing.assert_allclose(results.body("mass").origin[:, 1:], 0.0, atol=1e-12)


@pytest.mark.parametrize("angle", [None, 0.3])
def test_torsion_spring_oscillates_about_its_free_angle(angle):
    """J = 0.3, k = 30, c = 0.6; without an angle the spring is free in the initial pose, and the wheel starts with a spin."""
    spin = 2.0 if angle is None else 0.0
    body = RigidBody(2.0, inertia=INERTIA, velocity=Velocity(angular=(0.0, 0.0, spin)))
    axle = joint("revolute", "ground", "wheel", at=ORIGIN, axis=(0, 0, 1))
    spring = TorsionSpring("axle", 30.0, 0.6, angle)
    results, _ = simulate(Model({"wheel": body}, {"axle": axle}, {"spring": spring}), 2.0, 1e-3, rows=10)
    t, damped = results.time, 10.0 * np.sqrt(1 - 0.1**2)
    if angle is None:
        expected = spin / damped * np.exp(-t) * np.sin(damped * t)
    else:
        expected = angle - decaying(t, angle, 10.0, 0.1)
    np.testing.assert_allclose(results.joint("axle").coordinate[:, 0], expected, atol=1e-5)


def test_global_force_and_torque():
    """A force at an offset point under a given turn; the work is F·Δr."""
    body = RigidBody(2.0, inertia=INERTIA, attachments={"tip": Attachment(at=(0.2, 0.0, 0.0))})
    joints = {"axle": joint("revolute", "ground", "arm", at=ORIGIN, axis=(0, 0, 1))}
    loads = {
        "push": PointLoad(end("arm.tip"), "force", functions("0", "3", "0")),
        "twist": PointLoad(end("arm"), "torque", functions("0", "0", "-0.6*cos(t)")),
    }
    results, _ = simulate(Model({"arm": body}, joints, loads), 2.0, 1e-3, rows=10)
    # J θ̈ = 0.2·3 cos θ − 0.6 cos t
    reference = solve_ivp(
        lambda t, y: [y[1], (0.6 * np.cos(y[0]) - 0.6 * np.cos(t)) / 0.3],
        (0.0, 2.0),
        [0.0, 0.0],
        method="DOP853",
        t_eval=results.time,
        rtol=1e-12,
        atol=1e-14,
    )
    np.testing.assert_allclose(results.joint("axle").coordinate[:, 0], reference.y[0], atol=1e-6)


def test_following_force_and_torque():
    """In body axes: a wheel with a constant tangential force and a constant body torque spins up evenly."""
    body = RigidBody(2.0, inertia=INERTIA, attachments={"rim": Attachment(at=(0.2, 0.0, 0.0))})
    joints = {"axle": joint("revolute", "ground", "wheel", at=ORIGIN, axis=(0, 0, 1))}
    loads = {
        "jet": PointLoad(end("wheel.rim"), "force", functions("0", "3", "0"), "body"),
        "twist": PointLoad(end("wheel"), "torque", functions("7", "0", "0.3"), "body"),
    }
    results, _ = simulate(Model({"wheel": body}, joints, loads), 2.0, 1e-2, rows=10)
    angle = 0.5 * (0.6 + 0.3) / 0.3 * results.time**2
    np.testing.assert_allclose(results.joint("axle").coordinate[:, 0], angle, atol=1e-10)
    np.testing.assert_allclose(results.energy.work, 0.9 * angle, atol=1e-10)
    # the torque about the body's x axis, turned, is taken by the bearing
    expected = -7.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(results.joint("axle").torque[:, :2], expected, atol=1e-8)
    # and the jet by the bearing's force: the centre of mass stays on the axis
    tangent = np.column_stack([-np.sin(angle), np.cos(angle)])
    np.testing.assert_allclose(results.joint("axle").force[:, :2], -3.0 * tangent, atol=1e-8)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, -9.81), (1.0, -2.0, 3.0)])
def test_free_fall_with_an_off_centre_frame(gravity):
    """The centre of mass falls on its parabola while the body spins steadily about a principal axis."""
    body = RigidBody(
        2.0, center_of_mass=(0.3, 0.0, 0.0), inertia=INERTIA, velocity=Velocity((0.0, 0.0, 0.0), (0.0, 0.0, 4.0))
    )
    results, _ = simulate(Model({"body": body}, gravity=gravity), 1.0, 1e-3, rows=5)
    t = results.time[:, None]
    center = results.body("body").origin + results.body("body").rotation @ [0.3, 0.0, 0.0]
    expected = np.array([0.3, 0.0, 0.0]) + np.array([0.0, 1.2, 0.0]) * t + 0.5 * np.array(gravity) * t**2
    np.testing.assert_allclose(center, expected, atol=2e-5)
    angle = np.arctan2(results.body("body").rotation[:, 1, 0], results.body("body").rotation[:, 0, 0])
    np.testing.assert_allclose(np.unwrap(angle), 4.0 * results.time, atol=1e-6)


def test_pendulum_on_a_moving_support():
    """Support at x = 0.1 sin 6t on a body with a given motion: θ̈ = −(g sin θ + ẍ cos θ)/l for a point mass."""
    support = RigidBody(1.0, motion=GivenMotion(origin=functions("0.1*sin(6*t)", "0", "0")))
    bob = RigidBody(0.5, pose=Pose((0.0, 0.0, -0.6)), velocity=Velocity(linear=(0.6, 0.0, 0.0)))
    pin = joint("revolute", "support", "bob", at=ORIGIN, axis=(0, 1, 0))
    model = Model({"support": support, "bob": bob}, {"pin": pin}, gravity=(0, 0, -9.81))
    results, summary = simulate(model, 3.0, 1e-3, rows=15)

    def rates(t, y):
        shift = -3.6 * np.sin(6 * t)
        return [y[1], -(9.81 * np.sin(y[0]) + shift * np.cos(y[0])) / 0.6]

    # the bob starts with the support's own 0.6 m/s: no turn at first
    reference = solve_ivp(
        rates, (0.0, 3.0), [0.0, 0.0], method="DOP853", t_eval=results.time, rtol=1e-12, atol=1e-14
    ).y[0]
    place = np.column_stack([0.1 * np.sin(6 * results.time) + 0.6 * np.sin(reference), -0.6 * np.cos(reference)])
    np.testing.assert_allclose(results.body("bob").origin[:, [0, 2]], place, atol=2e-5)
    # turning about +y takes the bob, which hangs down, towards −x
    np.testing.assert_allclose(results.joint("pin").coordinate[:, 0], -reference, atol=3e-5)
    assert (summary.residuals < 1e-10).all()


def test_turntable_given_by_an_angle_carries_a_mass_on_a_radial_spring():
    """A slide on a table turning at Ω in a spring: m r̈ = −k(r − r₀) + m Ω² r, with the slot's force 2 m Ω ṙ across."""
    table = RigidBody(1.0, motion=GivenMotion(axis=(0.0, 0.0, 1.0), angle=expression("4*t")))
    bead = RigidBody(0.5, inertia=INERTIA, pose=Pose((0.3, 0.0, 0.0)))
    joints = {"slot": joint("prismatic", "table", "bead", at=(0.3, 0.0, 0.0), axis=(1, 0, 0))}
    spring = SpringDamper(End("ground", point=ORIGIN), end("bead"), stiffness=50.0, length=0.2)
    results, _ = simulate(Model({"table": table, "bead": bead}, joints, {"spring": spring}), 1.0, 5e-4, rows=10)
    square = 50.0 / 0.5 - 4.0**2
    rest = 50.0 / 0.5 * 0.2 / square
    t = results.time
    radius = rest + (0.3 - rest) * np.cos(np.sqrt(square) * t)
    np.testing.assert_allclose(results.joint("slot").coordinate[:, 0], radius - 0.3, atol=1e-6)
    speed = -(0.3 - rest) * np.sqrt(square) * np.sin(np.sqrt(square) * t)
    across = np.column_stack([-np.sin(4 * t), np.cos(4 * t)])
    np.testing.assert_allclose(results.joint("slot").force[:, :2], 2 * 0.5 * 4.0 * speed[:, None] * across, atol=1e-4)

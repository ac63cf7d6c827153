"""One motion with a closed form for every type of joint."""

import numpy as np
import pytest
from scipy.special import ellipk
from transient_runs import joint, simulate

from maggi.model import Attachment, Driver, Model, Pose, RigidBody, Velocity, expression

G = 9.81
UNIT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def diagonal(x, y, z):
    return ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))


def turned(axis, angle):
    """Rotation matrix by Rodrigues' formula."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def rows(matrix):
    return tuple(tuple(row) for row in np.asarray(matrix).tolist())


def test_revolute_a_swinging_bar_has_the_period_of_its_elliptic_integral():
    """Released from 60°: half a period T/2 = 2 K(sin² 30°)/ω later it is at −60°. Its frame sits off the pin and off the centre."""
    mass, length, start = 2.0, 0.8, np.pi / 3
    about_pin = mass * length**2 / 3
    omega = np.sqrt(mass * G * length / 2 / about_pin)
    half = 2 * ellipk(np.sin(start / 2) ** 2) / omega
    R = turned([0, 1, 0], np.pi / 2 - start)  # the bar's x axis, from straight down
    origin = R @ [0.6, 0.0, 0.0]
    bar = RigidBody(
        mass,
        center_of_mass=(-0.2, 0.0, 0.0),
        inertia=diagonal(1e-3, mass * length**2 / 12, mass * length**2 / 12),
        pose=Pose(tuple(origin), rows(R)),
    )
    model = Model(
        {"bar": bar},
        {"pin": joint("revolute", "ground", "bar", at=(0.0, 0.0, 0.0), axis=(0, 1, 0))},
        gravity=(0, 0, -G),
    )
    results, _ = simulate(model, half, half / 2000, rows=2)
    angle = results.joint("pin").coordinate[:, 0]
    # right-handed about +y from the start at 60° on the side of +x: down through the middle is a positive turn
    np.testing.assert_allclose(angle, [0.0, start, 2 * start], atol=2e-6)
    # in the lowest position: m g + m ω² l/2 upwards, with ω² = 2 ω₀² (1 − cos 60°)
    upwards = mass * G + mass * (length / 2) * 2 * omega**2 * (1 - np.cos(start))
    np.testing.assert_allclose(results.joint("pin").force[1], [0.0, 0.0, upwards], atol=1e-4)


def test_prismatic_a_mass_slides_down_an_incline():
    """s = ½ g sin α t², with the joint carrying the weight across it."""
    slope = 0.4
    along = np.array([np.cos(slope), 0.0, -np.sin(slope)])
    across = np.array([np.sin(slope), 0.0, np.cos(slope)])
    body = RigidBody(3.0, center_of_mass=(0.1, 0.2, 0.3), inertia=UNIT, pose=Pose((1.0, 2.0, 3.0)))
    guide = joint("prismatic", "ground", "body", at=(1.0, 2.0, 3.0), axis=tuple(along))
    results, _ = simulate(Model({"body": body}, {"guide": guide}, gravity=(0, 0, -G)), 1.0, 0.05, rows=4)
    s = 0.5 * G * np.sin(slope) * results.time**2
    np.testing.assert_allclose(results.body("body").origin, [1.0, 2.0, 3.0] + np.outer(s, along), atol=1e-12)
    np.testing.assert_allclose(results.joint("guide").coordinate[:, 0], s, atol=1e-12)
    np.testing.assert_allclose(
        results.joint("guide").force, np.tile(3.0 * G * np.cos(slope) * across, (5, 1)), atol=1e-10
    )


def test_cylindrical_a_body_falls_along_and_spins_about_the_axis_independently():
    body = RigidBody(
        1.5, inertia=diagonal(0.1, 0.2, 0.3), velocity=Velocity(linear=(0.0, 0.0, 2.0), angular=(0.0, 0.0, 5.0))
    )
    sleeve = joint("cylindrical", "ground", "body", at=(0.0, 0.0, 0.0), axis=(0, 0, 1))
    results, _ = simulate(Model({"body": body}, {"sleeve": sleeve}, gravity=(0, 0, -G)), 4.0, 0.05, rows=8)
    t = results.time
    coordinate = results.joint("sleeve").coordinate
    np.testing.assert_allclose(coordinate[:, 0], 2.0 * t - 0.5 * G * t**2, atol=1e-11)
    np.testing.assert_allclose(coordinate[:, 1], 5.0 * t, atol=1e-11)  # three turns: unwrapped
    np.testing.assert_allclose(results.joint("sleeve").force, 0.0, atol=1e-11)


@pytest.mark.parametrize("own", [0.0, 0.01], ids=["point", "ball"])
def test_spherical_a_conical_pendulum_keeps_its_cone(own):
    """ω² = g/(l cos α); tension m g/cos α. One turn; a ball's own momentum stays along the vertical.

    A point's rotation about the line to the pin is left open by everything, and must do no harm.
    """
    mass, length, cone = 1.2, 0.7, 0.5
    omega = np.sqrt(G / (length * np.cos(cone)))
    position = length * np.array([np.sin(cone), 0.0, -np.cos(cone)])
    bob = RigidBody(
        mass,
        inertia=diagonal(own, own, own),
        pose=Pose(tuple(position)),
        velocity=Velocity(linear=(0.0, omega * position[0], 0.0), angular=(0, 0, omega)),
    )
    pin = joint("spherical", "ground", "bob", at=(0.0, 0.0, 0.0))
    turn = 2 * np.pi / omega
    results, _ = simulate(Model({"bob": bob}, {"pin": pin}, gravity=(0, 0, -G)), turn, turn / 4000, rows=4)
    for phase, at, force in zip(
        np.arange(5) * np.pi / 2, results.body("bob").origin, results.joint("pin").force, strict=True
    ):
        expected = turned([0, 0, 1], phase) @ position
        np.testing.assert_allclose(at, expected, atol=3e-6)
        np.testing.assert_allclose(force, -mass * G / np.cos(cone) * expected / length, atol=1e-4)


def test_planar_a_disc_flies_in_its_plane_and_turns():
    """Normal (0, 1, 1)/√2: gravity's part in the plane accelerates, the rest is carried; the spin stays."""
    normal = np.array([0.0, 1.0, 1.0]) / np.sqrt(2)
    gravity = np.array([0.0, 0.0, -G])
    start = np.array([1.0, 0.0, 0.0]) + 0.5 * np.cross(normal, [1.0, 0.0, 0.0])
    R = turned([1, 0, 0], -np.pi / 4)  # z along the normal
    disc = RigidBody(
        2.0,
        inertia=diagonal(0.1, 0.1, 0.2),
        pose=Pose(rotation=rows(R)),
        velocity=Velocity(linear=tuple(start), angular=tuple(3.0 * normal)),
    )
    plane = joint("planar", "ground", "disc", at=(0.0, 0.0, 0.0), axis=tuple(normal))
    results, _ = simulate(Model({"disc": disc}, {"plane": plane}, gravity=tuple(gravity)), 3.0, 1e-3, rows=6)
    t = results.time[:, None]
    inside = gravity - gravity @ normal * normal
    # gravity turns as the body sees it: the step's error, (hω)²/12 of it
    np.testing.assert_allclose(results.body("disc").origin, start * t + 0.5 * inside * t**2, atol=1e-4)
    np.testing.assert_allclose(results.joint("plane").coordinate[:, 2], 3.0 * t[:, 0], atol=1e-11)
    np.testing.assert_allclose(
        results.joint("plane").force, np.tile(-2.0 * gravity @ normal * normal, (7, 1)), atol=1e-10
    )


@pytest.mark.parametrize("bend", [0.2, 0.7])
def test_universal_turns_its_shafts_as_hookes_joint(bend):
    """tan θ₂ = tan θ₁ / cos β from the position where the first fork lies across the bend, ω₂/ω₁ = cos β/(1 − sin²β cos²θ₁)."""
    output = np.array([np.cos(bend), np.sin(bend), 0.0])
    flat = diagonal(0.02, 0.02, 0.02)
    shafts = {
        "input": RigidBody(1.0, inertia=flat),
        "output": RigidBody(1.0, inertia=flat, attachments={"end": Attachment(at=tuple(output))}),
    }
    # the first fork's axis normal to the plane of the shafts, the second's in it
    axes = ((0.0, 0.0, 1.0), tuple(np.cross([0.0, 0.0, 1.0], output)))
    joints = {
        "front": joint("revolute", "ground", "input", at=(-1.0, 0.0, 0.0), axis=(1, 0, 0)),
        "rear": joint("revolute", "ground", "output.end", axis=tuple(output)),
        "cross": joint("universal", "input", "output", at=(0.0, 0.0, 0.0), axes=axes),
        "motor": Driver("front", "speed", expression(7.0)),
    }
    turn = 2 * np.pi / 7.0
    results, summary = simulate(Model(shafts, joints), 2 * turn, turn / 480, rows=32)
    first = 7.0 * results.time
    np.testing.assert_allclose(results.joint("front").coordinate[:, 0], first, atol=1e-10)
    second = np.unwrap(np.arctan2(np.sin(first) * np.cos(bend), np.cos(first)))
    np.testing.assert_allclose(results.joint("rear").coordinate[:, 0], second, atol=1e-5)
    speed = results.body("output").attachment("end").angular_velocity @ output
    ratio = np.cos(bend) / (1 - (np.sin(bend) * np.sin(first)) ** 2)
    np.testing.assert_allclose(speed / 7.0, ratio, atol=1e-5)
    assert (summary.residuals < 1e-10).all()


def test_weld_two_halves_move_as_the_whole():
    """A free body thrown with a spin about no principal axis, whole and in two welded halves."""
    throw = Velocity(linear=(1.0, 2.0, 3.0), angular=(4.0, -5.0, 6.0))
    near, far = np.array([0.1, 0.0, 0.05]), np.array([-0.2, 0.3, 0.0])
    J1, J2 = np.diag([0.02, 0.03, 0.04]), np.diag([0.05, 0.04, 0.03])

    def shifted(mass, c):
        return mass * (c @ c * np.eye(3) - np.outer(c, c))

    center = (2.0 * near + 1.0 * far) / 3.0
    J = J1 + J2 + shifted(2.0, near - center) + shifted(1.0, far - center)
    whole = RigidBody(3.0, center_of_mass=tuple(center), inertia=rows(J), velocity=throw)
    # the second half's frame is turned and lies elsewhere
    R, place = turned([1, 2, 3], 0.8), np.array([0.4, -0.1, 0.2])
    halves = {
        "one": RigidBody(2.0, center_of_mass=tuple(near), inertia=rows(J1), velocity=throw),
        "two": RigidBody(
            1.0, center_of_mass=tuple(R.T @ (far - place)), inertia=rows(R.T @ J2 @ R), pose=Pose(tuple(place), rows(R))
        ),
    }
    seam = joint("weld", "one", "two", at=(0.1, 0.1, 0.1))
    single, _ = simulate(Model({"one": whole}, gravity=(0, 0, -G)), 1.0, 1e-3, rows=4)
    double, _ = simulate(Model(halves, {"seam": seam}, gravity=(0, 0, -G)), 1.0, 1e-3, rows=4)
    one, two = double.body("one"), double.body("two")
    np.testing.assert_allclose(one.origin + one.rotation @ place, two.origin, atol=1e-12)
    np.testing.assert_allclose(one.rotation @ R, two.rotation, atol=1e-12)
    # the same motion up to the step's error: the halves' frames are integrated as they lie
    np.testing.assert_allclose(one.origin, single.body("one").origin, atol=2e-5)
    np.testing.assert_allclose(one.rotation, single.body("one").rotation, atol=2e-5)

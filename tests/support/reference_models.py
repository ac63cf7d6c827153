"""Mechanisms of the literature with reference answers (CASES.md), as models: where they start and what they are made of."""

from __future__ import annotations

import numpy as np
from transient_runs import end, joint

from maggi.model import (
    Attachment,
    Distance,
    End,
    GivenMotion,
    KnifeEdge,
    Model,
    Plane,
    PointLoad,
    Pose,
    RigidBody,
    RollingDisc,
    RollingSphere,
    SpringDamper,
    Velocity,
    expression,
)

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def about_z(angle):
    """A rotation about z as nested tuples."""
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))


def diagonal(x, y, z):
    """A diagonal inertia tensor."""
    return ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))


def pendulum():
    """A01: a point mass of 1 kg on a massless bar of 1 m, from rest at (−1, 0); gravity along −y."""
    return Model(
        {"mass": RigidBody(1.0, pose=Pose((-1.0, 0.0, 0.0)))},
        {"pivot": joint("revolute", "ground", "mass", at=(0.0, 0.0, 0.0), axis=Z)},
        gravity=(0.0, -9.81, 0.0),
    )


def four_bars(count):
    """A02: `count` windows of rods of 1 m and 1 kg, from vertical with B0 at 1 m/s; the rods turn with −1 rad/s."""
    thin = 1.0 / 12.0
    bodies, joints = {}, {}
    for i in range(count + 1):
        bodies[f"rod{i}"] = RigidBody(
            1.0,
            (0.0, 0.5, 0.0),
            diagonal(thin, 1e-3, thin),
            Pose((float(i), 0.0, 0.0)),
            velocity=Velocity(angular=(0.0, 0.0, -1.0)) if i == 0 else Velocity(),
            attachments={"top": Attachment(at=(0.0, 1.0, 0.0))},
        )
        joints[f"foot{i}"] = joint("revolute", "ground", f"rod{i}", at=(float(i), 0.0, 0.0), axis=Z)
    for i in range(count):
        bodies[f"coupler{i}"] = RigidBody(
            1.0,
            (0.5, 0.0, 0.0),
            diagonal(1e-3, thin, thin),
            Pose((float(i), 1.0, 0.0)),
            attachments={"end": Attachment(at=(1.0, 0.0, 0.0))},
        )
        joints[f"left{i}"] = joint("revolute", f"rod{i}.top", f"coupler{i}", axis=Z)
        joints[f"right{i}"] = joint("revolute", f"coupler{i}.end", f"rod{i + 1}.top", axis=Z)
    return Model(bodies, joints, gravity=(0.0, -9.81, 0.0))


SQUEEZER_START = (
    -0.0617138900142764496358948458001,
    0.0,
    0.455279819163070380255912382449,
    0.222668390165885884674473185609,
    0.487364979543842550225598953530,
    -0.222668390165885884674473185609,
    1.23054744454982119249735015568,
)


def squeezer():
    """A03: Andrews' squeezer, seven rigid bodies in a plane; joints named after the angles β, Θ, γ, Φ, δ, Ω, ε.

    Every body's frame stands in the joint that its angle is measured in, x towards what the case calls its length.
    """
    beta, theta, gamma, phi, delta, omega, eps = SQUEEZER_START
    A, B, C = np.array([-0.06934, -0.00227]), np.array([-0.03635, 0.03273]), (0.014, 0.072, 0.0)
    rr, d, ss, e, zt, zf, u = 0.007, 0.028, 0.035, 0.02, 0.04, 0.02, 0.04

    def along(angle):
        return np.array([np.cos(angle), np.sin(angle)])

    def body(mass, inertia, at, angle, center, attachments):
        return RigidBody(
            mass,
            (*center, 0.0),
            diagonal(inertia, inertia, inertia),
            Pose((*(float(x) for x in at), 0.0), about_z(angle)),
            attachments={name: Attachment(at=(*point, 0.0)) for name, point in attachments.items()},
        )

    F, G, H = rr * along(beta), A + zt * along(delta), A + u * along(eps - np.pi / 2)
    bodies = {
        "K1": body(0.04325, 2.194e-6, (0.0, 0.0), beta, (0.00092, 0.0), {"F": (rr, 0.0)}),
        "K2": body(0.00365, 4.410e-7, F, beta + theta, (-0.0115, 0.0), {"E": (-d, 0.0)}),
        "K3": body(0.02373, 5.255e-6, B, gamma, (0.01043, -0.01874), {"E": (0.0, -ss), "D": (0.02, -0.018)}),
        "K4": body(0.00706, 5.667e-7, G, phi + delta, (0.0, -(e - 0.01421)), {"E": (0.0, -e)}),
        "K5": body(0.0705, 1.169e-5, A, delta, (0.02308, 0.00916), {"G": (zt, 0.0)}),
        "K6": body(0.00706, 5.667e-7, H, omega + eps, (zf - 0.01421, 0.0), {"E": (zf, 0.0)}),
        "K7": body(0.05498, 1.912e-5, A, eps, (0.00449, -0.01228), {"H": (0.0, -u)}),
    }
    sa, sb = 0.01874, 0.01043
    assert np.hypot(*bodies["K3"].center_of_mass[:2]) == np.hypot(sa, sb)
    joints = {
        "beta": joint("revolute", "ground", "K1", at=(0.0, 0.0, 0.0), axis=Z),
        "theta": joint("revolute", "K1.F", "K2", axis=Z),
        "gamma": joint("revolute", "ground", "K3", at=(*B, 0.0), axis=Z),
        "delta": joint("revolute", "ground", "K5", at=(*A, 0.0), axis=Z),
        "phi": joint("revolute", "K5.G", "K4", axis=Z),
        "epsilon": joint("revolute", "ground", "K7", at=(*A, 0.0), axis=Z),
        "omega": joint("revolute", "K7.H", "K6", axis=Z),
        "E3": joint("revolute", "K2.E", "K3.E", axis=Z),
        "E4": joint("revolute", "K2.E", "K4.E", axis=Z),
        "E6": joint("revolute", "K2.E", "K6.E", axis=Z),
    }
    zero = expression(0.0)
    forces = {
        "motor": PointLoad(end("K1.F"), "torque", (zero, zero, expression(0.033))),
        "spring": SpringDamper(end("K3.D"), End("ground", point=C), 4530.0, 0.0, 0.07785),
    }
    return Model(bodies, joints, forces)


def car_axis():
    """A06: two point masses on springs, a rod between them, over a chassis whose right end goes up and down.

    The chassis is a bar of 1 m about the origin that turns by asin(r sin ωt); the left mass slides along the bar's y axis.
    """
    mass = 10.0 * 1e-4 / 2.0
    turning = GivenMotion(axis=Z, angle=expression("asin(0.1*sin(10*t))"))
    bodies = {
        "chassis": RigidBody(1.0, motion=turning, attachments={"end": Attachment(at=X)}),
        "left": RigidBody(mass, pose=Pose((0.0, 0.5, 0.0)), velocity=Velocity(linear=(-0.5, 0.0, 0.0))),
        "right": RigidBody(mass, pose=Pose((1.0, 0.5, 0.0)), velocity=Velocity(linear=(-0.5, 0.0, 0.0))),
    }
    joints = {
        "guide": joint("prismatic", "chassis", "left", at=(0.0, 0.5, 0.0), axis=Y),
        "plane": joint("planar", "ground", "right", at=(1.0, 0.5, 0.0), axis=Z),
        "rod": Distance(End("left"), End("right"), expression(1.0)),
    }
    forces = {
        "left": SpringDamper(End("ground", point=(0.0, 0.0, 0.0)), End("left"), 1.0, 0.0, 0.5),
        "right": SpringDamper(end("chassis.end"), End("right"), 1.0, 0.0, 0.5),
    }
    return Model(bodies, joints, forces, gravity=(0.0, -1.0, 0.0))


def rolling_disc(normal, center, spin, velocity):
    """B1: a thin disc of 1 kg and 0.5 m with its axis along `normal` (3,), from a given angular and linear velocity."""
    n = np.asarray(normal) / np.linalg.norm(normal)
    across = np.cross(Z, n)
    across /= np.linalg.norm(across)
    R = np.column_stack([across, np.cross(n, across), n])
    disc = RigidBody(
        1.0,
        inertia=diagonal(0.0625, 0.0625, 0.125),
        pose=Pose(tuple(center), tuple(map(tuple, R.tolist()))),
        velocity=Velocity(tuple(velocity), tuple(spin)),
    )
    contact = RollingDisc(End("ground"), End("disc"), 0.5, tuple(n.tolist()), Plane())
    return Model({"disc": disc}, {"contact": contact}, gravity=(0.0, 0.0, -9.81))


def disc_in_a_circle():
    """B1: 70° from the vertical, 1.5 rad/s around a circle."""
    tilt, spin = np.radians(70.0), -3.0883154069698686
    n = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    up = np.array([0.0, 0.0, 1.0]) - n[2] * n
    omega = np.array([0.0, 0.0, 1.5]) + (spin - 1.5 * n[2]) * n
    velocity = np.cross(-0.5 * up / np.linalg.norm(up), omega)
    return rolling_disc(n, (0.0, 0.0, 0.5 * np.sin(tilt)), omega, velocity)


def sleigh():
    """B2: Chaplygin's sleigh, blade at the frame's origin, centre of mass 0.3 m before it."""
    body = RigidBody(
        1.0,
        (0.3, 0.0, 0.0),
        diagonal(0.1, 0.1, 0.13),
        velocity=Velocity((0.2, 0.0, 0.0), (0.0, 0.0, 2.0)),
    )
    joints = {
        "ice": joint("planar", "ground", "sleigh", at=(0.0, 0.0, 0.0), axis=Z),
        "blade": KnifeEdge(End("ground"), End("sleigh"), X, Z, (0.0, 0.0, 0.0)),
    }
    return Model({"sleigh": body}, joints)


def ball_on_turntable(tilt=0.0):
    """B3: a homogeneous ball of 1 kg and 0.1 m on a table that turns with 3 rad/s; gravity tilted towards x."""
    table = RigidBody(1.0, motion=GivenMotion(axis=Z, angle=expression("3*t")))
    ball = RigidBody(
        1.0,
        inertia=diagonal(0.004, 0.004, 0.004),
        pose=Pose((0.4, 0.0, 0.1)),
        velocity=Velocity((0.1, 0.5, 0.0), ((3.0 * 0.4 - 0.5) / 0.1, 0.1 / 0.1, 0.0)),
    )
    contact = RollingSphere(End("table"), End("ball"), 0.1, Plane())
    gravity = (9.81 * float(np.sin(tilt)), 0.0, -9.81 * float(np.cos(tilt)))
    return Model({"table": table, "ball": ball}, {"contact": contact}, gravity=gravity)


def bicycle(speed):
    """B5: the bicycle of Meijaard et al. (2007), 25 parameters, upright and straight at `speed` (m/s) along x.

    Here y is to the left and z upwards, where the source has z down and y to the right: products of inertia I_xz change
    their sign, lengths along z too.
    """
    w, c, tilt = 1.02, 0.08, np.pi / 10.0
    rear, front = 0.3, 0.35
    axis = (-float(np.sin(tilt)), 0.0, float(np.cos(tilt)))  # up along the steering axis, backwards
    foot = np.array([w + c, 0.0, 0.0])  # where it meets the ground
    point = foot + 0.9 * np.array(axis)
    roll = Velocity((speed, 0.0, 0.0), (0.0, 0.0, 0.0))

    def part(mass, at, inertia):
        return RigidBody(mass, tuple(at), inertia, velocity=roll)

    def wheel(mass, radius, x, across, spin):
        return RigidBody(
            mass,
            inertia=diagonal(across, spin, across),
            pose=Pose((x, 0.0, radius)),
            velocity=Velocity((speed, 0.0, 0.0), (0.0, speed / radius, 0.0)),
        )

    bodies = {
        "frame": part(85.0, (0.3, 0.0, 0.9), ((9.2, 0.0, -2.4), (0.0, 11.0, 0.0), (-2.4, 0.0, 2.8))),
        "fork": part(4.0, (0.9, 0.0, 0.7), ((0.05892, 0.0, 0.00756), (0.0, 0.06, 0.0), (0.00756, 0.0, 0.00708))),
        "rear": wheel(2.0, rear, 0.0, 0.0603, 0.12),
        "front": wheel(3.0, front, w, 0.1405, 0.28),
    }
    joints = {
        "steering": joint("revolute", "frame", "fork", at=tuple(point.tolist()), axis=axis),
        "rear_hub": joint("revolute", "frame", "rear", at=(0.0, 0.0, rear), axis=Y),
        "front_hub": joint("revolute", "fork", "front", at=(w, 0.0, front), axis=Y),
        "rear_road": RollingDisc(End("ground"), End("rear"), rear, Y, Plane()),
        "front_road": RollingDisc(End("ground"), End("front"), front, Y, Plane()),
    }
    return Model(bodies, joints, gravity=(0.0, 0.0, -9.81))

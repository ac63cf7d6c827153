"""Springs, dampers and loads: generalised forces against virtual work, power against energies."""

import numpy as np
import pytest
from motions import (
    FIRST,
    POINTS,
    Motion,
    attachments_at,
    derivative,
    hold_together,
    mesh_body,
    rigid_body,
    ritz_body,
    rows_at,
)

from maggi.bodies.attachment_kernels import move
from maggi.bodies.tables import MotionState
from maggi.forces.kernels import applied_forces
from maggi.liaisons.registry import JOINTS
from maggi.model.bodies import RigidBody
from maggi.model.expression import expression
from maggi.model.forces import PointLoad, SpringDamper, TorsionSpring
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.stepping.allocate import copy_motion
from maggi.system.build import build_system

A, B, C = End("a", "p"), End("b", "p"), End("c", "s")
FIXED = End("ground", point=(0.4, -2.0, 1.0))
INSTANT = 0.3


def mechanism(**forces):
    """A rigid, a Ritz and a meshed body, free, with forces."""
    rng = np.random.default_rng(3)
    bodies = {
        "a": rigid_body(rng, p=(0.3, -0.2, 0.5)),
        "b": ritz_body(rng, 3, p=(0.2, 0.1, -0.4)),
        "c": mesh_body(rng),
    }
    return build_system(Model(bodies, forces=forces))


def force_and_power(system, state, t=INSTANT):
    Q, power = np.full(system.coordinates, np.nan), np.full(3, np.nan)
    rows = rows_at(system, state, t)
    at = attachments_at(system, state)
    applied_forces(system.forces, system.bodies, system.liaisons, state, at, rows, t, Q, power)
    return Q, power


def gradient(system, state, potential, h=0.01):
    """Derivative of a function of the state along every small coordinate (frames: along their exponential)."""
    result = np.zeros(system.coordinates)
    for i in range(system.coordinates):
        values = []
        for k in POINTS:
            moved = copy_motion(state)
            move(system.bodies, state, k * h * np.eye(system.coordinates)[i], moved)
            values.append(potential(moved))
        result[i] = FIRST @ values / h
    return result


def length(system, state, spring):
    p, q = attachments_at(system, state).position[system.forces.spring_ends[spring]]
    return np.linalg.norm(q - p)


SPRINGS = {
    "rigid-ritz": SpringDamper(A, B, 50.0, 0.0, 0.7),
    "mesh-ground": SpringDamper(C, FIXED, 30.0, 0.0, 0.4),
    "ground-ritz": SpringDamper(FIXED, B, 20.0),
}


def test_springs_do_virtual_work_of_their_potential():
    """Q = −∂V/∂q with V = ½ k (l − l₀)², along every velocity; no power besides."""
    system = mechanism(**SPRINGS)
    state = Motion(system, 1).at_rest(0.0)
    free = [0.7, 0.4, length(system, system.start, 2)]

    def potential(at):
        return sum(0.5 * k * (length(system, at, i) - free[i]) ** 2 for i, k in enumerate([50.0, 30.0, 20.0]))

    Q, power = force_and_power(system, state)
    np.testing.assert_allclose(Q, -gradient(system, state, potential), atol=1e-9 * np.abs(Q).max())
    np.testing.assert_allclose(power, [potential(state), 0.0, 0.0], rtol=1e-13)


def test_dampers_take_power():
    """Q · v = −c l̇², with l̇ by differences of the distance."""
    system = mechanism(one=SpringDamper(A, B, 0.0, 3.0), two=SpringDamper(C, FIXED, 0.0, 5.0))
    motion = Motion(system, 2)
    Q, power = force_and_power(system, motion.state(0.1))
    rates = [derivative(lambda t, i=i: length(system, motion.at_rest(t), i), 0.1) for i in (0, 1)]
    lost = 3.0 * rates[0] ** 2 + 5.0 * rates[1] ** 2
    assert Q @ motion.state(0.1).v == pytest.approx(-lost, rel=1e-9)
    np.testing.assert_allclose(power, [0.0, lost, 0.0], rtol=1e-9)


def test_damping_acts_along_the_spring():
    """As a spring of the tension that the damper has."""
    system = mechanism(one=SpringDamper(A, B, 0.0, 3.0))
    motion = Motion(system, 2)
    state = motion.state()
    Q, _ = force_and_power(system, state)
    rate = derivative(lambda t: length(system, motion.at_rest(t), 0))
    along = gradient(system, state, lambda at: length(system, at, 0))
    np.testing.assert_allclose(Q, -3.0 * rate * along, atol=1e-9 * np.abs(Q).max())


VALUE = ("2*t", "1 - t", "0.5")
AT_INSTANT = np.array([0.6, 0.7, 0.5])


@pytest.mark.parametrize("frame", ["global", "body"])
@pytest.mark.parametrize("end", [A, B, C, End("a")], ids=str)
def test_forces_do_virtual_work(frame, end):
    """A force at an attachment, or at a rigid body's origin: F · dp for every velocity, F in global or body axes."""
    system = mechanism(load=PointLoad(end, "force", tuple(expression(x) for x in VALUE), frame))
    motion = Motion(system, 4)
    state = motion.state()
    a = system.forces.load_attachment[0]
    at = attachments_at(system, state)
    F = at.rotation[a] @ AT_INSTANT if frame == "body" else AT_INSTANT
    Q, power = force_and_power(system, state)
    work = gradient(system, state, lambda moved: F @ attachments_at(system, moved).position[a])
    np.testing.assert_allclose(Q, work, atol=1e-10)
    np.testing.assert_allclose(
        power, [0.0, 0.0, F @ derivative(lambda t: attachments_at(system, motion.at_rest(t)).position[a])], atol=1e-9
    )
    assert Q @ state.v == pytest.approx(power[2], rel=1e-12)


@pytest.mark.parametrize("frame", ["global", "body"])
@pytest.mark.parametrize("end", [A, B, C], ids=str)
def test_torques_do_virtual_work(frame, end):
    """A torque turns with the attachment's own rotation: T · the axial vector of dR Rᵀ."""
    system = mechanism(load=PointLoad(end, "torque", tuple(expression(x) for x in VALUE), frame))
    state = Motion(system, 5).state()
    a = system.forces.load_attachment[0]
    R = attachments_at(system, state).rotation[a]
    T = R @ AT_INSTANT if frame == "body" else AT_INSTANT
    skew = np.cross(T, np.eye(3)).T  # T̃; T · axial(X) = ½ T̃ : X
    Q, power = force_and_power(system, state)
    work = gradient(system, state, lambda moved: 0.5 * np.sum(skew * (attachments_at(system, moved).rotation[a] @ R.T)))
    np.testing.assert_allclose(Q, work, atol=1e-10)
    assert Q @ state.v == pytest.approx(power[2], rel=1e-12)


def test_forces_add_up():
    loads = {"load": PointLoad(B, "force", tuple(expression(x) for x in VALUE)), **SPRINGS}
    together, state = mechanism(**loads), Motion(mechanism(), 6).state()
    alone = [force_and_power(mechanism(**{name: force}), state) for name, force in loads.items()]
    for part, parts in zip(force_and_power(together, state), zip(*alone, strict=True), strict=True):
        np.testing.assert_allclose(part, sum(parts), atol=1e-12)


@pytest.mark.parametrize("name", ["revolute", "cylindrical", "planar"])
@pytest.mark.parametrize("turns", [0.0, 2.0])
def test_torsion_springs_on_a_joint(name, turns):
    """Q · v = −d/dt ½ k (α − α₀)² − c α̇² along motions of the joint; the angle counts turns."""
    rng = np.random.default_rng(8)
    bodies = {"a": rigid_body(rng, p=(0.3, -0.2, 0.5)), "b": rigid_body(rng, p=(0.0, 0.1, 0.2))}
    joint = Joint(name, End("a", "p"), End("b", "p"), axis=(1.0, -2.0, 0.5))
    spring = TorsionSpring("hinge", 7.0, 0.6, 0.25)
    system = build_system(Model(bodies, {"hinge": joint}, {"spring": spring}))
    kind = JOINTS[name]

    def angle(t):
        return 2.0 * np.pi * turns + 0.4 * np.sin(3.0 * t) + 0.3

    motion = Motion(system, 9)
    hold_together(motion, 0, kind, lambda t: np.array([*[0.2 * t] * (len(kind.coordinates) - 1), angle(t)]), 1)
    t = 0.2
    state = motion.state(t)
    previous = np.full(len(kind.coordinates), 2.0 * np.pi * turns)
    rows = rows_at(system, state, t, previous)
    Q, power = np.empty(system.coordinates), np.empty(3)
    applied_forces(
        system.forces, system.bodies, system.liaisons, state, attachments_at(system, state), rows, t, Q, power
    )
    rate = 1.2 * np.cos(0.6)
    np.testing.assert_allclose(power, [3.5 * (angle(t) - 0.25) ** 2, 0.6 * rate**2, 0.0], rtol=1e-10)
    assert Q @ state.v == pytest.approx(-7.0 * (angle(t) - 0.25) * rate - 0.6 * rate**2, rel=1e-9)
    # equal and opposite torques: a common turn of both bodies takes no power
    common, spin = np.zeros(system.coordinates), np.array([0.3, -0.7, 1.1])
    for b in (1, 2):
        common[system.bodies.offset[b] + 3 : system.bodies.offset[b] + 6] = state.rotation[b].T @ spin
        common[system.bodies.offset[b] : system.bodies.offset[b] + 3] = state.rotation[b].T @ np.cross(
            spin, state.origin[b]
        )
    assert Q @ common == pytest.approx(0.0, abs=1e-12 * np.abs(Q).max())


def test_a_spring_without_length_pulls_nowhere():
    """Ends that have come together: no direction, hence no force, but the energy is there."""
    bodies = {"a": RigidBody(1.0), "b": RigidBody(1.0)}
    ends = (End("a"), End("ground", point=(1.0, 0.0, 0.0)))
    system = build_system(Model(bodies, forces={"spring": SpringDamper(*ends, 4.0, 1.0, 0.5)}))
    state = MotionState(*(part.copy() for part in system.start))
    state.origin[1] = [1.0, 0.0, 0.0]
    state.v[0] = 2.0
    Q, power = force_and_power(system, state)
    np.testing.assert_array_equal(Q, 0.0)
    np.testing.assert_allclose(power, [0.5 * 4.0 * 0.25, 0.0, 0.0])

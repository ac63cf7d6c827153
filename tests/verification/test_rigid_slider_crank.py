"""A rigid slider-crank along a turn, against closed-form kinematics and Newton–Euler equations written by hand."""

import numpy as np
from transient_runs import joint, orders, simulate

from maggi.model import Attachment, Driver, Model, Pose, RigidBody, SpringDamper, expression
from maggi.model.joints import End

L1, L2 = 0.1, 0.3  # crank and rod, m
M1, M2, M3 = 0.5, 0.8, 0.4  # kg
C1, C2 = 0.03, 0.12  # centres of mass from the bearing and from the crank pin, m
J1, J2 = 2e-3, 6e-3  # about them, kg m²
GRAVITY = np.array([0.0, -9.81])
MOTION = "30*t + 2*sin(5*t)"


def flat(moment):
    return ((moment / 2, 0.0, 0.0), (0.0, moment, 0.0), (0.0, 0.0, moment))


def slider_crank():
    bodies = {
        "crank": RigidBody(M1, (C1, 0.0, 0.0), flat(J1), attachments={"pin": Attachment(at=(L1, 0.0, 0.0))}),
        "rod": RigidBody(
            M2,
            (C2, 0.0, 0.0),
            flat(J2),
            pose=Pose((L1, 0.0, 0.0)),
            attachments={"big": Attachment(at=(0.0, 0.0, 0.0)), "small": Attachment(at=(L2, 0.0, 0.0))},
        ),
        "piston": RigidBody(
            M3, inertia=flat(1e-4), pose=Pose((L1 + L2, 0.0, 0.0)), attachments={"pin": Attachment(at=(0.0, 0.0, 0.0))}
        ),
    }
    z = (0.0, 0.0, 1.0)
    joints = {
        "bearing": joint("revolute", "ground", "crank", at=(0.0, 0.0, 0.0), axis=z),
        "crankpin": joint("revolute", "crank.pin", "rod.big", axis=z),
        "wristpin": joint("revolute", "rod.small", "piston.pin", axis=z),
        "cylinder": joint("prismatic", "ground", "piston.pin", axis=(1.0, 0.0, 0.0)),
        "motor": Driver("bearing", "angle", expression(MOTION)),
    }
    return Model(bodies, joints, gravity=(*GRAVITY, 0.0))


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def newton_euler(t):
    """Positions, and forces of the first body of each joint on its second, at times t (n,)."""
    angle, rate, acceleration = 30 * t + 2 * np.sin(5 * t), 30 + 10 * np.cos(5 * t), -50 * np.sin(5 * t)
    s1, c1 = np.sin(angle), np.cos(angle)
    s2 = -L1 / L2 * s1
    c2 = np.sqrt(1 - s2**2)
    rate2 = -L1 * c1 * rate / (L2 * c2)
    acceleration2 = (-L1 * (c1 * acceleration - s1 * rate**2) + L2 * s2 * rate2**2) / (L2 * c2)

    def arm(length, s, c, w, e):
        """A vector of a turning link and its second derivative."""
        r = length * np.column_stack([c, s])
        return r, e[:, None] * np.column_stack([-r[:, 1], r[:, 0]]) - (w**2)[:, None] * r

    pin, pin_a = arm(L1, s1, c1, rate, acceleration)
    first, first_a = arm(C1, s1, c1, rate, acceleration)
    whole, whole_a = arm(L2, s2, c2, rate2, acceleration2)
    part, part_a = arm(C2, s2, c2, rate2, acceleration2)
    wrist = np.empty_like(pin)  # rod on piston
    wrist[:, 0] = M3 * (pin_a + whole_a)[:, 0]
    # m₂ a = A − B + m₂ g and moments about the crank pin give B's lateral part
    moment = J2 * acceleration2 + M2 * cross(part, pin_a + part_a - GRAVITY)
    wrist[:, 1] = (whole[:, 1] * wrist[:, 0] - moment) / whole[:, 0]
    crank_pin = M2 * (pin_a + part_a - GRAVITY) + wrist
    bearing = M1 * (first_a - GRAVITY) + crank_pin
    torque = J1 * acceleration + M1 * cross(first, first_a - GRAVITY) + cross(pin, crank_pin)
    side = -M3 * GRAVITY[1] - wrist[:, 1]
    return {"angle": angle, "rod": np.arctan2(s2, c2), "pin": pin, "piston": pin + whole, "bearing": bearing} | {
        "crankpin": crank_pin,
        "wristpin": wrist,
        "cylinder": np.column_stack([np.zeros_like(side), side]),
        "motor": torque,
    }


def test_positions_and_joint_forces_along_a_turn():
    """Everything follows from the driver, so nothing is left of the step's error but round-off (and tolerance)."""
    results, summary = simulate(slider_crank(), 0.25, 1e-4, rows=50)
    expected = newton_euler(results.time)
    assert expected["angle"][-1] > 2 * np.pi
    np.testing.assert_allclose(results.joint("bearing").coordinate[:, 0], expected["angle"], atol=1e-9)
    np.testing.assert_allclose(results.joint("wristpin").coordinate[:, 0], -expected["rod"], atol=1e-9)
    np.testing.assert_allclose(results.body("rod").origin[:, :2], expected["pin"], atol=1e-10)
    np.testing.assert_allclose(results.body("piston").origin[:, :2], expected["piston"], atol=1e-10)
    stroke = expected["piston"][:, 0] - (L1 + L2)
    np.testing.assert_allclose(results.joint("cylinder").coordinate[:, 0], stroke, atol=1e-10)
    size = np.abs(expected["bearing"]).max()
    for name in ("bearing", "crankpin", "wristpin", "cylinder"):
        found = results.joint(name).force
        np.testing.assert_allclose(found[:, :2], expected[name], atol=1e-8 * size)
        np.testing.assert_allclose(found[:, 2], 0.0, atol=1e-8 * size)
        np.testing.assert_allclose(results.joint(name).torque, 0.0, atol=1e-8 * size)
    np.testing.assert_allclose(results.joint("motor").torque[:, 2], expected["motor"], atol=1e-9 * size)
    np.testing.assert_allclose(results.joint("motor").force, 0.0, atol=1e-12)
    assert (summary.residuals < 1e-10).all()


def test_work_of_the_motor_is_the_change_of_energy_to_second_order():
    """The motion is exact here, so the defect is that of the work's own integral (trapezoidal rule)."""

    def defect(step):
        results, _ = simulate(slider_crank(), 0.2, step, rows=20)
        assert np.ptp(results.energy.work) > 0.1 * np.ptp(results.energy.kinetic)
        return float(np.abs(results.energy.balance).max() / np.ptp(results.energy.kinetic))

    errors, order = orders(defect, [2e-4, 1e-4, 5e-5, 2.5e-5])
    np.testing.assert_allclose(order, 2.0, atol=0.05)
    assert errors[-1] < 1e-6


def test_free_crank_with_a_spring_and_a_damper_balances_to_second_order():
    """No motor: a driven base shakes the piston through a spring-damper, so that all five energies are exchanged."""
    driven = slider_crank()
    base = RigidBody(1.0, pose=Pose((0.8, 0.0, 0.0)))
    bodies = dict(driven.bodies) | {"base": base}
    joints = {name: entry for name, entry in driven.joints.items() if name != "motor"}
    joints["rail"] = joint("prismatic", "ground", "base", at=(0.8, 0.0, 0.0), axis=(1.0, 0.0, 0.0))
    joints["shaker"] = Driver("rail", "displacement", expression("0.05*sin(25*t)"))
    forces = {"spring": SpringDamper(End("piston", "pin"), End("base"), stiffness=400.0, damping=3.0, length=0.3)}
    model = Model(bodies, joints, forces, gravity=driven.gravity)

    def defect(step):
        results, _ = simulate(model, 1.0, step, rows=25)
        energy = results.energy
        parts = [energy.kinetic, energy.strain, energy.gravity, energy.dissipated, energy.work]
        exchanged = max(np.ptp(part) for part in parts)
        assert min(np.ptp(part) for part in parts) > 1e-2 * exchanged
        return float(np.abs(energy.balance).max() / exchanged)

    errors, order = orders(defect, [1e-3, 5e-4, 2.5e-4, 1.25e-4])
    np.testing.assert_allclose(order, 2.0, atol=0.05)
    assert errors[-1] < 1e-6

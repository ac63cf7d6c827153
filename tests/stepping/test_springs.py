"""Springs in the step's iteration: as stiff as they like, without smaller steps, and with the right motion."""

from __future__ import annotations

import math

import numpy as np
import pytest

from maggi.analyses.transient import run
from maggi.linalg.small import invert
from maggi.model.bodies import RigidBody
from maggi.model.forces import SpringDamper, TorsionSpring
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.model.simulation import Outputs, Simulation
from maggi.results.memory import MemoryRecorder

INERTIA = ((1e-2, 0.0, 0.0), (0.0, 1e-2, 0.0), (0.0, 0.0, 1e-2))
GRAVITY = 9.81


def hanging(count: int, stiffness: float, damping: float, step: float, duration: float) -> Model:
    """Masses of 1 kg one below the other, guided along z, each on a spring to the one above, released unstretched."""
    bodies, joints, forces = {}, {}, {}
    above = End("ground", point=(0.0, 0.0, 1.0))
    for i in range(count):
        bodies[f"mass{i}"] = RigidBody(1.0, inertia=INERTIA, pose=Pose((0.0, 0.0, -float(i))))
        joints[f"guide{i}"] = Joint(
            "prismatic", End("ground"), End(f"mass{i}"), at=(0.0, 0.0, -float(i)), axis=(0.0, 0.0, 1.0)
        )
        forces[f"spring{i}"] = SpringDamper(above, End(f"mass{i}"), stiffness, damping)
        above = End(f"mass{i}")
    return Model(
        bodies=bodies,
        joints=joints,
        forces=forces,
        gravity=(0.0, 0.0, -GRAVITY),
        simulation=Simulation(duration, step, rho_inf=1.0),
        outputs=Outputs(1),
    )


@pytest.mark.parametrize("stiffness", [1e4, 1e7, 1e10])
@pytest.mark.parametrize("count", [1, 3])
def test_no_spring_is_too_stiff_for_the_iteration(stiffness: float, count: int) -> None:
    # β h² k/m runs from 2.5e-3 to 2.5e3; the explicit iteration contracts by that factor
    recorder = MemoryRecorder()
    summary = run(hanging(count, stiffness, 0.0, 1e-3, 0.05), recorder)
    assert summary.restarts == 0
    assert summary.iterations <= 4 * summary.steps
    # the method conserves the energy of a linear oscillator at ρ∞ = 1 up to what its step cannot resolve
    z = recorder.results().body(f"mass{count - 1}").origin[:, 2] + count - 1
    static = sum(GRAVITY * (count - i) / stiffness for i in range(count))
    assert np.abs(z).max() <= 2.3 * static


def test_a_resolved_oscillation_is_the_closed_form() -> None:
    stiffness, damping = 400.0, 2.0  # ω = 20 rad/s, ζ = 0.05
    recorder = MemoryRecorder()
    run(hanging(1, stiffness, damping, 1e-3, 0.5), recorder)
    results = recorder.results()
    t, z = results.time[:], results.body("mass0").origin[:, 2]
    decay = damping / 2.0
    w = math.sqrt(stiffness - decay**2)
    exact = -GRAVITY / stiffness * (1.0 - np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t)))
    # second order: (ωh)²ωt/12 of the amplitude at most
    assert np.abs(z - exact).max() < 400e-6 * 10.0 / 12.0 * GRAVITY / stiffness * 1.1


@pytest.mark.parametrize("stiffness", [10.0, 1e6])
def test_a_torsion_spring_turns_a_flywheel_back_and_forth(stiffness: float) -> None:
    wheel = RigidBody(1.0, inertia=INERTIA)
    model = Model(
        bodies={"wheel": wheel},
        joints={"axle": Joint("revolute", End("ground"), End("wheel"), at=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0))},
        forces={"spring": TorsionSpring("axle", stiffness, 0.0, angle=0.01)},
        simulation=Simulation(0.2, 1e-3, rho_inf=1.0),
    )
    recorder = MemoryRecorder()
    summary = run(model, recorder)
    assert summary.restarts == 0
    angle = recorder.results().joint("axle").coordinate[:, 0]
    assert angle.min() >= -1e-4 and angle.max() <= 0.02 + 1e-4
    if stiffness == 10.0:  # ω = 31.6 rad/s: resolved
        t = recorder.results().time[:]
        w = math.sqrt(stiffness / 1e-2)
        assert np.abs(angle - 0.01 * (1.0 - np.cos(w * t))).max() < 0.01 * (w * 1e-3) ** 2 * w * 0.2 / 12.0 * 1.1


@pytest.mark.parametrize("n", [1, 2, 6, 17])
def test_inverse_of_a_positive_definite_matrix(n: int) -> None:
    random = np.random.default_rng(n)
    A = random.standard_normal((n, n))
    A = A @ A.T + 0.1 * np.eye(n)
    out = np.empty((n, n))
    invert(A.copy(), out)
    assert np.abs(out @ A - np.eye(n)).max() < 1e-12

"""Kinematics of attachments against differences of their poses, and forces as the transpose of velocities."""

from dataclasses import replace

import numpy as np
import pytest
from motions import Motion, attachments_at, axial, derivative, mesh_body, rigid_body, ritz_body, second_derivative

from maggi.bodies.attachment_kernels import generalised_force
from maggi.linalg.rotations import rotation_matrix
from maggi.model.model import Model
from maggi.system.build import build_system


@pytest.fixture(scope="module")
def system():
    """A rigid, a Ritz and a meshed body; (d, θ) of the meshed one are its own coordinates."""
    rng = np.random.default_rng(1)
    bodies = {
        "rigid": rigid_body(rng, p=(0.3, -0.2, 0.5), q=(0.0, 0.0, 0.0)),
        "ritz": ritz_body(rng, 5, p=(0.3, 0.1, -0.4), q=(-0.5, 0.2, 0.1)),
        "mesh": mesh_body(rng),
    }
    return build_system(Model(bodies))


@pytest.mark.parametrize("seed", range(4))
def test_positions_are_those_of_the_deformed_body(system, seed):
    """p = r + R(X + d) and rotation R exp(θ̃) with (d, θ) = Ψ e; elastic rotations of up to 3 rad."""
    state = Motion(system, seed, elastic=0.6).at_rest(0.0)
    at, bodies = attachments_at(system, state), system.bodies
    angles = []
    for a, b in enumerate(bodies.attachment_body):
        o, e = bodies.offset[b] + 6, bodies.offset[b + 1]
        start = bodies.psi_offset[a]
        d, theta = np.split(bodies.psi[start : start + 6 * (e - o)].reshape(6, -1) @ state.e[o:e], 2)
        arm = bodies.attachment_point[a] + d
        np.testing.assert_allclose(at.arm[a], arm, atol=1e-14)
        np.testing.assert_allclose(at.position[a], state.origin[b] + state.rotation[b] @ arm, atol=1e-13)
        np.testing.assert_allclose(at.rotation[a], state.rotation[b] @ rotation_matrix(theta), atol=1e-13)
        angles.append(np.linalg.norm(theta))
    assert max(angles) > 0.5


@pytest.mark.parametrize("seed", range(4))
def test_velocities_and_accelerations_are_the_rates_of_the_pose(system, seed):
    motion = Motion(system, seed)
    at = attachments_at(system, motion.state())

    def position(t):
        return attachments_at(system, motion.at_rest(t)).position

    def rotation(t):
        return attachments_at(system, motion.at_rest(t)).rotation

    first, second = derivative(rotation), second_derivative(rotation)
    angular = np.array([axial(dR @ R.T) for dR, R in zip(first, at.rotation, strict=True)])
    # R̈Rᵀ = α̃ + Ω̃Ω̃, of which the last is symmetric
    angular_rate = np.array([axial(ddR @ R.T) for ddR, R in zip(second, at.rotation, strict=True)])
    np.testing.assert_allclose(at.velocity, derivative(position), atol=2e-11)
    np.testing.assert_allclose(at.acceleration, second_derivative(position), atol=1e-9)
    np.testing.assert_allclose(at.angular_velocity, angular, atol=2e-11)
    np.testing.assert_allclose(at.angular_acceleration, angular_rate, atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_generalised_force_is_the_transpose_of_the_velocities(system, seed):
    """Power of a force and a moment = generalised force · velocities, for any velocities."""
    rng = np.random.default_rng(seed)
    state = Motion(system, seed).state()
    bodies = system.bodies
    for a, b in enumerate(bodies.attachment_body):
        f, m, v = rng.normal(size=3), rng.normal(size=3), rng.normal(size=system.coordinates)
        at = attachments_at(system, replace(state, v=v))
        out = np.zeros(bodies.offset[b + 1] - bodies.offset[b])
        for _ in range(2):  # adds to what is there
            generalised_force(bodies, state, at, a, *f, *m, out)
        power = out @ v[bodies.offset[b] : bodies.offset[b + 1]]
        assert power == pytest.approx(2.0 * (f @ at.velocity[a] + m @ at.angular_velocity[a]), rel=1e-12, abs=1e-12)

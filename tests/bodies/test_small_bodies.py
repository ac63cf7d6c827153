"""Compiled inertia of rigid and Ritz bodies against the readable reference of `elements.moving_frame` (T2, T3, T5a)."""

from dataclasses import replace

import numpy as np
import pytest
from motions import Motion, derivative, rigid_body, ritz_body

from maggi.bodies.ritz_kernels import deformed_inertia, inertia_residual, mass_matrix
from maggi.bodies.small_bodies import SmallBodyEnergies, body_mass, body_residual
from maggi.elements.moving_frame import FrameMotion, InertiaConstants, frame_resultants, maggi_vector
from maggi.model.model import Model
from maggi.system.build import build_system

GRAVITY = np.array([1.0, -2.0, -9.0])


@pytest.fixture(scope="module")
def system():
    """Two Ritz bodies around a rigid one, so that wrong offsets into the flat constants would show."""
    rng = np.random.default_rng(1)
    return build_system(Model({"a": ritz_body(rng, 2), "b": rigid_body(rng), "c": ritz_body(rng, 4)}))


def constants(system, b):
    """Reference constants, stiffness and damping of a body, from its description."""
    name = next(entry.name for entry in system.body_entries if entry.index == b)
    body = system.model.bodies[name]
    if hasattr(body, "terms"):
        return body.terms, body.terms.k, body.terms.D
    c, none = np.array(body.center_of_mass), np.zeros((3, 3, 0))
    about_origin = np.array(body.inertia) + body.mass * (c @ c * np.eye(3) - np.outer(c, c))
    empty = np.zeros((0, 0))
    terms = InertiaConstants(
        np.array(body.mass),
        body.mass * c,
        about_origin,
        empty,
        np.zeros((0, 3)),
        np.zeros((3, 0, 0)),
        np.zeros((3, 3, 0, 0)),
        np.zeros((3, 0)),
        none,
    )
    return terms, empty, empty


def residual(system, b, state, gravity=GRAVITY):
    out = np.empty(system.bodies.offset[b + 1] - system.bodies.offset[b])
    inertia_residual(system.bodies, b, state, gravity, out)
    return out


@pytest.mark.parametrize("b", [1, 2, 3])
def test_residual_is_the_maggi_vector_and_the_frames_resultants(system, b):
    state = Motion(system, 5).state()
    o, e = system.bodies.offset[b], system.bodies.offset[b + 1]
    v, w = state.v[o : o + 3], state.v[o + 3 : o + 6]
    a_O = state.vd[o : o + 3] + np.cross(w, v) - state.rotation[b].T @ GRAVITY
    frame = FrameMotion(w, state.vd[o + 3 : o + 6], a_O)
    q, rate, acceleration = state.e[o + 6 : e], state.v[o + 6 : e], state.vd[o + 6 : e]
    terms, k, D = constants(system, b)
    expected = np.concatenate(
        [
            *frame_resultants(terms, frame, q, rate, acceleration),
            maggi_vector(terms, frame, q, rate, acceleration) + k @ q + D @ rate,
        ]
    )
    np.testing.assert_allclose(residual(system, b, state), expected, rtol=0, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize("b", [1, 2, 3])
def test_mass_matrix_is_the_residuals_part_in_the_accelerations(system, b):
    state = Motion(system, 6).state()
    o, e = system.bodies.offset[b], system.bodies.offset[b + 1]
    M = np.empty((e - o, e - o))
    mass_matrix(system.bodies, b, state.e[o + 6 : e], M)
    np.testing.assert_allclose(M, M.T, atol=1e-15)
    assert np.linalg.eigvalsh(M)[0] > 0.0
    start = replace(state, vd=np.zeros(state.v.size))
    for i in range(o, e):
        one = replace(state, vd=np.eye(state.v.size)[i])
        column = residual(system, b, one) - residual(system, b, start)
        np.testing.assert_allclose(M[:, i - o], column, atol=1e-12 * np.abs(M).max())


@pytest.mark.parametrize("b", [1, 2, 3])
def test_terms_of_one_body_are_those_of_the_compiled_step(system, b):
    """Where a body is rigid they are written out once more, without anything to compile."""
    state = Motion(system, 9).state()
    elastic = state.e[system.bodies.offset[b] + 6 : system.bodies.offset[b + 1]]
    force = residual(system, b, state)
    np.testing.assert_allclose(
        body_residual(system.bodies, b, state, GRAVITY), force, rtol=0, atol=1e-13 * np.abs(force).max()
    )
    M = np.zeros((6 + elastic.size, 6 + elastic.size))
    mass_matrix(system.bodies, b, elastic, M)
    np.testing.assert_allclose(body_mass(system.bodies, b, elastic), M, rtol=0, atol=1e-15 * np.abs(M).max())


@pytest.mark.parametrize("b", [1, 3])
def test_deformed_inertia(system, b):
    """First moment and inertia as a rigid turn without deformation sees them: columns of the frame's resultants."""
    terms, _, _ = constants(system, b)
    delta = np.random.default_rng(7).normal(size=len(terms.m))
    S, J, rest = np.empty(3), np.empty((3, 3)), np.zeros_like(delta)
    deformed_inertia(system.bodies, b, delta, S, J)
    np.testing.assert_allclose(S, terms.S0 + terms.m_O.T @ delta, atol=1e-13)
    for k in range(3):
        turning = FrameMotion(np.zeros(3), np.eye(3)[k], np.zeros(3))
        force, moment = frame_resultants(terms, turning, delta, rest, rest)
        np.testing.assert_allclose(np.cross(np.eye(3)[k], S), force, atol=1e-13)
        np.testing.assert_allclose(J[:, k], moment, atol=1e-12)


def test_power_of_the_residual_is_the_rate_of_the_energy(system):
    """residual · v = d/dt (kinetic + strain + gravity) + dissipation, along a motion (a theorem, no formula repeated)."""
    motion, energies = Motion(system, 8), SmallBodyEnergies(system.bodies, GRAVITY)

    def energy(t):
        state = motion.state(t)
        return energies.at(state.origin[None], state.rotation[None], state.e[None], state.v[None])[0]

    state = motion.state()
    power = sum(
        residual(system, b, state) @ state.v[system.bodies.offset[b] : system.bodies.offset[b + 1]] for b in (1, 2, 3)
    )
    assert power == pytest.approx(derivative(energy)[:3].sum() + energy(0.0)[3], rel=1e-9)

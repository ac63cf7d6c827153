"""Rotations against mpmath, scipy's matrix exponential, differentiation, and the group's own laws."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from maggi.linalg import rotations as ro

EPS = np.finfo(float).eps
IDENTITY = np.eye(3)

component = st.floats(-1.0, 1.0, allow_subnormal=False)
direction = (
    st.tuples(component, component, component)
    .filter(lambda v: math.hypot(*v) > 1e-3)
    .map(lambda v: np.array(v) / math.hypot(*v))
)
# Angles over all scales from nothing to several turns, and around the switch from series to closed form at 1.
angle = st.one_of(
    st.just(0.0),
    st.floats(-12.0, 1.3).map(lambda e: 10.0**e),
    st.floats(-1e-3, 1e-3).map(lambda d: 1.0 + d),
    st.floats(0.0, 20.0),
)
turn = st.tuples(direction, angle).map(lambda pair: pair[0] * pair[1])
vector = st.tuples(component, component, component).map(np.array)


def skew(a):
    out = np.empty((3, 3))
    ro.skew(a, out)
    return out


def left_tangent(theta):
    out = np.empty((3, 3))
    ro.left_tangent(theta, out)
    return out


def rates(theta, thetadot, thetaddot):
    w, wdot = np.empty(3), np.empty(3)
    ro.left_tangent_rates(theta, thetadot, thetaddot, w, wdot)
    return w, wdot


@given(vector, vector)
def test_skew_is_the_cross_product(a, b):
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b), atol=EPS)


@pytest.mark.parametrize("x", [0.0, 1e-300, 1e-16, 1e-8, 1e-4, 0.1, 0.9, 1.0 - 1e-12, 1.0, 1.1, 4.0, 9.0, 30.0])
def test_coefficients_agree_with_mpmath(x):
    """Each coefficient to round-off of the largest term that it is made from, at 80 digits."""
    with mpmath.workdps(80):
        if x < 1e-30:
            exact = [1.0, 1 / 2, 1 / 6, -1 / 24, -1 / 120]
        else:

            def b(y):
                return (1 - mpmath.cos(mpmath.sqrt(y))) / y

            def c(y):
                return (mpmath.sqrt(y) - mpmath.sin(mpmath.sqrt(y))) / mpmath.sqrt(y) ** 3

            y = mpmath.mpf(x)
            a = mpmath.sin(mpmath.sqrt(y)) / mpmath.sqrt(y)
            exact = [float(v) for v in (a, b(y), c(y), (a - 2 * b(y)) / (2 * y), (b(y) - 3 * c(y)) / (2 * y))]
    found = [*ro._coefficients(x), *ro._coefficient_derivatives(x)]
    np.testing.assert_allclose(found, exact, rtol=4 * EPS, atol=2 * EPS)
    if x < 1.0:
        np.testing.assert_allclose(found, exact, rtol=4 * EPS, atol=0.0)


@given(turn)
@example(np.zeros(3))
def test_exponential_is_the_matrix_exponential_and_a_rotation(theta):
    R = ro.rotation_matrix(theta)
    scale = 1.0 + np.linalg.norm(theta)
    np.testing.assert_allclose(R, expm(skew(theta)), atol=30 * EPS * scale)
    np.testing.assert_allclose(R @ R.T, IDENTITY, atol=8 * EPS)
    assert np.linalg.det(R) == pytest.approx(1.0, abs=8 * EPS)


@given(direction, st.one_of(st.just(0.0), st.floats(-15.0, 0.497).map(lambda e: 10.0**e)))
@example(np.array([1.0, 0.0, 0.0]), 0.0)
@example(np.array([0.0, 1.0, 0.0]), math.pi / 2)
def test_logarithm_undoes_the_exponential(axis, t):
    """Relative to the angle: also a rotation of 1e-15 rad comes back to round-off."""
    theta = axis * t
    np.testing.assert_allclose(ro.rotation_vector(ro.rotation_matrix(theta)), theta, rtol=0, atol=10 * EPS * t)


@given(direction, st.floats(-17.0, -1.0))
@example(np.array([0.0, 0.0, 1.0]), -9.0)
@example(np.array([0.0, -1.0, 0.0]), -9.0)
def test_logarithm_near_half_a_turn(axis, exponent):
    theta = axis * (math.pi - 10.0**exponent)
    found = ro.rotation_vector(ro.rotation_matrix(theta))
    # Within round-off of π both signs of the axis are right.
    error = min(np.abs(found - theta).max(), np.abs(found + theta).max() if exponent < -14.5 else math.inf)
    assert error < 20 * EPS * math.pi


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_logarithm_of_exactly_half_a_turn(axis):
    R = -np.eye(3)
    R[axis, axis] = 1.0
    np.testing.assert_allclose(ro.rotation_vector(R), math.pi * IDENTITY[axis], atol=0.0)


@given(turn)
def test_left_tangent_is_the_average_of_the_rotations_on_the_way(theta):
    """T_l(theta) = ∫₀¹ exp(s S) ds, by Gauss-Legendre quadrature: no code in common with the closed form."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    average = sum(
        0.5 * weight * expm(0.5 * (1 + node) * skew(theta)) for node, weight in zip(nodes, weights, strict=True)
    )
    np.testing.assert_allclose(left_tangent(theta), average, atol=60 * EPS * (1.0 + np.linalg.norm(theta)))


def power_series(S, shift):
    """Σ Sⁿ/(n + shift)! in complex arithmetic: exp for shift 0, the left tangent for shift 1."""
    total, term = np.zeros((3, 3), dtype=complex), np.eye(3, dtype=complex)
    for n in range(60):
        total += term
        term = term @ S / (n + 1 + shift)
    return total


@given(turn, vector, vector)
@example(np.zeros(3), np.array([1.0, 2.0, 3.0]), np.array([-1.0, 0.5, 2.0]))
def test_rates_on_a_parabola_of_rotation_vectors(theta, thetadot, thetaddot):
    """w from d/dt R = skew(w) R, wdot from d/dt (T_l thetadot): complex steps through power series, no cancellation."""
    theta = theta / max(1.0, np.linalg.norm(theta) / 6.0)  # the power series lose digits at larger angles
    step = 1e-30
    p, q, r = theta + 1j * step * thetadot
    S = np.array([[0, -r, q], [r, 0, -p], [-q, p, 0]])
    R = power_series(S, 0)
    angular = power_series(S, 1) @ (thetadot + 1j * step * thetaddot)
    w, wdot = rates(theta, thetadot, thetaddot)
    tolerance = 1e-15 * (10.0 + math.exp(np.linalg.norm(theta)))
    np.testing.assert_allclose(skew(w), (R.imag / step) @ R.real.T, atol=10 * tolerance)
    np.testing.assert_allclose(w, angular.real, atol=tolerance)
    np.testing.assert_allclose(wdot, angular.imag / step, atol=10 * tolerance)


@given(st.floats(-12.0, -3.0), direction, vector, vector)
def test_rates_keep_their_small_terms_at_tiny_angles(exponent, axis, thetadot, thetaddot):
    """To first order in theta: w = θ̇ + θ×θ̇/2, wdot = θ̈ + θ×θ̈/2 + θ̇×(θ×θ̇)/6 + O(θ²)."""
    theta = axis * 10.0**exponent
    w, wdot = rates(theta, thetadot, thetaddot)
    tolerance = np.dot(theta, theta) + 4 * EPS
    np.testing.assert_allclose(w, thetadot + np.cross(theta, thetadot) / 2, rtol=0, atol=tolerance)
    quadratic = (
        np.cross(thetadot, np.cross(theta, thetadot)) / 6 - np.dot(theta, thetadot) * np.cross(theta, thetadot) / 12
    )
    expected = thetaddot + np.cross(theta, thetaddot) / 2 + quadratic
    np.testing.assert_allclose(wdot, expected, rtol=0, atol=tolerance)


def test_rates_may_overwrite_their_inputs():
    theta, u, z = np.array([0.3, -0.2, 0.9]), np.array([1.0, 2.0, 3.0]), np.array([-1.0, 0.5, 2.0])
    w, wdot = rates(theta, u, z)
    ro.left_tangent_rates(theta, u, z, u, z)
    np.testing.assert_array_equal(u, w)
    np.testing.assert_array_equal(z, wdot)


@given(turn, turn, vector, vector)
def test_pose_update_is_the_exponential_of_the_twist(start, theta, r, q):
    """Against the 4x4 matrix exponential of [[S, q], [0, 0]]."""
    R = ro.rotation_matrix(start)
    pose, twist = np.eye(4), np.zeros((4, 4))
    pose[:3, :3], pose[:3, 3] = R, r
    twist[:3, :3], twist[:3, 3] = skew(theta), q
    moved = pose @ expm(twist)
    R_out, r_out = np.empty((3, 3)), np.empty(3)
    ro.exp_se3_update(R, r, q, theta, R_out, r_out)
    tolerance = 60 * EPS * (1.0 + np.linalg.norm(theta))
    np.testing.assert_allclose(R_out, moved[:3, :3], atol=tolerance)
    np.testing.assert_allclose(r_out, moved[:3, 3], atol=tolerance)
    ro.exp_se3_update(R, r, q, theta, R, r)
    np.testing.assert_array_equal(R, R_out)
    np.testing.assert_array_equal(r, r_out)


@settings(max_examples=20)
@given(turn, vector)
def test_a_screw_motion_in_many_steps_is_one_in_one_step(theta, q):
    """exp of n equal increments composes exactly; the drift from orthogonality stays at round-off."""
    steps = 1000
    R, r = np.eye(3), np.zeros(3)
    for _ in range(steps):
        ro.exp_se3_update(R, r, q / steps, theta / steps, R, r)
    once_R, once_r = np.eye(3), np.zeros(3)
    ro.exp_se3_update(once_R, once_r, q, theta, once_R, once_r)
    np.testing.assert_allclose(R, once_R, atol=steps * EPS * (1.0 + np.linalg.norm(theta)))
    np.testing.assert_allclose(r, once_r, atol=steps * EPS * (1.0 + np.linalg.norm(theta)))
    np.testing.assert_allclose(R @ R.T, IDENTITY, atol=steps * EPS)

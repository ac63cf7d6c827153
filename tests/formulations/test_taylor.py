"""Taylor arithmetic against functions of time whose derivatives are known, and against the program's own jets."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maggi.formulations.programs import at_time, formula_at
from maggi.formulations.taylor import (
    Taylor,
    angular_velocity,
    arc_tangent,
    compose,
    constant,
    cross,
    dot,
    norm,
    partial_rotations,
    product,
    rotation_matrix,
    scaled,
    stack,
    time,
    unit,
)
from maggi.linalg.jets import sample
from maggi.linalg.rotations import left_tangent, left_tangent_rates
from maggi.linalg.rotations import rotation_matrix as exp_so3
from maggi.model import expression, formula

SEEDS = st.integers(0, 2**32 - 1)
UNKNOWNS = 4


def polynomial(rng, shape, order=2):
    """A random quantity, and the coefficients of its value, rate and acceleration: ẍ = c₂ + slopes·z."""
    known = tuple(rng.normal(size=shape) for _ in range(order))
    return Taylor(known, rng.normal(size=(1 + UNKNOWNS, *shape)))


def path(x, z, h):
    """The quantity at time h for unknowns z, to second order."""
    highest = x.highest[0] + np.tensordot(z, x.highest[1:], 1)
    return sum(h**k / [1.0, 1.0, 2.0][k] * part for k, part in enumerate((*x.known, highest)))


def derivatives(f, h=1e-2):
    """Value, first and second derivative at 0 of a smooth function of h, by differences of sixth order."""
    v = [f(k * h) for k in range(-3, 4)]
    first = np.tensordot([-1, 9, -45, 0, 45, -9, 1], v, 1) / (60 * h)
    second = np.tensordot([2, -27, 270, -490, 270, -27, 2], v, 1) / (180 * h**2)
    return v[3], first, second


@pytest.mark.parametrize(
    ("operation", "plain", "shapes"),
    [
        (lambda a, b: a + b, lambda a, b: a + b, [(3,), (3,)]),
        (lambda a, b: a - b * 2.0, lambda a, b: a - 2.0 * b, [(3,), (3,)]),
        (lambda a, b: product("ij,j->i", a, b), lambda a, b: a @ b, [(3, 3), (3,)]),
        (lambda a, b: product("ij,kj->ik", a, b), lambda a, b: a @ b.T, [(3, 3), (2, 3)]),
        (dot, np.dot, [(3,), (3,)]),
        (cross, np.cross, [(3,), (3,)]),
        (scaled, lambda a, b: a * b, [(), (3,)]),
        (lambda a: unit(a), lambda a: a / np.linalg.norm(a), [(3,)]),
        (norm, np.linalg.norm, [(3,)]),
        (rotation_matrix, exp_so3, [(3,)]),
        (lambda a: arc_tangent(a[0], a[1]), lambda a: np.arctan2(a[0], a[1]), [(2,)]),
        (lambda a, b: stack([a, b]), lambda a, b: np.array([a, b]), [(), ()]),
    ],
)
def test_operations(operation, plain, shapes):
    """Value, rate and acceleration, with its slopes to the unknowns, of every operation."""
    rng = np.random.default_rng(3)
    arguments = [polynomial(rng, shape) for shape in shapes]
    result = operation(*arguments)
    for z in (np.zeros(UNKNOWNS), rng.normal(size=UNKNOWNS)):
        expected = derivatives(lambda h, z=z: plain(*(path(x, z, h) for x in arguments)))
        found = (*result.known, result.highest[0] + np.tensordot(z, result.highest[1:], 1))
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_allclose(one, other, atol=1e-7)
    # carried to first order, the unknowns are rates
    lower = [Taylor(x.known[:1], x.highest) for x in arguments]
    slopes = operation(*lower)
    np.testing.assert_allclose(slopes.highest[1:], result.highest[1:], atol=1e-13)


def test_orders_and_rows_meet():
    """What is of lower order lowers the other; what has no slopes is padded."""
    rng = np.random.default_rng(4)
    a, b = polynomial(rng, (3,)), polynomial(rng, (3,), order=1)
    both = a + b
    assert both.order == 1
    np.testing.assert_array_equal(both.highest[0], a.known[1] + b.highest[0])
    np.testing.assert_array_equal(both.highest[1:], b.highest[1:])
    assert (a + constant(np.ones(3))).highest.shape == a.highest.shape
    np.testing.assert_array_equal(a.derivative().value, a.rate)
    np.testing.assert_array_equal(a.lower().rate, a.rate)


@given(SEEDS, st.sampled_from([0.0, 1e-9, 1e-3, 1.0, 6.0]))
def test_rotations(seed, angle):
    """ω and its rate of exp(θ̃) from R alone, against the tangents of `linalg.rotations`; R stays a rotation."""
    rng = np.random.default_rng(seed)
    theta = polynomial(rng, (3,))
    direction = theta.value / np.linalg.norm(theta.value)
    theta = Taylor((angle * direction, theta.rate), theta.highest)
    R = rotation_matrix(theta)
    np.testing.assert_allclose(R.value, exp_so3(theta.value), atol=2e-13)
    np.testing.assert_allclose(R.value.T @ R.value, np.eye(3), atol=2e-13)
    w, wdot = np.empty(3), np.empty(3)
    left_tangent_rates(theta.value, theta.rate, theta.highest[0].copy(), w, wdot)
    omega = angular_velocity(R)
    np.testing.assert_allclose(omega.value, w, atol=1e-11)
    np.testing.assert_allclose(omega.highest[0], wdot, atol=1e-11)
    tangent = np.empty((3, 3))
    left_tangent(theta.value, tangent)
    np.testing.assert_allclose(partial_rotations(R), theta.highest[1:] @ tangent.T, atol=1e-11)


FUNCTIONS = (
    "sin(3*t)*exp(-t) + t**3",
    "atan2(t, 1 + t**2)/(2 + cos(t))",
    "sqrt(1 + t)*log(2 + t) - tan(0.3*t)",
    "asin(0.5*t) + acos(0.3*t)**2",
    "abs(t - 0.7) + min(t, 0.2) + max(t**2, 0.1)",
    "smoothstep(t, 0, 1) + smoothstep(t, 2, 3)",
    "(1 + t)**(2*t) - (2 + t)**0.5 + t**1 + t**0",
    "3.5",
)


@pytest.mark.parametrize("text", FUNCTIONS)
@pytest.mark.parametrize("t", [0.05, 0.4, 0.9])
def test_functions_of_time(text, t):
    """Two evaluators of the same programs."""
    f = expression(text)
    x = at_time(f, t)
    np.testing.assert_allclose([x.value, x.rate, x.highest[0]], sample(f, t)[0], rtol=1e-12, atol=1e-12)


def test_formulas_in_moving_variables():
    rng = np.random.default_rng(5)
    a, b = polynomial(rng, ()), polynomial(rng, ())
    f = formula("c*a*b - sin(a)*t + b**2", ("t", "a", "b"), c=1.5)
    found = formula_at(f, {"t": time(0.3), "a": a, "b": b})

    def plain(h, z):
        x, y = path(a, z, h), path(b, z, h)
        return 1.5 * x * y - np.sin(x) * (0.3 + h) + y**2

    z = rng.normal(size=UNKNOWNS)
    value, rate, acceleration = derivatives(lambda h: plain(h, z))
    np.testing.assert_allclose([found.value, found.rate], [value, rate], atol=1e-9)
    np.testing.assert_allclose(found.highest[0] + z @ found.highest[1:], acceleration, atol=1e-7)


def test_infinite_slopes_count_only_where_something_moves():
    """√x at x = 0 that rests is 0, as `sqrt(max(0, t - 1))` is before t = 1."""
    resting = compose(0.0, [np.inf], np.array([[-np.inf]]), constant(0.0))
    assert (resting.value, resting.rate, resting.highest[0]) == (0.0, 0.0, 0.0)
    x = at_time(expression("sqrt(max(0, t - 1))"), 0.5)
    assert (x.value, x.rate, x.highest[0]) == (0.0, 0.0, 0.0)

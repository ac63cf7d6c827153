"""Second-order jets: against differences in 60 digits, against sympy, and where the formulas are delicate."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from maggi.linalg.jets import evaluate, program, sample
from maggi.model.errors import ModelError
from maggi.model.expression import FUNCTIONS, expression

DIGITS = mpmath.MPContext()
DIGITS.dps = 60


def _smoothstep(x: mpmath.mpf, low: mpmath.mpf, high: mpmath.mpf) -> mpmath.mpf:
    s = min(max((x - low) / DIGITS.mpf(high - low), 0), 1)
    return s**3 * (6 * s**2 - 15 * s + 10)


NAMES = {name: getattr(DIGITS, name) for name in FUNCTIONS - {"abs", "min", "max", "smoothstep"}}
NAMES |= {"abs": abs, "min": min, "max": max, "smoothstep": _smoothstep, "pi": DIGITS.pi, "__builtins__": {}}

LEAVES = st.integers(1, 9).map(str) | st.integers(1, 99).map(lambda n: f"{n / 10}") | st.sampled_from(["t", "t", "pi"])
OF_ONE = (
    "sin({})",
    "cos({})",
    "tan(sin({}))",
    "asin(cos({})/2)",
    "acos(sin({})/2)",
    "atan({})",
    "exp(sin({}))",
    "log(2 + abs({}))",
    "sqrt(3 + ({})**2)",
    "abs({})",
    "-({})",
    "smoothstep({}, 0, 2)",
    "({})**2",
    "({})**3",
    "(2 + sin({}))**-1.5",
    "({})**0",
    "({})**1",
)
OF_TWO = (
    "({}) + ({})",
    "({}) - ({})",
    "({}) * ({})",
    "({}) / (2 + cos({}))",
    "atan2({}, {})",
    "min({}, {})",
    "max({}, {})",
    "(1.5 + sin({}))**cos({})",
)


def _grow(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    one = st.tuples(st.sampled_from(OF_ONE), inner).map(lambda part: part[0].format(part[1]))
    two = st.tuples(st.sampled_from(OF_TWO), inner, inner).map(lambda part: part[0].format(part[1], part[2]))
    return one | two


EXPRESSIONS = st.recursive(LEAVES, _grow, max_leaves=6)


def differences(text: str, t: float, h: str) -> list[mpmath.mpf]:
    """Value and two derivatives by central differences in 60 digits: error of the order h² (1e-24)."""
    code = compile(text, "test", "eval")
    step, at = DIGITS.mpf(h), DIGITS.mpf(t)
    low, mid, high = (DIGITS.mpf(eval(code, dict(NAMES), {"t": x})) for x in (at - step, at, at + step))
    return [mid, (high - low) / (2 * step), (high - 2 * mid + low) / step**2]


def test_every_function_of_the_language_is_tried() -> None:
    tried = " ".join(OF_ONE + OF_TWO)
    assert all(f"{name}(" in tried for name in FUNCTIONS)


@given(text=EXPRESSIONS, t=st.floats(-3.0, 3.0).map(lambda x: round(x, 3)))
@settings(deadline=None, max_examples=300)
def test_random_expressions_against_differences(text: str, t: float) -> None:
    try:
        fine, coarse = differences(text, t, "1e-12"), differences(text, t, "1e-11")
    except (ZeroDivisionError, ValueError, TypeError, OverflowError):  # outside a domain, or complex there
        assume(False)
    # A kink, or a derivative without bound, shows as a disagreement of the two steps.
    assume(all(abs(a - b) < 1e-9 * (1 + abs(b)) for a, b in zip(fine, coarse, strict=True)))
    assume(all(abs(value) < 1e6 for value in fine))
    try:
        jet = sample(expression(text), [t])[0]
    except ModelError:
        # A constant part overflows in double precision though it does not in 60 digits.
        assume(False)
    size = 1.0 + max(abs(float(value)) for value in fine)
    np.testing.assert_allclose(jet, [float(value) for value in fine], rtol=1e-9, atol=1e-10 * size)


SMOOTH = [
    "3*t**2 - 2*t + 1",
    "sin(3*t)*exp(-t)",
    "t**t",
    "2**t",
    "t**2.5",
    "t**-2",
    "1/t",
    "t/(1 + t**2)",
    "tan(t/2)",
    "asin(t/3)",
    "acos(t/3)",
    "atan(t**2)",
    "atan2(t, 1 + t**2)",
    "atan2(-sin(2*t), cos(2*t) - 2)",
    "log(t)",
    "sqrt(t)",
    "exp(sqrt(t))",
    "abs(t - 5)*t",
]


@pytest.mark.parametrize("text", SMOOTH)
def test_against_symbolic_derivatives(text: str) -> None:
    t = sympy.Symbol("t", positive=True)
    names = {"t": t, "abs": sympy.Abs}
    symbolic = sympy.sympify(text, locals=names, rational=True)
    at = sympy.Rational(7, 10)
    wanted = [float(symbolic.diff(t, order).subs(t, at).evalf(30)) for order in range(3)]
    np.testing.assert_allclose(sample(expression(text), [0.7])[0], wanted, rtol=2e-14, atol=1e-14)


DELICATE = [
    # text, time, (f, ḟ, f̈), worked out by hand
    ("abs(t)", 0.0, (0.0, 1.0, 0.0)),  # derivatives to the right
    ("abs(-t)", 0.0, (0.0, 1.0, 0.0)),
    ("abs(t**2)", 0.0, (0.0, 0.0, 2.0)),
    ("max(0, t)", 0.0, (0.0, 1.0, 0.0)),
    ("min(0, t)", 0.0, (0.0, 0.0, 0.0)),
    ("max(t, t)", 2.0, (2.0, 1.0, 0.0)),
    ("min(t, 2*t, 3)", 1.0, (1.0, 1.0, 0.0)),
    ("max(t, t**2)", 1.0, (1.0, 2.0, 2.0)),
    ("min(t, t**2)", 1.0, (1.0, 1.0, 0.0)),
    ("t**2", 0.0, (0.0, 0.0, 2.0)),
    ("t**1", 0.0, (0.0, 1.0, 0.0)),
    ("t**0", 0.0, (1.0, 0.0, 0.0)),
    ("t**3", 0.0, (0.0, 0.0, 0.0)),
    ("(-t)**3", 2.0, (-8.0, -12.0, -12.0)),
    ("sqrt(max(0, t - 1))", 0.5, (0.0, 0.0, 0.0)),
    ("max(0, t - 1)**1.5", 0.5, (0.0, 0.0, 0.0)),
    ("(t**2)**1.5", 0.0, (0.0, 0.0, 0.0)),
    ("asin(min(t, 1))", 3.0, (math.pi / 2, 0.0, 0.0)),
    ("smoothstep(t, 1, 3)", 1.0, (0.0, 0.0, 0.0)),
    ("smoothstep(t, 1, 3)", 3.0, (1.0, 0.0, 0.0)),
    ("smoothstep(t, 1, 3)", 2.0, (0.5, 15.0 / 16.0, 0.0)),  # 30 s²(1−s)²/2 at the middle
    ("smoothstep(t, 3, 1)", 0.0, (1.0, 0.0, 0.0)),
    ("7", 0.3, (7.0, 0.0, 0.0)),
]


@pytest.mark.parametrize(("text", "t", "jet"), DELICATE)
def test_delicate_places(text: str, t: float, jet: tuple[float, float, float]) -> None:
    np.testing.assert_allclose(sample(expression(text), [t])[0], jet, rtol=1e-15, atol=1e-15)


def test_smoothstep_has_two_continuous_derivatives() -> None:
    f = expression("smoothstep(t, 0, 1)")
    inside = sample(f, [1e-9, 1.0 - 1e-9])
    np.testing.assert_allclose(inside[:, 1:], 0.0, atol=1e-7)


def test_a_driver_at_constant_speed() -> None:
    jets = sample(expression("speed*t", speed="1500 rpm"), np.linspace(0.0, 0.1, 11))
    speed = 50.0 * math.pi  # 1500 turns of 2π in 60 s
    np.testing.assert_allclose(jets[:, 0], speed * np.linspace(0.0, 0.1, 11), rtol=1e-15)
    np.testing.assert_allclose(jets[:, 1], speed, rtol=1e-15)
    np.testing.assert_array_equal(jets[:, 2], 0.0)


@pytest.mark.parametrize(
    ("text", "t", "what"),
    [
        ("1/t", 0.0, "value"),
        ("log(t)", -1.0, "value"),
        ("sqrt(t)", 0.0, "first derivative"),
        ("asin(t)", 1.5, "value"),
        ("exp(t)", 1e4, "value"),
        ("max(log(t), 1)", -1.0, "value"),
        ("min(1, log(t))", -1.0, "value"),
        ("smoothstep(log(t), 0, 1)", -1.0, "value"),
        ("atan2(t, t)", 0.0, "first derivative"),
        ("t**1.5", 0.0, "second derivative"),
    ],
)
def test_what_is_not_finite_is_refused_with_the_time(text: str, t: float, what: str) -> None:
    with pytest.raises(ModelError, match="not finite") as caught:
        sample(expression(text), [0.5, t])
    assert what in caught.value.message
    assert f"t = {t:.6g} s" in caught.value.message
    out = np.empty(3)
    assert not evaluate(*program(expression(text)), t, out)


def test_the_kernel_writes_what_sample_returns_and_says_finite() -> None:
    f = expression("(1 + t)*(2 + t)*(3 - (4 + t)*(5 - t))")
    out = np.full(5, 9.0)
    assert evaluate(*program(f), 0.25, out)
    np.testing.assert_array_equal(out[:3], sample(f, [0.25])[0])
    np.testing.assert_array_equal(out[3:], 9.0)


def test_deepest_stack_that_the_compiler_lets_through() -> None:
    deep = "(t*" * 31 + "t" + ")" * 31
    np.testing.assert_allclose(sample(expression(deep), [1.1])[0, 0], 1.1**32, rtol=1e-13)
    with pytest.raises(ModelError, match="intermediate results"):
        expression("(t*" * 32 + "t" + ")" * 32)

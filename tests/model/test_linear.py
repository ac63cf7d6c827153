"""Formulas taken apart: coefficients times names plus the rest is the formula."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maggi.model import Formula, ModelError, formula
from maggi.model.linear import linear_parts
from maggi.model.operations import BINARY, MAX_STACK, Operation, evaluate

NAMES = ("u", "v")
VARIABLES = ("u", "t", "v", "a")


def value(f: Formula | None, **known: float) -> float:
    if f is None:
        return 0.0
    return float(evaluate(f.codes, f.values, [np.array([known[name]]) for name in f.variables])[0])


def agree(f: Formula) -> None:
    """At random values of all variables, and without loss where the coefficients are asked alone."""
    parts, rest = linear_parts(f, NAMES)
    rng = np.random.default_rng(1)
    for _ in range(5):
        known = dict(zip(VARIABLES, rng.uniform(0.5, 2.0, 4), strict=True))
        whole = value(f, **known)
        total = sum(value(part, **known) * known[name] for name, part in parts.items()) + value(rest, **known)
        assert total == pytest.approx(whole, rel=1e-12, abs=1e-12)
    for part in [*parts.values(), *([rest] if rest else [])]:
        assert part.variables == ("t", "a")


@pytest.mark.parametrize(
    "text",
    [
        "u",
        "-v",
        "u - v",
        "2*u*cos(t) - sin(a)*v/3 + t",
        "a - u",
        "t*(a*(u + 2*v) - u)/(1 + t**2) - 1",
        "-(u - (v - (u - a)))",
        "u*a - a*u",
        "sin(t)",
        "3",
        "max(a, t)*u + min(1, t)",
    ],
)
def test_parts_make_the_whole(text: str) -> None:
    agree(formula(text, VARIABLES))


TERMS = st.recursive(
    st.sampled_from(["u", "v", "a*u", "2*v", "t", "a", "sin(t)"]),
    lambda part: st.one_of(
        st.tuples(part, part).map(lambda p: f"({p[0]} + {p[1]})"),
        st.tuples(part, part).map(lambda p: f"({p[0]} - {p[1]})"),
        part.map(lambda p: f"-{p}"),
        part.map(lambda p: f"(a*{p})"),
        part.map(lambda p: f"({p}*(t - a))"),
        part.map(lambda p: f"({p}/(1 + a))"),
    ),
    max_leaves=12,
)


@given(TERMS)
@settings(max_examples=100, deadline=None)
def test_parts_of_any_linear_formula(text: str) -> None:
    agree(formula(text, VARIABLES))


def test_what_does_not_occur_has_no_part() -> None:
    parts, rest = linear_parts(formula("2*u", VARIABLES), NAMES)
    assert parts.keys() == {"u"}
    assert rest is None
    assert linear_parts(formula("t", VARIABLES), NAMES)[0] == {}


def depth(f: Formula) -> int:
    height = deepest = 0
    for code in f.codes:
        height += 1 if code in (Operation.CONSTANT, Operation.VARIABLE) else -1 if code in BINARY else 0
        deepest = max(deepest, height)
    return deepest


@pytest.mark.parametrize("innermost", ["a", "u", "a*u"])
@pytest.mark.parametrize("around", ["u*({})", "t*({})", "({})*t"])
def test_parts_need_no_deeper_stack(innermost: str, around: str) -> None:
    if "u" in innermost and "u" in around:
        return
    text = innermost
    for _ in range(MAX_STACK - 3):
        text = f"(t + {text})"
    f = formula(around.format(text), VARIABLES)
    assert depth(f) > MAX_STACK - 4
    agree(f)
    parts, rest = linear_parts(f, NAMES)
    assert max(depth(part) for part in [*parts.values(), *([rest] if rest else [])]) <= depth(f)


@pytest.mark.parametrize(
    ("text", "name"),
    [("u*v", "u"), ("sin(u)", "u"), ("1/v", "v"), ("u**2", "u"), ("abs(v)", "v"), ("t*max(u, 1)", "u"), ("a**v", "v")],
)
def test_what_is_not_linear_is_refused(text: str, name: str) -> None:
    with pytest.raises(ModelError, match=f"is not linear in {name}"):
        linear_parts(formula(text, VARIABLES), NAMES)

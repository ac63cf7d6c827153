"""The expression language: what it computes, what it refuses, and that nothing in it can run, hang or crash."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maggi.model.errors import ModelError, ModelErrors
from maggi.model.expression import (
    FUNCTIONS,
    MAX_LENGTH,
    compile_program,
    constant,
    expression,
    resolve_parameters,
    value_at,
)
from maggi.model.operations import MAX_STACK, Operation

CONSTANTS = [
    ("2 + 3*4", 14.0),
    ("(2 + 3)*4", 20.0),
    ("2**3**2", 512.0),
    ("-2**2", -4.0),
    ("+3 - -4", 7.0),
    ("7/2", 3.5),
    ("1e-3", 1e-3),
    ("1_000", 1000.0),
    ("2*pi", 2 * math.pi),
    ("sin(1)", math.sin(1)),
    ("cos(1)", math.cos(1)),
    ("tan(1)", math.tan(1)),
    ("asin(0.5)", math.asin(0.5)),
    ("acos(0.5)", math.acos(0.5)),
    ("atan(-2)", math.atan(-2)),
    ("atan2(1, -2)", math.atan2(1, -2)),
    ("exp(2)", math.exp(2)),
    ("log(2)", math.log(2)),
    ("sqrt(2)", math.sqrt(2)),
    ("abs(-2)", 2.0),
    ("min(3, 1, 2)", 1.0),
    ("max(3, 1, 2)", 3.0),
    ("max(3)", 3.0),
    ("smoothstep(0.25, 0, 0.5)", 0.5),
    ("smoothstep(2, 0, 1)", 1.0),
    ("a + b", 5.0),
    ("30 deg", math.pi / 6),
]


@pytest.mark.parametrize(("text", "value"), CONSTANTS)
def test_constants(text: str, value: float) -> None:
    assert constant(text, {"a": 2.0, "b": 3.0}) == pytest.approx(value, rel=1e-15)


def test_every_function_is_computed_above() -> None:
    assert all(any(f"{name}(" in text for text, _ in CONSTANTS) for name in FUNCTIONS)


def test_constant_parts_are_folded() -> None:
    f = expression("(2*pi*f)*t + 0", f=50)
    assert f.codes == (Operation.CONSTANT, Operation.VARIABLE, Operation.MULTIPLY, Operation.CONSTANT, Operation.ADD)
    assert f.values[0] == 2 * math.pi * 50


def test_a_number_is_a_function_too() -> None:
    assert expression(3).values == (3.0,)
    assert value_at(expression("3 m/s"), [0.0, 1.0]) == [3.0, 3.0]


def test_value_at_many_times() -> None:
    assert value_at(expression("t**2 + 1"), [0.0, 2.0]) == [1.0, 5.0]


ATTACKS = [
    "__import__('os').system('touch /tmp/x')",
    "open('/etc/passwd').read()",
    "().__class__.__bases__[0].__subclasses__()",
    "t.__class__",
    "sin.__globals__",
    "getattr(t, 'real')",
    "eval('1')",
    "exec('1')",
    "compile('1', '', 'eval')",
    "globals()",
    "(lambda: 1)()",
    "lambda: 1",
    "[x for x in (1, 2)]",
    "{x: 1 for x in t}",
    "(x for x in t)",
    "f'{t}'",
    "f'{open(1)}'",
    "'a'*9",
    "'a' 'b'",
    "b'a'",
    "(1).real",
    "t[0]",
    "[1, 2]",
    "(1, 2)",
    "{1}",
    "{}",
    "t if t else 1",
    "t > 1",
    "1 < t < 2",
    "t and 1",
    "not t",
    "~1",
    "1 | 2",
    "1 << 99999999",
    "7 // 2",
    "7 % 2",
    "t @ t",
    "True",
    "None",
    "...",
    "0x",
    "3j*1",
    "await t",
    "yield t",
    "t := 1",
    "(t := 1)",
    "t = 1",
    "t; t",
    "t\nt",
    "import os",
    "*t",
    "sin(*t)",
    "sin(**t)",
    "sin(x=1)",
    "sin(sin)",
    "sin()(1)",
    "sin",
    "2^3",
    "",
    "   ",
    "#",
    "\0",
    "\ud800",
    "𝐭𝐭",
    "t" * (MAX_LENGTH + 1),
    "9" * 999,
    "9**9**9**9**9",
    "10.0**10**10",
    "(" * 999,
    "(" * 400 + "t" + ")" * 400,
    "-" * 900 + "t",
    "+" * 900 + "1",
    "t" + "+t" * 400,
    "sin(" * 190 + "t" + ")" * 190,
    "[" * 400,
    "not " * 200 + "t",
    "t" + "**t" * 300,
    "min(" + "t," * 450 + "t)" + "x",
    "exp(exp(exp(9)))",
    "1/0",
    "1/(t - t*0)/0",
    "0**-1",
    "sqrt(-1)",
    "(-8)**(1/3)",
    "log(0)",
    "asin(2)",
    "smoothstep(t, 1, 1)",
    "smoothstep(t)",
    "atan2(t)",
    "min()",
    "unknown",
    "unknown(t)",
    "1e999",
    "1e999*t",
    "nan",
    "inf",
]


@pytest.mark.parametrize("text", ATTACKS, ids=[text[:20].encode("unicode_escape").decode() for text in ATTACKS])
def test_attacks_and_mistakes_are_refused(text: str) -> None:
    with pytest.raises(ModelError) as caught:
        expression(text)
    assert len(str(caught.value)) < 600


ALPHABET = st.sampled_from(
    [
        "t",
        "pi",
        "sin",
        "max",
        "smoothstep",
        "a",
        "__x__",
        "1",
        "2.5",
        "1e9",
        "(",
        ")",
        "[",
        "]",
        "+",
        "-",
        "*",
        "**",
        "/",
    ]
    + ["//", ",", ".", " ", "\n", "=", "'", '"', "lambda", "for", "in", "if", ":", "{", "}", "@", "\\", "#", "é", "\t"]
)


@given(st.lists(ALPHABET, max_size=40).map("".join) | st.text(max_size=60))
@settings(max_examples=400, deadline=None)
def test_any_text_gives_a_function_or_a_model_error(text: str) -> None:
    try:
        f = expression(text, a=2)
    except ModelError:
        return
    assert len(f.codes) == len(f.values)
    assert all(math.isfinite(value) for value in f.values)


def test_deep_programs_fit_the_stack_of_the_kernel() -> None:
    assert len(expression("(t*" * (MAX_STACK - 1) + "t" + ")" * (MAX_STACK - 1)).codes) == 2 * MAX_STACK - 1
    with pytest.raises(ModelError, match="intermediate results"):
        expression("(t*" * MAX_STACK + "t" + ")" * MAX_STACK)


@pytest.mark.parametrize(
    ("text", "message", "remedy"),
    [
        ("sped*t", "unknown name 'sped'", "did you mean 'speed'?"),
        ("speed*sni(t)", "unknown function 'sni'", "did you mean 'sin'?"),
        ("2^t", "'^' is not an operator", "write ** for powers"),
        ("sin*t", "the function sin has no arguments", "write sin(…)"),
        ("atan2(t)", "atan2 takes 2 arguments, found 1", ""),
        ("1/0*t", "division by zero", ""),
        ("sqrt(-speed)", "sqrt of -157.08 is not a real number", ""),
        ("exp(1e4)", "exp of 10000 is too large", ""),
        ("t.real", "the attribute '.real' is not allowed", "use numbers"),
        ("(t", "is not an expression", "check operators"),
    ],
)
def test_messages_hold_text_reason_and_remedy(text: str, message: str, remedy: str) -> None:
    with pytest.raises(ModelError) as caught:
        expression(text, speed="1500 rpm")
    assert f"expression '{text}'" in caught.value.message
    assert message in caught.value.message
    assert remedy in caught.value.remedy


def test_time_is_refused_where_a_constant_is_wanted() -> None:
    with pytest.raises(ModelError, match="the time t cannot stand here"):
        constant("2*t")
    with pytest.raises(ModelError, match="finite"):
        constant(math.inf)
    with pytest.raises(ModelError, match="expected a number"):
        constant(True)


def test_parameters_refer_to_each_other_in_any_order() -> None:
    resolved = resolve_parameters({"a": "2*b", "b": "c + 1", "c": "3 mm", "d": 4})
    assert {name: parameter.value for name, parameter in resolved.items()} == {
        "a": 2 * (0.003 + 1),
        "b": 0.003 + 1,
        "c": 0.003,
        "d": 4.0,
    }
    assert str(resolved["c"].dimension) == "length"
    assert resolved["a"].dimension is None


def test_a_long_chain_of_parameters() -> None:
    chain = {"p0": 1.0} | {f"p{n}": f"p{n - 1} + 1" for n in range(1, 900)}
    assert resolve_parameters(dict(reversed(chain.items())))["p899"].value == 900.0


def test_circles_of_parameters_are_named() -> None:
    with pytest.raises(ModelErrors) as caught:
        resolve_parameters({"a": "b", "b": "c*2", "c": "a", "d": 1})
    assert (
        "a -> b -> c -> a" in caught.value.message
        or "b -> c -> a -> b" in caught.value.message
        or ("c -> a -> b -> c" in caught.value.message)
    )
    assert caught.value.path in {"parameters.a", "parameters.b", "parameters.c"}
    with pytest.raises(ModelErrors, match="a -> a"):
        resolve_parameters({"a": "a"})


def test_all_mistakes_in_parameters_are_collected_once() -> None:
    with pytest.raises(ModelErrors) as caught:
        resolve_parameters(
            {"a": "1/0", "b": "a + 1", "sin": 1, "2x": 1, "lambda": 2, "c": "3 mmm", "e": math.nan, "f": "g"}
        )
    assert sorted(error.path for error in caught.value.errors) == sorted(
        f"parameters.{name}" for name in ("a", "sin", "2x", "lambda", "c", "e", "f")
    )


def test_a_parameter_cannot_hide_a_coordinate() -> None:
    with pytest.raises(ModelError, match="both a parameter and a coordinate"):
        compile_program("x*2", {"x": 1.0}, ("x", "y", "z"))

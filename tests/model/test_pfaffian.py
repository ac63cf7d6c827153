"""Rows from texts and from coefficients: the two ways say the same."""

from __future__ import annotations

import numpy as np
import pytest

from maggi.model import ModelError, PfaffianRow
from maggi.model.joints import POSE
from maggi.model.operations import evaluate
from maggi.model.pfaffian import pfaffian_row

ENDS = ("p", "q")


def numbers(row: PfaffianRow) -> dict[str, float]:
    """Coefficients and constant at one arbitrary time and pose."""
    rng = np.random.default_rng(3)
    known = {"t": 0.7, **{f"{end}.{part}": rng.normal() for end in ENDS for part in POSE}}
    parts = {f"{end}.{component}": f for (end, component), f in row.coefficients.items()}
    if row.constant is not None:
        parts["constant"] = row.constant
    return {
        key: float(evaluate(f.codes, f.values, [np.array([known[name]]) for name in f.variables])[0])
        for key, f in parts.items()
    }


def test_text_and_coefficients_say_the_same() -> None:
    text = pfaffian_row("n*p.v.y*p.r11 - (p.v.x - q.w.z)*q.r21/2 + 0.1*t*p.x", ENDS, {"n": 3.0})
    given = {"p.v.y": "n*p.r11", "p.v.x": "-q.r21/2", "q.w.z": "q.r21/2", "constant": "0.1*t*p.x"}
    mapped = pfaffian_row(given, ENDS, {"n": 3.0})
    assert numbers(text) == pytest.approx(numbers(mapped), rel=1e-14)
    assert numbers(text).keys() == {"p.v.y", "p.v.x", "q.w.z", "constant"}


def test_numbers_are_coefficients() -> None:
    assert numbers(pfaffian_row({"q.w.x": 2, "constant": -1.5}, ENDS)) == {"q.w.x": 2.0, "constant": -1.5}
    assert pfaffian_row({"q.w.x": 2}, ENDS).constant is None


@pytest.mark.parametrize(
    ("given", "path", "message"),
    [
        ({"r.v.x": 1}, "r.v.x", "no end is called 'r'"),
        ({"p.v": 1}, "p.v", "names no velocity component"),
        ({"p.x": 1}, "p.x", "names no velocity component"),
        ({"p.v.x": "p.r41"}, "p.v.x", "unknown name 'p.r41'"),
        ({"p.v.x": "p.v.y"}, "p.v.x", "unknown name 'p.v.y'"),
        ({"p.v.x": "1 +"}, "p.v.x", "is not an expression"),
        ({"constant": 1}, "", "the row holds no velocity"),
        ("p.x + t", "", "the row holds no velocity"),
        ("p.v.x*q.v.y", "", "is not linear in p.v.x"),
        ("r.v.x", "", "unknown name 'r.v.x'"),
        ("p.v.x.real", "", "unknown name 'p.v.x.real'"),
        ("(p).v", "", "unknown name 'p.v'"),
        ("t.__class__", "", "unknown name 't.__class__'"),
        ("sin(t).real", "", "the attribute '.real' is not allowed"),
    ],
)
def test_what_is_no_row(given: str | dict[str, str | float], path: str, message: str) -> None:
    with pytest.raises(ModelError) as caught:
        pfaffian_row(given, ENDS)
    assert caught.value.path == path
    assert message in caught.value.message

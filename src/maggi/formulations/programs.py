"""Expressions of the model evaluated on Taylor numbers: functions of time, formulas in named variables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from maggi.model.functions import Formula, TimeFunction
from maggi.model.operations import Operation

from .taylor import Taylor, arc_tangent, constant, cosine, function, product, reciprocal, sine, time


def at_time(program: TimeFunction, t: float, order: int = 2) -> Taylor:
    """A function of time at t (s)."""
    return _evaluate(program.codes, program.values, [time(t, order)])


def formula_at(formula: Formula, variables: Mapping[str, Taylor]) -> Taylor:
    """A formula at given values of all its variables."""
    return _evaluate(formula.codes, formula.values, [variables[name] for name in formula.variables])


def _evaluate(codes: Sequence[int], values: Sequence[float], variables: Sequence[Taylor]) -> Taylor:
    order = min(x.order for x in variables) if variables else 2
    stack: list[Taylor] = []
    for code, value in zip(codes, values, strict=True):
        operation = Operation(code)
        if operation == Operation.CONSTANT:
            stack.append(constant(value, order))
        elif operation == Operation.VARIABLE:
            stack.append(variables[int(value)])
        elif operation in _BINARY:
            right = stack.pop()
            stack.append(_BINARY[operation](stack.pop(), right))
        else:
            stack.append(_UNARY[operation](stack.pop()))
    (result,) = stack
    return result


def _multiply(a: Taylor, b: Taylor) -> Taylor:
    return product(",->", a, b)


def _moves(x: Taylor) -> bool:
    return any(bool(np.any(part)) for part in (*x.known[1:], x.highest))


def _power(base: Taylor, exponent: Taylor) -> Taylor:
    u, g = float(base.value), float(exponent.value)
    if _moves(exponent):
        return _exponential(_multiply(exponent, _logarithm(base)))
    if g in (0.0, 1.0, 2.0):
        return {0.0: lambda: constant(1.0, base.order), 1.0: lambda: base, 2.0: lambda: _multiply(base, base)}[g]()
    return function(u**g, g * u ** (g - 1.0), g * (g - 1.0) * u ** (g - 2.0), base) if _moves(base) else constant(u**g)


def _sign_ahead(x: Taylor) -> float:
    """Sign of a quantity just after now, by its known derivatives: what a kink is judged by."""
    return next((float(part) for part in (*x.known, x.highest[0]) if part != 0.0), 0.0)


def _absolute(x: Taylor) -> Taylor:
    return -x if _sign_ahead(x) < 0.0 else x


def _minimum(a: Taylor, b: Taylor) -> Taylor:
    return a if _sign_ahead(b - a) > 0.0 else b


def _maximum(a: Taylor, b: Taylor) -> Taylor:
    return b if _sign_ahead(b - a) > 0.0 else a


def _tangent(x: Taylor) -> Taylor:
    return _multiply(sine(x), reciprocal(cosine(x)))


def _arc_sine(x: Taylor) -> Taylor:
    u = float(x.value)
    room = 1.0 - u * u
    return function(math.asin(u), room**-0.5, u * room**-1.5, x) if _moves(x) else constant(math.asin(u), x.order)


def _arc_cosine(x: Taylor) -> Taylor:
    return -_arc_sine(x) + math.pi / 2.0


def _exponential(x: Taylor) -> Taylor:
    h = math.exp(float(x.value))
    return function(h, h, h, x)


def _logarithm(x: Taylor) -> Taylor:
    u = float(x.value)
    return function(math.log(u), 1.0 / u, -1.0 / u**2, x)


def _square_root(x: Taylor) -> Taylor:
    root = math.sqrt(float(x.value))
    return function(root, 0.5 / root, -0.25 / root**3, x) if _moves(x) else constant(root, x.order)


def _smoothstep(x: Taylor) -> Taylor:
    s = float(x.value)
    if s <= 0.0 or s >= 1.0:
        return constant(float(s >= 1.0), x.order)
    return function(
        s**3 * (s * (6.0 * s - 15.0) + 10.0), 30.0 * s**2 * (1 - s) ** 2, 60.0 * s * (1 - s) * (1 - 2 * s), x
    )


_BINARY = {
    Operation.ADD: lambda a, b: a + b,
    Operation.SUBTRACT: lambda a, b: a - b,
    Operation.MULTIPLY: _multiply,
    Operation.DIVIDE: lambda a, b: _multiply(a, reciprocal(b)),
    Operation.POWER: _power,
    Operation.MINIMUM: _minimum,
    Operation.MAXIMUM: _maximum,
    Operation.ATAN2: arc_tangent,
}
_UNARY = {
    Operation.NEGATE: lambda x: -x,
    Operation.SIN: sine,
    Operation.COS: cosine,
    Operation.TAN: _tangent,
    Operation.ASIN: _arc_sine,
    Operation.ACOS: _arc_cosine,
    Operation.EXP: _exponential,
    Operation.LOG: _logarithm,
    Operation.SQRT: _square_root,
    Operation.ABS: _absolute,
    Operation.SMOOTHSTEP: _smoothstep,
}

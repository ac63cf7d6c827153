"""Functions of time, or of variables that move in time, with their first two derivatives, by forward second-order jets.

A jet is ``(f, ḟ, f̈)``. Every operation of a postfix program (`model.operations`) acts on jets by the chain rule
``(h∘u)˙ = h′u̇``, ``(h∘u)¨ = h″u̇² + h′ü``, so that the derivatives are exact to round-off and a driver's
acceleration needs no differences.

Where a function has a kink (abs, min, max) the derivatives are those to the right, which is where time goes. A
part that does not move (``u̇ = ü = 0``) has zero derivatives even where h′ is infinite, so that clamped inputs
such as ``sqrt(max(0, t - 1))`` are usable before t = 1.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.numpy_support import carray
from numpy.typing import ArrayLike, NDArray

from maggi.linalg.compiling import inner_kernel, kernel

from ..model.errors import ModelError
from ..model.functions import TimeFunction
from ..model.operations import MAX_STACK, Operation

Array = NDArray[np.float64]

# Plain integers: numba then compares machine words, and the cached code does not depend on a class.
_CONSTANT = int(Operation.CONSTANT)
_VARIABLE = int(Operation.VARIABLE)
_ADD = int(Operation.ADD)
_SUBTRACT = int(Operation.SUBTRACT)
_MULTIPLY = int(Operation.MULTIPLY)
_DIVIDE = int(Operation.DIVIDE)
_POWER = int(Operation.POWER)
_NEGATE = int(Operation.NEGATE)
_MINIMUM = int(Operation.MINIMUM)
_MAXIMUM = int(Operation.MAXIMUM)
_ATAN2 = int(Operation.ATAN2)
_SIN = int(Operation.SIN)
_COS = int(Operation.COS)
_TAN = int(Operation.TAN)
_ASIN = int(Operation.ASIN)
_ACOS = int(Operation.ACOS)
_EXP = int(Operation.EXP)
_LOG = int(Operation.LOG)
_SQRT = int(Operation.SQRT)
_ABS = int(Operation.ABS)
_SMOOTHSTEP = int(Operation.SMOOTHSTEP)


def _reserve(typing_context: Any) -> Any:
    """Room for MAX_STACK jets on the machine's stack: an array made inside a kernel would cost an allocation."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return cgutils.alloca_once(builder, context.get_value_type(types.float64), size=3 * MAX_STACK)  # type: ignore[no-untyped-call]

    return types.CPointer(types.float64)(), generate  # type: ignore[no-untyped-call]


_machine_stack: Any = intrinsic(_reserve)


@inner_kernel
def _power(u: float, du: float, ddu: float, g: float, dg: float, ddg: float) -> tuple[float, float, float]:
    """Jet of u**g; for a moving exponent u must be positive."""
    value = u**g
    if dg == 0.0 and ddg == 0.0:
        if (du == 0.0 and ddu == 0.0) or g == 0.0:
            return value, 0.0, 0.0
        if g == 1.0:
            return u, du, ddu
        first = g * u ** (g - 1.0)
        second = 2.0 if g == 2.0 else g * (g - 1.0) * u ** (g - 2.0)
        # A zero rate must not meet an infinite factor: (t²)^1.5 has a second derivative at 0.
        bend = 0.0 if du == 0.0 else second * du * du
        return value, first * du, bend + first * ddu
    logarithm = math.log(u)
    rate = du / u
    slope = dg * logarithm + g * rate
    bend = ddg * logarithm + 2.0 * dg * rate + g * (ddu / u - rate * rate)
    return value, value * slope, value * (bend + slope * slope)


@inner_kernel
def _outer(code: int, u: float) -> tuple[float, float, float]:
    """A function of one argument with its first two derivatives there: (h, h′, h″)."""
    if code == _SIN:
        s, c = math.sin(u), math.cos(u)
        return s, c, -s
    if code == _COS:
        s, c = math.sin(u), math.cos(u)
        return c, -s, -c
    if code == _TAN:
        h = math.tan(u)
        return h, 1.0 + h * h, 2.0 * h * (1.0 + h * h)
    if code == _ASIN or code == _ACOS:
        if not -1.0 <= u <= 1.0:
            return np.nan, np.nan, np.nan
        room = (1.0 - u) * (1.0 + u)
        first = 1.0 / math.sqrt(room)
        second = u * first / room
        if code == _ASIN:
            return math.asin(u), first, second
        return math.acos(u), -first, -second
    if code == _EXP:
        h = math.exp(u)
        return h, h, h
    if code == _LOG:
        if u < 0.0:
            return np.nan, np.nan, np.nan
        return math.log(u), 1.0 / u, -1.0 / (u * u)
    if code == _SQRT:
        if u < 0.0:
            return np.nan, np.nan, np.nan
        h = math.sqrt(u)
        return h, 0.5 / h, -0.25 / (h * u)
    # _SMOOTHSTEP: 6s⁵ − 15s⁴ + 10s³ between 0 and 1
    if u <= 0.0:
        return 0.0, 0.0, 0.0
    if u >= 1.0:
        return 1.0, 0.0, 0.0
    if math.isnan(u):
        return np.nan, np.nan, np.nan
    return (
        u * u * u * (u * (u * 6.0 - 15.0) + 10.0),
        30.0 * u * u * (1.0 - u) * (1.0 - u),
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
    )


@inner_kernel
def _later_sign(u: float, du: float, ddu: float) -> float:
    """Sign of a jet just after now: of the first of its entries that is not zero."""
    if u != 0.0:
        return u
    return du if du != 0.0 else ddu


@kernel
def evaluate(codes: NDArray[np.int64], values: Array, t: float, out: Array) -> bool:
    """Writes ``out[0:3] = f(t), ḟ(t), f̈(t)`` of a postfix program; returns whether all three are finite.

    codes (n,) integers and values (n,) floats as in `TimeFunction` (see `program`); out (3,) or longer. Units:
    those of the function, per second, per second squared. Allocates nothing.
    """
    time = carray(_machine_stack(), (1, 3))
    time[0, 0] = t
    time[0, 1] = 1.0
    time[0, 2] = 0.0
    return evaluate_jet(codes, values, time, out)


@kernel
def evaluate_jet(codes: NDArray[np.int64], values: Array, variables: Array, out: Array) -> bool:
    """As `evaluate`, for a function of several variables: `variables` (k, 3) are their jets along the motion.

    With the jet ``(x, w, 0)`` of a point the result is the value, the derivative along w, and the second one along w.
    """
    stack = carray(_machine_stack(), (MAX_STACK, 3))
    top = -1
    for i in range(codes.size):
        code = codes[i]
        if code == _CONSTANT:
            top += 1
            stack[top, 0] = values[i]
            stack[top, 1] = 0.0
            stack[top, 2] = 0.0
            continue
        if code == _VARIABLE:
            top += 1
            place = int(values[i])
            stack[top, 0] = variables[place, 0]
            stack[top, 1] = variables[place, 1]
            stack[top, 2] = variables[place, 2]
            continue
        if code == _NEGATE:
            stack[top, 0] = -stack[top, 0]
            stack[top, 1] = -stack[top, 1]
            stack[top, 2] = -stack[top, 2]
            continue
        if code > _ATAN2:
            u, du, ddu = stack[top, 0], stack[top, 1], stack[top, 2]
            if code == _ABS:
                if _later_sign(u, du, ddu) < 0.0:
                    stack[top, 0] = -u
                    stack[top, 1] = -du
                    stack[top, 2] = -ddu
                continue
            h, first, second = _outer(code, u)
            stack[top, 0] = h
            if du == 0.0 and ddu == 0.0:
                continue
            stack[top, 1] = first * du
            stack[top, 2] = second * du * du + first * ddu if du != 0.0 else first * ddu
            continue
        v, dv, ddv = stack[top, 0], stack[top, 1], stack[top, 2]
        top -= 1
        u, du, ddu = stack[top, 0], stack[top, 1], stack[top, 2]
        if code == _ADD:
            stack[top, 0] = u + v
            stack[top, 1] = du + dv
            stack[top, 2] = ddu + ddv
        elif code == _SUBTRACT:
            stack[top, 0] = u - v
            stack[top, 1] = du - dv
            stack[top, 2] = ddu - ddv
        elif code == _MULTIPLY:
            stack[top, 0] = u * v
            stack[top, 1] = du * v + u * dv
            stack[top, 2] = ddu * v + 2.0 * du * dv + u * ddv
        elif code == _DIVIDE:
            h = u / v
            dh = (du - h * dv) / v
            stack[top, 0] = h
            stack[top, 1] = dh
            stack[top, 2] = (ddu - 2.0 * dh * dv - h * ddv) / v
        elif code == _POWER:
            stack[top, 0], stack[top, 1], stack[top, 2] = _power(u, du, ddu, v, dv, ddv)
        elif code == _ATAN2:
            square = u * u + v * v
            turn = v * du - u * dv
            stack[top, 0] = math.atan2(u, v)
            stack[top, 1] = turn / square
            stack[top, 2] = (v * ddu - u * ddv) / square - 2.0 * (turn / square) * ((u * du + v * dv) / square)
        else:
            # _MINIMUM, _MAXIMUM: the one that is ahead just after now
            ahead = _later_sign(v - u, dv - du, ddv - ddu)
            if math.isnan(ahead) or (ahead > 0.0) == (code == _MAXIMUM):
                stack[top, 0] = v if not math.isnan(u) else u
                stack[top, 1] = dv
                stack[top, 2] = ddv
    out[0] = stack[0, 0]
    out[1] = stack[0, 1]
    out[2] = stack[0, 2]
    return math.isfinite(out[0]) and math.isfinite(out[1]) and math.isfinite(out[2])


@kernel
def _evaluate_many(codes: NDArray[np.int64], values: Array, times: Array, out: Array) -> None:
    for i in range(times.size):
        evaluate(codes, values, times[i], out[i])


def program(function: TimeFunction) -> tuple[NDArray[np.int64], Array]:
    """The codes (n,) and values (n,) of a function as the arrays that `evaluate` wants."""
    return np.array(function.codes, dtype=np.int64), np.array(function.values, dtype=np.float64)


def sample(function: TimeFunction, times: ArrayLike) -> Array:
    """Value and first two derivatives at many times (s): (n, 3).

    Raises ModelError with the first time at which the function or a derivative of it is not finite.
    """
    at = np.ascontiguousarray(np.atleast_1d(np.asarray(times, dtype=np.float64)))
    out = np.empty((at.size, 3))
    _evaluate_many(*program(function), at, out)
    finite = np.isfinite(out)
    if not finite.all():
        row = int(np.argmin(finite.all(axis=1)))
        what = ("value", "first derivative", "second derivative")[int(np.argmin(finite[row]))]
        raise ModelError(
            f"the {what} of '{function.text}' is not finite at t = {at[row]:.6g} s",
            remedy="keep the expression inside the domain of its functions over the whole run",
        )
    return out

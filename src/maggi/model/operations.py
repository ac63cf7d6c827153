"""The operations of compiled expressions (postfix programs), and their evaluation on numpy arrays.

A program is two sequences of equal length: operation codes, and for `CONSTANT` the number, for `VARIABLE`
the variable's place. It runs on a stack: operands push, operations take their arguments from the top.
`linalg.jets` runs the same programs with two time derivatives, compiled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAX_STACK = 32
"""The deepest stack a program may need; the compiler refuses deeper ones, so evaluators need no check."""


class Operation(IntEnum):
    """Codes of a postfix program. The numbers are part of no file format and may change."""

    CONSTANT = 0
    VARIABLE = 1
    ADD = 2
    SUBTRACT = 3
    MULTIPLY = 4
    DIVIDE = 5
    POWER = 6
    NEGATE = 7
    MINIMUM = 8
    MAXIMUM = 9
    ATAN2 = 10
    SIN = 11
    COS = 12
    TAN = 13
    ASIN = 14
    ACOS = 15
    EXP = 16
    LOG = 17
    SQRT = 18
    ABS = 19
    SMOOTHSTEP = 20


BINARY = frozenset(
    {
        Operation.ADD,
        Operation.SUBTRACT,
        Operation.MULTIPLY,
        Operation.DIVIDE,
        Operation.POWER,
        Operation.MINIMUM,
        Operation.MAXIMUM,
        Operation.ATAN2,
    }
)


def smoothstep(s: Any) -> Any:
    """The quintic ``6s⁵ − 15s⁴ + 10s³`` between 0 and 1, held outside: the lowest polynomial step that is C²."""
    s = np.clip(s, 0.0, 1.0)
    return s * s * s * (s * (s * 6.0 - 15.0) + 10.0)


ON_ARRAYS: dict[Operation, Callable[..., Any]] = {
    Operation.ADD: np.add,
    Operation.SUBTRACT: np.subtract,
    Operation.MULTIPLY: np.multiply,
    Operation.DIVIDE: np.divide,
    Operation.POWER: np.power,
    Operation.NEGATE: np.negative,
    Operation.MINIMUM: np.minimum,
    Operation.MAXIMUM: np.maximum,
    Operation.ATAN2: np.arctan2,
    Operation.SIN: np.sin,
    Operation.COS: np.cos,
    Operation.TAN: np.tan,
    Operation.ASIN: np.arcsin,
    Operation.ACOS: np.arccos,
    Operation.EXP: np.exp,
    Operation.LOG: np.log,
    Operation.SQRT: np.sqrt,
    Operation.ABS: np.abs,
    Operation.SMOOTHSTEP: smoothstep,
}


def evaluate(codes: Sequence[int], values: Sequence[float], variables: Sequence[Array]) -> Array:
    """Value of a program at many points.

    variables : one array (p,) per variable, all of one shape. Returns (p,). Points outside a function's
    domain give NaN or infinity without a warning: whoever asks must look.
    """
    stack: list[Array] = []
    with np.errstate(all="ignore"):
        for code, value in zip(codes, values, strict=True):
            if code == Operation.CONSTANT:
                stack.append(np.full_like(variables[0], value))
            elif code == Operation.VARIABLE:
                stack.append(variables[int(value)])
            elif code in BINARY:
                right = stack.pop()
                stack[-1] = ON_ARRAYS[Operation(code)](stack[-1], right)
            else:
                stack[-1] = ON_ARRAYS[Operation(code)](stack[-1])
    (result,) = stack
    return result

"""Formulas that are linear in some of their variables, taken apart: coefficients and the rest."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

from .errors import ModelError
from .functions import Formula
from .operations import BINARY, Operation

Code = tuple[tuple[int, float], ...]

ONE: Code = ((Operation.CONSTANT, 1.0),)


@dataclass(frozen=True)
class _Part:
    """A value on the stack, Σ by[place] · variable + rest, all as programs; None: no rest."""

    rest: Code | None = None
    by: dict[int, Code] = field(default_factory=dict)


def linear_parts(formula: Formula, names: Collection[str]) -> tuple[dict[str, Formula], Formula | None]:
    """The coefficients of `names` in a formula that is linear in them, and what stands without them (None: nothing).

    The parts are formulas in the formula's other variables. A name that does not occur has no coefficient.

    Example: ``v*cos(a) - 2*w + a`` in v, w gives ``{v: cos(a), w: -2}, a``.
    Raises ModelError if a name stands in a product with another, in a denominator or inside a function.
    """
    others = tuple(name for name in formula.variables if name not in names)
    place = {formula.variables.index(name): k for k, name in enumerate(others)}
    stack: list[_Part] = []
    for code, value in zip(formula.codes, formula.values, strict=True):
        if code == Operation.VARIABLE and int(value) not in place:
            stack.append(_Part(by={int(value): ONE}))
        elif code == Operation.VARIABLE:
            stack.append(_Part(((code, float(place[int(value)])),)))
        elif code == Operation.CONSTANT:
            stack.append(_Part(((code, value),)))
        else:
            count = 2 if code in BINARY else 1
            parts, stack = stack[-count:], stack[:-count]
            stack.append(_apply(formula, Operation(code), *parts))
    (whole,) = stack

    def part(code: Code, what: str) -> Formula:
        text = f"{what} in '{formula.text}'"
        return Formula(text, others, tuple(int(c) for c, _ in code), tuple(v for _, v in code))

    coefficients = {
        formula.variables[k]: part(code, f"coefficient of {formula.variables[k]}") for k, code in whole.by.items()
    }
    return coefficients, None if whole.rest is None else part(whole.rest, "the constant part")


def _apply(formula: Formula, operation: Operation, *parts: _Part) -> _Part:
    if operation in (Operation.ADD, Operation.SUBTRACT):
        left, right = parts
        places = [*left.by, *(k for k in right.by if k not in left.by)]
        by = {k: _sum(operation, left.by.get(k), right.by.get(k)) for k in places}
        rest = None if left.rest is right.rest is None else _sum(operation, left.rest, right.rest)
        return _Part(rest, by)
    if operation is Operation.NEGATE:
        (only,) = parts
        return _Part(only.rest and _negative(only.rest), {k: _negative(code) for k, code in only.by.items()})
    if not any(part.by for part in parts):
        return _Part((*(step for part in parts for step in part.rest or ()), (operation, 0.0)))
    if operation is Operation.MULTIPLY and not all(part.by for part in parts):
        left, right = parts
        if right.by:
            assert left.rest is not None  # a value without the names has nothing but a rest
            factor = left.rest
            return _Part(
                right.rest and _product(factor, right.rest), {k: _product(factor, c) for k, c in right.by.items()}
            )
    if operation in (Operation.MULTIPLY, Operation.DIVIDE) and not parts[1].by:
        left, right = parts
        assert right.rest is not None
        scaled = {k: _scaled(operation, code, right.rest) for k, code in left.by.items()}
        return _Part(left.rest and _scaled(operation, left.rest, right.rest), scaled)
    name = formula.variables[next(k for part in parts for k in part.by)]
    raise ModelError(
        f"'{formula.text}' is not linear in {name}",
        remedy="a speed may be multiplied by factors without speeds and added, nothing else",
    )


def _sum(operation: Operation, left: Code | None, right: Code | None) -> Code:
    if right is None:
        assert left is not None
        return left
    if left is None:
        return right if operation is Operation.ADD else _negative(right)
    return (*left, *right, (operation, 0.0))


def _negative(code: Code) -> Code:
    ((first, value), *more) = code
    return ((first, -value),) if not more and first == Operation.CONSTANT else (*code, (Operation.NEGATE, 0.0))


def _product(factor: Code, code: Code) -> Code:
    return factor if code == ONE else (*factor, *code, (Operation.MULTIPLY, 0.0))


def _scaled(operation: Operation, code: Code, by: Code) -> Code:
    if code == ONE and operation is Operation.MULTIPLY:
        return by
    return (*code, *by, (operation, 0.0))

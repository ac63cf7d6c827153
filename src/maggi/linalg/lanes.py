"""Four numbers at once in compiled code, as instructions of the processor take them.

LLVM groups the turns of a loop over arrays by itself, but not what is done with a matrix block, whose places are
scattered. A product of two fours and its sum with a third may be contracted, as in passes.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable

from .shared import inner_pass

WIDTH = 4
_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_PLACE = ir.IntType(32)


class FourType(types.Type):
    """Four numbers."""

    def __init__(self) -> None:
        super().__init__("Four")


FOUR = FourType()


@register_model(FourType)
class _FourModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)  # type: ignore[no-untyped-call]


def _same(builder: Any, number: Any) -> Any:
    """Four times a number."""
    undefined = ir.Constant(_VECTOR, ir.Undefined)
    first = builder.insert_element(undefined, number, ir.Constant(_PLACE, 0))
    return builder.shuffle_vector(first, undefined, ir.Constant(ir.VectorType(_PLACE, WIDTH), [0] * WIDTH))


def _place(context: Any, builder: Any, kind: Any, array: Any, place: Any) -> Any:
    """The address of four numbers of an array."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [place]), _VECTOR.as_pointer())


def _of(typing_context: Any, number: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return _same(builder, given[0])

    return FOUR(types.float64), code


def _read(typing_context: Any, array: Any, place: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        found = builder.load(_place(context, builder, signature.args[0], *given))
        found.align = 8
        return found

    return FOUR(array, types.intp), code


def _write(typing_context: Any, array: Any, place: Any, value: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        stored = builder.store(given[2], _place(context, builder, signature.args[0], *given[:2]))
        stored.align = 8
        return context.get_dummy_value()

    return types.void(array, types.intp, FOUR), code


def _number(typing_context: Any, value: Any, k: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.extract_element(given[0], builder.trunc(given[1], _PLACE))

    return types.float64(FOUR, types.intp), code


def _farther(typing_context: Any, far: Any, value: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        far, value = given
        opposite = builder.fneg(value)
        size = builder.select(builder.fcmp_ordered(">", value, opposite), value, opposite)
        return builder.select(builder.fcmp_ordered(">", far, size), far, size)

    return FOUR(FOUR, FOUR), code


def _operation(operation: Callable[..., Any], name: str) -> None:
    """Of two fours, or of a number and four."""

    @type_callable(operation)
    def kinds(context: Any) -> Any:
        def typer(left: Any, right: Any) -> Any:
            return FOUR if right == FOUR and left in (FOUR, types.float64) else None

        return typer

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        left = given[0] if signature.args[0] == FOUR else _same(builder, given[0])
        return getattr(builder, name)(left, given[1], flags=("contract",))

    for left in (FOUR, types.float64):
        lower_builtin(operation, left, FOUR)(code)  # type: ignore[no-untyped-call]


_operation(operator.add, "fadd")
_operation(operator.iadd, "fadd")
_operation(operator.mul, "fmul")

four: Any = intrinsic(_of)
"""``four(x)``: x four times."""
four_at: Any = intrinsic(_read)
"""``four_at(array, place)``: the numbers of a C-contiguous array from a place on, counted as if it had one dimension."""
put_four: Any = intrinsic(_write)
"""``put_four(array, place, numbers)``: to there."""
number: Any = intrinsic(_number)
"""``number(numbers, k)``: one of them."""
farther: Any = intrinsic(_farther)
"""``farther(far, numbers)``: the larger of far and |numbers|, each of four."""


@inner_pass
def sum_of(numbers):  # type: ignore[no-untyped-def]
    """The sum of four numbers."""
    return (number(numbers, 0) + number(numbers, 1)) + (number(numbers, 2) + number(numbers, 3))


@inner_pass
def three_fours(fields, n):  # type: ignore[no-untyped-def]
    """At a node, of four fields (n, 3, 4)."""
    place = 3 * WIDTH * np.int64(n)
    return four_at(fields, place), four_at(fields, place + WIDTH), four_at(fields, place + 2 * WIDTH)

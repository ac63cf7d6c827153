"""Numbers in memory that several threads read and change, each access complete and in one order for all; calls by address."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from .links import POINTER

_NUMBER, _SHORT, _NOTHING = ir.IntType(64), ir.IntType(32), ir.VoidType()


def _at(builder: Any, address: Any) -> Any:
    return builder.inttoptr(address, _NUMBER.as_pointer())


def _typed(signature: Any, generate: Callable[[Any, Any], Any]) -> tuple[Any, Any]:
    """What an intrinsic returns: its types, and its code, generate(builder, values)."""

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        found = generate(builder, values)
        return context.get_dummy_value() if signature.return_type == types.void else found

    return signature, code


def _load(typing_context: Any, address: Any) -> Any:
    return _typed(
        types.int64(types.int64), lambda builder, given: builder.load_atomic(_at(builder, given[0]), "seq_cst", 8)
    )


def _store(typing_context: Any, address: Any, value: Any) -> Any:
    return _typed(
        types.void(types.int64, types.int64),
        lambda builder, given: builder.store_atomic(given[1], _at(builder, given[0]), "seq_cst", 8),
    )


def _add(typing_context: Any, address: Any, value: Any) -> Any:
    return _changed("add")


def _exchange(typing_context: Any, address: Any, value: Any) -> Any:
    return _changed("xchg")


def _changed(operation: str) -> Any:
    return _typed(
        types.int64(types.int64, types.int64),
        lambda builder, given: builder.atomic_rmw(operation, _at(builder, given[0]), given[1], "seq_cst"),
    )


def _called(result: Any, *kinds: Any) -> Any:
    """The call of a function (first of the values) of such arguments, addresses for pointers; what it returns is not used."""

    def generate(builder: Any, given: Any) -> Any:
        entry = builder.inttoptr(given[0], ir.FunctionType(result, kinds).as_pointer())
        pairs = zip(kinds, given[1:], strict=True)
        builder.call(entry, [_converted(builder, kind, value) for kind, value in pairs])

    return _typed(types.void(*(1 + len(kinds)) * [types.int64]), generate)


def _converted(builder: Any, kind: Any, value: Any) -> Any:
    if kind == POINTER:
        return builder.inttoptr(value, POINTER)
    return builder.trunc(value, kind) if kind == _SHORT else value


def _call_part(typing_context: Any, kernel: Any, table: Any, part: Any, parts: Any) -> Any:
    return _called(POINTER, POINTER, _NUMBER, _NUMBER)


def _call_acquire(typing_context: Any, function: Any, lock: Any, wait: Any) -> Any:
    return _called(_SHORT, POINTER, _SHORT)


def _call_release(typing_context: Any, function: Any, lock: Any) -> Any:
    return _called(_NOTHING, POINTER)


def _call_yield(typing_context: Any, function: Any) -> Any:
    return _called(_SHORT)


load: Any = intrinsic(_load)
"""``load(address)``: the number there."""
store: Any = intrinsic(_store)
"""``store(address, number)``."""
add: Any = intrinsic(_add)
"""``add(address, number)``: what was there before."""
exchange: Any = intrinsic(_exchange)
"""``exchange(address, number)``: what was there before."""
call_part: Any = intrinsic(_call_part)
"""``call_part(kernel, table, part, parts)``."""
call_acquire: Any = intrinsic(_call_acquire)
"""``call_acquire(PyThread_acquire_lock, lock, wait)``."""
call_release: Any = intrinsic(_call_release)
"""``call_release(PyThread_release_lock, lock)``."""
call_yield: Any = intrinsic(_call_yield)
"""``call_yield(sched_yield)``."""

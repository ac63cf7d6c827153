"""Passes of every step that numba's threads share.

A parallel loop of numba's (`prange`) would do the same; but it takes twice as long to compile as what is in it, and costs
some microseconds an array at every call. Here one generalised function of numpy's, compiled once for numba's threads, calls
any kernel by its address, as `links` do.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, ParamSpec, TypeVar

import numpy as np
from llvmlite import ir
from numba import guvectorize, njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from . import compiling as compiling  # for its effect
from .links import POINTER
from .table import Table, TableType, numba_type

_njit: Any = njit  # its types leave out the entries that it can do without
_guvectorize: Any = guvectorize
P = ParamSpec("P")
R = TypeVar("R")
_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}, "no_cpython_wrapper": True}


def inner_pass(function: Callable[P, R]) -> Callable[P, R]:
    """What kernels of passes are made of: products and sums may be contracted there too; only compiled functions call it."""
    compiled: Callable[P, R] = _njit(no_cfunc_wrapper=True, **_OPTIONS)(function)
    return compiled


class SharedPass:
    """A kernel ``f(table, part, parts)`` for every part of some; call it with a table, and how many parts there are.

    What it writes for one part must not depend on the others; then nothing depends on the number of threads. Products and
    sums may be contracted. Loops over an array from somewhere in its middle numba does not vectorise, for it
    looks for negative places; over a slice it does.
    """

    def __init__(self, function: Callable[..., None]) -> None:
        """Of a function to be compiled."""
        self.kernel: Any = _njit(**_OPTIONS)(function)
        self.__doc__ = function.__doc__
        self._addresses: dict[TableType, int] = {}

    def __call__(self, table: Table, parts: int) -> None:
        """Do all parts; they are `parts` in number."""
        kind = numba_type(table)
        address = self._addresses.get(kind)
        if address is None:
            address = self._addresses[kind] = self._address(kind)
        numbers, done = _numbers(parts)
        with np.errstate(all="ignore"):  # what is not finite is looked for where it is known what it means
            _run()(numbers, parts, address, table.__dict__["_address"], done)

    def _address(self, kind: TableType) -> int:
        signature = (kind, types.int64, types.int64)
        self.kernel.compile(signature)
        compiled = self.kernel.overloads[signature]
        return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name))


@cache
def _numbers(parts: int) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
    return np.arange(parts), np.zeros(parts, np.int8)


@cache
def _run() -> Callable[..., object]:
    """``run(part, parts, kernel's address, table's address, done)``; `done` is there since there has to be a result."""
    signature = types.void(types.int64, types.int64, types.int64, types.int64, types.int8[::1])
    compiled: Callable[..., object] = _guvectorize([signature], "(),(),(),()->()", target="parallel", cache=True)(_call)
    return compiled


def _call(part: int, parts: int, kernel: int, table: int, done: NDArray[np.int8]) -> None:
    _call_part(kernel, table, part, parts)


def _calling(typing_context: Any, kernel: Any, table: Any, part: Any, parts: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        function = ir.FunctionType(POINTER, [POINTER, ir.IntType(64), ir.IntType(64)])
        entry, directory = builder.inttoptr(values[0], function.as_pointer()), builder.inttoptr(values[1], POINTER)
        builder.call(entry, [directory, *values[2:]])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.int64, types.int64), generate


_call_part: Any = intrinsic(_calling)

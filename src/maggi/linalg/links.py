"""Compiled functions that call each other by address.

numba puts the code of every callee into its caller and optimises it there again: a kernel at the top of a tall pile costs as
much to compile as everything below it, and all of it again at every level. A `Link` is compiled by itself and called through
its address, so that each is compiled once, at the same time as others if need be, and not at all where no model asks for it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.core.dispatcher import Dispatcher
from numba.extending import intrinsic

from . import compiling as compiling  # for its effect
from .table import Table, TableType, numba_type

POINTER = ir.IntType(8).as_pointer()


class Link:
    """A kernel of tables, then one float, that returns nothing: ``f(first, second, …, t)``.

    Call it like any compiled function, or from compiled code by `call` with its `address`.
    """

    def __init__(self, function: Callable[..., None]) -> None:
        """Of a function to be compiled, or one that already is."""
        compiled = isinstance(function, Dispatcher)
        self.kernel: Any = function if compiled else njit(cache=True, error_model="numpy")(function)
        self.__doc__ = function.__doc__

    def __call__(self, *arguments: Any) -> None:
        """From Python."""
        self.kernel(*arguments)

    def address(self, *tables: Table) -> int:
        """Where the kernel for tables of these types is, compiled if it has not been before."""
        signature = (*(numba_type(table) for table in tables), types.float64)
        self.kernel.compile(signature)
        compiled: Any = self.kernel.overloads[signature]
        address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)
        if not address:
            raise TypeError(f"{self.kernel.__name__} was compiled without an entry for calls by address")
        return int(address)


def _calling(typing_context: Any, address: Any, *arguments: Any) -> Any:
    """The call of ``f(table, …, double)`` at an address."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kinds = [POINTER if isinstance(kind, TableType) else ir.DoubleType() for kind in signature.args[1:]]
        function = ir.FunctionType(POINTER, kinds)
        builder.call(builder.inttoptr(values[0], function.as_pointer()), values[1:])
        return context.get_dummy_value()

    return types.void(types.int64, *arguments), generate


def _call3(typing_context: Any, address: Any, a: Any, b: Any, c: Any, t: Any) -> Any:
    return _calling(typing_context, address, a, b, c, t)


def _call4(typing_context: Any, address: Any, a: Any, b: Any, c: Any, d: Any, t: Any) -> Any:
    return _calling(typing_context, address, a, b, c, d, t)


def _call5(typing_context: Any, address: Any, a: Any, b: Any, c: Any, d: Any, e: Any, t: Any) -> Any:
    return _calling(typing_context, address, a, b, c, d, e, t)


call3: Any = intrinsic(_call3)
"""``call3(address, first, second, third, t)``: a link of three tables."""
call4: Any = intrinsic(_call4)
"""The same of four tables."""
call5: Any = intrinsic(_call5)
"""The same of five tables."""

"""Passes of every step that threads share, as many as numba's.

A parallel loop of numba's (`prange`) would do the same; but it takes twice as long to compile as what is in it, and costs
some microseconds an array at every call. Here a team of threads calls any kernel by its address, as `links` do.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from numba import get_num_threads, njit, types

from . import compiling as compiling  # for its effect
from .table import Table, TableType, numba_type
from .team import Crew, share, team

_njit: Any = njit  # its types leave out the entries that it can do without
P = ParamSpec("P")
R = TypeVar("R")
_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}, "no_cpython_wrapper": True}


def inner_pass(function: Callable[P, R]) -> Callable[P, R]:
    """What kernels of passes are made of: products and sums may be contracted there too; only compiled functions call it."""
    compiled: Callable[P, R] = _njit(no_cfunc_wrapper=True, **_OPTIONS)(function)
    return compiled


def crew() -> Crew:
    """The threads that share passes now, as many as numba's."""
    threads = int(get_num_threads())
    return team(threads).crew(threads)


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
        share(crew(), self.entry(table), table.__dict__["_address"], parts)

    def entry(self, table: Table) -> int:
        """The kernel's address for tables such as this one, for compiled code that calls ``share(crew, entry, address(table), parts)``."""
        kind = numba_type(table)
        address = self._addresses.get(kind)
        if address is None:
            address = self._addresses[kind] = self._address(kind)
        return address

    def _address(self, kind: TableType) -> int:
        signature = (kind, types.int64, types.int64)
        self.kernel.compile(signature)
        compiled = self.kernel.overloads[signature]
        return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name))

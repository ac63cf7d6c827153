"""How kernels are compiled, and what makes numba quicker at it."""

from __future__ import annotations

import gc
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from numba import njit
from numba.core import event

_njit: Any = njit  # its types leave out the entries that it can do without
P = ParamSpec("P")
R = TypeVar("R")


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """A compiled function: kept on disk, divisions as numpy's, and no entry for callers in C, which takes an eighth of the time."""
    compiled: Callable[P, R] = _njit(cache=True, error_model="numpy", no_cfunc_wrapper=True)(function)
    return compiled


def part_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """One for `threads.in_parts`, which runs without Python's lock."""
    compiled: Callable[P, R] = _njit(cache=True, error_model="numpy", no_cfunc_wrapper=True, nogil=True)(function)
    return compiled


def inner_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """One that only compiled functions call: without an entry for Python either, which takes a twelfth."""
    options = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True}
    compiled: Callable[P, R] = _njit(cache=True, error_model="numpy", **options)(function)
    return compiled


class _Uncollected(event.Listener):
    """Keeps Python's garbage collector out of compilations: it would walk all of numba's trees again and again."""

    def __init__(self) -> None:
        self._depth = 0
        self._collected = False

    def on_start(self, event: event.Event) -> None:
        if self._depth == 0:
            self._collected = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: event.Event) -> None:
        self._depth -= 1
        if self._depth == 0 and self._collected:
            gc.enable()


event.register("numba:compile", _Uncollected())  # type: ignore[no-untyped-call]

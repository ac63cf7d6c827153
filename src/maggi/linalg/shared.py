"""Passes of every step that numba's threads share: generalised functions of numpy's, which numba compiles for them.

A parallel loop of numba's (`prange`) would do the same, and takes two to four times as long to compile.
"""

from __future__ import annotations

import string
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numba import guvectorize, types
from numpy.typing import NDArray

from . import compiling as compiling  # for its effect

_guvectorize: Any = guvectorize  # which has no types
Numbers = NDArray[np.int64]
Kind = (
    tuple[str, int, bool] | type
)  # of an array: dtype's character, dimensions, whether C-contiguous; of a number: its type


class SharedPass:
    """``kernel(part, parts, *arguments, done)`` for every part of some, compiled when first called and kept on disk.

    Call it with the number of parts and the arguments: C-contiguous arrays, and numbers. What the kernel writes for one
    part must not depend on the others; then nothing depends on the number of threads. It leaves `done` alone: generalised
    functions have a result.

        @SharedPass
        def double(part, parts, x, done):
            for i in range(x.size * part // parts, x.size * (part + 1) // parts):
                x[i] *= 2.0

        double(4, x)

    Loops over an array from somewhere in its middle numba does not vectorise, for it looks for negative places; over a
    slice it does.
    """

    def __init__(self, kernel: Callable[..., None]) -> None:
        self.__doc__ = kernel.__doc__
        self._kernel = kernel
        self._compiled: dict[tuple[Kind, ...], Callable[..., object]] = {}
        self._numbers: dict[int, tuple[Numbers, NDArray[np.int8]]] = {}

    def __call__(self, parts: int, *arguments: Any) -> None:
        """Raises ValueError for an array that is not C-contiguous: kernels take it for one."""
        found = self._numbers.get(parts)
        if found is None:
            found = self._numbers[parts] = np.arange(parts), np.zeros(parts, np.int8)
        # Arrays of just these kinds numpy hands on as they are. Of others it would make copies, and writing be lost.
        kinds = tuple(
            [(a.dtype.char, a.ndim, a.flags.c_contiguous) if type(a) is np.ndarray else type(a) for a in arguments]
        )
        run = self._compiled.get(kinds)
        if run is None:
            run = self._compiled[kinds] = self._compile(kinds)
        numbers, done = found
        run(numbers, parts, *arguments, done)

    def _compile(self, kinds: tuple[Kind, ...]) -> Callable[..., object]:
        names = iter(string.ascii_letters)
        signature: list[Any] = [types.int64, types.int64]
        shapes = ["()", "()"]
        for place, kind in enumerate(kinds):
            if isinstance(kind, type):
                signature.append(numba.from_dtype(np.dtype(kind)))
                shapes.append("()")
                continue
            character, ndim, contiguous = kind
            if not contiguous:
                raise ValueError(f"argument {place} of the pass {self._kernel.__name__} is not C-contiguous")
            signature.append(types.Array(numba.from_dtype(np.dtype(character)), ndim, "C"))
            shapes.append("(" + ",".join(next(names) for _ in range(ndim)) + ")")
        signature.append(types.Array(types.int8, 1, "C"))
        layout = ",".join(shapes) + "->()"
        decorate = _guvectorize([types.void(*signature)], layout, target="parallel", cache=True)
        compiled: Callable[..., object] = decorate(self._kernel)
        return compiled

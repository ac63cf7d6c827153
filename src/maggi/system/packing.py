"""Growing lists that become the tables of the kernels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from maggi.model.functions import Formula, TimeFunction

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class FunctionList:
    """Functions, concatenated to postfix arrays."""

    def __init__(self) -> None:
        self._start = [0]
        self._codes: list[int] = []
        self._values: list[float] = []

    def add(self, function: TimeFunction | Formula) -> int:
        """Append a function and return its number."""
        self._codes += function.codes
        self._values += function.values
        self._start.append(len(self._codes))
        return len(self._start) - 2

    def tables(self) -> tuple[IntArray, IntArray, Array]:
        """start, codes, values."""
        return (
            np.array(self._start, dtype=np.int64),
            np.array(self._codes, dtype=np.int64),
            np.array(self._values, dtype=np.float64),
        )


def integers(values: Sequence[object], shape: tuple[int, ...] = (-1,)) -> IntArray:
    """An int64 array of the given shape, also where there are no values."""
    return np.ascontiguousarray(np.array(values, dtype=np.int64).reshape(shape))


def numbers(values: Sequence[object], shape: tuple[int, ...] = (-1,)) -> Array:
    """A float64 array of the given shape, also where there are no values."""
    return np.ascontiguousarray(np.array(values, dtype=np.float64).reshape(shape))


def flat(parts: Sequence[Array]) -> Array:
    """All parts, raveled, one after the other."""
    return np.concatenate([np.empty(0), *(np.asarray(part, dtype=np.float64).ravel() for part in parts)])

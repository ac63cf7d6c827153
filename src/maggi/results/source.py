"""Where results lie, and tables read from there piece by piece."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Protocol, overload

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Table(Protocol):
    """What a store gives for a table: numpy's or h5py's own object."""

    @property
    def shape(self) -> tuple[int, ...]: ...

    def __getitem__(self, key: Any, /) -> Any: ...


class Source(Protocol):
    """Where results lie; paths as in `results.contract`."""

    name: str
    rows: int

    def attributes(self, path: str) -> Mapping[str, Any]:
        """Attributes of a group; the empty path is the whole."""

    def children(self, path: str) -> tuple[str, ...]:
        """Names in a group, in the order of the model; empty if there is no such group."""

    def table(self, path: str) -> Table | None:
        """A table, or None if it was not kept."""

    def close(self) -> None: ...


class Frames:
    """A time-dependent table read piece by piece: ``frames[k]``, ``frames[a:b:c]``, ``np.asarray(frames)``.

    Every index gives a numpy array; `shape` is (n, ...), n the number of complete rows.
    """

    def __init__(self, table: Table, rows: int) -> None:
        self._table = table
        self.shape = (rows, *table.shape[1:])

    def __len__(self) -> int:
        return self.shape[0]

    @overload
    def __getitem__(self, key: int) -> Array: ...
    @overload
    def __getitem__(self, key: slice) -> Array: ...
    def __getitem__(self, key: int | slice) -> Array:
        places = range(len(self))[key]
        if isinstance(places, int):
            return np.asarray(self._table[places])
        if places.step < 0:  # h5py reads forwards only
            return self[places[-1] : places[0] + 1 : -places.step][::-1] if places else self[0:0]
        return np.asarray(self._table[places.start : places.stop : places.step])

    def __iter__(self) -> Iterator[Array]:
        return (self[k] for k in range(len(self)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.asarray(self[:], dtype=dtype)

"""A table of a result file that rows are appended to."""

from __future__ import annotations

from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray


class GrowingTable:
    """Appends by the library's lower interface: the upper one takes several times as long, and a large mechanism has hundreds of tables."""

    def __init__(self, table: Any) -> None:
        """table : a dataset that may grow along its first axis."""
        self.name: str = table.name
        self._id = table.id
        self._dtype = table.dtype
        self._shape: tuple[int, ...] = table.shape[1:]
        self._chunk = int(table.chunks[0])
        self._chunk_bytes = 8 * int(np.prod(table.chunks, dtype=np.int64)) + 512  # and its place in the index

    def growth(self, rows: int, until: int) -> int:
        """Bytes by which the file grows when the table of so many rows gets more."""
        return (-(-until // self._chunk) - -(-rows // self._chunk)) * self._chunk_bytes

    def append(self, rows: int, values: NDArray[Any]) -> None:
        """Put values (m, …) behind the first `rows` rows, m ≥ 1. Raises OSError or RuntimeError, as the library does."""
        values = np.ascontiguousarray(values, dtype=self._dtype)
        self._id.set_extent((rows + len(values), *self._shape))
        place = self._id.get_space()
        place.select_hyperslab((rows, *(0 for _ in self._shape)), values.shape)
        self._id.write(h5py.h5s.create_simple(values.shape), place, values)

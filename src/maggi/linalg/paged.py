"""Large arrays in temporary files that are mapped: memory that the system may take back while something else needs it.

What a body keeps for its products is not read while its factor is made, which is when most memory is needed. In such an
array it may leave: its pages stay in the file, or in what the system keeps of it as long as there is room.
"""

from __future__ import annotations

import mmap
import os
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

SMALL = 2 << 20  # bytes below which ordinary memory does
MOMENT = 0.05  # seconds; reading again what has been let go too early costs milliseconds


def empty(shape: tuple[int, ...], dtype: DTypeLike = np.float64) -> NDArray[Any]:
    """An array, not initialised: in a file if it is large and a file of its size can be had, and else in ordinary memory."""
    kind = np.dtype(dtype)
    size = int(np.prod(shape, dtype=np.int64)) * kind.itemsize
    pages = _pages(size) if size >= SMALL else None
    return np.empty(shape, kind) if pages is None else np.frombuffer(pages, kind).reshape(shape)


def moved(array: NDArray[Any]) -> NDArray[Any]:
    """The values of an array in one that `empty` gives; small ones stay where they are."""
    if array.nbytes < SMALL:
        return array
    new = empty(array.shape, array.dtype)
    new[...] = array
    return new


def release(*arrays: NDArray[Any]) -> None:
    """Let the system take back the memory of those that lie in files. They keep their values, and are there when next used."""
    for array in arrays:
        base: Any = array
        while isinstance(base, np.ndarray | memoryview):
            base = base.base if isinstance(base, np.ndarray) else base.obj
        if isinstance(base, mmap.mmap):
            base.madvise(mmap.MADV_DONTNEED)  # of a shared mapping: the file keeps what was written


@contextmanager
def read_at_first(array: NDArray[Any]) -> Iterator[None]:
    """Around something long that reads an array in its first moments only: its memory is let go meanwhile."""
    timer = threading.Timer(MOMENT, release, (array,))
    timer.daemon = True
    if array.nbytes >= SMALL:
        timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _pages(size: int) -> mmap.mmap | None:
    """A mapping of a new file without a name, or None: no room, nowhere to write, or a system that lacks one of the means."""
    try:
        with tempfile.TemporaryFile(prefix="maggi-") as file:
            os.posix_fallocate(file.fileno(), 0, size)  # a file with holes would fail when it is written to, too late
            return mmap.mmap(file.fileno(), size, mmap.MAP_SHARED)
    except (OSError, AttributeError, ValueError):
        return None

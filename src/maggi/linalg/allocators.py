"""What allocators keep of freed memory: settings of rslab's, to be made before it is loaded, and libc's on demand."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from typing import cast

# rslab's keeps what it has freed for a second, a sixth of a factor on top of it, and takes in advance what it may not need;
# a solve asks again at once for what the last one freed, though. In milliseconds; read when it is loaded.
os.environ.setdefault("MIMALLOC_PURGE_DELAY", "1")
os.environ.setdefault("MIMALLOC_ARENA_EAGER_COMMIT", "0")


def _found() -> Callable[[int], int] | None:
    """glibc's malloc_trim."""
    try:
        return cast(Callable[[int], int], ctypes.CDLL("libc.so.6").malloc_trim)
    except (OSError, AttributeError):  # another system, another libc
        return None


_trim = _found()


def give_back() -> None:
    """Give free memory between arrays in use back to the system, where libc is glibc: before much is needed elsewhere.

    What assembling a mesh leaves is some 5 % of its factor. Takes milliseconds.
    """
    if _trim is not None:
        _trim(0)

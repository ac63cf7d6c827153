"""Threads: set-up work shared among them, and none for dense products.

numba's own parallel loops cost seconds to compile, each, and passes of every step have a way of theirs (`shared`). A kernel that runs once or a
few times is compiled for one part of the work, without Python's lock, and called in as many threads as there are parts.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from typing import Any

import numba
import scipy.linalg as scipy_linalg  # brings a BLAS of its own
from threadpoolctl import threadpool_limits


def in_parts(kernel: Callable[..., None], *arguments: Any) -> None:
    """``kernel(part, parts, *arguments)`` for every part, one for each of numba's threads.

    The kernel is a `compiling.part_kernel`; what it writes must not depend on the number of parts.
    """
    parts = int(numba.get_num_threads())
    if parts == 1:
        kernel(0, 1, *arguments)
        return
    with ThreadPoolExecutor(parts) as pool:
        for done in [pool.submit(kernel, part, parts, *arguments) for part in range(parts)]:
            done.result()


def one_blas_thread() -> AbstractContextManager[object]:
    """Within it, BLAS works in one thread.

    Its sums depend on how many there are, and its threads would wait, busy, for the next small product while others have
    work to do.
    """
    assert scipy_linalg
    limits: AbstractContextManager[object] = threadpool_limits(limits=1, user_api="blas")
    return limits

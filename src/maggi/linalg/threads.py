"""Set-up work shared among threads.

numba's own parallel loops cost seconds to compile, each; they are for passes of every step. A kernel that runs once or a
few times is compiled for one part of the work, without Python's lock, and called in as many threads as there are parts.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numba


def in_parts(kernel: Callable[..., None], *arguments: Any) -> None:
    """``kernel(part, parts, *arguments)`` for every part, one for each of numba's threads.

    The kernel is compiled with ``nogil=True``; what it writes must not depend on the number of parts.
    """
    parts = int(numba.get_num_threads())
    if parts == 1:
        kernel(0, 1, *arguments)
        return
    with ThreadPoolExecutor(parts) as pool:
        for done in [pool.submit(kernel, part, parts, *arguments) for part in range(parts)]:
            done.result()

"""What makes numba compile sooner, for the whole process."""

from __future__ import annotations

import gc

from numba.core import event


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

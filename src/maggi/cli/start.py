"""Python's garbage collector, kept out of what a command begins with.

It would walk through all that is loaded, again and again, an eighth of the time of a short run; none of it is garbage.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def collector_off() -> Iterator[None]:
    """Around a command, which calls `started` where something long begins; a short one ends without the collector."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def started() -> None:
    """Everything is loaded, and what is to come may be long: the collector works from now on, on what is made from now on."""
    gc.freeze()
    gc.enable()

"""A team of threads for passes of some tens of microseconds: whoever is there takes the next part.

The loops of numba's threads end when the last thread has come, whether it has done anything or not. One that the system
lets wait, since the solve before has left its own threads running, costs half a millisecond then, as one pass in ten did. Here
nobody waits for a thread that has not begun: what it does not take the others do.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import sys
import threading
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import config
from numpy.typing import NDArray

from .atomics import add, call_acquire, call_part, call_release, call_yield, exchange, load, store
from .compiling import inner_kernel, kernel, part_kernel
from .table import Table

_settings: Any = config
MOST = 8  # threads that share a pass: it is bound by memory, and each has to be woken
# Looks at whether there is something to do before a thread goes to sleep: some 30 µs, from one pass of a step to the next.
LOOKS = 8_000
# Looks at whether others are done, before they are given the processor, if it is that which they wait for.
PATIENCE = 2_000

# Places in bytes, those that different threads write on lines of the cache of their own. Every thread has a ticket: the end of
# its parts times 2³², and the next of them. So whoever draws a part knows that the pass to which it belongs is
# still going on. It draws its own first, which are the same in every pass and may still be in its cache, then others'.
DONE, KERNEL, TABLE, PARTS, THREADS, STOPPED, TICKET, ASLEEP, LINE = 0, 64, 72, 80, 88, 96, 128, 136, 64
NEXT = 0xFFFFFFFF


@dataclass(frozen=True, eq=False)
class Crew(Table):
    """Those of a team who share passes, for compiled code: the team's place and two functions of the system (3,), and the locks of
    the threads besides the one that calls.
    """

    numbers: NDArray[np.int64]
    locks: NDArray[np.int64]


class Team:
    """Threads that wait for passes; they end with the program."""

    def __init__(self, threads: int) -> None:
        """threads : as many of them, besides the one that calls."""
        self._numbers = np.zeros((TICKET + LINE * (threads + 2)) // 8, np.int64)
        self._base = -(-self._numbers.ctypes.data // LINE) * LINE
        self._locks = np.array([_taken_lock() for _ in range(threads)], np.int64)
        self._threads = [
            threading.Thread(target=_work, args=(self._base, k, _ACQUIRE, int(lock)), daemon=True)
            for k, lock in enumerate(self._locks, start=1)
        ]
        self._crews: dict[int, Crew] = {}
        for thread in self._threads:
            thread.start()  # the first compiles what they do; until then passes go on without them

    def crew(self, threads: int) -> Crew:
        """As many threads at most as share a pass, the one that calls among them."""
        helpers = max(min(threads - 1, len(self._threads)), 0)
        found = self._crews.get(helpers)
        if found is None:
            numbers = np.array([self._base, _RELEASE, _YIELD])
            found = self._crews[helpers] = Crew(numbers, self._locks[:helpers].copy())
        return found

    def stop(self) -> None:
        """End the threads: compiled code must not run on while the program is taken down."""
        _stop(self._base, self._locks, _RELEASE)
        for thread in self._threads:
            thread.join()
        self._threads = []


_team: Team | None = None


def team(threads: int) -> Team:
    """The program's team, begun when `threads` first are more than one."""
    global _team
    if _team is None:
        if threads == 1:
            return _ALONE
        _team = Team(min(int(_settings.NUMBA_NUM_THREADS), MOST) - 1)
        atexit.register(_team.stop)
    return _team


def _forget() -> None:
    """A process that was forked has none of the threads."""
    global _team
    if _team is not None:
        atexit.unregister(_team.stop)
        _team = None


if sys.platform != "win32":
    os.register_at_fork(after_in_child=_forget)


def _taken_lock() -> int:
    """The address of a lock that is taken."""
    allocate = ctypes.pythonapi.PyThread_allocate_lock
    allocate.restype = ctypes.c_void_p
    lock = allocate()
    acquire = ctypes.pythonapi.PyThread_acquire_lock
    acquire.argtypes = ctypes.c_void_p, ctypes.c_int
    acquire(lock, 1)
    return int(lock)


def _address(function: Any) -> int:
    return int(ctypes.cast(function, ctypes.c_void_p).value or 0)


# Python's own locks, which any thread may take, without the interpreter's.
_ACQUIRE, _RELEASE = (
    _address(function) for function in (ctypes.pythonapi.PyThread_acquire_lock, ctypes.pythonapi.PyThread_release_lock)
)
try:
    _YIELD = _address(ctypes.CDLL(None).sched_yield)
except (OSError, TypeError, AttributeError):  # another system
    _YIELD = 0


@inner_kernel
def _take(base: int, me: int) -> None:
    """Do parts until all are drawn."""
    threads = load(base + THREADS)
    for k in range(threads):
        ticket = base + TICKET + LINE * ((me + k) % threads)
        while _is_open(load(ticket)):
            drawn = add(ticket, 1)
            if not _is_open(drawn):
                break
            call_part(load(base + KERNEL), load(base + TABLE), drawn & NEXT, load(base + PARTS))
            add(base + DONE, 1)


@inner_kernel
def _is_open(ticket: int) -> bool:
    """Whether there are parts to draw."""
    return (ticket & NEXT) < (ticket >> 32)


@inner_kernel
def _is_wanted(base: int) -> bool:
    """Whether there is something to do, or the end has come."""
    for k in range(load(base + THREADS)):
        if _is_open(load(base + TICKET + LINE * k)):
            return True
    return bool(load(base + STOPPED) != 0)


@part_kernel
def _work(base: int, me: int, acquire: int, lock: int) -> None:
    """What a thread does."""
    asleep = base + ASLEEP + LINE * me
    while load(base + STOPPED) == 0:
        _take(base, me)
        looks = 0
        while looks < LOOKS and not _is_wanted(base):
            looks += 1
        if looks < LOOKS:
            continue
        store(asleep, 1)
        # whoever finds the sign and takes it away opens the lock as well
        if not (_is_wanted(base) and exchange(asleep, 0) == 1):
            call_acquire(acquire, lock, 1)


@inner_kernel
def _wake(base: int, locks: Any, release: int) -> None:
    for k in range(locks.size):
        if exchange(base + ASLEEP + LINE * (k + 1), 0) == 1:
            call_release(release, locks[k])


@kernel
def share(crew: Any, kernel: int, table: int, parts: int) -> None:
    """All parts of a pass: the kernel, by its address, is called as ``kernel(table, part, parts)`` for every part."""
    base, release, give_way = crew.numbers[0], crew.numbers[1], crew.numbers[2]
    locks = crew.locks[: max(0, min(crew.locks.size, parts - 1))]
    threads = locks.size + 1
    if threads == 1:
        for part in range(parts):
            call_part(kernel, table, part, parts)
        return
    store(base + KERNEL, kernel)
    store(base + TABLE, table)
    store(base + PARTS, parts)
    store(base + DONE, 0)
    store(base + THREADS, threads)
    for k in range(threads):
        store(base + TICKET + LINE * k, (parts * (k + 1) // threads) << 32 | (parts * k // threads))
    _wake(base, locks, release)
    _take(base, 0)
    looks = 0
    while load(base + DONE) < parts:
        looks += 1
        if looks > PATIENCE and give_way != 0:
            call_yield(give_way)


@kernel
def _stop(base: int, locks: Any, release: int) -> None:
    store(base + STOPPED, 1)
    _wake(base, locks, release)


_ALONE = Team(0)

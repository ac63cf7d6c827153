"""Times of several programs measured in turn, so that a noisy machine disturbs all of them alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def in_turn(runs: Mapping[str, Callable[[], float]], rounds: int) -> dict[str, Array]:
    """Seconds (rounds,) of every run; each returns the seconds of one of its steps. A first round is thrown away."""
    taken: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(rounds + 1):
        for name, run in runs.items():
            taken[name].append(run())
    return {name: np.array(values[1:]) for name, values in taken.items()}


def median(values: Array) -> float:
    """The middle one."""
    return float(np.median(values))


def ratio(slow: Array, quick: Array) -> float:
    """How many times as long: the median of the rounds' own quotients."""
    return float(np.median(slow / quick))


def cpu_seconds(action: Callable[[], object]) -> float:
    """Processor time of this thread: blind to what else the machine does, and to idle threads that wait by spinning."""
    began = time.thread_time()
    action()
    return time.thread_time() - began


def process_seconds(action: Callable[[], object]) -> float:
    """Processor time of all threads of this process."""
    began = time.process_time()
    action()
    return time.process_time() - began


def wall_seconds(action: Callable[[], object]) -> float:
    """Time that passes: what counts where several threads work."""
    began = time.perf_counter()
    action()
    return time.perf_counter() - began


def each(count: int, action: Callable[[], object]) -> float:
    """Seconds of one of some calls."""
    return wall_seconds(lambda: [action() for _ in range(count)]) / count

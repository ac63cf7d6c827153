"""Threads that share passes: every part is done once, whoever comes late, asleep or not."""

import os
import subprocess
import sys
import threading
import time
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from maggi.linalg import team as module
from maggi.linalg.atomics import load, store
from maggi.linalg.shared import SharedPass
from maggi.linalg.table import Table
from maggi.linalg.team import Team, share


@dataclass(frozen=True, eq=False)
class Work(Table):
    counts: NDArray[np.int64]
    effort: NDArray[np.int64]
    x: NDArray[np.float64]


@SharedPass
def count(of, part, parts):
    """How often every part is done, each after some effort."""
    for k in range(of.effort[part]):
        of.x[part] += 1.0 / (1.0 + k)
    of.counts[part] += 1


def done(team, counts, effort, threads):
    work = Work(counts, effort, np.zeros(counts.size))
    share(team.crew(threads), count.entry(work), work.__dict__["_address"], counts.size)


@pytest.fixture(scope="module")
def trio():
    team = Team(3)
    yield team
    team.stop()


@pytest.mark.parametrize("parts", [0, 1, 2, 3, 4, 5, 16, 61])
@pytest.mark.parametrize("threads", [1, 2, 4, 9])
def test_every_part_is_done_once(trio, parts, threads):
    """Passes at once behind each other, on threads that are still there, and after some that have let them go to sleep."""
    rng = np.random.default_rng(parts)
    for wait in (0.0, 0.0, 0.002, 0.0, 0.0005):
        time.sleep(wait)
        counts = np.zeros(parts, np.int64)
        done(trio, counts, rng.integers(0, 200, parts), threads)
        assert (counts == 1).all()


@pytest.mark.parametrize(("threads", "others"), [(1, 0), (2, 1), (4, 3), (9, 3)])
def test_no_more_threads_than_asked_for(trio, threads, others):
    assert trio.crew(threads).locks.size == others


def test_a_long_row_of_passes(trio):
    """Signs of sleep that are missed or seen twice would end it."""
    rng = np.random.default_rng(0)
    for k in range(20_000):
        parts = 1 + k % 7
        counts = np.zeros(parts, np.int64)
        done(trio, counts, rng.integers(0, 5, parts), 4)
        assert (counts == 1).all()
        if k % 40 == 0:
            time.sleep(1e-4)


def test_the_parts_of_others_are_waited_for(trio):
    """They take a hundred times as long as that of the one that calls, which looks at them at once."""
    kept = []  # whatever is still written to shall be there
    for _ in range(100):
        counts, effort = np.zeros(4, np.int64), np.array([2_000, 200_000, 200_000, 200_000])
        work = Work(counts, effort, np.zeros(4))
        kept.append(work)
        share(trio.crew(4), count.entry(work), work.__dict__["_address"], 4)
        assert counts.tolist() == [1, 1, 1, 1]


@dataclass(frozen=True, eq=False)
class Meeting(Table):
    begun: NDArray[np.int64]
    place: NDArray[np.int64]
    met: NDArray[np.int64]


@SharedPass
def meet(of, part, parts):
    """Each of two parts waits for the other to begin, for some seconds at most."""
    place = of.place[0]
    store(place + 8 * part, 1)
    for _ in range(2_000_000_000):
        if load(place + 8 * (1 - part)) == 1:
            of.met[part] = 1
            return


@pytest.mark.parametrize("wait", [0.0, 0.01])
def test_others_take_part(trio, wait):
    """Whether they are still there or asleep: two parts that wait for each other would not meet in one thread."""
    done(trio, np.zeros(8, np.int64), np.full(8, 100_000), 4)  # what the threads do is compiled by then
    for _ in range(5):
        time.sleep(wait)
        begun = np.zeros(2, np.int64)
        table = Meeting(begun, np.array([begun.ctypes.data]), np.zeros(2, np.int64))
        share(trio.crew(2), meet.entry(table), table.__dict__["_address"], 2)
        assert table.met.tolist() == [1, 1]


def test_without_its_threads_a_team_still_works():
    team = Team(2)
    team.stop()
    assert not any(thread.is_alive() for thread in team._threads)
    counts = np.zeros(5, np.int64)
    done(team, counts, np.zeros(5, np.int64), 3)
    assert (counts == 1).all()


def test_threads_end_asleep_or_not():
    for wait in (0.0, 0.01):
        before = threading.active_count()
        team = Team(3)
        time.sleep(wait)
        team.stop()
        assert threading.active_count() == before


def test_one_thread_begins_none(monkeypatch):
    monkeypatch.setattr(module, "_team", None)
    before = threading.active_count()
    assert module.team(1)._threads == []
    assert threading.active_count() == before


PROGRAM = """
import os, sys, numba, numpy as np
from maggi.elements.products import SymmetricBlocks
import scipy.sparse as sp
n = 2000
K = SymmetricBlocks.of(sp.bsr_matrix((np.ones((n, 3, 3)), np.arange(n), np.arange(n + 1)), shape=(3 * n, 3 * n)))
x, out = np.ones(3 * n), np.zeros(3 * n)
numba.set_num_threads(2)
K.add_product(x, out)
{then}
K.add_product(x, out)
assert (out == 6.0).all()
"""


FORK = "if os.fork(): sys.exit(os.waitstatus_to_exitcode(os.wait()[1]))"
no_fork = pytest.mark.skipif(sys.platform == "win32", reason="Windows does not fork")


@pytest.mark.parametrize("then", ["", pytest.param(FORK, marks=no_fork)], ids=["end", "fork"])
def test_a_program_ends_and_forks(then):
    """With threads that wait, or work: nothing hangs, nothing falls over."""
    for _ in range(3):
        environment = os.environ | {"NUMBA_NUM_THREADS": "2"}
        subprocess.run([sys.executable, "-c", PROGRAM.format(then=then)], check=True, timeout=120, env=environment)

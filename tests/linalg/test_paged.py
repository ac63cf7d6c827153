"""Large arrays whose memory the system may take back."""

import errno
import os
import sys
import threading
import time

import numpy as np
import pytest

from maggi.linalg import paged

MANY = 4 << 20  # values, 32 MB
in_files = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere ordinary memory is used")


def resident() -> int:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@in_files
@pytest.mark.parametrize(
    "part", [lambda a: a, lambda a: a[1:], lambda a: a.reshape(-1, 4)], ids=["all", "part", "shape"]
)
def test_memory_is_taken_back_and_values_stay(part):
    values = np.random.default_rng(0).normal(size=MANY)
    array = paged.moved(values)
    assert array.flags.writeable and array.flags.aligned and array.flags.c_contiguous
    before = resident()
    paged.release(part(array))
    assert before - resident() > 0.9 * array.nbytes
    np.testing.assert_array_equal(array, values)
    array[7] = 1.0  # written to after it has come back
    paged.release(array)
    assert array[7] == 1.0


@in_files
def test_what_is_read_at_first_only_is_let_go_meanwhile():
    array = paged.moved(np.ones(MANY))
    before = resident()
    with paged.read_at_first(array):
        assert array.sum() == MANY
        for _ in range(100):  # a second, at most
            time.sleep(0.1 * paged.MOMENT)
            if before - resident() > 0.9 * array.nbytes:
                break
        else:
            pytest.fail("not let go")
    assert array.sum() == MANY


def test_a_short_run_is_not_waited_for(monkeypatch):
    """However it ends, what would let go of the array ends with it."""
    monkeypatch.setattr(paged, "MOMENT", 1000.0)
    array, before = paged.moved(np.ones(MANY)), set(threading.enumerate())
    with pytest.raises(RuntimeError), paged.read_at_first(array):
        raise RuntimeError
    for thread in set(threading.enumerate()) - before:
        thread.join(60.0)
        assert not thread.is_alive()


def test_small_arrays_stay_where_they_are():
    small = np.arange(10.0)
    assert paged.moved(small) is small
    paged.release(small, small[2:])
    assert small.sum() == 45.0
    assert paged.empty((0, 3), np.int32).shape == (0, 3)


@pytest.mark.parametrize(
    ("name", "error"),
    [
        ("tempfile.TemporaryFile", OSError(errno.EACCES, "nowhere to write")),
        ("os.posix_fallocate", OSError(errno.ENOSPC, "no room")),
        ("os.posix_fallocate", AttributeError("another system")),
    ],
)
def test_without_a_file_ordinary_memory_does(monkeypatch, name, error):
    def fail(*args, **kwargs):
        raise error

    monkeypatch.setattr(f"maggi.linalg.paged.{name}", fail)
    array = paged.moved(np.ones((MANY // 4, 4)))
    assert array.shape == (MANY // 4, 4)
    paged.release(array)
    assert array.sum() == MANY


@in_files
def test_no_file_is_left_behind(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    array = paged.moved(np.ones(MANY))
    assert array.sum() == MANY
    assert list(tmp_path.iterdir()) == []

"""What allocators keep of freed memory."""

import os
import subprocess
import sys

import numpy as np
import pytest

from maggi.linalg import allocators


def resident() -> int:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(allocators._trim is None, reason="glibc's")
def test_free_memory_between_arrays_in_use_is_given_back():
    arrays = [np.ones(8_000) for _ in range(2_000)]  # 64 kB each: from the heap, which shrinks at its end only
    arrays = arrays[::2]
    before = resident()
    allocators.give_back()
    assert before - resident() > 32 << 20  # of 64 MB
    assert all(array[0] == 1.0 for array in arrays)


def test_another_libc_is_left_alone(monkeypatch):
    monkeypatch.setattr(allocators, "_trim", None)
    allocators.give_back()


def test_the_library_finds_its_settings_and_those_of_the_user_stand():
    show = "import os, maggi.linalg.factor; print(os.environ['MIMALLOC_PURGE_DELAY'])"
    environment = {key: value for key, value in os.environ.items() if not key.startswith("MIMALLOC")}
    for given, expected in (({}, "1"), ({"MIMALLOC_PURGE_DELAY": "500"}, "500")):
        found = subprocess.run(
            [sys.executable, "-c", show], env=environment | given, check=True, capture_output=True, text=True
        )
        assert found.stdout.strip() == expected

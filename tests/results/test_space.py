"""Space reserved before it is needed."""

import errno
import os
from types import SimpleNamespace

import pytest

from maggi.results.space import AHEAD, Reservation


@pytest.fixture
def path(tmp_path):
    found = tmp_path / "file"
    found.write_bytes(b"kept")
    return found


@pytest.mark.skipif(not os.path.exists("/proc"), reason="other systems only look at the space left")
def test_space_is_there_and_nothing_is_overwritten(path):
    Reservation(path).grow(10_000)
    assert path.stat().st_size == 4 + 10_000 + AHEAD
    assert path.read_bytes().startswith(b"kept\0")


def test_what_was_cut_off_is_reserved_again(path):
    reservation = Reservation(path)
    reservation.grow(10_000)
    size = path.stat().st_size
    os.truncate(path, 4)
    reservation.grow(0)
    assert path.stat().st_size == size


@pytest.mark.parametrize("reason", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG])
def test_a_refusal(path, monkeypatch, reason):
    def refuse(*_):
        raise OSError(reason, os.strerror(reason))

    monkeypatch.setattr(os, "posix_fallocate", refuse)
    with pytest.raises(OSError, match=os.strerror(reason)):
        Reservation(path).grow(1)


def test_file_systems_that_cannot_reserve(path, monkeypatch):
    def cannot(*_):
        raise OSError(errno.EOPNOTSUPP, os.strerror(errno.EOPNOTSUPP))

    monkeypatch.setattr(os, "posix_fallocate", cannot)
    Reservation(path).grow(1000)
    monkeypatch.setattr("shutil.disk_usage", lambda _: SimpleNamespace(free=1000))
    with pytest.raises(OSError, match="No space left"):
        Reservation(path).grow(1000)

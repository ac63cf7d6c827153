"""Disk space taken before it is needed, so that a full disk is met where it does no harm.

HDF5 cannot recover from a write that fails: its cache keeps what it could not write, closing the file
fails as well, and the process may end in a segmentation fault (seen with HDF5 2.0 and a limit on the
file's size). So the space of the next rows is reserved first, by the operating system, and HDF5 only
ever writes into space that is there.
"""

from __future__ import annotations

import errno
import os
import shutil
import sys
from pathlib import Path

AHEAD = 1 << 20  # bytes kept in reserve for HDF5's own bookkeeping


class Reservation:
    """Space reserved for one growing file.

    Parameters
    ----------
    path : the file; it must exist.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._needed = path.stat().st_size
        self._reserved = self._needed

    def grow(self, extra: int) -> None:
        """Make sure that the file can grow by `extra` bytes more than was asked for so far.

        Raises
        ------
        OSError : the disk is full, or a quota or limit is reached; the file is as it was.
        """
        self._needed += extra
        wanted = self._needed + AHEAD
        if wanted <= self._reserved:
            return
        if sys.platform == "linux":
            with self._path.open("r+b") as file:
                os.posix_fallocate(file.fileno(), self._reserved, wanted - self._reserved)
        elif shutil.disk_usage(self._path.parent).free < extra + AHEAD:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        self._reserved = wanted

    def moved(self, path: Path) -> None:
        """The file has another name now."""
        self._path = path

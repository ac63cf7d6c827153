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

    def grow(self, extra: int) -> None:
        """Make sure that the file can grow by `extra` bytes more than was asked for so far.

        Raises
        ------
        OSError : the disk is full, or a quota or limit is reached; the file is as it was.
        """
        self._needed += extra
        wanted = self._needed + AHEAD
        reserved = self._path.stat().st_size  # HDF5 gives back what it does not use at its first flush
        if wanted <= reserved:
            return
        if not self._allocate(reserved, wanted) and shutil.disk_usage(self._path.parent).free < wanted - reserved:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _allocate(self, start: int, end: int) -> bool:
        """Have the bytes allocated; whether this system and this file system can."""
        if sys.platform != "linux":
            return False
        try:
            with self._path.open("r+b") as file:
                os.posix_fallocate(file.fileno(), start, end - start)
        except OSError as error:
            if error.errno in (errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL):
                return False
            raise
        return True

    def moved(self, path: Path) -> None:
        """The file has another name now."""
        self._path = path

"""Reading a result file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py

from maggi.model.errors import ModelError

from .contract import FORMAT, FORMAT_VERSION
from .results import Results
from .source import Table
from .store import is_hdf5


def read(path: str | Path) -> Results:
    """Open a result file; use as ``with read(path) as results:``.

    Rows that were not complete when the run ended, however it ended, are left out.

    Raises
    ------
    ModelError : there is no such file, it is not a result file, or it cannot be read.
    """
    path = Path(path)
    try:
        if not path.exists():
            raise ModelError(f"there is no file {path}")
        if path.is_dir() or not is_hdf5(path):
            raise ModelError(f"{path} is not a result file", remedy="give a .h5 file that `maggi run` wrote")
        file = h5py.File(path, "r", locking="best-effort")
    except BlockingIOError as error:
        raise ModelError(f"{path} is being written by a run", remedy="wait for its end, or copy the file") from error
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise ModelError(f"cannot read {path}: {reason}") from error
    try:
        return Results(FileSource(file, path.name))
    except ModelError:
        file.close()
        raise


class FileSource:
    """A result file as a `results.Source`."""

    def __init__(self, file: Any, name: str) -> None:
        self._file = file
        self.name = name
        version = file.attrs.get("format_version", 0)
        if file.attrs.get("format") != FORMAT:
            raise ModelError(f"{name} is an HDF5 file, but not a result file of maggi")
        if version > FORMAT_VERSION:
            raise ModelError(
                f"{name} has format {version}, this program reads up to {FORMAT_VERSION}",
                remedy="install a newer maggi",
            )
        # The shortest table as well: a kill between two flushes leaves `rows` behind the tables, never before them,
        # but the file may have been through other hands.
        self.rows = min(int(file.attrs["rows"]), self._shortest())

    def attributes(self, path: str) -> Mapping[str, Any]:
        """Attributes of a group; the empty path is the whole."""
        return dict(self._file[path or "/"].attrs)

    def children(self, path: str) -> tuple[str, ...]:
        """Names in a group, in the order of the model."""
        return tuple(self._file[path]) if path in self._file else ()

    def table(self, path: str) -> Table | None:
        """A table, or None if it was not kept."""
        found = self._file.get(path)
        return found if isinstance(found, h5py.Dataset) else None

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _shortest(self) -> int:
        lengths: list[int] = []

        def visit(_: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.maxshape[0] is None:
                lengths.append(item.shape[0])

        self._file.visititems(visit)
        return min(lengths, default=0)

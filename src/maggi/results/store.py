"""The result file: an HDF5 file that grows as the run goes and survives whatever ends it."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from maggi.analyses.recorder import Layout, Rows
from maggi.model.errors import ModelError, SimulationError
from maggi.model.simulation import QUANTITIES

from .buffer import RowBuffer
from .contract import FORMAT, Column, check_names, columns, constants, groups, head
from .growing import GrowingTable
from .space import Reservation

FLUSH_SECONDS = 1.0
CHUNK_BYTES = 64 << 10


class FileRecorder:
    """Keeps a run in an HDF5 file, by the contract of `results.contract`.

    Rows are collected for at most a second, appended to the tables, and flushed; then the attribute
    ``rows`` says how many are complete, and is flushed by itself. A reader that stops at ``rows`` sees
    complete rows only, even if the process was killed in the middle of a flush.

    The file is written under a temporary name in the same folder and takes its own name when the first
    row is in it: an earlier result stays untouched until the new run stands, and from then on the file
    is there under its name, whatever happens. It is closed for the renaming, which needs no more than
    every operating system allows.

    Parameters
    ----------
    path : the result file. An existing result file is replaced, any other existing file is refused.
    quantities : what to keep (names of `Outputs.quantities`).
    text : the model file's text, kept in the file with its SHA-256; empty for none.

    Raises
    ------
    ModelError : at once, if `path` cannot be written; by `begin`, if the disk is too small for the rows.
    SimulationError : by `write` and `end`, if writing fails or a row holds a NaN; rows before it are kept.
    """

    def __init__(self, path: str | Path, quantities: tuple[str, ...] = QUANTITIES, text: str = "") -> None:
        self.path = Path(path)
        check_writable(self.path)
        self.rows = 0
        self.last_time = 0.0
        self._quantities = quantities
        self._text = text
        self._part = self.path.with_name(f".{self.path.name}.{os.getpid()}.part")
        self._file: Any = None
        self._tables: list[GrowingTable] = []
        self._space: Reservation
        self._buffer: RowBuffer | None = None
        self._flushed = 0.0
        self._broken = False

    def begin(self, layout: Layout) -> None:
        """Create the file with everything that does not change in time."""
        check_names(layout)
        kept = columns(layout, self._quantities)
        self._check_space(layout, kept)
        self._buffer = RowBuffer(layout, kept)
        try:
            self._file = h5py.File(self._part, "w", track_order=True, locking="best-effort")
            self._space = Reservation(self._part)
            self._space.grow(_head_bytes(layout, kept, self._text))
            self._write_head(layout)
            self._tables = [self._create(column, layout.rows) for column in kept]
        except OSError as error:
            self.end("failed: the file could not be created")
            raise ModelError(
                f"cannot create {self.path}: {_reason(error)}", remedy="choose another file with -o"
            ) from error

    def write(self, rows: Rows) -> None:
        """Keep rows; the first are on the disk at once, the others within a second."""
        assert self._buffer is not None, "begin() comes first"
        taken = 0
        while taken < len(rows.time):
            taken += self._buffer.append(rows, taken)
            if self.rows == 0:
                self._commit()
                self._take_own_name()
            elif self._buffer.full or time.monotonic() - self._flushed > FLUSH_SECONDS:
                self._commit()

    def end(self, status: str) -> None:
        """Write what is still waiting, note the status and close; without a single row nothing is left behind."""
        if self._file is None:
            return
        try:
            if not self._broken:
                self._commit()
                self._set("status", status)
        except SimulationError as error:
            if not self._broken:
                self._set("status", f"failed: {error}")
            raise
        finally:
            self._close()
            if self.rows == 0:
                self._part.unlink(missing_ok=True)
            else:
                self._give_back()

    def _give_back(self) -> None:
        """Cut off the space that was reserved and not used: HDF5 does so when it closes a file that it has opened."""
        with contextlib.suppress(OSError, RuntimeError):
            h5py.File(self.path, "r+", locking="best-effort").close()

    def _commit(self) -> None:
        """Append the waiting rows, flush, and only then count them; repeating it after an interrupt is harmless."""
        assert self._buffer is not None
        not_finite = self._buffer.drop_from_first_nan()
        end = self.rows + len(self._buffer)
        if end > self.rows:
            blocks = self._buffer.blocks()
            try:
                self._space.grow(sum(table.growth(self.rows, end) for table in self._tables))
                for table, (_, values) in zip(self._tables, blocks, strict=True):
                    table.append(self.rows, values)
                self._file.flush()
                self._set("rows", end)
                self._file.flush()
            except (OSError, RuntimeError) as error:  # h5py raises either when the disk is full
                self._broken = True
                kept = f"it holds the rows up to t = {self.last_time:.6g} s" if self.rows else "nothing was written"
                raise SimulationError(
                    f"cannot write {self.path}: {_reason(error)}; {kept}. Free some space, or raise outputs.every"
                ) from error
            self.last_time = float(blocks[0][1][-1])
            self.rows = end
            self._buffer.clear()
            self._flushed = time.monotonic()
        if not_finite is not None:
            self._buffer.clear()
            raise not_finite

    def _take_own_name(self) -> None:
        paths = [table.name for table in self._tables]
        try:
            self._close()
            self._part.replace(self.path)
            self._space.moved(self.path)
            self._file = h5py.File(self.path, "r+", locking="best-effort")
            self._tables = [GrowingTable(self._file[path]) for path in paths]
        except OSError as error:
            self._broken = True
            raise SimulationError(f"cannot write {self.path}: {_reason(error)}") from error

    def _write_head(self, layout: Layout) -> None:
        for name, value in head(layout, self._quantities, self._text).items():
            self._file.attrs[name] = value
        for path, said in groups(layout).items():
            group = self._group(path)
            for name, value in said.items():
                group.attrs[name] = value
        for constant in constants(layout):
            folder, _, name = constant.path.rpartition("/")
            table = self._group(folder).create_dataset(name, data=constant.values)
            table.attrs["unit"], table.attrs["description"] = constant.unit, constant.description

    def _create(self, column: Column, rows: int) -> GrowingTable:
        folder, _, name = column.path.rpartition("/")
        chunk = max(1, min(rows, CHUNK_BYTES // max(column.row_bytes, 1)))
        table = self._group(folder).create_dataset(
            name,
            shape=(0, *column.shape),
            maxshape=(None, *column.shape),
            chunks=(chunk, *(max(1, size) for size in column.shape)),
            dtype=column.dtype,
        )
        table.attrs["unit"], table.attrs["description"] = column.unit, column.description
        return GrowingTable(table)

    def _group(self, path: str) -> Any:
        """The group, made with its parents if need be; they all keep the order in which things were made."""
        group = self._file
        for name in filter(None, path.split("/")):
            group = group[name] if name in group else group.create_group(name, track_order=True)
        return group

    def _set(self, name: str, value: str | int) -> None:
        if name in self._file.attrs and not isinstance(value, str):
            self._file.attrs.modify(name, np.int64(value))  # in place: no metadata moves
        else:
            self._file.attrs[name] = value

    def _close(self) -> None:
        file, self._file = self._file, None
        if file is not None:
            # A full disk makes closing fail too; the rows counted so far are on the disk already.
            with contextlib.suppress(OSError, RuntimeError):
                file.close()

    def _check_space(self, layout: Layout, kept: tuple[Column, ...]) -> None:
        needed = layout.rows * sum(column.row_bytes for column in kept)
        free = shutil.disk_usage(self.path.parent).free
        if needed > free:
            raise ModelError(
                f"the results would take {needed / 1e9:.3g} GB, {self.path.parent.resolve()} has {free / 1e9:.3g} GB left",
                path="outputs",
                remedy="raise outputs.every, or leave displacement out of outputs.quantities",
            )


def check_writable(path: Path) -> None:
    """Find out whether a result file could be written, without touching it.

    Raises
    ------
    ModelError : the folder is missing or not writable, or `path` is a folder, not a plain file, or a
        file that is not a result file.
    """
    remedy = "choose another file with -o"
    folder = path.parent
    try:
        if path.is_dir():
            raise ModelError(f"{path} is a folder", remedy="give the name of a file with -o")
        if not folder.is_dir():
            raise ModelError(f"there is no folder {folder}", remedy=f"make it first (mkdir -p {folder}), or {remedy}")
        if path.exists() and not (path.is_file() and is_result_file(path)):
            raise ModelError(f"{path} exists and is not a result file of maggi; it is left alone", remedy=remedy)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise ModelError(f"cannot write {path}: {_reason(error)}", remedy=remedy) from error


def is_result_file(path: Path) -> bool:
    """Whether a file is one that this program wrote (an empty file counts: nothing is lost with it)."""
    if path.stat().st_size == 0:
        return True
    if not is_hdf5(path):
        return False
    try:
        with h5py.File(path, "r", locking="best-effort") as file:
            return bool(file.attrs.get("format") == FORMAT)
    except OSError:
        return False


def is_hdf5(path: Path) -> bool:
    """Whether a file starts as HDF5 files do."""
    with path.open("rb") as file:
        return file.read(8) == b"\x89HDF\r\n\x1a\n"


def _head_bytes(layout: Layout, kept: tuple[Column, ...], text: str) -> int:
    """Bound of the file's size before the first row: meshes, texts, and HDF5's headers of groups and tables."""
    fixed = sum(constant.values.nbytes for constant in constants(layout))
    texts = len(text.encode()) + sum(len(str(value).encode()) for value in layout.attributes.values())
    tables = len(kept) + len(constants(layout))
    return fixed + texts + 4096 * (tables + len(groups(layout)) + 3 * len(layout.bodies) + 16)


def _reason(error: Exception) -> str:
    """The system's own words (h5py wraps them in its own)."""
    number = getattr(error, "errno", None)
    return os.strerror(number) if number else str(error)

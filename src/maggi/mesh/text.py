"""Reading files that cannot be trusted: size limit, regular files only, numbers without surprises."""

from __future__ import annotations

import os
import stat

import numpy as np

from maggi.model.errors import MeshError

from .mesh import Array, IntArray

FILE_LIMIT = 2 * 1024**3
_CHUNK = 1 << 24
_EXACT = 2.0**53


def read_bytes(path: str) -> bytes:
    """The content of a regular file of at most `FILE_LIMIT` bytes; MeshError otherwise."""
    try:
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):  # opening a pipe would wait for ever
            what = "a folder" if stat.S_ISDIR(status.st_mode) else "not a regular file"
            raise MeshError(f"this is {what}", file=path, remedy="give the path of a mesh file")
        if status.st_size > FILE_LIMIT:
            raise MeshError(
                f"{status.st_size / 1024**3:.1f} GiB is more than the limit of {FILE_LIMIT / 1024**3:.0f} GiB",
                file=path,
                remedy="use a coarser mesh",
            )
        with open(path, "rb") as stream:
            data = stream.read(FILE_LIMIT)
    except OSError as error:
        raise MeshError(
            f"cannot be read: {error.strerror}", file=path, remedy="check the path and its rights"
        ) from None
    if not data.strip():
        raise MeshError("the file is empty", file=path, remedy="write the mesh again")
    return data


def parse_floats(text: bytes) -> Array | None:
    """The whitespace-separated numbers of `text`, (n,); None if one of them is not a finite number.

    Works chunk by chunk, so that memory stays in proportion to the text.
    """
    if b"_" in text:  # Python's own digit separator, no number in any mesh format
        return None
    parts = []
    start = 0
    while start < len(text):
        end = min(start + _CHUNK, len(text))
        while end < len(text) and not text[end : end + 1].isspace():
            end += 1
        try:
            parts.append(np.array(text[start:end].split(), dtype=np.float64))
        except ValueError:
            return None
        start = end
    values = np.concatenate(parts) if parts else np.zeros(0)
    return values if np.isfinite(values).all() else None


def as_integers(values: Array) -> IntArray | None:
    """`values` as integers; None if one is not whole or is too large for a float to hold exactly."""
    if not np.all((np.abs(values) < _EXACT) & (values == np.floor(values))):
        return None
    return values.astype(np.int64)


def shorten(token: str, width: int = 40) -> str:
    """A token of a file fit for a message."""
    printable = "".join(c if c.isprintable() else "?" for c in token)
    return printable if len(printable) <= width else printable[: width - 1] + "…"

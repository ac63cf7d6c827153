"""The sections of a Gmsh file as streams of numbers, read alike from ASCII and binary.

`Stream` is what the reader of the sections sees. Every count in a file is checked against what is left of the
section before anything of that size is made.
"""

from __future__ import annotations

from typing import NoReturn, Protocol

import numpy as np

from maggi.model.errors import MeshError

from .mesh import Array, IntArray
from .text import as_integers, parse_floats, shorten

REMEDY = "the file is damaged or was not written completely: write it again"


class Stream(Protocol):
    """Numbers of one section, in order."""

    @property
    def position(self) -> int:
        """Where the next number is, for `fail`."""

    @property
    def size_step(self) -> int:
        """By how much one size advances the position."""

    def ints(self, count: int) -> IntArray:
        """The next `count` integers (4 bytes each in a binary file)."""

    def sizes(self, count: int) -> IntArray:
        """The next `count` sizes, which include all node and element tags (8 bytes each in a binary file)."""

    def doubles(self, count: int) -> Array:
        """The next `count` real numbers."""

    def fail(self, message: str, *, at: int | None = None, remedy: str = REMEDY) -> NoReturn:
        """Raise MeshError at a `position` (by default the present one)."""


class AsciiStream:
    """The numbers of an ASCII section: the text between its ``$Name`` line and its end; `line` is its first (1-based)."""

    size_step = 1

    def __init__(self, text: bytes, file: str, section: str, line: int) -> None:
        self._text, self._file, self._section, self._line = text, file, section, line
        values = parse_floats(text)
        self._values = self._longest_start() if values is None else values
        self._damaged = values is None
        self.position = 0

    def _longest_start(self) -> Array:
        """The numbers before the first token that is none, so that earlier mistakes are reported first."""
        tokens = self._text.split()
        low, high = 0, len(tokens)
        while high - low > 1:  # tokens[:low] are numbers, tokens[:high] are not all
            middle = (low + high) // 2
            if parse_floats(b" ".join(tokens[low:middle])) is None:
                high = middle
            else:
                low = middle
        good = parse_floats(b" ".join(tokens[:low]))
        return np.zeros(0) if good is None else good

    def _next(self, count: int) -> Array:
        if count < 0:
            self.fail(f"${self._section}: a negative count", at=self.position - 1)
        if count > len(self._values) - self.position:
            if self._damaged:
                token = shorten(self._text.split()[len(self._values)].decode("latin-1"))
                self.fail(f"${self._section}: a number was expected, found '{token}'", at=len(self._values))
            self.fail(f"${self._section} ends too early", at=len(self._values))
        self.position += count
        return self._values[self.position - count : self.position]

    def ints(self, count: int) -> IntArray:
        start = self.position
        values = self._next(count)
        integers = as_integers(values)
        if integers is None:
            wrong = next(i for i in range(count) if as_integers(values[i : i + 1]) is None)
            self.fail(f"${self._section}: a whole number was expected, found {values[wrong]:g}", at=start + wrong)
        return integers

    sizes = ints

    def doubles(self, count: int) -> Array:
        return self._next(count)

    def finish(self) -> None:
        """Raise MeshError if numbers are left over."""
        if self._damaged or self.position < len(self._values):
            self.fail(f"${self._section} holds more than its counts announce")

    def fail(self, message: str, *, at: int | None = None, remedy: str = REMEDY) -> NoReturn:
        raise MeshError(
            message, file=self._file, line=self._line_of(self.position if at is None else at), remedy=remedy
        )

    def _line_of(self, index: int) -> int:
        """The line of a token; counted only for messages."""
        line = self._line
        for text in self._text.rstrip().split(b"\n"):
            index -= len(text.split())
            if index < 0:
                break
            line += 1
        return line


class BinaryStream:
    """The numbers of a binary section, from a byte offset of the file on."""

    def __init__(self, data: bytes, file: str, section: str, start: int, order: str, size_bytes: int) -> None:
        self._data, self._file, self._section = data, file, section
        self._int = np.dtype(order + "i4")
        self._size = np.dtype(f"{order}u{size_bytes}")
        self._double = np.dtype(order + "f8")
        self.size_step = size_bytes
        self.position = start

    def _next(self, count: int, kind: np.dtype[np.generic]) -> np.ndarray[tuple[int], np.dtype[np.generic]]:
        if count < 0 or count * kind.itemsize > len(self._data) - self.position:
            self.fail(f"${self._section}: {count} numbers announced, but the file ends before them")
        values = np.frombuffer(self._data, kind, count, self.position)
        self.position += count * kind.itemsize
        return values

    def ints(self, count: int) -> IntArray:
        return self._next(count, self._int).astype(np.int64)

    def sizes(self, count: int) -> IntArray:
        return self._next(count, self._size).astype(np.int64)  # beyond 2^63 becomes negative: refused as a count

    def doubles(self, count: int) -> Array:
        return self._next(count, self._double).astype(np.float64)

    def fail(self, message: str, *, at: int | None = None, remedy: str = REMEDY) -> NoReturn:
        place = self.position if at is None else at
        raise MeshError(f"{message}, at byte {place}", file=self._file, remedy=remedy)

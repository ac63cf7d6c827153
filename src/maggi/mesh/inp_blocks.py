"""The keyword blocks of an Abaqus or CalculiX input file: keyword, parameters, data lines with their numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from maggi.model.errors import MeshError

from .mesh import Array, IntArray
from .text import as_integers, parse_floats, shorten


@dataclass(frozen=True)
class Block:
    """One keyword with its data.

    keyword : upper case, without its star and spaces (``SOLIDSECTION``). title : as users write it.
    parameters : upper-case names to values as written, quotes removed; a parameter without value has "".
    line : of the keyword (1-based). rows : data lines without comments and empty ones; numbers : their lines.
    """

    keyword: str
    title: str
    parameters: dict[str, str]
    file: str
    line: int
    rows: tuple[str, ...]
    numbers: tuple[int, ...]

    def fail(self, message: str, remedy: str, row: int | None = None) -> NoReturn:
        """Raise MeshError at the keyword or at one of its data rows."""
        line = self.line if row is None else self.numbers[row]
        raise MeshError(message, file=self.file, line=line, remedy=remedy)

    def required(self, parameter: str) -> str:
        """A parameter's value; MeshError if it is not there."""
        value = self.parameters.get(parameter, "")
        if not value:
            self.fail(f"{self.title} has no {parameter}=", f"add {parameter}= to the line")
        return value

    def words(self) -> Iterator[tuple[int, list[str]]]:
        """The rows as lists of their comma-separated entries; empty entries at a row's end are left out."""
        for row, text in enumerate(self.rows):
            words = [word.strip() for word in text.split(",")]
            while words and not words[-1]:
                words.pop()
            yield row, words

    def floats(self, row: int, words: Sequence[str]) -> list[float]:
        """The entries of one row as numbers; an empty entry is 0, as in Abaqus."""
        values: list[float] = []
        for word in words:
            value = _parse([word or "0"])
            if value is None:
                self.fail(f"a number was expected, found '{shorten(word)}'", "correct the line", row)
            values.append(float(value[0]))
        return values

    def integer(self, row: int, word: str) -> int:
        """One entry as a whole number."""
        values = _parse([word])
        integers = None if values is None else as_integers(values)
        if integers is None:
            self.fail(f"a whole number was expected, found '{shorten(word)}'", "correct the line", row)
        return int(integers[0])

    def integer_table(self, width: int) -> tuple[IntArray, list[int]]:
        """Records of `width` whole numbers, each on one or several rows: (n, width) and the first row of each."""
        records: list[str] = []
        starts: list[int] = []
        missing = 0
        for row, text in enumerate(self.rows):
            words = text.rstrip(", \t").split(",")
            if missing == 0:
                starts.append(row)
                missing = width
            missing -= len(words)
            if missing < 0:
                self.fail(f"{width - missing} numbers where {width} make a record", "correct the line", row)
            records += words
        if missing:
            self.fail(f"{width - missing} numbers where {width} make a record", "add what is missing", starts[-1])
        values = _parse(records)
        integers = None if values is None else as_integers(values)
        if integers is None:
            for row, words in self.words():
                for word in words:
                    self.integer(row, word)
            self.fail("a whole number was expected", "correct the data lines")
        return integers.reshape(-1, width), starts

    def node_table(self) -> tuple[IntArray, Array]:
        """The rows of ``*NODE``: labels (n,) and coordinates (n, 3); missing coordinates are 0, as in Abaqus."""
        fast = _parse(",".join(self.rows).split(",")) if all(row.count(",") == 3 for row in self.rows) else None
        if fast is None:
            rows: list[list[float]] = []
            for row, words in self.words():
                if len(words) > 4:
                    self.fail(
                        f"{len(words)} entries for a node, expected its number and x, y, z", "correct the line", row
                    )
                rows.append(self.floats(row, words) + [0.0] * (4 - len(words)))
            fast = np.array(rows, dtype=np.float64)
        table = fast.reshape(-1, 4)
        labels = as_integers(table[:, 0])
        if labels is None:
            wrong = next(i for i in range(len(table)) if as_integers(table[i : i + 1, 0]) is None)
            self.fail(f"a node's number must be whole, found {table[wrong, 0]:g}", "correct the line", wrong)
        return labels, table[:, 1:]


def _parse(words: Sequence[str]) -> Array | None:
    """Numbers (n,), with Fortran's exponents (1.0D-3) too; None if one is none."""
    text = "\n".join(words).encode("utf-8", "replace")
    values = parse_floats(text)
    if values is None:
        values = parse_floats(text.upper().replace(b"D", b"E"))
    return values if values is not None and len(values) == len(words) else None


def read_blocks(data: bytes, file: str) -> list[Block]:
    """All blocks of a file; MeshError if it is no text or begins with data."""
    if b"\0" in data:
        raise MeshError("this is not a text file", file=file, remedy="give an Abaqus or CalculiX input file")
    lines = data.decode("utf-8", "replace").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    heads = [i for i, line in enumerate(lines) if line.lstrip().startswith("*") and not line.lstrip().startswith("**")]
    first = heads[0] if heads else len(lines)
    for i in range(first):
        if lines[i].strip() and not lines[i].lstrip().startswith("**"):
            message = f"a keyword was expected, found '{shorten(lines[i].strip())}'"
            raise MeshError(message, file=file, line=i + 1, remedy="an input file begins with *HEADING or *NODE")
    ends = [*heads[1:], len(lines)] if heads else []
    return [_block(lines, head, end, file) for head, end in zip(heads, ends, strict=True)]


def _block(lines: list[str], head: int, end: int, file: str) -> Block:
    text = lines[head].strip()
    start = head + 1
    while text.endswith(",") and start < end:  # the keyword's line goes on
        if not lines[start].lstrip().startswith("**"):
            text += lines[start].strip()
        start += 1
    title, *rest = text.split(",")
    parameters: dict[str, str] = {}
    for item in rest:
        name, _, value = item.partition("=")
        if name.strip():
            parameters[name.strip().upper()] = value.strip().strip("\"'").strip()
    kept = [i for i in range(start, end) if lines[i].strip() and not lines[i].lstrip().startswith("**")]
    title = "*" + " ".join(title[1:].upper().split())
    keyword = title[1:].replace(" ", "")
    return Block(keyword, title, parameters, file, head + 1, tuple(lines[i] for i in kept), tuple(i + 1 for i in kept))

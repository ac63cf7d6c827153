"""Points of a curve from a text file of two or three columns."""

from __future__ import annotations

import re
import stat
from pathlib import Path

from ..model.errors import ModelError
from ..model.geometry import Vector

MAX_BYTES = 10_000_000
HEADERS = (["x", "y"], ["x", "y", "z"])

_NUMBER = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_LARGEST = 1e100


def read_points(path: Path, unit: float) -> tuple[tuple[Vector, ...], tuple[int, ...]]:
    """The points (m) of a CSV file and the lines (from 1) that they stand in.

    Columns x, y and, if there is a third, z are separated by commas, semicolons or blanks; a first line may name them.
    Empty lines, and what follows a ``#``, are passed over. unit : length of one unit of the file (m).

    Raises ModelError with the file and its line for anything that is not a number, and for rows of unequal length.
    """
    points: list[Vector] = []
    lines: list[int] = []
    width = 0
    for number, line in enumerate(_text(path).splitlines(), start=1):
        row = re.split(r"[,;]", line.partition("#")[0])
        parts = row[0].split() if len(row) == 1 else [part.strip() for part in row]
        if not parts:
            continue
        if not points and [part.lower() for part in parts] in HEADERS:
            continue
        width = width or len(parts)
        if len(parts) not in (2, 3) or len(parts) != width:
            wanted = str(width) if width in (2, 3) else "2 or 3"
            raise _refuse(path, number, f"expected {wanted} numbers, found {len(parts)}: '{line.strip()[:60]}'")
        values = [_number(part, path, number) * unit for part in parts]
        points.append((values[0], values[1], values[2] if width == 3 else 0.0))
        lines.append(number)
    return tuple(points), tuple(lines)


def _text(path: Path) -> str:
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):  # opening a pipe would wait for ever
            what = "a folder" if stat.S_ISDIR(status.st_mode) else "not a regular file"
            raise ModelError(f"'{path}' is {what}", remedy="give the path of a file of points")
        if status.st_size > MAX_BYTES:
            raise ModelError(f"'{path}' has more than {MAX_BYTES} bytes", remedy="give fewer points")
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise ModelError(f"no file '{path}'", remedy="paths start at the model file's folder") from None
    except UnicodeDecodeError:
        raise ModelError(f"'{path}' is not a text in UTF-8", remedy="save the points as CSV") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise ModelError(f"'{path}' cannot be read: {reason}") from None


def _number(text: str, path: Path, line: int) -> float:
    if not _NUMBER.fullmatch(text):
        raise _refuse(path, line, f"expected a number, found '{text[:40]}'")
    value = float(text)
    if not abs(value) < _LARGEST:
        raise _refuse(path, line, f"the number {text[:40]} is too large")
    return value


def _refuse(path: Path, line: int, message: str) -> ModelError:
    return ModelError(
        message, file=str(path), line=line, remedy="write x, y and perhaps z in columns, with a point for decimals"
    )

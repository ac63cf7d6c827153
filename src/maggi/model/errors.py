"""The one exception for a user's mistake, whatever part of the program notices it."""

from __future__ import annotations

from collections.abc import Sequence


class ModelError(ValueError):
    """A mistake in what the user gave: a model, a mesh, an expression, an option.

    Every part of the program raises this class (or a subclass) for a user's mistake and never
    for its own; the command line prints it without a traceback and ends with status 2.

    Parameters
    ----------
    message : what is wrong, with the value that was found.
    path : where in the model, as dotted keys (``"bodies.arm.mesh.file"``); the model-file reader
        turns it into a line and a column.
    remedy : what the user can do about it, one sentence.
    file, line, column : the place in a file, where known (1-based; 0 means unknown).
    """

    def __init__(
        self,
        message: str,
        *,
        path: str = "",
        remedy: str = "",
        file: str = "",
        line: int = 0,
        column: int = 0,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.path = path
        self.remedy = remedy
        self.file = file
        self.line = line
        self.column = column

    def __str__(self) -> str:
        place = self.file
        if self.line:
            place += f":{self.line}"
            if self.column:
                place += f":{self.column}"
        parts = [part for part in (place, self.path, self.message) if part]
        text = ": ".join(parts)
        return f"{text} ({self.remedy})" if self.remedy else text


class ModelErrors(ModelError):
    """Several mistakes found in one pass, in the order of the file; message and place are those of the first.

    errors : the single mistakes, never empty.
    """

    def __init__(self, errors: Sequence[ModelError]) -> None:
        first = errors[0]
        super().__init__(
            first.message,
            path=first.path,
            remedy=first.remedy,
            file=first.file,
            line=first.line,
            column=first.column,
        )
        self.errors = tuple(errors)

    def __reduce__(self) -> tuple[type[ModelErrors], tuple[tuple[ModelError, ...]]]:
        return ModelErrors, (self.errors,)  # copies and other processes must get the list, not the text

    def __str__(self) -> str:
        return "\n".join(str(error) for error in self.errors)


class MeshError(ModelError):
    """A mesh file or mesh that cannot be used; names the cell, node or set."""


class SimulationError(RuntimeError):
    """A run that failed: where (time, body or joint), why, and what to try. Exit status 1."""

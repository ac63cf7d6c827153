"""How a command ended, for people and for machines."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal

import click

from maggi.model.errors import ModelError, ModelErrors

Status = Literal["complete", "failed", "error", "interrupted"]
EXIT: Mapping[Status, int] = MappingProxyType({"complete": 0, "failed": 1, "error": 2, "interrupted": 130})


@dataclass(frozen=True)
class Outcome:
    """What ``--json`` prints, and what the exit status follows from.

    status : ``complete``; ``failed`` (a run, or the program itself); ``error`` (the user's); ``interrupted``.
    file : the result file, where there is one. steps, iterations, residuals : of the run, as far as it went.
    more : further entries of single commands.
    """

    status: Status
    file: str | None = None
    steps: int = 0
    iterations: int = 0
    residuals: Mapping[str, float] = field(default_factory=dict)
    errors: tuple[ModelError, ...] = ()
    more: Mapping[str, Any] = field(default_factory=dict)

    @property
    def exit_code(self) -> int:
        """0 complete, 1 failed, 2 the user's error, 130 interrupted."""
        return EXIT[self.status]

    def print_json(self) -> None:
        """One object on standard output."""
        entries = {
            "status": self.status,
            "file": self.file,
            "steps": self.steps,
            "iterations": self.iterations,
            "residuals": dict(self.residuals),
            **self.more,
            "errors": [_entry(error) for error in self.errors],
        }
        click.echo(json.dumps(entries, indent=2, ensure_ascii=False))

    def print_errors(self) -> None:
        """One line for each error on standard error, ``file:line:column: path: message (remedy)``."""
        for error in self.errors:
            text = str(error)
            click.echo(text if error.file else f"maggi: {text}", err=True)


def failure(status: Status, errors: ModelError | Sequence[ModelError] | str, file: str | None = None) -> Outcome:
    """The outcome of a command that ended with errors before there was anything to tell."""
    if isinstance(errors, str):
        errors = ModelError(errors)
    if isinstance(errors, ModelErrors):
        errors = errors.errors
    if isinstance(errors, ModelError):
        errors = (errors,)
    return Outcome(status, file, errors=tuple(errors))


def _entry(error: ModelError) -> dict[str, str | int | None]:
    return {
        "file": error.file or None,
        "line": error.line or None,
        "column": error.column or None,
        "path": error.path or None,
        "message": error.message,
        "remedy": error.remedy or None,
    }

"""How far a run is, on standard error: a bar on a terminal, a few lines elsewhere."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager
from types import TracebackType
from typing import TYPE_CHECKING, Protocol, Self

import click

from maggi.analyses.recorder import Progress

if TYPE_CHECKING:
    from rich.progress import Progress as RichProgress
    from rich.progress import TaskID

_LINES = 10  # of a run, where there is no terminal


class Display(Progress, AbstractContextManager["Display"], Protocol):
    """A progress display, to be used as a context manager; `step` is the last step it was told of."""

    step: int


class Silent:
    """Shows nothing."""

    def __init__(self) -> None:
        self.step = 0

    def stage(self, text: str) -> None:
        """Nothing to show."""

    def advance(self, step: int, steps: int, time: float, note: str) -> None:
        """Remember the step."""
        self.step = step

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Nothing to end."""


class Lines(Silent):
    """A line for each stage and each tenth of the steps."""

    def __init__(self) -> None:
        super().__init__()
        self._tenth = 0

    def stage(self, text: str) -> None:
        """A line."""
        click.echo(text, err=True)

    def advance(self, step: int, steps: int, time: float, note: str) -> None:
        """A line if another tenth is done."""
        super().advance(step, steps, time, note)
        tenth = _LINES * step // max(1, steps)
        if tenth > self._tenth:
            self._tenth = tenth
            click.echo(
                f"{100 * step // steps:3d} %  step {step:,} of {steps:,}  t = {time:.6g} s  {note}".rstrip(), err=True
            )


class Bar(Silent):
    """A bar with the time left, below the stages that are done."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            Progress,
            SpinnerColumn,
            TaskProgressColumn,
            TextColumn,
            TimeRemainingColumn,
        )

        super().__init__()
        self._bar: RichProgress = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            TaskProgressColumn(),
            TimeRemainingColumn(compact=True),
            TextColumn("{task.fields[state]}", markup=False),
            console=Console(stderr=True),
            transient=True,
        )
        self._task: TaskID = self._bar.add_task("starting", total=None, state="")
        self._stage = ""

    def stage(self, text: str) -> None:
        """The stage before stays above as a line; this one stands beside the bar."""
        self._bar.reset(self._task, total=None, description=text, state="")
        self._bar.console.print(text, style="dim", markup=False, highlight=False)

    def advance(self, step: int, steps: int, time: float, note: str) -> None:
        """Move the bar."""
        super().advance(step, steps, time, note)
        state = f"step {step:,} of {steps:,}  t = {time:.5g} s  {note}".rstrip()
        self._bar.update(self._task, total=steps, completed=step, description="running", state=state)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Take the bar away."""
        self._bar.stop()


def display(quiet: bool) -> Display:
    """The display that suits standard error."""
    if quiet:
        return Silent()
    return Bar() if sys.stderr.isatty() else Lines()

"""What must be reached, beside what was measured."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass

from .tables import MISSING, figure

RECORD = "MAGGI_BENCH_TARGETS"  # a file that every target is appended to: run.py makes its summary of it


@dataclass(frozen=True)
class Target:
    """A bound on a figure: at least, or at most `bound`; unit is written behind both."""

    bound: float
    unit: str = "×"
    at_most: bool = False

    def cells(self, what: str, measured: float | None) -> tuple[str, str]:
        """Target and whether it is reached, and a note for the summary; `what` says which figure it is."""
        wanted = f"{'≤' if self.at_most else '≥'} {self.bound:g}{self.unit}"
        reached = MISSING
        if measured is not None:
            reached = "yes" if (measured <= self.bound if self.at_most else measured >= self.bound) else "no"
        noted = MISSING if measured is None else figure(measured) + self.unit
        _record(Outcome(what, noted, wanted, reached))
        return wanted, reached


@dataclass(frozen=True)
class Outcome:
    """One line of the summary."""

    what: str
    measured: str
    target: str
    reached: str


def _record(outcome: Outcome) -> None:
    path = os.environ.get(RECORD)
    if path:
        with open(path, "a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(outcome)) + "\n")


def recorded(path: str) -> list[Outcome]:
    """What was noted in a file."""
    with open(path, encoding="utf-8") as file:
        return [Outcome(**json.loads(line)) for line in file]

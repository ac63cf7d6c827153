"""All benchmarks in a short form, which writes RESULTS.md; or the named ones, which does not unless asked.

./dev bench                 all, short: RESULTS.md
./dev bench chains reduced  these, short
./dev bench --long chains   in full
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from common.machine import description
from common.targets import RECORD, Outcome, recorded

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "RESULTS.md"
PICTURE = HERE.parent / "docs" / "pictures" / "growth.png"


@dataclass(frozen=True)
class Case:
    """A script, with its arguments in the short and in the long form; `named`: too long to run unless it is named."""

    name: str
    short: tuple[str, ...] = ()
    long: tuple[str, ...] = ("--long",)
    named: bool = False


CASES = (
    Case("chains"),
    Case("four_bars"),
    Case("squeezer"),
    Case("reduced"),
    Case("reduction_error"),
    Case("full_mesh"),
    Case("many_bodies"),
    Case("full_mesh_peer"),
    Case("rows"),
    Case("startup"),
    Case("setup_costs"),
    Case("adaptive"),
    Case("growth"),
    Case("long_run", ("--steps", "20000"), ()),
    Case("simeon_crank", (), (), named=True),
    Case("where", named=True),
)


@dataclass(frozen=True)
class Outcomes:
    """What a script printed, how long it took (s), what it held against targets, and its exit status."""

    name: str
    text: str
    seconds: float
    targets: list[Outcome]
    status: int


def main() -> int:
    names = [case.name for case in CASES]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(names))
    parser.add_argument("--long", action="store_true", help="in full: hours for all")
    parser.add_argument("--write", action="store_true", help="write RESULTS.md also for some, or for the long form")
    given = parser.parse_args()
    chosen = [name.removesuffix(".py") for name in given.names]
    chosen = chosen or [case.name for case in CASES if given.long or not case.named]
    unknown = [name for name in chosen if name not in names]
    if unknown:
        print(f"there is no benchmark {unknown[0]!r}; there are {', '.join(names)}", file=sys.stderr)
        return 2
    writing = given.write or not (given.names or given.long)
    machine, done = description(), []  # before a run, which rewrites a picture
    for case in CASES:
        if case.name in chosen:
            arguments = case.long if given.long else case.short
            if case.name == "growth" and writing:
                arguments = (*arguments, "--picture", str(PICTURE))
            done.append(run(case.name, arguments))
    if writing:
        RESULTS.write_text(report(machine, done, "long" if given.long else "short"), encoding="utf-8")
        print(f"written: {RESULTS.relative_to(HERE.parent)}")
    return int(any(outcome.status for outcome in done))  # a script that was killed has a negative status


def run(name: str, arguments: tuple[str, ...]) -> Outcomes:
    """Run a script; what it prints appears at once."""
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        record = str(Path(folder) / "targets")
        Path(record).touch()
        # one thread for BLAS: the products of this program's own kernels use theirs, and Exudyn has one
        environment = {"OPENBLAS_NUM_THREADS": "1", **os.environ, RECORD: record}
        command = [sys.executable, "-u", str(HERE / f"{name}.py"), *arguments]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
            assert process.stdout is not None
            lines = []
            for line in process.stdout:
                print(line, end="", flush=True)
                lines.append(line)
        seconds = time.perf_counter() - began
        if process.returncode:
            failure = f"\n{name} failed with exit status {process.returncode}.\n"
            print(failure, end="")
            lines.append(failure)
        print(f"({name}: {seconds:.0f} s)\n", flush=True)
        return Outcomes(name, "".join(lines).strip(), seconds, recorded(record), process.returncode)


def report(machine: list[tuple[str, str]], done: list[Outcomes], form: str) -> str:
    """RESULTS.md: the machine, the targets, all tables."""
    minutes = sum(outcome.seconds for outcome in done) / 60.0
    parts = [
        "# Results\n\n"
        f"Written by `./dev bench` ({form} form, {minutes:.1f} minutes in all); what the columns mean is in README.md.\n"
    ]
    parts.append("\n".join(["| machine | |", "|:--|:--|", *(f"| {what} | {which} |" for what, which in machine)]))
    targets = [target for outcome in done for target in outcome.targets]
    lines = ["\n## Targets\n", "| figure | measured | target | reached |", "|:--|--:|--:|--:|"]
    lines += [f"| {t.what} | {t.measured} | {t.target} | {t.reached} |" for t in targets]
    parts.append("\n".join(lines))
    parts.append("\n## Tables\n")
    for outcome in done:
        parts.append(f"{outcome.text}\n\n`{outcome.name}.py`: {outcome.seconds:.0f} s\n")
    return "\n".join(parts)


if __name__ == "__main__":
    sys.exit(main())

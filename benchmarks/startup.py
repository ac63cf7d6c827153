"""Starting up, each in fresh processes: the import, a run of a small model beyond its steps, the first compilation.

A run of a single step is nothing but start-up: interpreter, imports, model, kernels loaded from the cache, result file.
The first compilation is a run and a plot of the demo's model with an empty cache folder, less the same with a full one.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from common.tables import MISSING, Table, figure
from common.targets import Target

ROOT = Path(__file__).resolve().parent.parent
HERE = ROOT / "benchmarks"
IMPORT = Target(0.5, " s", at_most=True)
RUN = Target(2.0, " s", at_most=True)
FIRST = Target(30.0, " s", at_most=True)
DEMO = ROOT / "examples" / "slider_crank" / "slider_crank.yml"
ARM = ROOT / "examples" / "two_link_arm" / "two_link_arm.yml"
ONE_STEP = "simulation.duration=0.001"
PLAIN = "import maggi"
ALL = "import maggi; maggi.run; maggi.Model"
# As an installed program is: where Python is told to keep no bytecode, each start would compile the sources anew.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


@dataclass(frozen=True)
class Took:
    """Seconds of processor time of a process, and those that passed."""

    cpu: float
    wall: float

    def __add__(self, other: Took) -> Took:
        return Took(self.cpu + other.cpu, self.wall + other.wall)

    def __sub__(self, other: Took) -> Took:
        return Took(self.cpu - other.cpu, self.wall - other.wall)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="fifteen processes each instead of five")
    parser.add_argument(
        "--no-compilation", action="store_true", help="leave out the first compilation: a minute or more"
    )
    given = parser.parse_args()
    rounds = 15 if given.long else 5
    table = Table("Start-up: seconds", "what", "processor", "passed", "target", "reached")

    def line(what: str, took: Took, target: Target | None = None) -> None:
        cells = target.cells(what, took.cpu) if target else (MISSING, MISSING)
        table.row(what, figure(took.cpu), figure(took.wall), *cells)

    python = [sys.executable, "-c"]
    nothing = repeated([*python, "pass"], rounds)
    line("Python itself", nothing)
    line("import maggi", repeated([*python, PLAIN], rounds) - nothing, IMPORT)
    line("import maggi, with what a run needs", repeated([*python, ALL], rounds) - nothing)
    with tempfile.TemporaryDirectory() as folder:
        for what, model in {"rigid four-bar": HERE / "four_bar.yml", "two reduced beams": ARM}.items():
            line(f"a run of one step, {what}", repeated(run_command(model, ONE_STEP, folder), rounds), RUN)
        if not given.no_compilation:
            cache = str(Path(folder) / "cache")
            empty = demo(folder, cache)
            full = demo(folder, cache)
            line("demo of two steps and its pictures, cache full", full)
            line("demo of two steps and its pictures, cache empty", empty)
            first = empty - full
            cells = FIRST.cells("first compilation for the demo", first.wall)
            table.row("first compilation for the demo", figure(first.cpu), figure(first.wall), *cells)
    table.note(
        "Medians of fresh processes, the first of which does not count. Targets are held against processor time, which on"
    )
    table.note("an otherwise idle machine is what passes; but for the first compilation, which two processes share.")
    table.show()


def run_command(model: Path, setting: str, folder: str) -> list[str]:
    """`maggi run` of a model with a setting, quiet."""
    out = str(Path(folder) / "out.h5")
    return [sys.executable, "-m", "maggi", "run", str(model), "--quiet", "--set", setting, "-o", out]


def demo(folder: str, cache: str) -> Took:
    """A short run and its plot, with a cache folder of its own."""
    environment = {**ENVIRONMENT, "NUMBA_CACHE_DIR": cache}
    plot = [sys.executable, "-m", "maggi", "plot", str(Path(folder) / "out.h5")]
    return call(run_command(DEMO, "simulation.duration=8e-5", folder), environment) + call(plot, environment)


def repeated(command: list[str], rounds: int) -> Took:
    """Medians of some calls, after a first one."""
    taken = [call(command) for _ in range(rounds + 1)][1:]
    return Took(float(np.median([t.cpu for t in taken])), float(np.median([t.wall for t in taken])))


def call(command: list[str], environment: dict[str, str] = ENVIRONMENT) -> Took:
    """Runs a command; raises where it fails."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, check=True, capture_output=True, env=environment)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return Took(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall)


if __name__ == "__main__":
    main()

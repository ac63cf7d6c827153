"""Compiling the step in a second process: only where nothing is kept, and never in the way of a run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from maggi.stepping import ahead


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    return tmp_path


def test_a_kept_kernel_is_not_compiled_again(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (cache / ahead.MARKER).touch()
    monkeypatch.setattr(subprocess, "Popen", lambda *a, **k: pytest.fail("a process was started"))
    ahead.begin()
    ahead.finish(lambda text: pytest.fail(text))


def test_the_run_waits_and_says_why(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start = subprocess.Popen
    command = [sys.executable, "-c", "import time; time.sleep(0.5)"]
    monkeypatch.setattr(subprocess, "Popen", lambda _, **k: start(command, **k))
    said: list[str] = []
    ahead.begin()
    ahead.begin()  # one is enough
    ahead.finish(said.append)
    assert said == ["compiling the step's kernels (once per installation)"]
    ahead.finish(said.append)
    assert len(said) == 1


def test_without_a_second_process_the_run_goes_on(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError("no more processes")

    monkeypatch.setattr(subprocess, "Popen", refuse)
    ahead.begin()
    ahead.finish(lambda text: pytest.fail(text))


def test_the_kernel_that_is_compiled_is_the_one_that_runs_use() -> None:
    from maggi.stepping import iteration

    ahead.compile_step()
    count = len(iteration.advance.signatures)
    from maggi.analyses.transient import run
    from maggi.model.bodies import RigidBody
    from maggi.model.model import Model
    from maggi.model.simulation import Simulation
    from maggi.results.memory import MemoryRecorder

    inertia = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    run(Model(bodies={"b": RigidBody(1.0, inertia=inertia)}, simulation=Simulation(0.01, 1e-3)), MemoryRecorder())
    assert len(iteration.advance.signatures) == count

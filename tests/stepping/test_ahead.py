"""Compiling the step in a second process: only where nothing is kept, and never in the way of a run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from maggi.stepping import ahead

# Says that the rows are compiled, after a while, and goes on.
REPORT = f"""
import pathlib, sys, time
time.sleep(0.3)
next(pathlib.Path(sys.argv[1]).glob("{ahead.CLAIMS}*")).joinpath("{ahead.ROWS}").touch()
time.sleep(2)
"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    return tmp_path


def test_a_kept_kernel_is_not_compiled_again(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (cache / ahead.MARKER).touch()
    monkeypatch.setattr(subprocess, "Popen", lambda *a, **k: pytest.fail("a process was started"))
    ahead.begin()
    ahead.announce(pytest.fail)
    ahead.finish()


def test_the_run_waits_and_says_why(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start = subprocess.Popen
    command = [sys.executable, "-c", "import time; time.sleep(0.5)"]
    monkeypatch.setattr(subprocess, "Popen", lambda _, **k: start(command, **k))
    said: list[str] = []
    ahead.begin()
    ahead.begin()  # one is enough
    ahead.announce(said.append)
    ahead.finish()
    assert said == ["compiling the step's kernels (once per installation)"]
    assert list(cache.iterdir()) == []  # no claims are left
    ahead.announce(said.append)
    ahead.finish()
    assert len(said) == 1


def test_the_run_waits_for_the_rows_and_does_something_else_meanwhile(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = subprocess.Popen
    monkeypatch.setattr(subprocess, "Popen", lambda _, **k: start([sys.executable, "-c", REPORT, str(cache)], **k))
    ahead.await_rows(lambda: pytest.fail("nobody else compiles"))
    ahead.begin()
    done: list[bool] = []
    ahead.await_rows(lambda: done.append(any(cache.rglob(ahead.ROWS))))
    assert done == [False]
    assert any(cache.rglob(ahead.ROWS))
    assert ahead._pending[0].poll() is None  # not for the whole of it
    ahead.finish()


def test_nobody_waits_for_rows_of_a_process_that_has_died(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start = subprocess.Popen
    monkeypatch.setattr(subprocess, "Popen", lambda _, **k: start([sys.executable, "-c", "raise SystemExit(1)"], **k))
    ahead.begin()
    ahead.await_rows()
    ahead.finish()


def test_a_cache_folder_that_is_not_there_yet_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "new" / "cache"))
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    start = subprocess.Popen
    started: list[object] = []
    command = [sys.executable, "-c", "pass"]
    monkeypatch.setattr(subprocess, "Popen", lambda wanted, **k: (started.append(wanted), start(command, **k))[1])
    ahead.begin()
    ahead.finish()
    assert len(started) == 1


def test_without_a_second_process_the_run_goes_on(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError("no more processes")

    monkeypatch.setattr(subprocess, "Popen", refuse)
    ahead.begin()
    ahead.announce(pytest.fail)
    ahead.finish()


def test_each_compilation_is_claimed_by_one_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []
    monkeypatch.setattr(ahead, "_claims", [tmp_path])
    (tmp_path / "b").touch()  # by the other
    ahead.share((name, lambda name=name: done.append(name)) for name in "abcb")
    assert done == ["a", "c"]
    ahead.share((name, lambda name=name: done.append(name)) for name in "acd")
    assert done == ["a", "c", "d"]
    monkeypatch.setattr(ahead, "_claims", [tmp_path / "gone"])
    ahead.share([("b", lambda: done.append("b"))])
    assert done == ["a", "c", "d", "b"]


def test_what_a_process_has_claimed_is_compiled_though_it_dies(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second process claims everything and fails: the run links what it needs all the same."""
    from maggi.model.bodies import RigidBody
    from maggi.model.model import Model
    from maggi.stepping.stepper import Stepper
    from maggi.system.build import build_system

    stepper = Stepper(build_system(Model(bodies={"b": RigidBody(1.0)})), 0.9, 1e-8, 1.0, 1.0)
    start = subprocess.Popen
    monkeypatch.setattr(subprocess, "Popen", lambda _, **k: start([sys.executable, "-c", "raise SystemExit(1)"], **k))
    ahead.begin()
    monkeypatch.setattr(ahead, "_claim", lambda name: False)
    stepper.link()
    assert (stepper.small.links[:5] != 0).all()


def test_the_kernels_that_are_compiled_are_the_ones_that_runs_use(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from maggi.stepping import iteration

    claims = cache / "claims"
    claims.mkdir()
    monkeypatch.setattr(ahead, "_claims", [])
    ahead.compile_step(str(claims))
    assert (cache / ahead.MARKER).exists()
    assert {path.name for path in claims.iterdir()} == {
        *("evaluate", "refresh", "correct", "accept", "predict", "advance", "show", ahead.ROWS)
    }
    count = len(iteration.advance.signatures)
    from maggi.analyses.transient import run
    from maggi.model.bodies import RigidBody
    from maggi.model.model import Model
    from maggi.model.simulation import Simulation
    from maggi.results.memory import MemoryRecorder

    inertia = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    run(Model(bodies={"b": RigidBody(1.0, inertia=inertia)}, simulation=Simulation(0.01, 1e-3)), MemoryRecorder())
    assert len(iteration.advance.signatures) == count

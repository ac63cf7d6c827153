"""Compiling the step in two processes.

The step's kernels take longest to compile of all, and numba compiles in one thread. Where no compiled ones are kept yet, a
second process begins with them while the first reads and assembles the model, on the other core. The first helps from the
other end once it gets there: each stage is *claimed* by the one that compiles it, and the other loads it afterwards.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

MARKER = "step-compiled"
CLAIMS = "claims-"
ROWS = "rows-compiled"  # among the claims
_pending: list[subprocess.Popen[bytes]] = []
_claims: list[Path] = []  # the folder that both processes put their claims in


def begin() -> None:
    """Start compiling the step's kernels, unless this state of the sources has been compiled before."""
    folder = os.environ.get("NUMBA_CACHE_DIR")
    if folder is None or _pending or (Path(folder) / MARKER).exists() or (os.cpu_count() or 1) < 2:
        return
    quiet = subprocess.DEVNULL
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
        claims = tempfile.mkdtemp(prefix=CLAIMS, dir=folder)
        command = [sys.executable, "-c", f"from {__name__} import compile_step; compile_step({claims!r})"]
        _pending.append(subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet))
    except OSError:  # no second process is to be had: the first compiles when it needs to
        return
    _claims.append(Path(claims))


def announce(say: Callable[[str], None]) -> None:
    """Tell that a run waits for compilations, if it does."""
    if any(process.poll() is None for process in _pending):
        say("compiling the step's kernels (once per installation)")


def await_rows(meanwhile: Callable[[], object] | None = None) -> None:
    """Where the second process is compiling the liaisons' rows, do something else, then wait for them.

    That process begins with them, so the first, which needs them to look for the initial state, had better not.
    """
    if not _pending:
        return
    if meanwhile is not None:
        meanwhile()
    while _pending[0].poll() is None and not any((claims / ROWS).exists() for claims in _claims):
        time.sleep(0.01)


def share(compilations: Iterable[tuple[str, Callable[[], object]]]) -> None:
    """Carry out those that no other process has claimed, in this order."""
    for name, compilation in compilations:
        if _claim(name):
            compilation()


def _claim(name: str) -> bool:
    for claims in _claims:
        try:
            (claims / name).touch(exist_ok=False)
        except FileExistsError:
            return False
        except OSError:  # the folder is gone, and so is the other process
            return True
    return True


def finish() -> None:
    """Wait for the second process, if there is one; whatever became of it, the kernels can now be called."""
    while _pending:
        process = _pending.pop()
        try:
            process.wait()
        except BaseException:
            process.kill()
            raise
        finally:
            for claims in _claims:
                shutil.rmtree(claims, ignore_errors=True)
            _claims.clear()


def compile_step(claims: str) -> None:
    """Compile the step's kernels as `Stepper` calls them, as far as nobody else claims them, and leave a marker.

    First the liaisons' rows, by which the first process looks for the initial state once its meshes are assembled.
    """
    from maggi.model.bodies import RigidBody
    from maggi.model.model import Model
    from maggi.system.build import build_system
    from maggi.system.dense import dense_rows

    from .linking import compilations
    from .stepper import Stepper

    _claims.append(Path(claims))
    system = build_system(Model(bodies={"body": RigidBody(1.0)}))
    dense_rows(system, system.start, 0.0)
    (Path(claims) / ROWS).touch()
    stepper = Stepper(system, 0.9, 1e-8, 1.0, 1.0)
    share(compilations(stepper.small, stepper.trial, stepper.work, stepper.state, stepper.record).items())
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    (folder / MARKER).touch()

"""Compiling the step ahead of its use, in a second process.

The step's kernel takes longest to compile of all, and numba compiles in one thread. Where no compiled one is kept yet, a
second process makes it while the first reads and assembles the model, on the other core; the first then loads it.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

MARKER = "step-compiled"
_pending: list[subprocess.Popen[bytes]] = []


def begin() -> None:
    """Start compiling the step's kernel, unless this state of the sources has been compiled before."""
    folder = os.environ.get("NUMBA_CACHE_DIR")
    if folder is None or _pending or (Path(folder) / MARKER).exists() or (os.cpu_count() or 1) < 2:
        return
    command = [sys.executable, "-c", f"from {__name__} import compile_step; compile_step()"]
    quiet = subprocess.DEVNULL
    try:
        _pending.append(subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet))
    except OSError:  # no second process is to be had: the first compiles when it needs to
        return


def finish(announce: Callable[[str], None]) -> None:
    """Wait for the second process, if there is one; whatever became of it, the kernel can now be called."""
    while _pending:
        process = _pending.pop()
        if process.poll() is None:
            announce("compiling the step's kernels (once per installation)")
        try:
            process.wait()
        except BaseException:
            process.kill()
            raise


def compile_step() -> None:
    """Compile the step's kernel as `Stepper` calls it, without a step being made, and leave a marker.

    First the liaisons' rows, by which the first process looks for the initial state once its meshes are assembled.
    """
    from maggi.model.bodies import RigidBody
    from maggi.model.model import Model
    from maggi.system.build import build_system
    from maggi.system.dense import dense_rows

    from .stepper import Stepper

    system = build_system(Model(bodies={"body": RigidBody(1.0)}))
    dense_rows(system, system.start, 0.0)
    stepper = Stepper(system, 0.9, 1e-8, 1.0, 1.0)
    stepper.link()
    stepper.advance(0.0, 0)
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    (folder / MARKER).touch()

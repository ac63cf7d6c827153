"""The functions of the package itself: ``maggi.load``, ``check``, ``compare``, ``ode``, ``linearize``, ``run``, ``open``."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from maggi.analyses.audit_report import Audit
    from maggi.analyses.compare_formulations import Comparison
    from maggi.analyses.linearize import Linearization
    from maggi.analyses.ode import Ode
    from maggi.analyses.recorder import Progress
    from maggi.bodies.tables import MotionState
    from maggi.model.model import Model
    from maggi.results.results import Results
    from maggi.system.system import System


def load(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Model:
    """The model that a YAML or JSON file describes.

    Parameters
    ----------
    overrides : texts ``key=value`` that replace single values, such as ``simulation.step=1e-6``.

    Raises
    ------
    ModelErrors : every mistake found, each with file, line, column and remedy.
    """
    from maggi.modelfile import read

    return read(path, overrides)[0]


def check(model: Model, progress: Progress | None = None) -> Audit:
    """What a model is, without running it: masses, node sets, liaisons, freedoms, rank; see `Audit`.

    Raises
    ------
    ModelError : the model cannot be assembled.
    """
    from maggi.analyses.audit import audit

    return audit(model, progress)


def compare(model: Model) -> Comparison:
    """Accelerations and joint forces at t = 0 by five formulations, and how far they are apart; see `Comparison`.

    Raises
    ------
    ModelError : the model cannot be assembled, has no consistent initial state, or has a body without points.
    """
    from maggi.analyses.compare_formulations import compare_formulations

    return compare_formulations(model)


def ode(model: Model | System, *, strategy: str | None = None) -> Ode:
    """The equations of motion as y' = f(t, y) in the true freedoms, from the initial state on; see `Ode`.

    Parameters
    ----------
    strategy : how independent velocities are chosen: ``lu``, ``qr``, ``svd``, ``tree``; by structure where not given.

    Raises
    ------
    ModelError : the model cannot be assembled, has no consistent initial state, or a force on what has no inertia.
    """
    from maggi.analyses.ode import equations_of

    return equations_of(model, strategy=strategy)


def linearize(model: Model | System, state: MotionState | None = None, t: float = 0.0) -> Linearization:
    """The linearised equations about a state, such as an equilibrium or a steady motion; see `Linearization`.

    Parameters
    ----------
    state : positions and velocities at time t (s) that the liaisons admit; the initial state where not given.

    Raises
    ------
    ModelError : as for `ode`.
    """
    from maggi.analyses.linearize import linearize as about

    return about(model, state, t)


def run(model: Model, output: str | os.PathLike[str] | None = None, progress: Progress | None = None) -> Results:
    """Simulate a model; its `simulation` says how long and how fine.

    What the user should know of a run that went well is given as `UserWarning`.

    Parameters
    ----------
    output : a result file (HDF5) to write; without it the results are kept in memory.
    progress : told how far the run is.

    Returns
    -------
    The results; of a file they are a context manager, to be closed.

    Raises
    ------
    ModelError : a mistake in the model.
    SimulationError : the run cannot go on. What was computed up to there is kept in the file.
    """
    from maggi.analyses.transient import run as simulate
    from maggi.results.memory import MemoryRecorder

    if output is None:
        memory = MemoryRecorder(model.outputs.quantities, model.text)
        _warn(simulate(model, memory, progress).warnings)
        return memory.results()
    from maggi.results.read import read
    from maggi.results.store import FileRecorder

    file = FileRecorder(os.fspath(output), model.outputs.quantities, model.text)
    try:
        summary = simulate(model, file, progress)
    except BaseException as error:
        file.end(f"failed: {type(error).__name__}: {error}")  # does nothing where the run has ended it itself
        raise
    _warn(summary.warnings)
    return read(os.fspath(output))


def open(path: str | os.PathLike[str]) -> Results:  # noqa: A001
    """Open a result file; use as ``with maggi.open("run.h5") as results:``.

    Raises
    ------
    ModelError : there is no such file, or it is not a result file.
    """
    from maggi.results.read import read

    return read(os.fspath(path))


def _warn(texts: Sequence[str]) -> None:
    for text in texts:
        warnings.warn(text, stacklevel=3)

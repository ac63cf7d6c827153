"""Exudyn set up to run fast: its module without range checks, no files, no sensors, one thread, the best solver found.

Everything that imports Exudyn does so through `load`, because the fast module must be asked for before the first import.
"""

from __future__ import annotations

import contextlib
import io
import sys
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from common.timing import cpu_seconds

Array = NDArray[np.float64]


def load() -> ModuleType | None:
    """The module, or None where it is not installed (it has no wheel for some Pythons and platforms)."""
    sys.exudynFast = True  # type: ignore[attr-defined]
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            import exudyn
            import exudyn.FEM
            import exudyn.utilities
        except ImportError:
            return None
    return exudyn


@dataclass(frozen=True)
class Settings:
    """How the equations are solved. `solver`: a `LinearSolverType`; `method`: a `DynamicSolverType`.

    modified : keep the Jacobian as long as the iteration contracts. redundant : go on where it is singular. The
    tolerances are Exudyn's defaults, and the relative one is ours too.
    """

    solver: str = "EigenSparse"
    modified: bool = True
    redundant: bool = False
    method: str = "GeneralizedAlpha"
    rho_inf: float = 0.9
    tolerance: float = 1e-8

    def __str__(self) -> str:
        kept = ", modified Newton" if self.modified else ", full Newton"
        return f"{self.solver}{kept}" if self.method == "GeneralizedAlpha" else self.method


IMPLICIT = tuple(
    Settings(solver, modified)
    for solver in ("EXUdense", "EigenDense", "EigenSparse", "EigenSparseSymmetric")
    for modified in (True, False)
)
SPARSE = tuple(settings for settings in IMPLICIT if "Sparse" in settings.solver)
# With elastic bodies a Jacobian, by differences, costs many residuals: full Newton is never quicker.
KEPT = tuple(settings for settings in IMPLICIT if "ense" in settings.solver and settings.modified)
DENSE = tuple(settings for settings in IMPLICIT if "ense" in settings.solver)


@dataclass
class Peer:
    """An assembled Exudyn system: what it is called, the system, and the position (3,) to compare at the end (m)."""

    name: str
    mbs: Any
    point: Callable[[], Array]
    settings: Settings = Settings()
    sensor: Any = None  # stores the point's path where a run asks for it
    iterations: float = 0.0  # Newton iterations of a step in the last run
    jacobians: float = 0.0

    def run(self, h: float, steps: int, every: int = 0, file: str = "") -> float:
        """Seconds of a step (s) of the run from t = 0; setting up the solver does not count.

        every : have sensors, and the point for `path`, stored after every so many steps. file : write its solution file as often. Raises RuntimeError where Exudyn fails.
        """
        exudyn = load()
        assert exudyn is not None
        chosen = self.settings
        options = self._options(exudyn, h, steps)
        options.solution.sensors.active = every > 0
        options.solution.sensors.writePeriod = every * h
        options.solution.file.write = bool(file)
        if file:
            options.solution.file.name, options.solution.file.writePeriod = file, every * h
        implicit = chosen.method == "GeneralizedAlpha"
        solver = exudyn.MainSolverImplicitSecondOrder() if implicit else exudyn.MainSolverExplicit()
        done = False

        def action() -> None:
            nonlocal done
            done = solver.SolveSteps(self.mbs, options)

        with _silent():
            if not solver.InitializeSolver(self.mbs, options):
                raise RuntimeError("Exudyn does not start")
            seconds = cpu_seconds(action)
            solver.FinalizeSolver(self.mbs, options)
        if not done:
            raise RuntimeError("Exudyn's iteration does not converge")
        self.iterations = solver.it.newtonStepsCount / steps
        self.jacobians = solver.it.newtonJacobiCount / steps
        return seconds / steps

    def path(self) -> Array:
        """The point's positions (k, 3) at the start and after every so many steps of the last run that kept them."""
        return np.array(self.mbs.GetSensorStoredData(self.sensor))[:, 1:4]

    def _options(self, exudyn: ModuleType, h: float, steps: int) -> Any:
        chosen = self.settings
        options = exudyn.SimulationSettings()
        time = options.timeIntegration
        time.numberOfSteps, time.endTime = steps, h * steps
        time.adaptiveStep = False
        time.verboseMode = time.stepInformation = 0
        time.solverType = getattr(exudyn.DynamicSolverType, chosen.method)
        time.generalizedAlpha.spectralRadius = chosen.rho_inf
        time.newton.useModifiedNewton = chosen.modified
        time.newton.relativeTolerance = chosen.tolerance
        options.linearSolver.solverType = getattr(exudyn.LinearSolverType, chosen.solver)
        options.linearSolver.reuseAnalyzedPattern = True
        options.linearSolver.ignoreSingularJacobian = chosen.redundant
        options.solution.file.write = False
        options.parallel.numberOfThreads = 1
        return options

    def tuned(self, candidates: Iterable[Settings], h: float, steps: int, trials: int = 2) -> Peer:
        """With the quickest of the candidates; those that fail are passed over."""
        times: dict[Settings, float] = {}
        for settings in candidates:
            trial = replace(self, settings=settings)
            with contextlib.suppress(RuntimeError):
                times[settings] = min(trial.run(h, steps) for _ in range(trials))
        if not times:
            raise RuntimeError(f"Exudyn fails on {self.name} with every setting")
        return replace(self, settings=min(times, key=lambda settings: times[settings]))


def quickest(peers: Iterable[Peer], candidates: Iterable[Settings], h: float, steps: int) -> Peer:
    """The quickest of several models of the same mechanism, each with its quickest settings."""
    settings = tuple(candidates)
    tuned = [peer.tuned(settings, h, steps) for peer in peers]
    return min(tuned, key=lambda peer: min(peer.run(h, steps) for _ in range(2)))


@contextlib.contextmanager
def _silent():  # type: ignore[no-untyped-def]
    """Exudyn prints through Python's stdout; a benchmark's tables should stand alone."""
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield

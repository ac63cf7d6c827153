"""A transient run: rows, progress, and how it went, whatever method takes it on."""

from __future__ import annotations

import hashlib
import time
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.threads import one_blas_thread
from maggi.model.errors import ModelError, SimulationError
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.stepping.stepper import Counts

from .alpha_run import AlphaRun
from .prepare import built, checked, prepare
from .recorder import Progress, Recorder, Silent
from .snapshot import Present, Snapshots, layout, next_row

Array = NDArray[np.float64]

LARGE_ROTATION = 0.2  # rad; beyond it the linear-elastic floating frame ends (Theory §3)
SHOW_SECONDS = 0.1  # between two looks at progress, after which rows are handed on, too


@dataclass(frozen=True, eq=False)
class RunSummary:
    """How a run went.

    iterations : corrections of the small system. rejected : steps whose local error was too large. residuals (3,): the largest scaled liaison residuals of the stored
    rows. energy_balance : the largest |T + U + G + dissipated − work − start| over the energy exchanged; numerical_loss
    (J): the same at the end with its sign, what ρ∞ < 1 and the step's error have taken (positive) or given.
    """

    steps: int
    iterations: int
    back_substitutions: int
    factorisations: int
    restarts: int
    rejected: int
    residuals: Array
    energy_balance: float
    numerical_loss: float
    warnings: tuple[str, ...]
    seconds: float
    timings: dict[str, float] = field(default_factory=dict)


def run(model: Model, recorder: Recorder, progress: Progress | None = None, *, exact: bool = False) -> RunSummary:
    """Simulate a model; rows go to `recorder`, whose `end` is called however the run ends.

    exact : iterate every step to round-off (for comparisons).

    Raises ModelError for a mistake in the model, SimulationError for a run that cannot go on, KeyboardInterrupt
    after an interrupt.
    """
    progress = progress or Silent()
    began = time.perf_counter()
    try:
        with one_blas_thread():
            return _Run(model, recorder, progress, exact).run(began)
    except KeyboardInterrupt:
        recorder.end("interrupted")
        raise
    except (SimulationError, ModelError) as error:
        recorder.end(f"failed: {error}")
        raise


class March(Present, Protocol):
    """A way through a run: `advance` takes it on from nominal step to nominal step."""

    @property
    def counts(self) -> Counts: ...

    def advance(self, done: int) -> int:
        """Go on from nominal step `done`; how many steps that was. Raises SimulationError.

        Where a row is to be, it ends, or keeps the instant in `record`.
        """

    def note(self) -> str:
        """How it goes, for whoever watches."""


class _Run:
    """One run from start to end."""

    def __init__(self, model: Model, recorder: Recorder, progress: Progress, exact: bool) -> None:
        self._model = model
        self._recorder = recorder
        self._progress = progress
        self._exact = exact
        self._residuals = np.zeros(3)
        self._energies: list[Array] = []

    def run(self, began: float) -> RunSummary:
        simulation = checked(self._model)
        notes: list[str] = []
        timings: dict[str, float] = {}
        march = self._march(simulation, notes, timings)
        self._snapshots = Snapshots(march)
        steps = round(simulation.duration / simulation.step)
        every = self._model.outputs.every
        rows = 1 + -(-steps // every)
        self._recorder.begin(layout(march.system, rows, self._attributes(simulation)))
        self._snapshots.take(0)
        self._write(march, simulation.step)
        clock = time.perf_counter()
        writing = self._loop(march, simulation, steps, every)
        timings["steps"] = time.perf_counter() - clock - writing
        timings["rows"] = writing
        self._recorder.end("complete")
        angle, attachment = self._snapshots.largest_rotation
        if angle > LARGE_ROTATION:
            notes.append(
                f"attachment {attachment} turns by up to {angle:.2g} rad relative to its body: "
                "beyond about 0.2 rad a linear-elastic body on a floating frame is no longer accurate"
            )
        if self._snapshots.shared:
            notes.append(
                f"joints repeat each other: the forces of {', '.join(self._snapshots.shared)} are not unique, and are "
                "the least that do the same (`maggi check` names the rows; elastic bodies would share them)"
            )
        balance, loss = _balance(np.concatenate(self._energies))
        return _summary(march.counts, self._residuals, balance, loss, notes, time.perf_counter() - began, timings)

    def _march(self, simulation: Simulation, notes: list[str], timings: dict[str, float]) -> March:
        """What the model's method is, at t = 0."""
        if simulation.method == "generalized-alpha":
            stepper, _, said, took = prepare(self._model, self._progress, exact=self._exact)
            notes += said
            timings |= took
            clock = time.perf_counter()
            stepping = AlphaRun(stepper, simulation, self._model.outputs.every)
            timings["factorisation"] = time.perf_counter() - clock
            return stepping
        system = built(self._model, self._progress, timings, dense=True)
        clock = time.perf_counter()
        from .ode_run import OdeRun  # not at the start of every run: it brings much along

        run = OdeRun(system, simulation, self._model.outputs.every, notes, self._progress.stage)
        timings["start"] = time.perf_counter() - clock
        return run

    def _loop(self, march: March, simulation: Simulation, steps: int, every: int) -> float:
        """Go on to the end; returns the seconds that went into rows."""
        done, last, writing = 0, 0, 0.0  # last: the nominal step of the last row
        shown = time.perf_counter()
        try:
            while done < steps:
                done += march.advance(done)
                reached = time.perf_counter()
                last = max(last, march.record.last_step())
                if done > last and done == next_row(done - 1, steps, every):
                    self._snapshots.take(done)
                    last = done
                due = reached - shown > SHOW_SECONDS or done == steps
                if due or not march.record.room:
                    self._write(march, simulation.step)
                writing += time.perf_counter() - reached
                if due:
                    shown = reached
                    self._progress.advance(done, steps, done * simulation.step, march.note())
        finally:  # whatever was reached is kept
            self._write(march, simulation.step)
        return writing

    def _write(self, march: March, step: float) -> None:
        if not march.record.kept:
            return
        rows = self._snapshots.rows(step)
        self._residuals = np.maximum(self._residuals, rows.residuals.max(axis=0))
        self._energies.append(rows.energy)
        self._recorder.write(rows)

    def _attributes(self, simulation: Simulation) -> dict[str, str | float | int]:
        text = self._model.text
        return {
            "title": self._model.title,
            "model": text,
            "model_sha256": hashlib.sha256(text.encode()).hexdigest(),
            "duration": simulation.duration,
            "step": simulation.step,
            "rho_inf": simulation.rho_inf,
            "tolerance": simulation.tolerance,
            "method": simulation.method,
            "start": simulation.start,
            **({} if simulation.accuracy is None else {"accuracy": simulation.accuracy}),
        }


def _balance(energies: Array) -> tuple[float, float]:
    """Largest defect of the energy balance over the energy exchanged, and the energy lost at the end (J)."""
    total = energies[:, :4].sum(axis=1) - energies[:, 4]
    exchanged = float(np.ptp(energies, axis=0).max())
    defect = total - total[0]
    # where nothing is exchanged there is only the round-off of the energies themselves
    nothing = exchanged <= 1e-12 * float(np.abs(energies).max())
    return (0.0 if nothing else float(np.abs(defect).max()) / exchanged), float(-defect[-1])


def _summary(
    counts: Counts,
    residuals: Array,
    balance: float,
    loss: float,
    notes: list[str],
    seconds: float,
    timings: dict[str, float],
) -> RunSummary:
    return RunSummary(
        counts.steps,
        counts.corrections,
        counts.back_substitutions,
        counts.factorisations,
        counts.restarts,
        counts.rejected,
        residuals,
        balance,
        loss,
        tuple(notes),
        seconds,
        timings,
    )

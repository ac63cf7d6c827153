"""A transient run: start, steps, rows, progress; smaller steps where the iteration fails, a message where it cannot."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.threads import one_blas_thread
from maggi.model.bodies import ElasticBody
from maggi.model.errors import ModelError, SimulationError
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.stepping import ahead
from maggi.stepping.stepper import Counts, Stepper
from maggi.stepping.tables import ITERATIONS
from maggi.system.build import RecordedMotion, build_system, has_recorded_motion
from maggi.system.system import System

from .adaptive import AdaptiveSteps
from .initial import initial_motion, set_velocities
from .recorder import Progress, Recorder
from .snapshot import Present, Snapshots, layout, next_row

if TYPE_CHECKING:
    from maggi.bodies.mesh_body import MeshBody

Array = NDArray[np.float64]

HALVINGS = 6  # a step that fails is tried in up to 2⁶ parts
LARGE_ROTATION = 0.2  # rad; beyond it the linear-elastic floating frame ends (Theory §3)
SHOW_SECONDS = 0.1  # between two looks at progress, after which rows are handed on, too
CHUNK_SECONDS = 0.1  # of compiled steps between two looks at progress and interrupts


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


class Silent:
    """Progress for nobody."""

    def stage(self, text: str) -> None:
        """See `Progress.stage`."""

    def advance(self, step: int, steps: int, time: float, note: str) -> None:
        """See `Progress.advance`."""


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


def prepare(
    model: Model, progress: Progress | None = None, *, exact: bool = False
) -> tuple[Stepper, Simulation, list[str], dict[str, float]]:
    """A stepper at t = 0 with consistent positions, velocities, accelerations and forces, and what was noted."""
    progress = progress or Silent()
    simulation = checked(model)
    notes: list[str] = []
    timings: dict[str, float] = {}
    system = _built(model, progress, timings)
    clock = time.perf_counter()
    stepper = started(system, simulation, notes, progress.stage, exact=exact)
    timings["start"] = time.perf_counter() - clock
    return stepper, simulation, notes, timings


def checked(model: Model) -> Simulation:
    """The model's simulation; ModelError where there is none, or no step in it."""
    simulation = model.simulation
    if simulation is None:
        raise ModelError(
            "the model has no simulation", path="simulation", remedy="add `simulation: {duration: …, step: …}`"
        )
    if round(simulation.duration / simulation.step) < 1:
        raise ModelError(
            f"the duration {simulation.duration:g} s is shorter than a step of {simulation.step:g} s",
            path="simulation.step",
            remedy="make the step smaller or the duration longer",
        )
    return simulation


def _built(model: Model, progress: Progress, timings: dict[str, float], *, dense: bool = False) -> System:
    """The system, after a run with rigid bodies where frames follow one; dense: without nodal freedoms."""
    clock = time.perf_counter()
    meshes: dict[str, MeshBody] = {}
    recorded: dict[str, RecordedMotion] = {}
    following = has_recorded_motion(model)
    if following:
        recorded, meshes = rigid_run(model, following, progress)
        timings["rigid run"] = time.perf_counter() - clock
        clock = time.perf_counter()
    system = build_system(model, recorded=recorded, dense=dense, meshes=meshes, announce=progress.stage)
    bodies = system.mesh_bodies.values()
    ahead.await_rows((lambda: _compile_passes(bodies)) if bodies else None)
    timings["assembly"] = time.perf_counter() - clock
    return system


def _compile_passes(bodies: Iterable[MeshBody]) -> None:
    from maggi.stepping.mesh_passes import compile_passes  # others do without what meshes need

    compile_passes(solids=any(body.freedoms is not None for body in bodies))


def started(
    system: System, simulation: Simulation, notes: list[str], announce: Callable[[str], None], *, exact: bool = False
) -> Stepper:
    """A stepper at the initial state."""
    gravity = float(np.linalg.norm(system.forces.gravity))
    slowest = 1e-3 * system.size / simulation.duration
    stepper = Stepper(
        system,
        simulation.rho_inf,
        simulation.tolerance,
        slowest,
        max(gravity, slowest / simulation.duration),
        exact=exact,
        announce=announce,
    )
    announce("finding the initial state")
    motion = initial_motion(system, notes)
    if simulation.start == "quasi-static" and stepper.has_elastic():
        from .quasi_static import quasi_static_start

        quasi_static_start(system, motion, stepper.meshes, simulation.step)
        set_velocities(system, motion, [])  # what there is to tell was told for the undeformed bodies
    for target, source in zip(stepper.state.now, motion, strict=True):
        target[:] = source
    stepper.start_accelerations(0.0)
    return stepper


def rigid_run(
    model: Model, following: list[str], progress: Progress
) -> tuple[dict[str, RecordedMotion], dict[str, MeshBody]]:
    """The motion of frames in a run of the same mechanism with all its elastic bodies rigid."""
    progress.stage("running the mechanism with rigid bodies")
    simulation = model.simulation
    assert simulation is not None
    elastic = frozenset(name for name, body in model.bodies.items() if isinstance(body, ElasticBody))
    meshes: dict[str, MeshBody] = {}
    system = build_system(model, rigid=elastic, meshes=meshes, announce=progress.stage)
    stepper = started(system, simulation, [], progress.stage)
    driver = _Advance(stepper, simulation)
    steps = round(simulation.duration / simulation.step)
    frames = {name: system.body(name).index for name in following}
    history: dict[str, list[tuple[Array, ...]]] = {name: [] for name in following}
    for k in range(steps + 1):
        if k:
            driver.steps(k - 1, 1)
        motion = stepper.state.now
        for name, b in frames.items():
            o = int(system.bodies.offset[b])
            history[name].append(
                (
                    motion.origin[b].copy(),
                    motion.rotation[b].copy(),
                    motion.v[o : o + 6].copy(),
                    motion.vd[o : o + 6].copy(),
                )
            )
    return {
        name: RecordedMotion(simulation.step, *(np.array(part) for part in zip(*rows, strict=True)))
        for name, rows in history.items()
    }, meshes


class _Advance:
    """Nominal steps, halved where the iteration fails.

    every : keep an instant for a row after every so many steps, 0 for none. See `Stepper.keep`.
    """

    def __init__(self, stepper: Stepper, simulation: Simulation, every: int = 0) -> None:
        self._stepper = stepper
        self._h = simulation.step
        self._every, self._last = every, round(simulation.duration / simulation.step)
        self._stepper.set_step(self._h)

    def steps(self, first: int, count: int) -> None:
        """Steps first … first + count − 1; raises SimulationError where even 2⁶ parts of one fail."""
        stepper, every, last, done = self._stepper, self._every, self._last, 0
        while done < count:
            stepper.keep(first + done, every, last)
            done += stepper.advance((first + done) * self._h, count - done)
            if done < count:
                stepper.keep(0, 0, 0)
                self._in_parts(first + done)
                done += 1
                if every and first + done == next_row(first + done - 1, last, every):
                    stepper.state.counts[ITERATIONS] = stepper.last_iterations
                    stepper.record.keep(stepper.state, first + done)

    def _in_parts(self, k: int) -> None:
        stepper = self._stepper
        whole = 2**HALVINGS
        part, position = whole, 0
        while position < whole:
            if part == 1 and stepper.coefficients.h <= self._h / whole:
                raise stepper.failure(self._h * (k + (position + 1) / whole))
            part //= 2
            stepper.counts.restarts += 1
            stepper.set_step(self._h * part / whole)
            count = (whole - position) // part
            position += part * stepper.advance(self._h * (k + position / whole), count)
        stepper.set_step(self._h)


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


class _Stepping:
    """A run of generalised-α steps, in chunks that grow until a call's own cost vanishes."""

    def __init__(self, stepper: Stepper, simulation: Simulation, every: int) -> None:
        self.system, self.state, self.meshes = stepper.system, stepper.state, stepper.meshes
        self.counts, self.record = stepper.counts, stepper.record
        self._stepper = stepper
        self._steps, self._every = round(simulation.duration / simulation.step), every
        self._adaptive = simulation.accuracy is not None
        self._through_rows = not (self._adaptive or self.meshes)  # as many as there is room for
        self._advance = (
            _Advance(stepper, simulation, every if self._through_rows else 0)
            if simulation.accuracy is None
            else AdaptiveSteps(stepper, simulation.step, simulation.accuracy)
        )
        self._chunk = 1

    @property
    def last_iterations(self) -> int:
        """Back-substitutions or corrections of the last step."""
        return self._stepper.last_iterations

    def dissipated(self) -> float:
        """See `Stepper.dissipated`."""
        return self._stepper.dissipated()

    def advance(self, done: int) -> int:
        """See `March.advance`."""
        until = next_row(done, self._steps, self._every)
        if self._through_rows:
            until = min(self._steps, until + (self.record.room - 1) * self._every)
        count = min(self._chunk, until - done)
        began = time.perf_counter()
        self._advance.steps(done, count)
        if count == self._chunk:
            took = max(time.perf_counter() - began, 1e-6)
            self._chunk = max(1, min(2 * self._chunk, int(self._chunk * CHUNK_SECONDS / took)))
        return count

    def note(self) -> str:
        """See `March.note`."""
        per_step = self.counts.back_substitutions / max(1, self.counts.steps)
        parts = [f"{per_step:.2f} solves a step"] if self.meshes else []
        if self._adaptive:
            parts.append(f"steps of {self._stepper.coefficients.h:.2g} s")
        return ", ".join(parts)


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
            stepping = _Stepping(stepper, simulation, self._model.outputs.every)
            timings["factorisation"] = time.perf_counter() - clock
            return stepping
        system = _built(self._model, self._progress, timings, dense=True)
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

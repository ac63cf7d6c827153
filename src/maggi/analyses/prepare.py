"""From a model to a stepper at t = 0, after a run with rigid bodies where frames follow one."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maggi.model.bodies import ElasticBody
from maggi.model.errors import ModelError
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.stepping import ahead
from maggi.stepping.stepper import Stepper
from maggi.system.build import RecordedMotion, build_system, has_recorded_motion
from maggi.system.system import System

from .fixed_steps import FixedSteps
from .initial import initial_motion, set_velocities
from .recorder import Progress, Silent

if TYPE_CHECKING:
    from maggi.bodies.mesh_body import MeshBody

Array = NDArray[np.float64]


def prepare(
    model: Model, progress: Progress | None = None, *, exact: bool = False
) -> tuple[Stepper, Simulation, list[str], dict[str, float]]:
    """A stepper at t = 0 with consistent positions, velocities, accelerations and forces, and what was noted."""
    progress = progress or Silent()
    simulation = checked(model)
    notes: list[str] = []
    timings: dict[str, float] = {}
    system = built(model, progress, timings)
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


def built(model: Model, progress: Progress, timings: dict[str, float], *, dense: bool = False) -> System:
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
    driver = FixedSteps(stepper, simulation)
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

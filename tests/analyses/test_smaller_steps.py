"""A step whose iteration fails is done in parts; where no part is small enough, the run ends and keeps what it has.

A body spinning at ω about its principal axis of largest inertia, with a small wobble: gyroscopic terms are explicit in
the iteration, which contracts in proportion to hω and so fails at hω = 2.4 and 8, and not at 1.2.
"""

from __future__ import annotations

import numpy as np
import pytest

from maggi.analyses.transient import run
from maggi.model.bodies import RigidBody
from maggi.model.errors import SimulationError
from maggi.model.geometry import Velocity
from maggi.model.model import Model
from maggi.model.simulation import Outputs, Simulation
from maggi.results.memory import MemoryRecorder

INERTIA = ((1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.5))
STEP = 1e-2


def spinning(speed: float, step: float = STEP, every: int = 1) -> Model:
    wheel = RigidBody(1.0, inertia=INERTIA, velocity=Velocity(angular=(0.2 * speed, 0.1 * speed, speed)))
    return Model(
        bodies={"wheel": wheel},
        simulation=Simulation(10 * STEP, step, rho_inf=1.0),
        outputs=Outputs(every),
    )


def test_a_failing_step_is_done_in_parts_and_rows_stay_where_they_are() -> None:
    recorder = MemoryRecorder()
    summary = run(spinning(800.0), recorder)
    assert summary.restarts > 0
    results = recorder.results()
    assert np.allclose(results.time[:], STEP * np.arange(11), rtol=0.0, atol=1e-15)
    # energy of free rotation, from the inertia and the given velocity
    kinetic = 0.5 * 800.0**2 * (1.0 * 0.2**2 + 2.0 * 0.1**2 + 2.5)
    assert results.energy.kinetic[0] == pytest.approx(kinetic, rel=1e-12)


def test_a_failed_attempt_leaves_no_trace() -> None:
    # every step fails and is done in halves: the same steps as those of a run with half the nominal step
    first, second = MemoryRecorder(), MemoryRecorder()
    halved = run(spinning(240.0), first)
    half = run(spinning(240.0, STEP / 2.0, every=2), second)
    assert (halved.restarts, half.restarts) == (10, 0)
    for name in ("rotation", "origin"):
        a, b = (getattr(recorder.results().body("wheel"), name) for recorder in (first, second))
        assert np.abs(a[:] - b[:]).max() < 1e-6


def test_a_run_that_no_part_saves_ends_with_a_message_and_keeps_its_rows() -> None:
    recorder = MemoryRecorder()
    with pytest.raises(SimulationError, match=r"t = .*s.*smaller step"):
        run(spinning(1e6), recorder)
    results = recorder.results()
    assert results.status.startswith("failed")
    assert len(results.time) >= 1 and np.isfinite(results.body("wheel").rotation[:]).all()

"""Rows of results: the same however many instants they are made of at once, at the times that were asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linkages import four_bar, random_mechanism
from motions import ritz_body

from maggi.analyses.snapshot import next_row
from maggi.analyses.transient import run
from maggi.model.bodies import RigidBody
from maggi.model.errors import SimulationError
from maggi.model.geometry import Velocity
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.model.simulation import QUANTITIES, Outputs, Simulation
from maggi.results.contract import columns
from maggi.results.memory import MemoryRecorder
from maggi.stepping.stepper import Stepper

STEP, STEPS = 1e-3, 61


def elastic() -> Model:
    """A Ritz body between ground and a rigid one."""
    rng = np.random.default_rng(2)
    ends = {"root": (0.0, 0.0, 0.0), "tip": (0.2, 0.1, 0.0)}
    bodies = {"beam": ritz_body(rng, **ends), "weight": RigidBody(0.3, inertia=np.diag([0.01, 0.02, 0.015]))}
    hinge = Joint("revolute", End("ground"), End("beam", "root"), axis=(0.0, 1.0, 0.3))
    ball = Joint("spherical", End("beam", "tip"), End("weight"))
    return Model(bodies, {"hinge": hinge, "ball": ball}, gravity=(0.0, 1.0, -9.81))


MODELS = {
    "four-bar whose rows repeat each other": four_bar,
    "loops": lambda: random_mechanism(5, 6, 3, ["revolute", "cylindrical", "spherical"]),
    "tree": lambda: random_mechanism(3, 5, 0, ["revolute", "universal", "prismatic"]),
    "elastic": elastic,
    "free body": lambda: Model({"top": RigidBody(1.0, velocity=Velocity(angular=(1.0, 2.0, 30.0)))}),
}


class Kept(MemoryRecorder):
    """Remembers how many rows came at once."""

    def __init__(self) -> None:
        super().__init__()
        self.sizes: list[int] = []

    def begin(self, layout):
        self.paths = [column.path for column in columns(layout, QUANTITIES)]
        super().begin(layout)

    def write(self, rows) -> None:
        self.sizes.append(len(rows.time))
        super().write(rows)


def rows_of(model: Model, every: int, most: int, monkeypatch) -> tuple[dict[str, np.ndarray], list[int]]:
    monkeypatch.setattr("maggi.stepping.stepper.MOST_KEPT", most)
    recorder = Kept()
    simulation = Simulation(STEPS * STEP, STEP, start="undeformed")
    run(replace(model, simulation=simulation, outputs=Outputs(every)), recorder)
    results = recorder.results()
    source = results._source
    return {
        path: np.asarray(source.table(path)) for path in recorder.paths if source.table(path) is not None
    }, recorder.sizes


@pytest.mark.parametrize("every", [1, 7])
@pytest.mark.parametrize("name", MODELS)
def test_rows_are_the_same_one_by_one_and_many_at_once(name: str, every: int, monkeypatch) -> None:
    one_by_one, sizes = rows_of(MODELS[name](), every, 1, monkeypatch)
    assert set(sizes) == {1}
    at_once, sizes = rows_of(MODELS[name](), every, 256, monkeypatch)
    assert max(sizes) > 1
    expected = [*range(0, STEPS, every), STEPS]
    np.testing.assert_array_equal(at_once["time"], np.array(expected) * STEP)
    for path, values in one_by_one.items():
        np.testing.assert_array_equal(at_once[path], values, err_msg=path)


def test_rows_keep_their_own_numbers(monkeypatch) -> None:
    """Not views of what the next instants are written into."""
    values, _ = rows_of(four_bar(), 1, 256, monkeypatch)
    for path in ("energy/kinetic", "residuals/velocity"):
        assert len(np.unique(values[path])) > STEPS // 2


@pytest.mark.parametrize("every", [1, 3, 10, 100])
def test_the_next_row(every: int) -> None:
    found, done = [0], 0
    while done < STEPS:
        done = next_row(done, STEPS, every)
        found.append(done)
    assert found == [*range(0, STEPS, every), STEPS]


@pytest.mark.parametrize("stop", [SimulationError("no further"), KeyboardInterrupt()], ids=["failure", "interrupt"])
def test_what_was_kept_before_a_run_ended_is_written(stop: BaseException, monkeypatch) -> None:
    advance, calls = Stepper.advance, []

    def stopped(stepper: Stepper, t: float, steps: int) -> int:
        calls.append(advance(stepper, t, steps))
        if sum(calls) > 20:
            raise stop
        return calls[-1]

    monkeypatch.setattr(Stepper, "advance", stopped)
    recorder = MemoryRecorder()
    with pytest.raises(type(stop)):
        run(replace(four_bar(), simulation=Simulation(STEPS * STEP, STEP)), recorder)
    results = recorder.results()
    np.testing.assert_array_equal(results.time[:], np.arange(sum(calls) + 1) * STEP)
    assert results.status.startswith(("failed: no further", "interrupted"))

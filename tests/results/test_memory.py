"""Runs kept in memory."""

from dataclasses import replace

import fake_runs
import numpy as np
import pytest

from maggi.model.errors import ModelError, SimulationError
from maggi.results.memory import MemoryRecorder


def test_results_before_a_run():
    with pytest.raises(ModelError, match="no results yet"):
        MemoryRecorder().results()


def test_results_of_an_interrupted_run():
    recorder = MemoryRecorder()
    recorder.begin(fake_runs.layout(1000))
    for one in list(fake_runs.rows(1000))[:5]:
        recorder.write(one.rows())
    recorder.end("interrupted")
    results = recorder.results()
    assert results.status == "interrupted"
    assert len(results.time) == len(results.body("rod").displacement) == 5


def test_nan_is_refused():
    recorder = MemoryRecorder()
    recorder.begin(fake_runs.layout(3))
    recorder.write(fake_runs.row(0.0).rows())
    recorder.write(replace(fake_runs.row(0.1), energy=np.full(5, np.nan)).rows())
    with pytest.raises(SimulationError, match=r"energy/kinetic .* t = 0.1 s"):
        recorder.end("complete")
    assert len(recorder.results().time) == 1
    assert recorder.results().status.startswith("failed")


def test_more_than_fits_in_memory():
    with pytest.raises(ModelError, match="of memory"):
        MemoryRecorder().begin(fake_runs.layout(10**14))

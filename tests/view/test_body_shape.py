"""Exaggerated shapes stay on their joints."""

import fake_runs
import numpy as np
import pytest

from maggi.results.memory import MemoryRecorder
from maggi.view.body_shape import TARGET, body_shape, exaggeration


@pytest.fixture(scope="module")
def results():
    recorder = MemoryRecorder()
    fake_runs.record(recorder, 41)
    return recorder.results()


def test_true_shape(results):
    row = 5
    drawn, size = body_shape(results, "rod").drawn(row, 1.0)
    one = fake_runs.row(results.time[row])
    nodes, _ = fake_runs.box_mesh()
    assert drawn == pytest.approx(one.origin[1] + (nodes + one.displacement[0]) @ one.rotation[1].T)
    # The fake run bends by a half sine square to the line between the ends; section turns add to it at the ends.
    middle = np.isclose(nodes[:, 0], fake_runs.ROD / 2)
    expected = fake_runs.BENDING * abs(np.sin(fake_runs.SPEED * results.time[row]))
    assert size[middle] == pytest.approx(np.full(middle.sum(), expected), rel=1e-6)


def test_the_ends_stay_where_they_are(results):
    shape = body_shape(results, "rod")
    drawn, _ = shape.drawn(5, 1000.0)
    for at, place in (("big_end", 0.0), ("small_end", fake_runs.ROD)):
        end = drawn[np.isclose(shape.nodes[:, 0], place)].mean(axis=0)
        assert end == pytest.approx(results.body("rod").attachment(at).position[5], abs=1e-9)


def test_exaggeration_is_round_and_bounded(results):
    shapes = (body_shape(results, "rod"),)
    rows = np.arange(41)
    factor = exaggeration(shapes, rows)
    # 0.4 mm of 160 mm: 6 % of the length would be × 24.
    assert factor == 20.0
    largest = max(np.abs(shapes[0].elastic(row)[1]).max() for row in rows)
    assert factor * largest <= TARGET * fake_runs.ROD
    assert exaggeration((), rows) == 1.0

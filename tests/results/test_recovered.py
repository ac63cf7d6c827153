"""Nodal displacements of reduced bodies, recovered from coordinates and shapes, in memory and from a file."""

from dataclasses import replace

import fake_runs
import numpy as np
import pytest

from maggi.model.errors import ModelError
from maggi.results.extremes import deflection_extremes, elastic_bodies
from maggi.results.memory import MemoryRecorder
from maggi.results.read import read
from maggi.results.store import FileRecorder
from maggi.view.body_shape import body_shape
from maggi.view.mechanism import mechanism_figure

NODES, CELLS = fake_runs.box_mesh()
BASIS = np.random.default_rng(1).normal(size=(len(NODES), 3, 2))


def reduced(layout):
    """The layout with a reduced rod in place of the full mesh; it has the blade's two coordinates first in `modal`."""
    bodies = list(layout.bodies)
    bodies[1] = replace(bodies[1], kind="reduced", modes=2, basis=BASIS)
    return replace(layout, bodies=tuple(bodies))


def row(t):
    one = fake_runs.row(t)
    return replace(one, displacement=(), modal=(np.array([1e-4 * np.cos(t), 2e-4 * np.sin(300 * t)]), *one.modal))


def record(recorder, times):
    recorder.begin(reduced(fake_runs.layout(len(times))))
    for t in times:
        recorder.write(row(float(t)).rows())
    recorder.end("complete")


TIMES = fake_runs.times(9)
EXPECTED = np.stack([BASIS @ row(t).modal[0] for t in TIMES])


@pytest.fixture(scope="module", params=["memory", "file"])
def results(request, tmp_path_factory):
    if request.param == "memory":
        recorder = MemoryRecorder()
        record(recorder, TIMES)
        yield recorder.results()
        return
    path = tmp_path_factory.mktemp("reduced") / "run.h5"
    record(FileRecorder(path), TIMES)
    with read(path) as found:
        yield found


def test_what_is_kept(results):
    rod = results.body("rod")
    assert rod.kind == "reduced"
    assert rod.modal.shape == (9, 2)
    np.testing.assert_array_equal(rod.basis, BASIS)
    np.testing.assert_array_equal(rod.nodes, NODES)
    assert rod.cells.keys() == CELLS.keys()


@pytest.mark.parametrize("key", [0, 4, -1, slice(None), slice(2, 7, 2), slice(None, None, -1), slice(3, 3)], ids=str)
def test_displacements(results, key):
    frames = results.body("rod").displacement
    assert frames.shape == EXPECTED.shape and len(frames) == 9
    np.testing.assert_allclose(frames[key], EXPECTED[key], atol=1e-18)


def test_as_a_table(results):
    path = "bodies/rod/displacement"
    assert results.has(path) and not results.has("bodies/crank/displacement")
    np.testing.assert_allclose(results.series(path), EXPECTED, atol=1e-18)
    with pytest.raises(ModelError, match="holds no bodies/blade/displacement"):
        results.series("bodies/blade/displacement")
    assert not results.has("bodies/blade/displacement")  # a Ritz body has no nodes


def test_pictures_and_extremes(results):
    assert elastic_bodies(results) == ("rod",)
    (rod,) = deflection_extremes(results)
    assert rod.displacement == pytest.approx(np.linalg.norm(EXPECTED, axis=2).max())
    drawn, _ = body_shape(results, "rod").drawn(4, 1.0)
    one = row(TIMES[4])
    np.testing.assert_allclose(drawn, one.origin[1] + (NODES + EXPECTED[4]) @ one.rotation[1].T, atol=1e-12)
    assert mechanism_figure(results) is not None


def test_without_coordinates_there_are_none():
    recorder = MemoryRecorder(("bodies",))
    record(recorder, TIMES)
    assert not recorder.results().has("bodies/rod/displacement")

"""One interface to results, from a file and from memory; clear refusals."""

import os
import subprocess
import sys
from pathlib import Path

import fake_runs
import h5py
import numpy as np
import pytest

import maggi
from maggi.model.errors import ModelError
from maggi.results.memory import MemoryRecorder
from maggi.results.read import read
from maggi.results.source import Frames
from maggi.results.store import FileRecorder

ROWS = 25


@pytest.fixture(params=["file", "memory"])
def results(request, tmp_path):
    if request.param == "memory":
        recorder = MemoryRecorder()
        fake_runs.record(recorder, ROWS)
        yield recorder.results()
    else:
        fake_runs.record(FileRecorder(tmp_path / "run.h5"), ROWS)
        with read(tmp_path / "run.h5") as opened:
            yield opened


def test_everything_by_name(results):
    expected = list(fake_runs.rows(ROWS))
    k = 7
    one = expected[k]
    assert results.bodies == ("crank", "rod", "piston", "blade")
    assert results.joints == ("bearing", "crankpin", "wristpin", "motor", "clamp")
    assert results.status == "complete"
    assert results.title == "Fake slider-crank"
    assert results.attributes["model"] == fake_runs.MODEL
    assert (results.time == [row.time for row in expected]).all()
    assert (results.iterations == 1).all()
    rod = results.body("rod")
    assert rod.kind == "mesh"
    assert rod.attachments == ("big_end", "small_end")
    wristpin = results.joint("wristpin")
    assert (wristpin.kind, wristpin.ends) == ("cylindrical", ("rod.small_end", "piston.pin"))
    assert wristpin.units == ("m", "rad")
    assert results.joint("clamp").units == ()
    assert rod.cells["hex8"].shape == (192, 8)
    assert rod.nodes.shape == (396, 3)
    pairs = [
        (rod.origin[k], one.origin[1]),
        (rod.rotation[k], one.rotation[1]),
        (rod.displacement[k], one.displacement[0]),
        (results.body("blade").modal[k], one.modal[0]),
        (rod.attachment("small_end").position[k], one.position[2]),
        (rod.attachment("small_end").rotation[k], one.attachment_rotation[2]),
        (rod.attachment("small_end").velocity[k], one.velocity[2]),
        (rod.attachment("small_end").angular_velocity[k], one.angular_velocity[2]),
        (rod.attachment("small_end").at, [fake_runs.ROD, 0.0, 0.0]),
        (results.joint("crankpin").position[k], one.joint_position[1]),
        (results.joint("crankpin").force[k], one.force[1]),
        (results.joint("motor").torque[k], one.torque[3]),
        (results.joint("wristpin").coordinate[k], one.coordinate[2]),
        (results.energy.kinetic[k], one.energy[0]),
        (results.energy.strain[k], one.energy[1]),
        (results.energy.gravity[k], one.energy[2]),
        (results.energy.dissipated[k], one.energy[3]),
        (results.energy.work[k], one.energy[4]),
        (results.residuals.position[k], one.residuals[0]),
        (results.residuals.velocity[k], one.residuals[1]),
        (results.residuals.acceleration[k], one.residuals[2]),
    ]
    for found, wanted in pairs:
        assert np.array_equal(found, wanted)
    assert results.joint("clamp").coordinate.shape == (ROWS, 0)
    assert results.body("piston").cells == {}


def test_energy_balance(results):
    # The fake run's work is what the other four sum up to, less a constant.
    assert np.abs(results.energy.balance).max() < 1e-13
    assert np.abs(results.energy.work).max() > 1.0


@pytest.mark.parametrize(
    "key",
    [0, -1, 7, slice(None), slice(3, 9, 2), slice(None, None, -1), slice(20, 2, -5), slice(5, 5), slice(-3, None)],
)
def test_frames_index_as_arrays_do(results, key):
    frames = results.body("rod").displacement
    whole = np.stack([row.displacement[0] for row in fake_runs.rows(ROWS)])
    assert isinstance(frames, Frames)
    assert frames.shape == whole.shape
    assert np.array_equal(frames[key], whole[key])
    assert np.array_equal(np.asarray(frames), whole)


def test_frames_end(results):
    assert len(list(results.body("rod").displacement)) == ROWS
    with pytest.raises(IndexError):
        results.body("rod").displacement[ROWS]


@pytest.mark.parametrize(
    ("ask", "remedy"),
    [
        (lambda r: r.body("rodd"), "did you mean rod?"),
        (lambda r: r.joint("xyz"), "there are: bearing, crankpin"),
        (lambda r: r.body("rod").attachment("big_ned"), "did you mean big_end?"),
        (lambda r: r.body("crank").displacement, "outputs.quantities"),
    ],
)
def test_unknown_names(results, ask, remedy):
    with pytest.raises(ModelError) as caught:
        ask(results)
    assert remedy in caught.value.remedy


def test_what_was_not_kept(tmp_path):
    recorder = MemoryRecorder(("bodies",))
    fake_runs.record(recorder, 3)
    with pytest.raises(ModelError, match="holds no joints/motor/force"):
        _ = recorder.results().joint("motor").force
    assert not recorder.results().has("joints/motor/force")
    assert recorder.results().has("bodies/rod/origin")


def test_tables_of_different_length_are_cut_to_the_shortest(tmp_path):
    fake_runs.record(FileRecorder(tmp_path / "run.h5"), ROWS)
    with h5py.File(tmp_path / "run.h5", "r+") as file:
        file["joints/motor/force"].resize(9, axis=0)
    with read(tmp_path / "run.h5") as results:
        assert len(results.time) == len(results.body("rod").displacement) == len(results.joint("motor").force) == 9


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "there is no file"),
        (b"", "is not a result file"),
        (b"maggi: 1\n", "is not a result file"),
        (b"\x89HDF\r\n\x1a\n" + bytes(100), "cannot read"),
    ],
)
def test_not_a_result_file(tmp_path, content, message):
    path = tmp_path / "run.h5"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ModelError, match=message):
        read(path)


def test_a_folder_is_not_a_result_file(tmp_path):
    with pytest.raises(ModelError, match="is not a result file"):
        read(tmp_path)


def test_other_hdf5_and_newer_formats(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1.0
    with pytest.raises(ModelError, match="not a result file of maggi"):
        read(tmp_path / "other.h5")
    fake_runs.record(FileRecorder(tmp_path / "run.h5"), 2)
    with h5py.File(tmp_path / "run.h5", "r+") as file:
        file.attrs["format_version"] = 99
    with pytest.raises(ModelError, match="has format 99"):
        read(tmp_path / "run.h5")


def test_reading_while_a_run_writes(tmp_path):
    path = tmp_path / "run.h5"
    recorder = FileRecorder(path)
    recorder.begin(fake_runs.layout(4))
    recorder.write(fake_runs.row(0.0).rows())
    script = f"from maggi.results.read import read; read({str(path)!r})"
    environment = {**os.environ, "PYTHONPATH": str(Path(maggi.__file__).parents[1])}
    other = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False)
    assert "ModelError: " in other.stderr and "is being written by a run" in other.stderr
    recorder.end("complete")
    with read(path) as results:
        assert len(results.time) == 1

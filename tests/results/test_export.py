"""Comma-separated tables: headers with units, and not a bit lost."""

import csv

import fake_runs
import numpy as np
import pytest

from maggi.model.errors import ModelError
from maggi.results.export import export_csv
from maggi.results.memory import MemoryRecorder

ROWS = 11


@pytest.fixture(scope="module")
def results():
    recorder = MemoryRecorder()
    fake_runs.record(recorder, ROWS)
    return recorder.results()


def read_csv(path):
    with path.open(newline="") as file:
        header, *lines = csv.reader(file)
    return {name: np.array(column, dtype=float) for name, column in zip(header, zip(*lines, strict=True), strict=True)}


def test_groups_and_values(results, tmp_path):
    written = export_csv(results, tmp_path / "tables", "run")
    names = ["time", "bodies", "attachments", "joints", "energy", "residuals"]
    assert [path.name for path in written] == [f"run_{name}.csv" for name in names]
    tables = {name: read_csv(path) for name, path in zip(names, written, strict=True)}
    for table in tables.values():
        assert next(iter(table)) == "time [s]"
        assert np.array_equal(table["time [s]"], results.time)
    expected = [
        ("time", "iterations [1]", results.iterations),
        ("bodies", "rod.origin.z [m]", results.body("rod").origin[:, 2]),
        ("bodies", "rod.rotation.xz [1]", results.body("rod").rotation[:, 0, 2]),
        ("bodies", "blade.modal.2 [m]", results.body("blade").modal[:, 1]),
        ("attachments", "rod.big_end.velocity.x [m/s]", results.body("rod").attachment("big_end").velocity[:, 0]),
        ("joints", "crankpin.force.x [N]", results.joint("crankpin").force[:, 0]),
        ("joints", "motor.torque.y [N m]", results.joint("motor").torque[:, 1]),
        ("joints", "wristpin.coordinate.2 [rad]", results.joint("wristpin").coordinate[:, 1]),
        ("energy", "work [J]", results.energy.work),
        ("residuals", "acceleration [1]", results.residuals.acceleration),
    ]
    for group, header, values in expected:
        assert np.array_equal(tables[group][header], values), header


def test_groups_that_were_not_kept(tmp_path):
    recorder = MemoryRecorder(("energy",))
    fake_runs.record(recorder, 3)
    assert [path.name for path in export_csv(recorder.results(), tmp_path, "run")] == ["run_time.csv", "run_energy.csv"]


def test_a_folder_that_cannot_be_made(results, tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(ModelError, match="cannot write to"):
        export_csv(results, tmp_path / "taken", "run")

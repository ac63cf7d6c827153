"""`maggi plot` and `maggi export`, which tell result files from models by what is in them."""

import json
from pathlib import Path

import fake_runs
import pytest

from maggi.results.store import FileRecorder

PICTURES = ["mechanism", "joints", "motion", "deflection", "energy", "residuals"]
TABLES = ["time", "bodies", "attachments", "joints", "energy", "residuals"]


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch):
    monkeypatch.setattr("maggi.view.style.DOTS_PER_INCH", 50)


@pytest.fixture
def result(shell):
    Path("sub").mkdir()
    fake_runs.record(FileRecorder("sub/run.data"), 9)
    return "sub/run.data"


def test_plot_of_results(shell, result):
    found = shell("plot", result)
    assert found.exit_code == 0, found.stderr
    expected = [f"sub/run_{name}.png" for name in PICTURES]
    assert found.stdout.split() == expected
    assert all(Path(path).read_bytes().startswith(b"\x89PNG") for path in expected)


def test_plot_of_a_model(shell):
    found = shell("plot", shell.model(), "-o", "pictures", "--json")
    assert found.exit_code == 0, found.stderr
    assert json.loads(found.stdout)["files"] == ["pictures/model_model.png"]
    assert Path("pictures/model_model.png").read_bytes().startswith(b"\x89PNG")


def test_set_is_for_models(shell, result):
    found = shell("plot", result, "--set", "a=1")
    assert found.exit_code == 2
    assert "--set is for model files" in found.stderr


def test_export(shell, result):
    found = shell("export", result, "--csv", "-o", "tables")
    assert found.exit_code == 0, found.stderr
    assert found.stdout.split() == [f"tables/run_{name}.csv" for name in TABLES]
    said = json.loads(shell("export", result, "--csv", "--json").stdout)
    assert said["files"] == [f"sub/run_{name}.csv" for name in TABLES]


def test_something_else(shell):
    found = shell("export", shell.model(), "--csv")
    assert found.exit_code == 2
    assert "model.yml is not a result file" in found.stderr

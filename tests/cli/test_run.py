"""`maggi run`: every way in which a run can end."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import fake_core
import h5py
import pytest

import maggi
from maggi.results.read import read


def titled(title):
    return fake_core.MODEL.replace("Fake slider-crank", title)


def test_complete(shell):
    found = shell("run", shell.model())
    assert found.exit_code == 0, found.stderr
    said = found.stdout
    for text in (
        "1.10",
        "position 3.0e-16",
        "crankpin",
        "750",
        "rod",
        "big_end – small_end",
        "model.h5: 41 rows",
        "largest deflection [mm]",
        "at t [s]",
        "2.0e-09",
        "40 (2 times with a smaller step)",
        "3.00e-07 J",
    ):
        assert text in said, text
    assert "compiling kernels" in found.stderr
    assert "100 %" in found.stderr
    assert "warning: the initial velocities were projected" in found.stderr
    with h5py.File("model.h5") as file:
        assert file.attrs["status"] == "complete"


def test_output_and_overrides(shell):
    found = shell("run", shell.model(), "-o", "other.h5", "--set", "title=diverges", "--quiet")
    assert found.exit_code == 1
    assert shell("run", "model.yml", "-o", "other.h5", "--quiet").stdout == ""
    assert not Path("model.h5").exists()
    with read("other.h5") as results:
        assert results.status == "complete"


def test_json(shell):
    found = shell("run", shell.model(), "--json")
    assert found.exit_code == 0
    said = json.loads(found.stdout)
    assert said["status"] == "complete"
    assert said["file"] == "model.h5"
    assert (said["steps"], said["iterations"], said["back_substitutions"]) == (40, 44, 44)
    assert said["residuals"] == {"position": 3e-16, "velocity": 6e-13, "acceleration": 6e-9}
    assert said["errors"] == []


@pytest.mark.parametrize(("title", "status", "code"), [("diverges", "failed", 1), ("stopped", "interrupted", 130)])
def test_what_was_computed_is_kept(shell, title, status, code):
    name = shell.model(titled(title))
    found = shell("run", name)
    assert found.exit_code == code
    assert "model.h5 keeps 20 rows, up to t = 0.0298" in found.stderr
    assert "Traceback" not in found.stderr
    said = json.loads(shell("run", name, "--json").stdout)
    assert said["status"] == status
    assert said["file"] == "model.h5"
    assert said["steps"] == 19
    assert said["iterations"] == 20
    assert said["residuals"]["position"] > 0.0
    assert "model.h5 keeps 20 rows" in said["errors"][0]["remedy"]
    with read("model.h5") as results:
        assert results.status.startswith(status)
        assert len(results.time) == 20


def test_an_error_of_the_core_is_placed_in_the_model(shell):
    name = shell.model(titled("over-driven"))
    found = shell("run", name)
    assert found.exit_code == 2
    assert "model.yml:6:12: joints.bearing: over-driven joint (leave one driver out)" in found.stderr
    assert json.loads(shell("run", name, "--json").stdout)["errors"][0]["line"] == 6
    assert not Path("model.h5").exists()


@pytest.mark.parametrize(
    ("output", "message"),
    [("missing/run.h5", "there is no folder missing"), (".", ". is a folder"), ("model.yml", "is not a result file")],
)
def test_output_that_cannot_be_written(shell, output, message):
    found = shell("run", shell.model(), "-o", output)
    assert found.exit_code == 2
    assert message in found.stderr
    assert Path("model.yml").read_text() == fake_core.MODEL


def test_control_c(tmp_path):
    (tmp_path / "model.yml").write_text(titled("slow"))
    # a shell without job control starts what it starts in the background deaf to Control-C, and so would be this child
    hear = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    script = (
        f"{hear}; import fake_core; fake_core.install(); from maggi.cli.main import main; main(['run', 'model.yml'])"
    )
    support = str(Path(fake_core.__file__).parent)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(maggi.__file__).parents[1]), support])}
    process = subprocess.Popen(
        [sys.executable, "-c", script], env=environment, cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    assert process.stderr is not None
    while "10 %" not in process.stderr.readline():
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    said = process.stderr.read()
    assert process.wait() == 130
    assert "interrupted (model.h5 keeps" in said
    assert "Traceback" not in said
    with read(tmp_path / "model.h5") as results:
        assert results.status == "interrupted"
        assert len(results.time) >= 4

"""Usage errors, exit statuses, bugs, pipes."""

import json
import os
import subprocess
import sys
from pathlib import Path

import fake_core
import pytest

import maggi
from maggi.results.read import read

SOURCE = str(Path(maggi.__file__).parents[1])


def test_help_and_version(shell):
    assert shell().exit_code == 0
    assert "Usage:" in shell().stdout
    found = shell("--help")
    assert found.exit_code == 0
    for command in ("run", "check", "plot", "export", "schema"):
        assert f"  {command} " in found.stdout
        assert shell(command, "--help").exit_code == 0
    for command in ("modes", "view"):
        assert command not in found.stdout
    assert shell("--version").stdout == f"maggi {maggi.__version__}\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["rnu"], "No such command 'rnu'"),
        (["run"], "Missing argument 'MODEL'"),
        (["run", "model.yml", "--fast"], "No such option '--fast'"),
        (["run", "model.yml", "-o"], "requires an argument"),
        (["export", "run.h5"], "say which format: --csv"),
        (["modes", "model.yml", "--count", "3"], "`maggi modes` is not built yet"),
        (["view", "run.h5"], "`maggi view` is not built yet"),
        (["run", "missing.yml"], "missing.yml: no such file"),
        (["plot", "missing.h5"], "there is no file missing.h5"),
        (["plot", "missing.yml"], "missing.yml: no such file"),
        (["export", "missing.h5", "--csv"], "there is no file missing.h5"),
        (["check", "."], "this is a folder"),
    ],
)
def test_mistakes_in_the_command_line(shell, arguments, message):
    found = shell(*arguments)
    assert found.exit_code == 2
    assert message in found.stderr
    assert found.stdout == ""
    assert "Traceback" not in found.stderr
    as_json = shell(*arguments, "--json") if arguments != ["run", "model.yml", "-o"] else shell("--json", *arguments)
    assert as_json.exit_code == 2
    said = json.loads(as_json.stdout)
    assert said["status"] == "error"
    assert set(said["errors"][0]) == {"file", "line", "column", "path", "message", "remedy"}


@pytest.mark.parametrize("command", ["run", "check", "plot"])
def test_mistakes_in_a_model_have_line_and_column(shell, command):
    name = shell.model(fake_core.MODEL.replace("mass: 0.4", "mass: -0.4").replace("duration: 0.1", "durration: 0.1"))
    found = shell(command, name)
    assert found.exit_code == 2
    lines = found.stderr.splitlines()
    # "  crank: {kind: rigid, mass: -0.4": the value starts in column 30 of line 4.
    assert lines[0].startswith("model.yml:4:30: bodies.crank.mass: ")
    assert any(line.startswith("model.yml:7:14: simulation.durration: unknown key 'durration'") for line in lines)
    said = json.loads(shell(command, name, "--json").stdout)
    assert (said["errors"][0]["line"], said["errors"][0]["column"]) == (4, 30)
    assert said["errors"][0]["file"] == "model.yml"
    assert said["errors"][0]["path"] == "bodies.crank.mass"


def test_a_bug_is_named_as_one(shell, monkeypatch):
    name = shell.model(fake_core.MODEL.replace("Fake slider-crank", "bug"))
    found = shell("run", name)
    assert found.exit_code == 1
    assert "this is a bug in maggi: ZeroDivisionError: division by zero" in found.stderr
    assert "maggi --traceback" in found.stderr
    assert "Traceback" not in found.stderr
    assert "Traceback (most recent call last)" in shell("--traceback", "run", name).stderr
    monkeypatch.setenv("MAGGI_DEBUG", "1")
    assert "Traceback (most recent call last)" in shell("run", name).stderr
    said = json.loads(shell("run", name, "--json").stdout)
    assert said["status"] == "failed"
    with read("model.h5") as results:
        assert results.status == "failed: ZeroDivisionError: division by zero"
        assert len(results.time) == 3


def test_schema(shell):
    said = json.loads(shell("schema").stdout)
    assert {"bodies", "joints", "simulation"} <= set(said["properties"])


def test_help_is_quick_because_nothing_slow_is_imported():
    script = (
        "import sys; from maggi.cli.main import main\n"
        "try: main(['--help'])\n"
        "finally: print([m for m in ('numba', 'scipy', 'h5py', 'matplotlib', 'pydantic', 'rich') if m in sys.modules])"
    )
    environment = {**os.environ, "PYTHONPATH": SOURCE}
    found = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == "[]"


def test_a_closed_pipe_ends_quietly():
    environment = {**os.environ, "PYTHONPATH": SOURCE}
    command = [sys.executable, "-m", "maggi", "schema"]
    reading, writing = os.pipe()
    os.close(reading)
    process = subprocess.run(command, env=environment, stdout=writing, stderr=subprocess.PIPE, check=False)
    os.close(writing)
    assert process.stderr == b""
    assert process.returncode == 141  # 128 + SIGPIPE, as a shell would say

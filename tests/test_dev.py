"""The first thing a newcomer types: ./dev answers in one line where it cannot work, from wherever it is called."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
NAMES = ("python3", "python3.11", "python3.12", "python3.13", "python3.14")

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="dev is a POSIX shell script")


@pytest.fixture
def checkout(tmp_path):
    """A copy of what ./dev reads, in a folder with a space, without an environment."""
    folder = tmp_path / "a checkout"
    folder.mkdir()
    for name in ("dev", "pyproject.toml", "requirements.txt", "requirements-dev.txt", "requirements-bench.txt"):
        shutil.copy(ROOT / name, folder)
    return folder


@pytest.fixture
def fake_python(tmp_path):
    """Puts a script in the place of every Python on the path."""

    def make(script):
        folder = tmp_path / "bin"
        folder.mkdir()
        for name in NAMES:
            path = folder / name
            path.write_text(f"#!/bin/sh\n{script}\n")
            path.chmod(0o755)
        return {**os.environ, "PATH": f"{folder}:/usr/bin:/bin"}

    return make


def dev(checkout, *arguments, env=None):
    return subprocess.run(
        [checkout / "dev", *arguments], cwd="/", env=env, capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.parametrize("arguments", [(), ("nonsense",)])
def test_unknown_commands_get_the_usage(checkout, arguments):
    result = dev(checkout, *arguments)
    assert result.returncode == 2
    assert result.stdout == ""
    assert [line.split()[0] for line in result.stderr.splitlines()[2:]] == ["setup", "demo", "test", "lint", "bench"]


def test_help_is_no_error(checkout):
    result = dev(checkout, "--help")
    assert result.returncode == 0
    assert result.stdout.startswith("usage: ./dev COMMAND")


def test_an_old_python_is_named_in_one_line(checkout, fake_python):
    env = fake_python('case "$1" in --version) echo Python 3.9.2 ;; *) exit 1 ;; esac')
    result = dev(checkout, "setup", env=env)
    assert result.returncode == 1
    (line,) = result.stderr.splitlines()
    assert "Python 3.11 to 3.14 is needed, found Python 3.9.2" in line
    assert not (checkout / ".venv").exists()


def test_a_python_without_venv_is_named_in_one_line(checkout, fake_python):
    """As on Debian, where ensurepip is in a package of its own."""
    env = fake_python(f'case "$2" in *ensurepip*) exit 1 ;; *) exec "{sys.executable}" "$@" ;; esac')
    result = dev(checkout, "demo", env=env)
    assert result.returncode == 1
    (line,) = result.stderr.splitlines()
    version = ".".join(map(str, sys.version_info[:2]))
    assert line.endswith(f"on Debian or Ubuntu: apt install python{version}-venv")
    assert not (checkout / ".venv").exists()


def test_a_second_setup_has_nothing_to_do(checkout, fake_python):
    """With the stamp of this state in place no Python is started at all; with another, one is."""
    env = fake_python("exit 1")
    (checkout / ".venv" / "bin").mkdir(parents=True)
    (checkout / ".venv" / "bin" / "maggi").write_text("#!/bin/sh\n")
    (checkout / ".venv" / "bin" / "maggi").chmod(0o755)
    state = f"{checkout.resolve()}\n{(checkout / 'pyproject.toml').read_text()}{(checkout / 'requirements.txt').read_text()}"
    stamp = subprocess.run(["cksum"], input=state, capture_output=True, text=True, check=True).stdout
    (checkout / ".venv" / "requirements.txt.stamp").write_text(stamp)
    assert dev(checkout, "setup", env=env).returncode == 0
    (checkout / "requirements.txt").write_text("")
    assert dev(checkout, "setup", env=env).returncode == 1


def test_benchmarks_do_without_a_peer_that_cannot_be_installed(checkout, fake_python):
    """Its columns stay empty; one line says why."""
    folder = checkout / ".venv-bench" / "bin"
    folder.mkdir(parents=True)
    python = 'case "$*" in *requirements-bench*) exit 1 ;; *run.py*) echo "ran: $*" ;; esac'
    for name, script in (("maggi", "exit 0"), ("python", python)):
        (folder / name).write_text(f"#!/bin/sh\n{script}\n")
        (folder / name).chmod(0o755)
    state = f"{checkout.resolve()}\n{(checkout / 'pyproject.toml').read_text()}{(checkout / 'requirements.txt').read_text()}"
    stamp = subprocess.run(["cksum"], input=state, capture_output=True, text=True, check=True).stdout
    (checkout / ".venv-bench" / "requirements.txt.stamp").write_text(stamp)
    result = dev(checkout, "bench", "chains", env=fake_python("exit 1"))
    assert result.returncode == 0
    assert result.stdout == "ran: benchmarks/run.py chains\n"
    (line,) = result.stderr.splitlines()
    assert "Exudyn cannot be installed" in line


def test_requirements_pin_every_line_with_hashes_and_name_no_address():
    for name, least in (("requirements.txt", 15), ("requirements-dev.txt", 15), ("requirements-bench.txt", 1)):
        lines = (ROOT / name).read_text().splitlines()
        assert not [line for line in lines if "://" in line or "index" in line]
        pins = [i for i, line in enumerate(lines) if "==" in line and "--hash" not in line]
        assert len(pins) >= least
        assert all("--hash=sha256:" in lines[i + 1] for i in pins)

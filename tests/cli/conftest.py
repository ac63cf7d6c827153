"""The fake runs of tests/support can be imported by the tests here; commands run in a folder of their own."""

import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))

import fake_core

from maggi.cli.main import main


class Shell:
    """Runs commands of `maggi` in a folder."""

    def __init__(self, folder):
        self.folder = folder

    def __call__(self, *arguments):
        return CliRunner().invoke(main, [str(argument) for argument in arguments])

    def model(self, text=fake_core.MODEL, name="model.yml"):
        (self.folder / name).write_text(text)
        return name


@pytest.fixture
def shell(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MAGGI_DEBUG", raising=False)
    fake_core.install(lambda name, module: monkeypatch.setitem(sys.modules, name, module))
    return Shell(tmp_path)

"""What a command begins with: without Python's garbage collector, and with threads of BLAS that soon sleep."""

import gc
import os
import subprocess
import sys

import pytest

from maggi.cli.start import collector_off, started


def test_the_collector_is_on_again_afterwards():
    assert gc.isenabled()
    off = []

    def interrupted():
        with collector_off():
            off.append(not gc.isenabled())
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert off == [True]
    assert gc.isenabled()


def test_it_works_on_what_is_made_once_something_long_begins():
    class Ring:
        gone = False

        def __init__(self):
            self.ring = self

        def __del__(self):
            Ring.gone = True

    with collector_off():
        before = [Ring()]
        started()
        assert gc.isenabled()
        assert gc.get_freeze_count() > 0
        del before
        Ring()
        gc.collect()
        assert Ring.gone
    gc.unfreeze()


def test_a_collector_that_was_off_stays_off():
    gc.disable()
    try:
        with collector_off():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


@pytest.mark.parametrize(("given", "expected"), [({}, "16"), ({"OPENBLAS_THREAD_TIMEOUT": "20"}, "20")])
def test_blas_finds_its_setting_before_it_is_loaded_and_that_of_the_user_stands(given, expected):
    show = "import os, sys, maggi.cli; assert 'numpy' not in sys.modules; print(os.environ['OPENBLAS_THREAD_TIMEOUT'])"
    environment = {key: value for key, value in os.environ.items() if not key.startswith("OPENBLAS")}
    found = subprocess.run(
        [sys.executable, "-c", show], env=environment | given, check=True, capture_output=True, text=True
    )
    assert found.stdout.strip() == expected


@pytest.mark.parametrize(("command", "work"), [("run", "transient.run"), ("check", "audit.audit")])
def test_what_may_be_long_goes_on_with_the_collector(shell, monkeypatch, command, work):
    seen = []
    module, name = work.split(".")
    module = sys.modules[f"maggi.analyses.{module}"]
    does = getattr(module, name)

    def watched(*args, **kwargs):
        seen.append(gc.isenabled())
        return does(*args, **kwargs)

    monkeypatch.setattr(module, name, watched)
    assert shell(command, shell.model()).exit_code == 0
    assert seen == [True]
    assert gc.isenabled()
    gc.unfreeze()

"""The package itself: what ``import maggi`` brings, and what it does not."""

import subprocess
import sys
import warnings
from pathlib import Path

import pytest

import maggi
import maggi.model

SWING = """\
maggi: 1
title: Swing
gravity: [0, 0, -9.81]
bodies:
  bob: {kind: rigid, mass: 2, center_of_mass: [0.5, 0, 0], attachments: {tip: {at: [1, 0, 0]}}}
joints:
  hinge: {type: revolute, between: [ground, bob], at: [0, 0, 0], axis: [0, 1, 0]}
simulation: {duration: 0.02, step: 1e-3}
"""


@pytest.fixture
def swing(tmp_path):
    path = tmp_path / "swing.yml"
    path.write_text(SWING)
    return path


def test_importing_the_package_imports_nothing_slow():
    """Not even numpy; the kernels' cache is set up all the same."""
    script = (
        "import sys, os, maggi\n"
        "print([name for name in ('numpy', 'numba', 'scipy', 'pydantic', 'h5py') if name in sys.modules])\n"
        "print('NUMBA_CACHE_DIR' in os.environ, os.environ['GOMP_SPINCOUNT'])"
    )
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert said.splitlines()[0] == "[]"
    assert said.splitlines()[1].startswith("True ")


def test_a_users_own_spin_count_is_kept():
    script = "import os; os.environ['GOMP_SPINCOUNT'] = '7'; import maggi; print(os.environ['GOMP_SPINCOUNT'])"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, check=True).stdout == b"7\n"


def test_every_public_name_is_there():
    for name in maggi.__all__:
        assert getattr(maggi, name) is not None
    assert maggi.RigidBody is maggi.model.RigidBody
    assert set(maggi.__all__) <= set(dir(maggi))
    assert sorted(maggi.__all__) == maggi.__all__


def test_every_description_is_public():
    """Whatever a model can be made of is reached from the package: all classes of `maggi.model` but type aliases."""
    classes = {name for name in maggi.model.__all__ if isinstance(getattr(maggi.model, name), type)}
    assert classes <= set(maggi.__all__)


def test_an_unknown_name():
    with pytest.raises(AttributeError, match="module 'maggi' has no attribute 'RigidBdy'"):
        _ = maggi.RigidBdy
    assert not hasattr(maggi, "np")


def test_load_takes_overrides(swing):
    model = maggi.load(swing, ["simulation.step=2e-3"])
    assert model.title == "Swing"
    assert model.simulation == maggi.Simulation(0.02, 2e-3)
    with pytest.raises(maggi.ModelErrors) as caught:
        maggi.load(swing, ["simulation.stop=1"])
    assert caught.value.errors[0].path == "simulation.stop"


def test_results_are_the_same_in_a_file_and_in_memory(swing, tmp_path):
    model = maggi.load(swing)
    kept = maggi.run(model)
    with maggi.run(model, tmp_path / "run.h5") as written, maggi.open(tmp_path / "run.h5") as read:
        for results in (written, read):
            assert (results.time == kept.time).all()
            assert (results.joint("hinge").force == kept.joint("hinge").force).all()
            assert results.status == kept.status == "complete"
    # the bob falls from rest: the hinge takes m (g − r α), α = g r / r² of a point mass at r = 0.5 m, so nothing
    assert abs(kept.joint("hinge").force[0]).max() < 1e-9
    assert kept.joint("hinge").coordinate[0, 0] == 0.0
    # and after t its angle about y, downwards from x, is g t² / (2 r) but for terms of t⁶
    assert kept.joint("hinge").coordinate[-1, 0] == pytest.approx(9.81 * 0.02**2 / (2 * 0.5), rel=1e-5)


def test_what_a_run_notes_is_a_warning(monkeypatch, swing):
    class Summary:
        warnings = ("too large",)

    monkeypatch.setattr(
        "maggi.analyses.transient.run", lambda model, recorder, progress: recorder.begin(_rows()) or Summary
    )
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        maggi.run(maggi.load(swing))
    assert [str(one.message) for one in told] == ["too large"]
    assert Path(told[0].filename) == Path(__file__)


def _rows():
    from maggi.analyses.recorder import Layout

    return Layout((), (), 1, {})


def test_a_failed_run_says_so_in_its_file(swing, tmp_path, monkeypatch):
    from maggi.analyses.snapshot import Snapshots

    whole = Snapshots.rows
    monkeypatch.setattr("maggi.stepping.stepper.MOST_KEPT", 9)
    monkeypatch.setattr(
        Snapshots,
        "rows",
        lambda self, step: rows if (rows := whole(self, step)).time.max(initial=0.0) < 0.01 else 1 / 0,
    )
    with pytest.raises(ZeroDivisionError):
        maggi.run(maggi.load(swing), tmp_path / "run.h5")
    with maggi.open(tmp_path / "run.h5") as results:
        assert results.status == "failed: ZeroDivisionError: division by zero"
        assert len(results.time) == 10

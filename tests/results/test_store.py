"""The result file: its contract, and that it survives whatever ends a run."""

import hashlib
import os
import signal
import subprocess
import sys
import textwrap
import time
from dataclasses import replace
from pathlib import Path

import fake_runs
import h5py
import numpy as np
import pytest

import maggi
from maggi.analyses.recorder import JointLayout
from maggi.model.errors import ModelError, SimulationError
from maggi.results import store
from maggi.results.read import read
from maggi.results.store import FileRecorder

SUPPORT = str(Path(fake_runs.__file__).parent)
SOURCE = str(Path(maggi.__file__).parents[1])

# Paths and shapes of the contract, written out by hand; n = 11 rows, 32 × 2 × 3 hexes have 33 · 3 · 4 nodes.
CONTRACT = {
    "time": (11,),
    "bodies/crank/origin": (11, 3),
    "bodies/rod/rotation": (11, 3, 3),
    "bodies/crank/attachments/pin/position": (11, 3),
    "bodies/rod/attachments/big_end/rotation": (11, 3, 3),
    "bodies/rod/attachments/small_end/velocity": (11, 3),
    "bodies/piston/attachments/pin/angular_velocity": (11, 3),
    "bodies/rod/attachments/small_end/at": (3,),
    "bodies/rod/displacement": (11, 396, 3),
    "bodies/rod/mesh/nodes": (396, 3),
    "bodies/rod/mesh/cells/hex8": (192, 8),
    "bodies/blade/modal": (11, 2),
    "joints/crankpin/position": (11, 3),
    "joints/crankpin/force": (11, 3),
    "joints/motor/torque": (11, 3),
    "joints/bearing/coordinate": (11, 1),
    "joints/wristpin/coordinate": (11, 2),
    "energy/kinetic": (11,),
    "energy/strain": (11,),
    "energy/gravity": (11,),
    "energy/dissipated": (11,),
    "energy/work": (11,),
    "residuals/position": (11,),
    "residuals/velocity": (11,),
    "residuals/acceleration": (11,),
    "solver/iterations": (11,),
}


@pytest.fixture
def target(tmp_path):
    return tmp_path / "run.h5"


def test_contract(target):
    fake_runs.record(FileRecorder(target), 11)
    with h5py.File(target) as file:
        for path, shape in CONTRACT.items():
            assert file[path].shape == shape, path
        datasets = []
        file.visititems(lambda _, item: datasets.append(item) if isinstance(item, h5py.Dataset) else None)
        assert all(set(item.attrs) == {"unit", "description"} for item in datasets)
        assert file["bodies/rod/attachments/big_end/velocity"].attrs["unit"] == "m/s"
        assert "joints/clamp/coordinate" not in file
        assert list(file["joints"]) == ["bearing", "crankpin", "wristpin", "motor", "clamp"]
        assert file.attrs["model"] == fake_runs.MODEL
        assert file.attrs["model_sha256"] == hashlib.sha256(fake_runs.MODEL.encode()).hexdigest()
        assert file.attrs["version"] == maggi.__version__
        assert file.attrs["status"] == "complete"
        assert file["bodies/rod"].attrs["kind"] == "mesh"
        wristpin = {
            "kind": "cylindrical",
            "first": "rod.small_end",
            "second": "piston.pin",
            "coordinate_units": "m rad",
        }
        assert dict(file["joints/wristpin"].attrs) == wristpin
        assert file["joints/wristpin/coordinate"].attrs["unit"] == "m, rad"
        assert file["joints/bearing/coordinate"].attrs["unit"] == "rad"


def test_values_are_those_of_the_rows(target):
    fake_runs.record(FileRecorder(target), 11)
    last = fake_runs.row(float(fake_runs.times(11)[-1]))
    with h5py.File(target) as file:
        assert file["time"][-1] == last.time
        assert (file["bodies/rod/origin"][-1] == last.origin[1]).all()
        assert (file["bodies/rod/attachments/small_end/position"][-1] == last.position[2]).all()
        assert (file["bodies/piston/attachments/pin/position"][-1] == last.position[3]).all()
        assert (file["bodies/rod/displacement"][-1] == last.displacement[0]).all()
        assert (file["joints/wristpin/coordinate"][-1] == last.coordinate[2]).all()
        assert file["energy/work"][-1] == last.energy[4]
        assert file["residuals/acceleration"][-1] == last.residuals[2]


def test_no_reserved_space_is_left(target):
    fake_runs.record(FileRecorder(target), 11)
    stored = 0
    with h5py.File(target) as file:

        def visit(_, item):
            nonlocal stored
            stored += item.id.get_storage_size() if isinstance(item, h5py.Dataset) else 0

        file.visititems(visit)
    assert target.stat().st_size < stored + 300_000  # headers of 45 tables


def test_a_long_model_text_is_kept(target):
    text = "# ä comment\n" * 20_000  # an attribute beyond 64 kB
    recorder = FileRecorder(target)
    recorder.begin(replace(fake_runs.layout(1), attributes={"model": text}))
    recorder.write(fake_runs.row(0.0).rows())
    recorder.end("complete")
    with h5py.File(target) as file:
        assert file.attrs["model"] == text


@pytest.mark.parametrize("left_out", ["bodies", "attachments", "displacement", "joints", "energy", "residuals"])
def test_quantities(target, left_out):
    everything = ("bodies", "attachments", "displacement", "joints", "energy", "residuals")
    fake_runs.record(FileRecorder(target, tuple(q for q in everything if q != left_out)), 3)
    sign = {
        "bodies": "bodies/rod/origin",
        "attachments": "bodies/rod/attachments/big_end/position",
        "displacement": "bodies/rod/displacement",
        "joints": "joints/crankpin/force",
        "energy": "energy/work",
        "residuals": "residuals/position",
    }
    with h5py.File(target) as file:
        assert {quantity for quantity, path in sign.items() if path not in file} == {left_out}


def test_rows_may_reuse_their_arrays(target):
    recorder = FileRecorder(target)
    recorder.begin(fake_runs.layout(3))
    one = fake_runs.row(0.0)
    for t in (0.0, 1.0, 2.0):
        one.origin[:] = t
        recorder.write(replace(one, time=t).rows())
    recorder.end("complete")
    with h5py.File(target) as file:
        assert (file["bodies/crank/origin"][:, 0] == [0.0, 1.0, 2.0]).all()


def test_interrupted_run_keeps_its_rows(target):
    recorder = FileRecorder(target)
    recorder.begin(fake_runs.layout(1000))
    for one in list(fake_runs.rows(1000))[:7]:
        recorder.write(one.rows())
    recorder.end("interrupted")
    assert recorder.rows == 7
    with read(target) as results:
        assert results.status == "interrupted"
        assert len(results.time) == 7
        assert results.body("rod").displacement.shape[0] == 7


@pytest.mark.parametrize(
    ("field", "path"),
    [
        ("force", "joints/bearing/force"),
        ("energy", "energy/kinetic"),
        ("displacement", "bodies/rod/displacement"),
        ("coordinate", "joints/bearing/coordinate"),
        ("rotation", "bodies/crank/rotation"),
    ],
)
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_nothing_that_is_not_finite_is_written(target, field, path, bad):
    recorder = FileRecorder(target)
    recorder.begin(fake_runs.layout(20))
    good = list(fake_runs.rows(20))
    value = getattr(good[5], field)
    (value[0] if isinstance(value, tuple) else value).flat[0] = bad
    with pytest.raises(SimulationError, match=path):  # noqa: PT012
        for one in good:
            recorder.write(one.rows())
        recorder.end("complete")
    with h5py.File(target) as file:
        assert file["time"].shape == (5,)
        assert np.isfinite(file[path][:]).all()
        assert file.attrs["status"].startswith("failed")


def test_a_nan_in_the_first_row_leaves_nothing(target):
    recorder = FileRecorder(target)
    recorder.begin(fake_runs.layout(2))
    one = fake_runs.row(0.0)
    one.force[0, 0] = np.nan
    with pytest.raises(SimulationError, match="joints/bearing/force"):
        recorder.write(one.rows())
    recorder.end("failed")
    assert list(target.parent.iterdir()) == []


def test_an_earlier_result_stays_until_the_new_run_stands(target):
    fake_runs.record(FileRecorder(target), 5)
    recorder = FileRecorder(target)
    recorder.begin(fake_runs.layout(9))
    recorder.end("failed: the initial state is inconsistent")
    with read(target) as results:
        assert len(results.time) == 5
    fake_runs.record(FileRecorder(target), 9)
    with read(target) as results:
        assert len(results.time) == 9
    assert [path.name for path in target.parent.iterdir()] == ["run.h5"]


def test_missing_folder(tmp_path):
    with pytest.raises(ModelError, match="no folder"):
        FileRecorder(tmp_path / "missing" / "run.h5")


def test_a_folder_is_not_a_file(tmp_path):
    with pytest.raises(ModelError, match="is a folder"):
        FileRecorder(tmp_path)


def test_unwritable_folder(tmp_path):
    # nothing of one's own is forbidden to root, but nobody makes files in /proc
    folder = Path("/proc/self") if os.geteuid() == 0 else tmp_path
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(ModelError, match="cannot write"):
            FileRecorder(folder / "run.h5")
    finally:
        tmp_path.chmod(0o700)


@pytest.mark.parametrize("content", [b"maggi: 1\n", b"\x89HDF\r\n\x1a\nbroken"])
def test_other_files_are_left_alone(target, content):
    target.write_bytes(content)
    with pytest.raises(ModelError, match="not a result file"):
        FileRecorder(target)
    assert target.read_bytes() == content


def test_somebody_elses_hdf5_is_left_alone(target):
    with h5py.File(target, "w") as file:
        file["mine"] = 1.0
    with pytest.raises(ModelError, match="not a result file"):
        FileRecorder(target)


def test_a_disk_that_is_too_small_is_noticed_before_the_run(target):
    recorder = FileRecorder(target)
    with pytest.raises(ModelError, match=r"would take .* GB") as caught:
        recorder.begin(fake_runs.layout(10**12))
    assert "outputs.every" in caught.value.remedy
    assert not target.exists()


@pytest.mark.parametrize("name", ["", ".", "a/b", "a\0b"])
def test_names_that_cannot_be_paths(target, name):
    joint = JointLayout(name, "weld", "ground", "rod", ())
    with pytest.raises(ModelError, match="cannot stand"):
        FileRecorder(target).begin(replace(fake_runs.layout(1), joints=(joint,)))


def run_script(script, *arguments, **options):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([SOURCE, SUPPORT])}
    command = [sys.executable, "-c", textwrap.dedent(script), *map(str, arguments)]
    return subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
    )


@pytest.mark.parametrize("moment", [0.0, 0.05, 0.11])
def test_kill_9_leaves_complete_rows(target, moment):
    script = """
        import sys, itertools, fake_runs
        from maggi.results import store
        store.FLUSH_SECONDS = 0.0  # as many chances as possible to be hit in the middle
        recorder = store.FileRecorder(sys.argv[1])
        recorder.begin(fake_runs.layout(1000))
        some = list(fake_runs.rows(50))
        for count, row in enumerate(itertools.cycle(some)):
            recorder.write(row.rows())
            if count == 3:
                print("started", flush=True)
    """
    process = run_script(script, target)
    assert process.stdout is not None
    assert process.stdout.readline() == "started\n"
    time.sleep(moment)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    expected = [fake_runs.row(float(t)) for t in fake_runs.times(50)]
    with read(target) as results:
        n = len(results.time)
        assert n >= 4
        assert results.status == "running"
        displacement, force, origin = results.body("rod").displacement, results.joint("crankpin").force, None
        assert len(displacement) == len(force) == n
        origin = results.body("piston").origin
        for k in range(n):
            one = expected[k % 50]
            assert results.time[k] == one.time
            assert (displacement[k] == one.displacement[0]).all()
            assert (force[k] == one.force[1]).all()
            assert (origin[k] == one.origin[2]).all()


# A limit on the size of files stands for the full disk: both refuse the write.
FULL_DISK = """
    import resource, signal, sys, fake_runs
    from maggi.model.errors import ModelError, SimulationError
    from maggi.results import store
    store.FLUSH_SECONDS = 0.0
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    recorder = store.FileRecorder(sys.argv[1])
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), int(sys.argv[2])))
    try:
        recorder.begin(fake_runs.layout(1000))
        for row in fake_runs.rows(1000):
            recorder.write(row.rows())
    except (ModelError, SimulationError) as error:
        recorder.end(f"failed: {error}")
        print(recorder.rows, type(error).__name__, error)
"""


def test_a_full_disk_keeps_what_was_written(target):
    process = run_script(FULL_DISK, target, 4_500_000)
    said, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    rows, kind, message = said.split(maxsplit=2)
    assert kind == "SimulationError"
    assert "File too large; it holds the rows up to t = " in message
    with read(target) as results:
        assert len(results.time) == int(rows) > 10
        assert (results.time == fake_runs.times(1000)[: int(rows)]).all()
        assert (results.body("rod").displacement[-1] == fake_runs.row(results.time[-1]).displacement[0]).all()


@pytest.mark.parametrize(("limit", "kind"), [(1_000, "ModelError"), (2_000_000, "SimulationError")])
def test_a_disk_full_from_the_start_leaves_nothing(target, limit, kind):
    process = run_script(FULL_DISK, target, limit)
    said, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    assert said.startswith(f"0 {kind} cannot ")
    assert "File too large" in said and "rows up to" not in said
    assert list(target.parent.iterdir()) == []


def test_chunks_stay_small(target):
    fake_runs.record(FileRecorder(target), 3)
    sizes = []
    with h5py.File(target) as file:

        def visit(_, item):
            if isinstance(item, h5py.Dataset) and item.chunks:
                sizes.append(int(np.prod(item.chunks)) * 8 // max(1, item.chunks[0]) * item.chunks[0])

        file.visititems(visit)
    assert max(sizes) <= store.CHUNK_BYTES

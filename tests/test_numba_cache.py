"""The folder of the compiled kernels: follows every edit that a kernel can see, and never stands in the way."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

import maggi
from maggi import _numba_cache as cache

KERNEL = """
from numba import njit
from .helpers.callee import double

@njit(cache=True)
def kernel(x):
    return double(x) + 1.0
"""
CALLEE = """
from numba import njit
from maggi_toy.constants import (
    FACTOR,
)

@njit(cache=True)
def double(x):
    return FACTOR * x
"""
FACADE = """
import importlib.util
from pathlib import Path
spec = importlib.util.spec_from_file_location("cache", {cache!r})
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
module.configure(Path(__file__).resolve().parent)
"""


@pytest.fixture
def toy(tmp_path):
    """A package with a kernel, its callee, the callee's constant, and a module that no kernel sees."""
    package = tmp_path / "maggi_toy"
    (package / "helpers").mkdir(parents=True)
    (package / "__init__.py").write_text(FACADE.format(cache=cache.__file__))
    (package / "kernels.py").write_text(KERNEL)
    (package / "helpers" / "__init__.py").write_text("")
    (package / "helpers" / "callee.py").write_text(CALLEE)
    (package / "constants.py").write_text("FACTOR = 2.0\n")
    (package / "report.py").write_text("from . import kernels\n")
    return package


@pytest.fixture(autouse=True)
def no_folder_chosen(monkeypatch):
    monkeypatch.delenv(cache.VARIABLE, raising=False)
    monkeypatch.delenv(cache.OWN_VARIABLE, raising=False)


def run(toy, code, **variables):
    environment = {**os.environ, **variables, "PYTHONPATH": str(toy.parent)}
    result = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    return result.stdout.split()


CALL = """
from maggi_toy.kernels import kernel
print(kernel(3.0), *[sum(hits.values()) for hits in [kernel.stats.cache_hits]])
"""


def test_an_edit_in_another_file_reaches_a_cached_kernel(toy):
    """Without the keyed folder the third call gives 7 again: numba looks at the kernel's own file only."""
    assert run(toy, CALL) == ["7.0", "0"]
    assert run(toy, CALL) == ["7.0", "1"]
    (toy / "constants.py").write_text("FACTOR = 5.0\n")
    assert run(toy, CALL) == ["16.0", "0"]
    (toy / "helpers" / "callee.py").write_text(CALLEE.replace("FACTOR * x", "FACTOR * x * x"))
    assert run(toy, CALL) == ["46.0", "0"]
    assert run(toy, CALL) == ["46.0", "1"]


def test_only_what_kernels_see_changes_the_key(toy):
    key = cache.source_key(toy)
    (toy / "report.py").write_text("from . import kernels\nprint(1)\n")
    with (toy / "__init__.py").open("a") as facade:
        facade.write("\nfrom . import report, kernels\n")
    assert cache.source_key(toy) == key
    seen = {key}
    for name in ("kernels.py", "helpers/callee.py", "helpers/__init__.py", "constants.py"):
        path = toy / name
        path.write_text(path.read_text() + "# edited\n")
        seen.add(cache.source_key(toy))
    assert len(seen) == 5


def test_every_kernel_of_the_program_and_what_it_imports_is_seen():
    package = Path(maggi.__file__).parent
    texts = cache.sources(package)
    assert {package.parent.joinpath(*module).with_suffix(".py"): text for module, text in texts.items()} == {
        path: path.read_bytes() for path in package.rglob("*.py")
    }
    del texts["maggi", "__init__"]  # as for the key
    seen = {"/".join(module[1:]) for module in cache.seen_by_kernels(texts)}
    assert {"linalg/rotations", "linalg/jets", "model/operations", "linalg/__init__"} <= seen
    # what stands above the kernels can be edited without compiling anything
    assert not {name for name in seen if name.split("/")[0] in ("results", "view", "cli", "modelfile", "analyses")}


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("import numpy as np, toy.a", {"numpy", "as", "np", "toy.a"}),
        ("from toy.a import b", {"toy.a.b"}),
        (
            "x = 1\nif x:\n    from .b import (\n    c,\n    d as e,\n)",
            {"toy.sub.b.c", "toy.sub.b.d", "toy.sub.b.as", "toy.sub.b.e"},
        ),
        ("from . import c", {"toy.sub.c"}),
        ("from .. import c  # d", {"toy.c", "toy.d"}),
        ("from ..a import b", {"toy.a.b"}),
        ("# from a import b\nfromage = 1\nimporting = 2", set()),
    ],
)
def test_imports_are_found(text, names):
    assert {".".join(name) for name in cache.imported(text.encode(), ("toy", "sub"))} == names


def test_a_folder_chosen_by_the_user_is_respected(toy, tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "mine"))
    cache.configure(toy)
    assert os.environ[cache.VARIABLE] == str(tmp_path / "mine")
    assert not (toy / "__pycache__").exists()


def test_a_child_process_looks_at_the_sources_anew(toy, monkeypatch):
    """The variable it inherits was set by this module, not by the user."""
    monkeypatch.delitem(sys.modules, "numba", raising=False)  # or this process would be told of the folder
    cache.configure(toy)
    first = os.environ[cache.VARIABLE]
    (toy / "constants.py").write_text("FACTOR = 3.0\n")
    assert run(toy, f"import maggi_toy, os; print(os.environ[{cache.VARIABLE!r}])") != [first]


def test_numba_imported_before_is_told(toy):
    code = "import numba, maggi_toy, os; print(numba.config.CACHE_DIR == os.environ['NUMBA_CACHE_DIR'])"
    assert run(toy, code) == ["True"]


def test_a_package_that_cannot_be_written_to_uses_the_users_folder(tmp_path):
    blocked = tmp_path / "blocked"
    blocked.write_text("a file where a folder should be")
    assert cache.make_folder((blocked, tmp_path / "user"), "key") == tmp_path / "user" / "key"
    temporary = cache.make_folder((blocked, blocked), "key")
    assert temporary.is_dir()
    assert temporary.stat().st_mode & 0o077 == 0


def test_the_users_folder_follows_the_platform(monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", "/var/scratch")
    assert cache.user_cache() == (Path("/var/scratch/maggi/numba"),)
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", "/home/someone")
    assert cache.user_cache() == (Path("/home/someone/.cache/maggi/numba"),)

    def no_home(path):
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "expanduser", no_home)
    assert cache.user_cache() == ()


def test_old_folders_go_but_not_those_in_use(tmp_path):
    now = time.time()
    for age in range(10):
        folder = tmp_path / f"state{age}"
        folder.mkdir()
        seconds = now - age * cache.KEPT_SECONDS / 3.5
        os.utime(folder, (seconds, seconds))
    cache.make_folder((tmp_path,), "state0")
    assert len(list(tmp_path.iterdir())) == 10, "nothing new, nothing to remove"
    cache.make_folder((tmp_path,), "new")
    # The new one, and those of the last day: ages 0, 1, 2, 3 times 1/3.5 days.
    assert {path.name for path in tmp_path.iterdir()} == {"new", "state0", "state1", "state2", "state3"}


def test_importing_the_program_is_light():
    code = "import sys, maggi; print(*sorted({'numba', 'numpy', 'scipy'} & set(sys.modules)) or ['none'])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "none"

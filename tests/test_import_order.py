"""Imports point one way: a package sees only what is below it in the order of the design.

Counted are all import statements, also those inside functions and under TYPE_CHECKING, and import_module("maggi...")
with a literal name.
"""

from __future__ import annotations

import ast
import textwrap
from collections.abc import Iterator
from pathlib import Path

import pytest

import maggi

PACKAGE = Path(maggi.__file__).parent

# Package: those directly below it; what is below them is allowed as well.
BELOW: dict[str, tuple[str, ...]] = {
    "model": (),
    # Functions of time are described in model and evaluated in linalg.
    "linalg": ("model",),
    "mesh": ("linalg",),
    "elements": ("mesh",),
    "bodies": ("elements",),
    "liaisons": ("bodies",),
    # Torsion springs act on joint coordinates.
    "forces": ("liaisons",),
    "system": ("forces",),
    "projection": ("system",),
    "formulations": ("projection",),
    "integrators": ("linalg",),
    "stepping": ("projection", "integrators"),
    "analyses": ("stepping", "formulations"),
    "results": ("analyses",),
    "view": ("results",),
    "modelfile": ("model",),
    "cli": ("view", "modelfile"),
    # Single modules beside the packages.
    "_numba_cache": (),
    "api": ("results", "modelfile"),
    "__main__": ("cli",),
}
# Not to be used although it is below: the formulations are there to check the projection, and the integrators work on
# plain vectors.
KEPT_APART = {"formulations": {"projection"}, "integrators": {"model"}}
# What a package may take from the facade, which otherwise stands above everything.
FROM_FACADE = {"__version__"}


def allowed(package: str) -> set[str]:
    """The package itself and everything below it, less what it is kept apart from."""
    return below(package) - KEPT_APART.get(package, set())


def below(package: str) -> set[str]:
    """The package itself and everything below it."""
    return {package}.union(*(below(lower) for lower in BELOW[package]))


def imported_modules(source: str, module: str, is_package: bool) -> Iterator[tuple[int, str]]:
    """Line and absolute dotted name of everything that a module of maggi imports from maggi."""
    parents = module.split(".") if is_package else module.split(".")[:-1]
    for node in ast.walk(ast.parse(source)):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            start = parents[: len(parents) - node.level + 1] if node.level else []
            base = ".".join([*start, *(node.module or "").split(".")]).rstrip(".")
            names = [f"{base}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("import_module", "__import__")):
            names = [a.value for a in node.args if isinstance(a, ast.Constant) and isinstance(a.value, str)]
        yield from ((node.lineno, name) for name in names if name.split(".")[0] == "maggi")


def violations(source: str, module: str, is_package: bool = False) -> list[str]:
    """The imports of a module against the order, as "module:line imports name"."""
    package = module.split(".")[1] if "." in module else ""
    if not package:
        return []  # the facade
    found = []
    for line, name in imported_modules(source, module, is_package):
        target = name.split(".")[1] if "." in name else ""
        if target not in allowed(package) and target not in FROM_FACADE:
            found.append(f"{module}:{line} imports {name}")
    return found


def test_every_package_has_its_place():
    packages = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    modules = {path.stem for path in PACKAGE.glob("*.py")} - {"__init__"}
    assert packages | modules <= set(BELOW)


def test_imports_follow_the_order():
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = ("maggi", *path.relative_to(PACKAGE).with_suffix("").parts)
        is_package = parts[-1] == "__init__"
        module = ".".join(parts[:-1] if is_package else parts)
        found += violations(path.read_text(encoding="utf-8"), module, is_package)
    assert not found


def test_model_stands_on_nothing_and_integrators_on_linalg():
    assert allowed("model") == {"model"}
    assert allowed("integrators") == {"integrators", "linalg"}


def test_formulations_do_not_see_projection():
    assert "projection" not in allowed("formulations")
    assert "projection" in allowed("stepping")


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("maggi.mesh.boxes", "from maggi.bodies import rigid"),
        ("maggi.mesh.boxes", "import maggi.elements.tet10 as t"),
        ("maggi.mesh.boxes", "from ..elements import tet10"),
        ("maggi.mesh.boxes", "from .. import elements"),
        ("maggi.mesh.boxes", "from maggi import elements"),
        ("maggi.mesh.boxes", "import maggi"),
        ("maggi.mesh.boxes", "from maggi import load"),
        ("maggi.mesh.boxes", "def f():\n    from ..system import pack"),
        ("maggi.mesh.boxes", "import typing\nif typing.TYPE_CHECKING:\n    from ..system import pack"),
        ("maggi.mesh.boxes", "import importlib\nimportlib.import_module('maggi.system')"),
        ("maggi.model.bodies", "from maggi.linalg import rotations"),
        ("maggi.linalg.rotations", "from ..mesh import boxes"),
        ("maggi.integrators.alpha", "from ..model.errors import ModelError"),
        ("maggi.liaisons.lower_pairs", "from ..forces import gravity"),
        ("maggi.forces.gravity", "from ..system import build"),
        ("maggi.formulations.kane", "from ..projection import maggi"),
        ("maggi.modelfile.schema", "from ..mesh import read"),
        ("maggi.analyses.transient", "from ..results import store"),
    ],
)
def test_an_import_against_the_order_is_caught(module, source):
    assert len(violations(textwrap.dedent(source), module)) == 1


def test_relative_imports_of_a_package_start_at_itself():
    assert violations("from .boxes import box", "maggi.mesh", is_package=True) == []
    assert violations("from ..elements import tet10", "maggi.mesh", is_package=True) == [
        "maggi.mesh:1 imports maggi.elements.tet10"
    ]


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("maggi.mesh.boxes", "import numpy\nfrom scipy import sparse\nfrom ..model.errors import MeshError"),
        ("maggi.mesh.boxes", "from .cells import Cell\nfrom maggi.mesh import cells\nfrom maggi import __version__"),
        ("maggi.forces.kernels", "from ..liaisons.tables import LiaisonTable"),
        ("maggi.system.pack", "from ..model import joints\nfrom ..elements import tet10\nfrom .. import liaisons"),
        ("maggi.stepping.step", "from ..integrators import alpha\nfrom ..projection.maggi import project"),
        ("maggi.cli.main", "from ..modelfile import load\nfrom ..analyses import transient"),
        ("maggi", "from maggi.cli import main"),
    ],
)
def test_an_import_along_the_order_is_let_through(module, source):
    assert violations(source, module) == []

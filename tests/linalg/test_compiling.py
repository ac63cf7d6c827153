"""Kernels without an entry for Python: nothing but kernels may name them, since a call would end the process."""

from __future__ import annotations

import ast
import gc
from pathlib import Path

import numpy as np
import pytest
from numba import njit

import maggi
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.links import Link
from maggi.linalg.table import Table

PACKAGE = Path(maggi.__file__).parent
INNER = {"inner_kernel", "inner_pass"}
COMPILED = {*INNER, "kernel", "part_kernel", "njit", "Link", "SharedPass"}


def decorators(function: ast.FunctionDef) -> set[str]:
    """Names of a function's decorators, without what stands before their last dot."""
    found = (d.func if isinstance(d, ast.Call) else d for d in function.decorator_list)
    return {d.attr if isinstance(d, ast.Attribute) else getattr(d, "id", "") for d in found}


def inner(tree: ast.Module) -> set[str]:
    """The kernels of a module that only kernels may call."""
    functions = (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))
    return {function.name for function in functions if decorators(function) & INNER}


def named_outside(tree: ast.AST, names: set[str], *, compiled: bool = False) -> list[tuple[int, str]]:
    """Line and name where one of these is named by anything that is not compiled."""
    if isinstance(tree, ast.FunctionDef):
        compiled = compiled or bool(decorators(tree) & COMPILED)
    if isinstance(tree, ast.Name) and tree.id in names and not compiled:
        return [(tree.lineno, tree.id)]
    parts = tree.body if isinstance(tree, ast.FunctionDef) else ast.iter_child_nodes(tree)
    return [found for part in parts for found in named_outside(part, names, compiled=compiled)]


def imported(tree: ast.Module, kernels: dict[str, set[str]]) -> set[str]:
    """Inner kernels of other modules that a module has by their names."""
    lists = (node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom))
    return {
        alias.asname or alias.name
        for node in lists
        for alias in node.names
        if alias.name in kernels.get((node.module or "").split(".")[-1], set())
    }


def test_only_kernels_call_kernels_without_an_entry() -> None:
    trees = {path: ast.parse(path.read_text(encoding="utf-8")) for path in PACKAGE.rglob("*.py")}
    kernels: dict[str, set[str]] = {}
    for path, tree in trees.items():
        kernels.setdefault(path.stem, set()).update(inner(tree))
    assert sum(map(len, kernels.values())) > 30
    for path, tree in trees.items():
        assert named_outside(tree, inner(tree) | imported(tree, kernels)) == [], path
    for path in Path(__file__).parent.parent.rglob("*.py"):
        assert imported(ast.parse(path.read_text(encoding="utf-8")), kernels) == set(), path


@pytest.mark.parametrize(("callee", "caller"), [("inner_kernel", "kernel"), ("inner_pass", "SharedPass")])
def test_a_call_from_outside_is_found(callee: str, caller: str) -> None:
    tree = ast.parse(
        f"@{callee}\ndef f(x): return x\n\n@{caller}\ndef g(x): return f(x)\n\ndef h(x):\n    return f(x)\n"
    )
    assert named_outside(tree, inner(tree)) == [(8, "f")]


@inner_kernel
def twice(x: float) -> float:
    return 2.0 * x


@kernel
def four_times(x: float) -> float:
    return twice(twice(x))


def test_a_kernel_calls_inner_ones() -> None:
    assert four_times(1.5) == 6.0


def test_a_kernel_without_an_entry_is_no_link() -> None:
    @kernel
    def nothing(table: Table, t: float) -> None:
        pass

    from dataclasses import dataclass

    @dataclass(frozen=True, eq=False)
    class One(Table):
        x: np.ndarray

    with pytest.raises(TypeError, match="nothing was compiled without an entry for calls by address"):
        Link(nothing).address(One(np.zeros(1)))


def test_the_collector_is_on_again_after_compiling() -> None:
    @njit
    def fresh(x: float) -> float:
        return x + 1.0

    assert gc.isenabled()
    assert fresh(1.0) == 2.0
    assert gc.isenabled()
    gc.disable()
    try:
        assert fresh(1) == 2  # compiled for another type
        assert not gc.isenabled()
    finally:
        gc.enable()

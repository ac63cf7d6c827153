"""Gibbs–Appell, Kane and Newton–Euler share no matrix and no kernel with Maggi's equations: by import, and by trial."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import four_bar

import maggi.formulations
from maggi.analyses.initial import initial_motion
from maggi.formulations import FORMULATIONS, question_at
from maggi.formulations.terms import Terms
from maggi.system.build import build_system

FOLDER = Path(maggi.formulations.__file__).parent
# The only modules that may see the program's tables: the question's two halves, and where they are put together.
SEE_THE_SYSTEM = {"__init__", "question", "terms"}
FROM_POINTS = ("gibbs_appell", "kane", "newton_euler")
# What those may use: descriptions, meshes, and of the elements shape functions and quadrature.
ALLOWED = (
    "maggi.model",
    "maggi.mesh",
    "maggi.elements.quadrature",
    "maggi.elements.solids",
    "maggi.elements.beam",
)
BEAM_NAMES = {"beam_axes", "beam_shapes", "shear_flexibilities"}


def imports(path):
    """Modules and names that a file imports from outside the formulations."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module or "", {alias.name for alias in node.names}
        elif isinstance(node, ast.Import):
            yield from ((alias.name, set()) for alias in node.names)


@pytest.mark.parametrize("path", sorted(FOLDER.rglob("*.py")), ids=lambda path: str(path.relative_to(FOLDER)))
def test_only_descriptions_shape_functions_and_quadrature_are_used(path):
    if path.stem in SEE_THE_SYSTEM and path.parent == FOLDER:
        return
    for module, names in imports(path):
        if module.split(".")[0] != "maggi":
            assert module.split(".")[0] != "numba"
            continue
        assert module.startswith(ALLOWED), module
        if module == "maggi.elements.beam":
            assert names <= BEAM_NAMES
        if module == "maggi.elements.solids":
            assert names <= {"SOLIDS"}


@pytest.mark.parametrize("name", FROM_POINTS)
def test_no_matrix_of_the_program_reaches_them(name):
    """They look at the question's points alone: its `terms` are never read."""
    tree = ast.parse((FOLDER / f"{name}.py").read_text(encoding="utf-8"))
    attributes = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    assert "terms" not in attributes


def test_they_answer_with_the_matrices_spoilt():
    """With every matrix of the program replaced by nonsense they answer as before, and Lagrange does not."""
    system = build_system(four_bar())
    question = question_at(system, initial_motion(system, []), 0.0)
    terms, rng = question.terms, np.random.default_rng(1)
    nonsense = [rng.normal(size=part.shape) for part in (terms.M, terms.A, terms.gamma, terms.f, terms.scale)]
    spoilt = replace(question, terms=Terms(*nonsense, terms.owner))
    for name, formulation in FORMULATIONS.items():
        same = np.array_equal(formulation(question).accelerations, formulation(spoilt).accelerations)
        assert same == (name != "Lagrange")

"""Relative coordinates: a tree by elimination and closures in range space, against dense matrices and null spaces."""

import numpy as np
import pytest
from linkages import four_bar, random_mechanism
from scipy.linalg import null_space

from maggi.projection.closures import (
    add_closure_forces,
    apply_compliance,
    closure_compliance,
    closure_rates,
    closure_scale,
)
from maggi.projection.relative_motion import relative_motion
from maggi.projection.relative_system import relative_system
from maggi.projection.tree_kernels import closure_columns, inwards, outwards, tree_factor
from maggi.stepping.allocate import new_instant, new_record, new_state, new_work, small_system
from maggi.stepping.evaluation import evaluate
from maggi.stepping.instant_kernels import show
from maggi.stepping.linking import link
from maggi.system.build import build_system
from maggi.system.dense import dense_mass, dense_rows

PAIRS = ["revolute", "spherical", "prismatic", "cylindrical", "planar", "weld"]
MODELS = {
    "four-bar": lambda: four_bar(),
    "spatial four-bar": lambda: four_bar(("revolute", "spherical", "spherical", "revolute")),
    "tree": lambda: random_mechanism(1, 8, 0, PAIRS),
    "loops": lambda: random_mechanism(3, 8, 2, PAIRS),
    "rows that no tree takes": lambda: random_mechanism(4, 6, 1, ["universal", "revolute", "screw"]),
}


class Case:
    """A system at a state that meets its rows at all three levels, dense and in relative coordinates."""

    def __init__(self, model):
        self.system = system = build_system(model)
        self.relative = relative_system(system)
        rng = np.random.default_rng(5)
        motion = system.start.copy()
        A = dense_rows(system, motion, 0.0).A
        S = null_space(A)
        motion.v[:] = S @ rng.normal(size=S.shape[1])
        gamma = dense_rows(system, motion, 0.0).acceleration
        motion.vd[:] = np.linalg.lstsq(A, -gamma, rcond=1e-10)[0] + S @ rng.normal(size=S.shape[1])
        self.motion, self.A = motion, A
        self.small = small_system(system, self.relative)
        instant = new_instant(system, 1.0, 1.0)
        self.state = new_state(system, self.relative, instant)
        self.work = new_work(system, self.relative)
        link(self.small, self.state, self.work, instant, new_record(instant, 1), lambda text: None)
        vectors = self.state.vectors
        relative_motion(self.relative, motion, self.state.joints, self.state.accepted, vectors.nu, vectors.nud)
        vectors.nu_next[:], vectors.nud_next[:] = vectors.nu, vectors.nud
        evaluate(self.small, self.state, self.work, 0.0)


@pytest.fixture(scope="module", params=MODELS, ids=str)
def case(request):
    return Case(MODELS[request.param]())


def test_every_rigid_body_is_carried_once(case):
    tree = case.relative.tree
    rigid = np.flatnonzero(case.system.bodies.kind == 1)
    assert sorted(tree.body) == sorted(rigid)
    assert (tree.parent < np.arange(len(tree.parent))).all()
    # rows in joints and closures are all rows, each once
    rows = np.concatenate([case.relative.joint_row, case.relative.closure_row])
    assert sorted(rows) == list(range(case.system.rows))
    # as many free motions as a body has velocities less the rows of its joint
    locked = np.diff(case.relative.joint_row_start)
    np.testing.assert_array_equal(np.diff(tree.free_start), 6 - locked)


def test_motion_survives_the_way_there_and_back(case):
    """Positions, velocities and accelerations in the frames of the model, from the tree's joints alone."""
    shown = new_instant(case.system, 1.0, 1.0)
    show(case.small, case.state, case.work, shown, 0.0)
    for name in ("origin", "rotation", "v", "vd"):
        expected = getattr(case.motion, name)
        np.testing.assert_allclose(
            getattr(shown.now, name), expected, atol=1e-12 * max(1.0, np.abs(expected).max()), err_msg=name
        )


def test_rows_of_closures_are_those_of_the_model(case):
    rows, full = case.state.rows, dense_rows(case.system, case.motion, 0.0)
    for name in ("position", "velocity", "acceleration"):
        expected = getattr(full, name)[case.relative.closure_row]
        np.testing.assert_allclose(getattr(rows, name), expected, atol=1e-11, err_msg=name)


@pytest.mark.parametrize("sigma", [1.0, 0.6])
def test_compliance_of_closures_is_that_of_the_null_space(case, sigma):
    """Λ = A S (Sᵀ σM S)⁻¹ Sᵀ Aᵀ with S from a singular value decomposition of the rows in the tree's joints."""
    system, tree, work = case.system, case.relative.tree, case.work
    tree_factor(tree, tree.M, sigma, work.stiffness, work.tree)
    closure_columns(tree, case.state.rows.A, work.kept, work.tree)
    closure_compliance(tree, case.relative.bodies, work.W, work.tree, work.kept, work.product, work.L)
    found = from_skyline(tree, work.L)
    S = null_space(case.A[case.relative.joint_row]) if len(case.relative.joint_row) else np.eye(system.coordinates)
    A = case.A[case.relative.closure_row] @ S
    M = S.T @ (sigma * dense_mass(system, case.motion)) @ S
    expected = A @ np.linalg.solve(M, A.T)
    np.testing.assert_allclose(found, expected, atol=1e-10 * max(1e-300, np.abs(expected).max(initial=1.0)))
    # a motion that forces on closures cause, and what closures see of it
    rng = np.random.default_rng(0)
    x, out = rng.normal(size=len(A)), np.zeros(len(A))
    force, z = np.zeros(len(tree.size)), np.zeros(len(tree.size))
    add_closure_forces(tree, work.tree.columns, x, 1.0, force)
    apply_compliance(tree, case.relative.bodies, work.W, work.tree, force, z)
    closure_rates(tree, work.tree.columns, z, 0, out)
    np.testing.assert_allclose(out, expected @ x, atol=1e-9 * max(1e-300, np.abs(expected).max(initial=1.0)))
    # the motion itself, on the bodies: S (SᵀσMS)⁻¹ Aᵀ x
    back, before = np.zeros(len(tree.size)), z.copy()
    outwards(tree, work.tree, z)
    inwards(tree, work.tree, z, back)
    np.testing.assert_allclose(back, before, atol=1e-12 * max(1e-300, np.abs(before).max(initial=1.0)))
    scale = np.zeros(len(A))
    closure_scale(tree, case.relative.bodies, case.state.rows.A, tree.W, sigma, work.W, work.product, scale)
    full = case.A[case.relative.closure_row]
    alone = np.diag(full @ np.linalg.solve(sigma * dense_mass(system, case.motion), full.T))
    table = case.relative.closures
    starts = table.end_start
    ends = [table.end[starts[i] : starts[i + 1], 0] for i in range(len(A))]
    single = np.array([len(set(part)) == len(part) for part in ends], dtype=bool)
    np.testing.assert_allclose(scale[single], alone[single], rtol=1e-9)


def from_skyline(tree, L):
    """A symmetric matrix from skyline storage."""
    r = len(tree.skyline_first)
    matrix = np.zeros((r, r))
    for i in range(r):
        matrix[i, tree.skyline_first[i] : i + 1] = L[tree.skyline_start[i] : tree.skyline_start[i + 1]]
    return matrix + np.tril(matrix, -1).T

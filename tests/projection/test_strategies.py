"""Strategies for independent velocities: one and the same set of admitted velocities, whatever the pivots (T8)."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from linkages import four_bar, random_mechanism
from reference_models import four_bars, squeezer

from maggi.analyses.initial import initial_motion
from maggi.projection.chart import unknown_velocities
from maggi.projection.maggi import RANK_TOLERANCE, accelerations, project
from maggi.projection.spanning_tree import spanning_tree, tree_velocities
from maggi.projection.splitting import HYSTERESIS, decided_rank
from maggi.projection.strategies import KEEP, by_lu, by_qr, by_svd, kept_or_renewed, named_strategy
from maggi.system.build import build_system
from maggi.system.dense import dense_mass, dense_rows, velocity_scale

NAMES = ("lu", "qr", "svd", "tree")
KINDS = ("revolute", "spherical", "prismatic", "cylindrical", "planar", "universal", "weld")


def check(splitting, A, scale, rank):
    """What every splitting promises."""
    n = A.shape[1]
    size = np.linalg.norm(A / scale, axis=1) + 1e-300
    assert (splitting.rank, splitting.freedoms) == (rank, n - rank)
    np.testing.assert_allclose(splitting.P @ splitting.N, 0.0, atol=1e-11)
    admitted = splitting.at(A)
    np.testing.assert_allclose(splitting.P @ admitted.S, np.eye(n - rank), atol=1e-11)
    scaled = admitted.S * scale[:, None]
    length = np.linalg.norm(scaled, axis=0)
    assert np.all(np.abs(A @ admitted.S) <= 1e-10 * size[:, None] * length)
    b = A @ (np.random.default_rng(0).normal(size=n) / scale)
    v_p = admitted.particular(b)
    assert np.abs((A @ v_p + b) / size).max(initial=0.0) < 1e-9
    np.testing.assert_allclose(splitting.P @ v_p, 0.0, atol=1e-10 * (1.0 + np.abs(splitting.P).max(initial=0.0)))
    assert admitted.condition >= 1.0 - 1e-12
    assert sorted([*splitting.rows, *splitting.redundant]) == list(range(len(A)))
    chosen = (A / scale / size[:, None])[splitting.rows]
    assert np.linalg.matrix_rank(chosen, tol=1e-9) == rank
    return scaled / length


@given(st.integers(0, 7), st.integers(1, 9), st.integers(0, 3), st.booleans(), st.integers(0, 2**32 - 1))
def test_random_rows(independent, n, repeated, scaled, seed):
    """The same rank, and columns that span the same space as those of `project`."""
    rng = np.random.default_rng(seed)
    independent = min(independent, n)
    A = rng.normal(size=(independent, n))
    if repeated and independent:
        A = np.vstack([A, rng.normal(size=(repeated, independent)) @ A])
    scale = 10.0 ** rng.uniform(-2, 2, n) if scaled else np.ones(n)
    A = A * scale
    S = project(A, scale).S * scale[:, None]
    basis = np.linalg.qr(S)[0]
    for strategy in (by_lu, by_qr, by_svd):
        splitting = strategy(None, A, scale, None)
        if np.linalg.cond(A[splitting.rows] / scale) > 1e5 if independent else False:
            return
        columns = check(splitting, A, scale, independent)
        np.testing.assert_allclose(basis @ (basis.T @ columns), columns, atol=1e-8)


@pytest.mark.parametrize("model", [four_bar(), four_bar(tilt=0.3), four_bars(2), squeezer()])
def test_mechanisms(model):
    """All four strategies, also with rows repeated by redundant joints; accelerations do not depend on the choice."""
    system = build_system(model)
    motion = initial_motion(system, [])
    A, scale = dense_rows(system, motion, 0.0).A, velocity_scale(system)
    rank = project(A, scale).rank
    tree = spanning_tree(system, A, unknown_velocities(system))
    rng = np.random.default_rng(2)
    M, f, gamma = dense_mass(system, motion), rng.normal(size=len(scale)), A @ rng.normal(size=len(scale))
    expected = accelerations(project(A, scale), M, f, gamma)
    for name in NAMES:
        splitting = named_strategy(name, tree)(motion, A, scale, None)
        check(splitting, A, scale, rank)
        found = accelerations(splitting.at(A), M, f, gamma)
        np.testing.assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.integers(0, 3))
def test_spanning_trees(seed, count, loops):
    """v = B q̇ satisfies the tree's joints and q̇ is read off v again; with its loops closed it is `project`'s space."""
    system = build_system(random_mechanism(seed, count, loops, KINDS))
    motion = system.start
    A, scale = dense_rows(system, motion, 0.0).A, velocity_scale(system)
    tree = spanning_tree(system, A, unknown_velocities(system))
    assert len(tree.branches) == count
    of_tree = np.concatenate([branch.rows for branch in tree.branches])
    assert sorted([*of_tree, *tree.loop_rows]) == list(range(system.rows))
    B, rates, size = tree_velocities(tree, motion, A, scale)
    assert B.shape[1] == len(scale) - len(of_tree) == len(size)
    large = np.abs(B * scale[:, None]).max(initial=1.0)
    np.testing.assert_allclose(A[of_tree] @ B, 0.0, atol=1e-11 * large * system.size)
    np.testing.assert_allclose(rates @ B, np.eye(len(size)), atol=1e-9 * large)
    known = project(A, scale)
    if known.gap < 1e6:
        return
    splitting = named_strategy("tree", tree)(motion, A, scale, None)
    check(splitting, A, scale, known.rank)


def test_joint_velocities_of_a_chain():
    """Revolute joints about z one after the other: ν are the differences of the bodies' angular velocities."""
    model = four_bar()
    chain = replace(model, joints={name: model.joints[name] for name in ("j0", "j1", "j2")})
    system = build_system(chain)
    A, scale = dense_rows(system, system.start, 0.0).A, velocity_scale(system)
    tree = spanning_tree(system, A, unknown_velocities(system))
    splitting = named_strategy(None, tree)(system.start, A, scale, None)
    assert splitting.strategy == "tree"
    assert [branch.before for branch in tree.branches] == [-1, 1, 2]
    turns = (splitting.at(A).S @ np.array([1.0, 10.0, 100.0])).reshape(3, 6)[:, 4]
    np.testing.assert_allclose(np.abs(np.diff([0.0, *turns])), [1.0, 10.0, 100.0])


def test_the_default_goes_by_structure():
    """A closed loop is partitioned; a chain has its joints' velocities."""
    for model, name in ((four_bar(), "lu"), (replace(four_bar(), joints={}), "tree")):
        system = build_system(model)
        A = dense_rows(system, system.start, 0.0).A
        tree = spanning_tree(system, A, unknown_velocities(system))
        assert named_strategy(None, tree)(system.start, A, velocity_scale(system), None).strategy == name
    with pytest.raises(ValueError, match="no strategy 'cholesky'; use one of lu, qr"):
        named_strategy("cholesky", tree)


def test_rank_has_hysteresis():
    """Between the thresholds what was stays; beyond them it changes."""
    low, high = RANK_TOLERANCE / HYSTERESIS, RANK_TOLERANCE * HYSTERESIS
    for pivot, expected in ((0.5 * low, (1, 1)), (2 * low, (1, 2)), (0.5 * high, (1, 2)), (2 * high, (2, 2))):
        pivots = np.array([1.0, pivot])
        assert (decided_rank(pivots, 3, 1), decided_rank(pivots, 3, 2)) == expected
    assert decided_rank(np.array([1.0, 2 * RANK_TOLERANCE]), 3, None) == 2
    assert decided_rank(np.array([1.0, 0.5 * RANK_TOLERANCE]), 3, None) == 1
    assert decided_rank(np.array([1e-16, 1e-17]), 4, None) == 0


def test_a_choice_is_kept_until_it_is_bad():
    """One row a·v = 0 whose dependent velocity loses its coefficient, and rows that lose rank for an instant."""
    three = by_lu(None, np.array([[1.0, 0.1, 0.2]]), np.ones(3), None)
    assert kept_or_renewed(three, by_lu, None, np.array([[1.0, 0.5, 0.3]])) is three
    worse = np.array([[0.01, 1.0, 0.5]])
    assert three.at(worse).condition > KEEP * three.condition
    np.testing.assert_array_equal(kept_or_renewed(three, by_lu, None, worse).velocities, [0, 2])
    assert kept_or_renewed(three, by_lu, None, np.zeros((1, 3))) is three

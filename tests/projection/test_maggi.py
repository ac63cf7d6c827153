"""Maggi's projection on random rows and on linkages (T8–T11), against the equations it must satisfy and Lagrange's."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from linkages import four_bar
from motions import positive

from maggi.analyses.initial import initial_motion
from maggi.bodies.attachment_kernels import move
from maggi.projection.maggi import accelerations, closest_velocities, liaison_forces, project, restore
from maggi.stepping.allocate import copy_motion
from maggi.system.build import build_system
from maggi.system.dense import dense_mass, dense_rows, velocity_scale

ROWS = st.tuples(st.integers(0, 8), st.integers(1, 10), st.integers(0, 4), st.integers(0, 2**32 - 1), st.booleans())


def random_rows(independent, n, repeated, seed, scaled):
    """Rows of rank min(independent, n), `repeated` of them combinations of others, in random order; b in their range."""
    rng = np.random.default_rng(seed)
    independent = min(independent, n)
    A = rng.normal(size=(independent, n))
    if repeated and independent:
        A = np.vstack([A, rng.normal(size=(repeated, independent)) @ A])
    A = A[rng.permutation(len(A))]
    scale = 10.0 ** rng.uniform(-2, 2, n) if scaled else np.ones(n)
    A = A * scale * 10.0 ** rng.uniform(-3, 3, len(A))[:, None]
    return A, A @ (rng.normal(size=n) / scale), scale, independent


def size_of(A, *vectors):
    """What round-off of A x counts with, row by row."""
    return sum((np.abs(A) @ np.abs(x) for x in vectors), np.full(len(A), 1e-300))


@given(ROWS)
def test_admitted_velocities(rows):
    """T8: A S = 0, S is the identity on ν, A v_p = −b, and the rank is that of the rows."""
    A, b, scale, rank = random_rows(*rows)
    p = project(A, scale)
    n = A.shape[1]
    assert p.rank == rank
    assert p.S.shape == (n, n - rank)
    assert sorted([*p.independent, *p.dependent]) == list(range(n))
    assert sorted([*p.rows, *p.redundant]) == list(range(len(A)))
    np.testing.assert_array_equal(p.S[p.independent], np.eye(n - rank))
    assert np.all(np.abs(A @ p.S) <= 1e-12 * size_of(A, np.abs(p.S).max(axis=1, initial=0.0))[:, None])
    v_p = p.particular(b)
    assert np.all(np.abs(A @ v_p + b) <= 1e-9 * size_of(A, v_p))
    assert not v_p[p.independent].any()
    # the rows that are kept have the whole rank
    weights = np.linalg.norm(A / scale, axis=1)
    kept = (A / scale / weights[:, None])[p.rows] if rank else np.zeros((0, n))
    assert np.linalg.matrix_rank(kept, tol=1e-9) == rank


@given(ROWS)
def test_accelerations_are_those_of_lagranges_multipliers(rows):
    """T9, T10, T11 against least squares on [M Aᵀ; A 0], on rows of ordinary size; M v̇ = f − Aᵀλ."""
    A, _, _, _ = random_rows(*rows[:4], False)
    A = A / np.linalg.norm(A, axis=1)[:, None]
    m, n = A.shape
    rng = np.random.default_rng(rows[3] + 1)
    M, f, gamma = positive(rng, n), rng.normal(size=n), A @ rng.normal(size=n)
    p = project(A)
    kkt = np.block([[M, A.T], [A, np.zeros((m, m))]])
    expected = np.linalg.lstsq(kkt, np.concatenate([f, -gamma]), rcond=1e-11)[0]
    vd = accelerations(p, M, f, gamma)
    condition = np.linalg.cond(p.S) if p.S.size else 1.0
    tolerance = 1e-12 * condition**2 * np.linalg.norm(expected)
    np.testing.assert_allclose(vd, expected[:n], rtol=0, atol=tolerance)
    multipliers = liaison_forces(p, f - M @ vd)
    np.testing.assert_allclose(A.T @ multipliers, f - M @ vd, rtol=0, atol=tolerance * n * np.abs(M).max())


@given(ROWS)
def test_closest_velocities(rows):
    """Admitted, and the correction is M-orthogonal to every admitted velocity: no nearer ones exist."""
    A, b, _, _ = random_rows(*rows[:4], False)
    weights = np.linalg.norm(A, axis=1)
    A, b = A / weights[:, None], b / weights
    rng = np.random.default_rng(rows[3] + 1)
    M, v = positive(rng, A.shape[1]), rng.normal(size=A.shape[1])
    p = project(A)
    w = closest_velocities(p, M, v, b)
    condition = np.linalg.cond(p.S) if p.S.size else 1.0
    size = np.linalg.norm(w) + np.linalg.norm(v)
    np.testing.assert_allclose(A @ w, -b, atol=1e-11 * condition * size)
    orthogonal = p.S.T @ M @ (w - v) / (np.abs(p.S).T.sum(axis=1) * np.abs(M).max())
    np.testing.assert_allclose(orthogonal, 0.0, atol=1e-11 * condition * size)
    again = closest_velocities(p, M, w, b)
    np.testing.assert_allclose(again, w, atol=1e-11 * condition * size)


def test_inconsistent_rows_show():
    """Two equal rows that ask for different velocities: half the difference remains on each."""
    p = project(np.array([[1.0, 2.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 1.0]]))
    assert p.rank == 2
    np.testing.assert_allclose(p.inconsistency(np.array([1.0, 1.0, 5.0])), 0.0, atol=1e-15)
    np.testing.assert_allclose(np.abs(p.inconsistency(np.array([1.0, 2.0, 5.0]))), [0.5, 0.5, 0.0], atol=1e-15)


def test_the_gap_says_how_clear_the_rank_is():
    rng = np.random.default_rng(1)
    A = rng.normal(size=(3, 5))
    nearly = np.vstack([A, A[0] + A[1] + 1e-13 * rng.normal(size=5)])
    assert project(A).gap == np.inf
    p = project(nearly)
    assert p.rank == 3 and 1e10 < p.gap < 1e15
    assert project(np.vstack([A, A[0] + 1e-6 * rng.normal(size=5)])).rank == 4


def test_no_rows_and_rows_that_are_not_finite():
    p = project(np.zeros((0, 3)))
    np.testing.assert_array_equal(p.S, np.eye(3))
    with pytest.raises(ValueError, match="not finite"):
        project(np.array([[1.0, np.nan]]))


@pytest.mark.parametrize(
    ("kinds", "tilt", "rank"),
    [
        (("revolute",) * 4, 0.0, 17),
        (("revolute",) * 4, 0.3, 18),
        (("revolute", "spherical", "spherical", "revolute"), 0.0, 16),
        (("revolute", "spherical", "cylindrical", "revolute"), 0.0, 17),
    ],
)
def test_rank_of_a_four_bar(kinds, tilt, rank):
    """Three bodies have 18 velocities. By hand: one freedom in a plane; none with a tilted axis; the coupler's spin."""
    system = build_system(four_bar(kinds, tilt))
    rows = dense_rows(system, system.start, 0.0)
    p = project(rows.A, velocity_scale(system))
    assert p.rank == rank
    assert len(p.redundant) == system.rows - rank
    assert p.gap > 1e6


@pytest.mark.parametrize("kinds", [("revolute",) * 4, ("revolute", "spherical", "spherical", "revolute")])
def test_restore_closes_a_perturbed_loop(kinds):
    """Back on Φ = 0 from gaps of 0.05, quadratically; in the metric M nothing moves along the free directions."""
    system = build_system(four_bar(kinds))
    base = initial_motion(system, [])
    rng = np.random.default_rng(2)
    n = system.coordinates
    move(system.bodies, base, 0.02 * rng.normal(size=n), base := copy_motion(base))
    trial = copy_motion(base)
    history, steps = [], []

    def rows(step):
        move(system.bodies, trial, step, trial)
        at = dense_rows(system, trial, 0.0)
        history.append(np.abs(at.position).max())
        steps.append(step)
        return at.A, at.position

    M = dense_mass(system, base)
    left = restore(rows, M, velocity_scale(system), 1e-13)
    assert history[0] > 1e-2
    assert left < 1e-13
    assert all(later < max(earlier**2, 1e-12) for earlier, later in pairwise(history[1:]))
    closed = dense_rows(system, trial, 0.0)
    assert np.abs(closed.position).max() < 1e-13
    increment = np.sum(steps, axis=0)  # to first order
    assert np.abs(increment).max() < 5.0 * 0.02
    p, at_first = (project(A, velocity_scale(system)) for A in (closed.A, dense_rows(system, base, 0.0).A))
    if p.rank == at_first.rank:  # rows that are redundant when closed lock the free motion while the loop is open
        # of first order, no part of the increment is an admitted motion: SᵀM Δ is of second order
        S = p.S / np.linalg.norm(p.S, axis=0)
        assert np.abs(S.T @ M @ increment).max() < 0.1 * np.linalg.norm(M @ increment)
    else:
        assert kinds == ("revolute",) * 4


def test_restore_tells_what_is_left():
    """Φ = x² + 1 has no zero."""
    x = np.zeros(1)

    def rows(step):
        x[:] += step
        return np.array([[2.0 * x[0] + 1e-3]]), np.array([x[0] ** 2 + 1.0])

    assert restore(rows, np.eye(1), np.ones(1), 1e-12, 5) >= 1.0
    assert np.isfinite(x).all()

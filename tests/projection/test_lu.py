"""The dense kernels of the projected equations against numpy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from motions import positive

from maggi.projection.lu import (
    factorise_lu,
    multiply,
    multiply_transposed,
    solve_inertia,
    solve_lu,
    solve_lu_transposed,
)

SIZE = st.integers(0, 9)
SEED = st.integers(0, 2**32 - 1)


@given(SIZE, st.integers(1, 3), SEED)
def test_lu_solves_both_ways(n, count, seed):
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(n, n))
    a[rng.random((n, n)) < 0.3] = 0.0
    a += np.diag(rng.choice([-1.0, 1.0], n)) if n else 0.0
    condition = np.linalg.cond(a) if n else 1.0
    if condition > 1e8:
        return
    factors, order = a.copy(), np.empty(n, dtype=np.int64)
    assert factorise_lu(factors, order) > 0.0
    x = rng.normal(size=(n, count))
    y = x.copy()
    solve_lu(factors, order, y)
    np.testing.assert_allclose(a @ y, x, atol=1e-14 * condition)
    z = rng.normal(size=n)
    w = z.copy()
    solve_lu_transposed(factors, order, w)
    np.testing.assert_allclose(a.T @ w, z, atol=1e-14 * condition)


def test_lu_tells_its_smallest_pivot():
    """Of a diagonal matrix the pivots are the entries; of no matrix there is none; NaN is not hidden."""
    order = np.empty(3, dtype=np.int64)
    assert factorise_lu(np.diag([3.0, -0.5, 2.0]), order) == 0.5
    assert factorise_lu(np.diag([1.0, 0.0, 2.0]), order) == 0.0
    assert np.isnan(factorise_lu(np.diag([1.0, np.nan, 2.0]), order))
    assert factorise_lu(np.empty((0, 0)), order[:0]) == np.inf


@given(SIZE, SIZE, SIZE, SEED)
def test_products(m, n, k, seed):
    rng = np.random.default_rng(seed)
    a, b, c = rng.normal(size=(m, n)), rng.normal(size=(n, k)), rng.normal(size=(m, k))
    a[rng.random((m, n)) < 0.5] = 0.0
    out, transposed = np.full((m, k), np.nan), np.full((n, k), np.nan)
    multiply(a, b, out)
    multiply_transposed(a, c, transposed)
    np.testing.assert_allclose(out, a @ b, atol=1e-14)
    np.testing.assert_allclose(transposed, a.T @ c, atol=1e-14)


@given(st.integers(1, 8), SEED)
def test_inertia_is_solved_for(n, seed):
    rng = np.random.default_rng(seed)
    M, x = positive(rng, n), rng.normal(size=n)
    y = x.copy()
    count, left = solve_inertia(M.copy(), np.diag(M).copy(), y)
    assert (count, left) == (0, 0.0)
    np.testing.assert_allclose(M @ y, x, atol=1e-10)


@pytest.mark.parametrize("turned", [False, True])
def test_freedoms_without_inertia_keep_their_velocity(turned):
    """M of rank 3 in 5 unknowns: where no force is on the others the least-squares answer; a force on them is told."""
    rng = np.random.default_rng(3)
    basis = np.linalg.qr(rng.normal(size=(5, 5)))[0] if turned else np.eye(5)
    M = basis @ np.diag([1.0, 2.0, 3.0, 0.0, 0.0]) @ basis.T
    inside = basis @ np.array([1.0, -2.0, 0.5, 0.0, 0.0])
    x = inside.copy()
    count, left = solve_inertia(M.copy(), np.ones(5), x)
    assert count == 2
    assert left < 1e-14
    np.testing.assert_allclose(M @ x, inside, atol=1e-14)
    assert np.sum(np.abs(x) < 1e-300) >= 2
    x = inside + 0.1 * basis[:, 4]
    assert solve_inertia(M.copy(), np.ones(5), x)[1] > 1e-3

"""The compiled range-space form A W Aᵀ against Maggi's null-space form Sᵀ W⁻¹ S, with and without redundant rows."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from linkages import four_bar, random_mechanism
from motions import positive, rows_at

from maggi.projection.maggi import project
from maggi.projection.range_space import (
    assemble_compliance,
    block_product,
    factorise,
    find_singular,
    product,
    solve,
    transpose_product,
)
from maggi.system.build import build_system
from maggi.system.dense import dense_rows, velocity_scale

JOINTS = ["revolute", "spherical", "universal", "prismatic", "cylindrical", "planar", "weld"]
SYSTEMS = {
    "planar four-bar, 3 redundant rows": lambda: build_system(four_bar()),
    "spatial four-bar": lambda: build_system(four_bar(("revolute", "spherical", "spherical", "revolute"))),
    "tilted four-bar, locked": lambda: build_system(four_bar(tilt=0.5)),
    "tree": lambda: build_system(random_mechanism(1, 8, 0, JOINTS)),
    "loops": lambda: build_system(random_mechanism(3, 8, 2, ["spherical", "universal", "cylindrical"])),
    "more rows than velocities": lambda: build_system(random_mechanism(3, 3, 3, ["revolute", "weld"])),
}


def compliances(system, rng):
    """Random symmetric positive definite W, block by block: flat as the kernels read it, and dense."""
    bodies, n = system.bodies, system.coordinates
    flat, dense = np.zeros(bodies.block[-1]), np.zeros((n, n))
    for b in range(1, bodies.kind.size):
        o, e = bodies.offset[b], bodies.offset[b + 1]
        block = positive(rng, e - o)
        flat[bodies.block[b] : bodies.block[b + 1]] = block.ravel()
        dense[o:e, o:e] = block
    return flat, dense


def factor(system, A, W):
    """Λ = A W Aᵀ (r, r), its skyline factor and the number of independent rows."""
    table = system.liaisons
    L, pivot, scale = np.empty(table.skyline_start[-1]), np.empty(system.rows), np.zeros(system.rows)
    assemble_compliance(table, system.bodies, A, W, L)
    matrix = L.copy()
    factorise(table.skyline_first, table.skyline_start, L, pivot, scale, np.ones(system.rows, dtype=np.int64))
    rank = int((pivot > 0.0).sum())
    return matrix, (L, pivot), rank


@pytest.fixture(scope="module", params=SYSTEMS, ids=str)
def case(request):
    system = SYSTEMS[request.param]()
    rng = np.random.default_rng(7)
    W, dense = compliances(system, rng)
    return system, rows_at(system, system.start, 0.0).A, dense_rows(system, system.start, 0.0).A, W, dense


def test_skyline_holds_the_whole_matrix(case):
    system, A, A_dense, W, W_dense = case
    matrix, _, _ = factor(system, A, W)
    expected = A_dense @ W_dense @ A_dense.T
    table = system.liaisons
    for i in range(system.rows):
        first = table.skyline_first[i]
        row = matrix[table.skyline_start[i] : table.skyline_start[i + 1]]
        np.testing.assert_allclose(row, expected[i, first : i + 1], atol=1e-12 * np.abs(expected).max())
        np.testing.assert_array_equal(expected[i, :first], 0.0)


def test_both_forms_give_the_same_increment(case):
    """x + the liaisons' increment with A δ = −g: nearest to x in the metric W⁻¹.

    Range space: δ = x − W Aᵀ Λ⁺(A x + g). Null space: δ = S ν + p with A p = −g, Sᵀ W⁻¹ (δ − x) = 0.
    """
    system, A, A_dense, W, W_dense = case
    table, n = system.liaisons, system.coordinates
    rng = np.random.default_rng(8)
    _, (L, pivot), rank = factor(system, A, W)
    p = project(A_dense, velocity_scale(system))
    assert rank == p.rank
    assert np.count_nonzero(pivot) == rank
    # columns of S as an orthonormal basis: the same space, without the condition of coordinate partitioning
    S = np.linalg.qr(p.S)[0]
    for _ in range(3):
        x, g = rng.normal(size=n), A_dense @ rng.normal(size=n)
        multipliers, force, step = np.empty(system.rows), np.empty(n), np.empty(n)
        product(table, system.bodies, A, x, multipliers)
        multipliers += g
        solve(table.skyline_first, table.skyline_start, L, pivot, multipliers)
        assert not multipliers[pivot == 0.0].any()
        transpose_product(table, system.bodies, A, multipliers, force)
        block_product(system.bodies, W, force, step)
        ranged = x - step
        metric = np.linalg.inv(W_dense)
        particular = np.linalg.lstsq(A_dense, -g, rcond=1e-11)[0]
        nu = np.linalg.solve(S.T @ metric @ S, S.T @ metric @ (x - particular)) if S.shape[1] else np.empty(0)
        expected = S @ nu + particular
        np.testing.assert_allclose(ranged, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_products(case):
    system, A, A_dense, W, W_dense = case
    rng = np.random.default_rng(9)
    v, x = rng.normal(size=system.coordinates), rng.normal(size=system.rows)
    rows, columns, blocks = np.empty(system.rows), np.empty(v.size), np.empty(v.size)
    product(system.liaisons, system.bodies, A, v, rows)
    transpose_product(system.liaisons, system.bodies, A, x, columns)
    block_product(system.bodies, W, v, blocks)
    np.testing.assert_allclose(rows, A_dense @ v, atol=1e-13)
    np.testing.assert_allclose(columns, A_dense.T @ x, atol=1e-13)
    np.testing.assert_allclose(blocks, W_dense @ v, atol=1e-12)


@given(st.integers(1, 9), st.integers(0, 9), st.integers(0, 2**32 - 1))
def test_skyline_factor_of_a_semidefinite_matrix(r, dependent, seed):
    """Rank, which rows are switched off, and a solution wherever there is one; random envelopes and dependent rows."""
    rng = np.random.default_rng(seed)
    # a banded product B Bᵀ has an envelope; rows that repeat earlier ones, times a factor, are dependent
    band = rng.integers(0, 4, r)
    B = np.array([[rng.normal() if i - band[i] <= j <= i else 0.0 for j in range(r)] for i in range(r)])
    B += 3.0 * np.eye(r)
    for _ in range(min(dependent, r)):
        i = int(rng.integers(0, len(B)))
        B = np.insert(B, int(rng.integers(i + 1, len(B) + 1)), rng.choice([-2.0, 0.5, 10.0]) * B[i], axis=0)
    matrix = B @ B.T
    expected_off = [
        np.linalg.matrix_rank(B[: i + 1]) == np.linalg.matrix_rank(B[:i]) if i else False for i in range(len(B))
    ]
    first = np.array([np.flatnonzero(matrix[i])[0] for i in range(len(B))], dtype=np.int64)
    start = np.concatenate([[0], np.cumsum(np.arange(len(B)) - first + 1)]).astype(np.int64)
    L = np.concatenate([matrix[i, first[i] : i + 1] for i in range(len(B))])
    pivot, scale = np.empty(len(B)), np.zeros(len(B))
    factorise(first, start, L, pivot, scale, np.ones(len(B), dtype=np.int64))
    assert (pivot > 0.0).sum() == np.linalg.matrix_rank(B)
    np.testing.assert_array_equal(pivot == 0.0, expected_off)
    np.testing.assert_array_equal(scale, np.diag(matrix))
    right = matrix @ rng.normal(size=len(B))
    x = right.copy()
    solve(first, start, L, pivot, x)
    assert not x[pivot == 0.0].any()
    condition = np.linalg.cond(B[pivot > 0.0]) ** 2
    np.testing.assert_allclose(
        matrix @ x, right, atol=1e-14 * condition * np.abs(matrix).max() * np.abs(x).max() + 1e-12
    )


def test_a_row_that_vanishes_is_dependent_by_its_former_size():
    """At a singular position a row's own diagonal is tiny: it is judged by the largest that it has had."""
    first, start = np.zeros(1, dtype=np.int64), np.array([0, 1])
    pivot, scale, active = np.empty(1), np.zeros(1), np.ones(1, dtype=np.int64)
    assert factorise(first, start, np.array([4.0]), pivot, scale, active) == 1.0
    assert pivot[0] == 0.25
    assert factorise(first, start, np.array([1e-12]), pivot, scale, active) == 1.0
    assert (pivot[0], scale[0]) == (0.0, 4.0)
    assert factorise(first, start, np.array([1e-12]), pivot, np.zeros(1), active) == 1.0
    assert pivot[0] == 1e12


def test_rows_are_dropped_and_taken_up_with_hysteresis():
    """Two rows at an angle: dropped below sin² = 1e-7, independent again above 4e-7; sin² of those kept is told."""
    first, start = np.zeros(2, dtype=np.int64), np.array([0, 1, 3])
    pivot, scale, active = np.empty(2), np.zeros(2), np.ones(2, dtype=np.int64)
    for square, kept in [(1e-2, 1), (2e-7, 1), (0.9e-7, 0), (3e-7, 0), (5e-7, 1), (2e-7, 1)]:
        c = np.sqrt(1.0 - square)
        smallest = find_singular(first, start, np.array([1.0, c, 1.0]), pivot, scale, active)
        assert active.tolist() == [1, kept]
        assert smallest == pytest.approx(square if kept else 1.0, rel=1e-6)
        factorise(first, start, np.array([1.0, c, 1.0]), pivot, np.ones(2), active)
        assert (pivot[1] > 0.0) == kept

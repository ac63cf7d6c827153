"""Lowest eigenpairs by block Lanczos, against dense ones, with eigenvalues that come many times."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp

from maggi.linalg.factor import factorise
from maggi.linalg.lanczos import BLOCK, ROOM, ModesNotFoundError, lowest_modes


def grid(n):
    """Laplace's matrix on a square grid, whose eigenvalues are (2 − 2 cos iπ/(n+1)) + the same of j: most come twice."""
    line = sp.diags([-np.ones(n - 1), 2.0 * np.ones(n), -np.ones(n - 1)], [-1, 0, 1])
    one = 2.0 - 2.0 * np.cos(np.arange(1, n + 1) * np.pi / (n + 1))
    return (sp.kron(line, sp.eye(n)) + sp.kron(sp.eye(n), line)).tocsr(), np.sort(np.add.outer(one, one).ravel())


def mass(n):
    rng = np.random.default_rng(2)
    factor = sp.diags(rng.uniform(0.5, 2.0, n)) + sp.random(n, n, 2.0 / n, random_state=3)
    return (factor @ factor.T).tocsr()


def check(K, M, values, shapes, expected):
    np.testing.assert_allclose(values, expected, rtol=1e-10)
    np.testing.assert_allclose(shapes.T @ (M @ shapes), np.eye(len(values)), atol=1e-12)
    np.testing.assert_allclose(K @ shapes, (M @ shapes) * values, atol=1e-6 * values[-1])


@pytest.mark.parametrize("count", [1, 5, 20])
def test_double_eigenvalues(count):
    K, expected = grid(30)
    M = sp.eye(900)
    values, shapes = lowest_modes(factorise(K).solve_many, M, count, 400)
    check(K, M, values, shapes, expected[:count])


@pytest.mark.parametrize("count", [1, 12])
def test_general_mass(count):
    K, _ = grid(20)
    M = mass(400)
    values, shapes = lowest_modes(factorise(K).solve_many, M, count, 400)
    check(K, M, values, shapes, scipy.linalg.eigh(K.toarray(), M.toarray(), eigvals_only=True)[:count])


def test_fewer_vectors_are_kept_than_are_made():
    """Restarts: the room for vectors is that of the modes and some blocks, whatever it takes to find them."""
    K, expected = grid(30)
    factor, made = factorise(K), []

    def inverse(forces):
        made.append(forces.shape[1])
        return factor.solve_many(forces)

    values, shapes = lowest_modes(inverse, sp.eye(900), 20, 1000)
    check(K, sp.eye(900), values, shapes, expected[:20])
    room = 20 + ROOM * BLOCK
    assert sum(made) > 1.5 * room
    assert shapes.base.shape == (900, room)


def test_an_eigenvalue_more_often_than_a_block_is_wide():
    """One block of directions exhausts its space before all are found; another is begun."""
    times = 2 * BLOCK + 3
    values = np.concatenate([np.ones(times), np.arange(2.0, 40.0)])
    found, shapes = lowest_modes(lambda force: force / values[:, None], sp.eye(values.size), times + 2, values.size)
    np.testing.assert_allclose(found, values[: times + 2], rtol=1e-12)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(times + 2), atol=1e-13)


def test_modes_of_a_subspace():
    """Where the inverse keeps to a subspace, the modes are those within it."""
    K, _ = grid(12)
    rng = np.random.default_rng(4)
    free = np.linalg.qr(rng.normal(size=(144, 144)))[0][:, 5:]
    small = np.linalg.inv(free.T @ (K @ free))
    values, shapes = lowest_modes(lambda force: free @ (small @ (free.T @ force)), sp.eye(144), 6, 144)
    np.testing.assert_allclose(values, np.linalg.eigvalsh(free.T @ (K @ free))[:6], rtol=1e-10)
    np.testing.assert_allclose(shapes, free @ (free.T @ shapes), atol=1e-12)


def test_all_there_are():
    values = np.arange(1.0, 31.0)
    found, _ = lowest_modes(lambda force: force / values[:, None], sp.eye(30), 30, 30)
    np.testing.assert_allclose(found, values, rtol=1e-12)


def test_too_few_vectors():
    K, _ = grid(30)
    with pytest.raises(ModesNotFoundError, match="20 modes were not found among 16 vectors"):
        lowest_modes(factorise(K).solve_many, sp.eye(900), 20, 20)


def test_repeated_calls_give_the_same():
    K, _ = grid(15)
    first, second = (lowest_modes(factorise(K).solve_many, sp.eye(225), 4, 225)[1] for _ in range(2))
    assert np.array_equal(first, second)

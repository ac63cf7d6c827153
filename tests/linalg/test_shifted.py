"""Factors of k₁ M + k₂ K against dense algebra."""

import numpy as np
import pytest
import scipy.sparse as sp

from maggi.linalg import factor as module
from maggi.linalg.factor import SingularMatrixError
from maggi.linalg.shifted import ShiftedFactors


def blocks(rng, nodes, density=0.3):
    """A definite K (3n, 3n) with some of its blocks stored."""
    pattern = sp.random_array((nodes, nodes), density=density, rng=rng).toarray() != 0.0
    pattern |= pattern.T | np.eye(nodes, dtype=bool)
    K = rng.normal(size=(3 * nodes, 3 * nodes)) * np.kron(pattern, np.ones((3, 3)))
    K = K + K.T
    return K + (1.0 - np.linalg.eigvalsh(K)[0]) * np.eye(3 * nodes), pattern


def triangle(K, pattern):
    """indptr, indices and blocks of the upper triangle."""
    rows, columns = np.nonzero(np.triu(pattern))
    values = np.array([K[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] for i, j in zip(rows, columns, strict=True)])
    return np.searchsorted(rows, np.arange(len(pattern) + 1)).astype(np.int32), columns.astype(np.int32), values


def mass(rng, pattern):
    """M (3n, 3n), diagonal in every block that K has."""
    mu = rng.normal(size=pattern.shape) * pattern
    mu = mu @ mu.T * pattern  # not definite in general, but symmetric
    return sp.csr_matrix(np.kron(mu + 10.0 * len(pattern) * np.eye(len(pattern)), np.eye(3)))


@pytest.fixture(params=["rslab", "superlu"])
def backend(request, monkeypatch):
    if request.param == "superlu":
        monkeypatch.setattr(module, "rslab", None)


@pytest.mark.usefixtures("backend")
@pytest.mark.parametrize("seed", range(6))
def test_solves_with_any_weights(seed):
    rng = np.random.default_rng(seed)
    K, pattern = blocks(rng, int(rng.integers(1, 12)))
    M = mass(rng, pattern)
    factors = ShiftedFactors(*triangle(K, pattern))
    for k1, k2 in ((1.0, 1.0), (1e-3, 2.0), (2.0, 1e-4), (0.0, 1.0)):
        S = k1 * M.toarray() + k2 * K
        x = rng.normal(size=len(K))
        found = factors.factorise(k1, lambda: M, k2).solve(S @ x)
        np.testing.assert_allclose(found, x, rtol=0, atol=1e-12 * np.linalg.cond(S) * np.abs(x).max())


@pytest.mark.usefixtures("backend")
def test_shifts_into_the_spectrum():
    rng = np.random.default_rng(7)
    K, pattern = blocks(rng, 8)
    M = mass(rng, pattern)
    values = np.linalg.eigvals(np.linalg.solve(M.toarray(), K)).real
    values.sort()
    between = int(np.argmax(np.diff(values)))
    shift = 0.5 * (values[between] + values[between + 1])
    S = K - shift * M.toarray()
    assert np.linalg.eigvalsh(S)[0] < 0.0
    x = rng.normal(size=len(K))
    found = ShiftedFactors(*triangle(K, pattern)).factorise(-shift, lambda: M, 1.0).solve(S @ x)
    np.testing.assert_allclose(found, x, rtol=0, atol=1e-12 * np.linalg.cond(S) * np.abs(x).max())


@pytest.mark.usefixtures("backend")
def test_singular_and_infinite_sums_are_refused():
    rng = np.random.default_rng(3)
    spring = np.kron(np.diag([2.0, 2.0, 2.0, 2.0]) - np.ones((4, 4)) / 2.0, np.eye(3))  # Σ of every row is 0
    full = np.ones((4, 4), dtype=bool)
    factors = ShiftedFactors(*triangle(spring, full))
    M = mass(rng, full)
    with pytest.raises(SingularMatrixError):
        factors.factorise(0.0, lambda: M, 1.0)
    with pytest.raises(ValueError, match="is inf"):
        factors.factorise(1.0, lambda: M * np.inf, 1.0)
    factors.factorise(1.0, lambda: M, 1.0)  # and it goes on


def test_superlu_takes_over_only_what_may_need_pivots_from_off_the_diagonal(monkeypatch):
    rng = np.random.default_rng(5)
    K, pattern = blocks(rng, 6)
    M = mass(rng, pattern)
    factors = ShiftedFactors(*triangle(K, pattern))

    def refuse(order, handle):
        raise SingularMatrixError("refused")

    monkeypatch.setattr(module, "RslabFactor", refuse)
    with pytest.raises(SingularMatrixError, match="refused"):
        factors.factorise(1.0, lambda: M, 1.0)
    shift = 2.0 * float((K.diagonal() / M.diagonal()).min())  # past the first entry of the diagonal
    S = K - shift * M.toarray()
    assert S.diagonal().min() < 0.0
    x = rng.normal(size=len(K))
    found = factors.factorise(-shift, lambda: M, 1.0).solve(S @ x)
    np.testing.assert_allclose(found, x, rtol=0, atol=1e-12 * np.linalg.cond(S) * np.abs(x).max())


def test_a_mass_that_does_not_fit_is_refused():
    rng = np.random.default_rng(1)
    pattern = np.eye(3, dtype=bool)
    factors = ShiftedFactors(*triangle(np.eye(9), pattern))
    with pytest.raises(ValueError, match="where K has none"):
        factors.factorise(1.0, lambda: mass(rng, np.ones((3, 3), dtype=bool)), 1.0)


def test_the_mass_is_let_go_before_the_factor_is_made(monkeypatch):
    """The factorisation is when most memory is needed."""
    rng = np.random.default_rng(2)
    K, pattern = blocks(rng, 5)
    alive = []

    class Mass(sp.csr_matrix):
        def __init__(self, *given):
            super().__init__(*given)
            alive.append(self)

        def __del__(self):
            alive.clear()

    def made():
        M = Mass(mass(rng, pattern))
        alive[:] = [True]
        return M

    factorised = module.Prepared.factorise

    def watched(prepared):
        assert not alive
        return factorised(prepared)

    monkeypatch.setattr(module.Prepared, "factorise", watched)
    ShiftedFactors(*triangle(K, pattern)).factorise(1.0, made, 1.0)


@pytest.mark.parametrize("held", [[0], [3, 4, 5], [0, 7, 14], [14], []])
def test_held_unknowns_are_cut_off(held):
    """Against the matrix without their rows and columns."""
    rng = np.random.default_rng(3)
    K, pattern = blocks(rng, 5)
    held = np.array(held, np.int64)
    free = np.setdiff1d(np.arange(len(K)), held)
    right = rng.normal(size=(len(K), 2))
    right[held] = 0.0
    found = ShiftedFactors(*triangle(K, pattern)).factorise_held(held).solve_many(right)
    assert (found[held] == 0.0).all()
    expected = np.linalg.solve(K[np.ix_(free, free)], right[free])
    np.testing.assert_allclose(found[free], expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_memory_is_set_aside_before_the_factor_is_made(monkeypatch):
    rng = np.random.default_rng(4)
    K, pattern = blocks(rng, 5)
    told, factorised = [], module.Prepared.factorise

    def watched(prepared):
        told.append("factorised")
        return factorised(prepared)

    monkeypatch.setattr(module.Prepared, "factorise", watched)
    factors = ShiftedFactors(*triangle(K, pattern), lambda: told.append("set aside"))
    factors.factorise(1.0, lambda: mass(rng, pattern), 1.0)
    factors.factorise_held(np.array([1]))
    assert told == 2 * ["set aside", "factorised"]

"""Both factorisations: accuracy, singular and unusable matrices."""

import numpy as np
import pytest
import skfem
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse
from skfem.models.elasticity import lame_parameters, linear_elasticity

from maggi.linalg import factor as module
from maggi.linalg.factor import WIDTH, RslabFactor, SingularMatrixError, SuperLUFactor, factorise

BACKENDS = ("rslab", "superlu")


@pytest.fixture(scope="module")
def stiffness():
    """Stiffness of a free steel bar of 12 x 3 x 3 hexahedra (m, Pa): six rigid motions."""
    mesh = skfem.MeshHex.init_tensor(np.linspace(0, 1, 13), np.linspace(0, 0.1, 4), np.linspace(0, 0.1, 4))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex1()))
    return linear_elasticity(*lame_parameters(210e9, 0.3)).assemble(basis)


@pytest.fixture(scope="module")
def clamped(stiffness):
    """The same, held at twelve nodes."""
    return stiffness[36:, 36:]


@pytest.mark.parametrize("backend", BACKENDS)
def test_solves_an_elastic_body(backend, clamped):
    rng = np.random.default_rng(1)
    X = rng.standard_normal((clamped.shape[0], 5))
    B = clamped @ X
    kept = B.copy()
    factor = factorise(clamped, backend)
    assert factor.order == clamped.shape[0]
    # Forward error: 1e-16 times the condition number, which is 1e7 here.
    np.testing.assert_allclose(factor.solve_many(B), X, atol=1e-8)
    np.testing.assert_allclose(factor.solve_many(np.asfortranarray(B)), X, atol=1e-8)
    for k in range(5):
        x = factor.solve(B[:, k])
        np.testing.assert_allclose(x, X[:, k], atol=1e-8)
        assert np.abs(clamped @ x - B[:, k]).max() < 1e-11 * np.abs(B[:, k]).max()
    np.testing.assert_array_equal(B, kept)


def definite(rng, n):
    G = sparse.random_array((n, n), density=0.2, rng=rng).toarray()
    return G @ G.T + np.eye(n)


def shifted(rng, n):
    """Indefinite, as in a search for modes near a given frequency; the shift stays clear of the eigenvalues."""
    A = definite(rng, n)
    values = np.linalg.eigvalsh(A)
    widest = int(np.argmax(np.diff(values))) if n > 1 else 0
    return A - (values[widest : widest + 2].mean() if n > 1 else 0.0) * np.eye(n)


def saddle_point(rng, n):
    """[A Cᵀ; C 0], whose zero diagonal needs pivots from off it."""
    m = max(1, n // 3)
    C = np.hstack([np.eye(m), rng.standard_normal((m, n - m))])
    return np.block([[definite(rng, n), C.T], [C, np.zeros((m, m))]])


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("columns", [WIDTH - 1, WIDTH, WIDTH + 1, 2 * WIDTH + 5])
def test_any_number_of_right_sides(backend, clamped, columns):
    factor = factorise(clamped, backend)
    X = np.random.default_rng(7).standard_normal((clamped.shape[0], columns))
    np.testing.assert_allclose(factor.solve_many(clamped @ X), X, atol=1e-8)


@pytest.mark.parametrize(
    ("backend", "family"),
    [
        ("rslab", definite),
        ("superlu", definite),
        ("auto", shifted),
        ("superlu", shifted),
        ("auto", saddle_point),
        ("superlu", saddle_point),
    ],
)
@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_solves_random_matrices_in_mixed_units(backend, family, seed, n):
    rng = np.random.default_rng(seed)
    A = family(rng, n)
    units = 10.0 ** rng.integers(-4, 5, A.shape[0])
    A = units[:, None] * A * units
    x = rng.standard_normal(A.shape[0]) / units
    found = factorise(sparse.csr_array(A), backend).solve(A @ x)
    np.testing.assert_allclose(found * units, x * units, atol=1e-7)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_body_that_nothing_holds_is_singular(backend, stiffness):
    with pytest.raises(SingularMatrixError, match=f"order {stiffness.shape[0]} is singular"):
        factorise(stiffness, backend)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "matrix",
    [
        np.zeros((3, 3)),
        np.diag([1.0, 0.0, 2.0]),
        np.ones((4, 4)),
        np.array([[2.0, -1.0, -1.0], [-1.0, 2.0, -1.0], [-1.0, -1.0, 2.0]]),
    ],
)
def test_small_singular_matrices(backend, matrix):
    with pytest.raises(SingularMatrixError):
        factorise(sparse.csc_array(matrix), backend)


def test_a_matrix_that_is_not_symmetric_is_noticed():
    matrix = sparse.csc_array(np.array([[4.0, 1.0], [3.0, 4.0]]))
    with pytest.raises(SingularMatrixError, match="not symmetric"):
        factorise(matrix, "rslab")


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_entries_that_are_not_finite_are_named(backend, value):
    matrix = np.eye(4)
    matrix[2, 3] = matrix[3, 2] = value
    with pytest.raises(ValueError, match=rf"entry \(3, 2\) of the matrix is {value}"):
        factorise(sparse.coo_array(matrix), backend)


@pytest.mark.parametrize("shape", [(2, 3), (0, 0)])
def test_matrices_that_are_not_square_are_refused(shape):
    with pytest.raises(ValueError, match="square"):
        factorise(sparse.csc_array(shape))


@pytest.mark.parametrize("backend", BACKENDS)
def test_right_hand_sides_that_are_not_finite_show_in_the_solution(backend, clamped):
    b = np.zeros(clamped.shape[0])
    b[7] = np.nan
    factor = factorise(clamped, backend)
    assert not np.isfinite(factor.solve(b)).all()
    assert not np.isfinite(factor.solve_many(np.column_stack([b, b]))).all()


def test_auto_takes_rslab_and_falls_back_on_superlu(monkeypatch, clamped):
    assert isinstance(factorise(clamped), RslabFactor)
    monkeypatch.setattr(module, "rslab", None)
    assert isinstance(factorise(clamped), SuperLUFactor)
    with pytest.raises(ModuleNotFoundError, match="rslab"):
        factorise(clamped, "rslab")


def test_matrices_of_any_sparse_kind_and_with_duplicates():
    rows, columns, values = [0, 0, 1, 1, 1, 0], [0, 0, 1, 0, 1, 1], [1.0, 2.0, 3.0, 1.0, 1.0, 1.0]
    matrix = sparse.coo_matrix((values, (rows, columns)))
    for backend in BACKENDS:
        np.testing.assert_allclose(factorise(matrix, backend).solve(np.array([4.0, 5.0])), [1.0, 1.0], atol=1e-14)

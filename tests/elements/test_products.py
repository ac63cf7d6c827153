"""Products with half of K against scipy."""

import numba
import numpy as np
import pytest
import scipy.sparse as sp

from maggi.elements.assembly import assemble_solids
from maggi.elements.products import SMALL, SymmetricBlocks
from maggi.model.materials import Material


@pytest.fixture(scope="module", params=[(2, 2, 2), (6, 5, 5)], ids=["one part", "several parts"])
def K(request, box):
    X, cells = box("tet10", count=request.param, jitter=0.2)
    assert (len(X) < SMALL) == (request.param == (2, 2, 2))
    return assemble_solids(X, {"tet10": cells}, Material(1.0, 1.0, 0.3)).stiffness


@pytest.fixture
def half(K):
    return SymmetricBlocks.of(K)


@pytest.fixture
def fields(K):
    return np.random.default_rng(5).normal(size=(3, K.shape[0]))


def test_the_product_is_added(K, half, fields):
    x, out, _ = fields
    expected = out + K @ x
    half.add_product(x, out)
    np.testing.assert_allclose(out, expected, rtol=0, atol=1e-14 * abs(expected).max())


def test_squares_of_four_fields(K, half):
    fields = np.random.default_rng(6).normal(size=(K.shape[0] // 3, 3, 4))
    squares = half.squares(fields)
    for _ in range(2):
        x = fields.reshape(-1, 4)
        np.testing.assert_allclose(squares.find(), np.einsum("nk,nk->k", x, K @ x), rtol=1e-13)
        fields[:] = fields[::-1].copy()


def test_a_square_depends_on_no_other(half):
    """To the last bit, so that it does not matter which are found together."""
    fields = np.random.default_rng(7).normal(size=(half.order // 3, 3, 4))
    found = half.squares(fields).find()
    for order in ([1, 2, 3, 0], [2, 2, 1, 1], [3, 0, 0, 0]):
        assert np.array_equal(half.squares(fields[:, :, order].copy()).find(), found[order])


def test_same_bits_for_any_number_of_threads(half, fields):
    x, _, _ = fields
    four = np.random.default_rng(8).normal(size=(half.order // 3, 3, 4))
    before = numba.get_num_threads()
    results = []
    for threads in {1, before}:
        numba.set_num_threads(threads)
        out = np.zeros_like(x)
        half.add_product(x, out)
        results.append((half.squares(four).find(), out))
    numba.set_num_threads(before)
    for squares, out in results:
        assert np.array_equal(squares, results[0][0])
        assert np.array_equal(out, results[0][1])


def test_arrays_that_do_not_fit_are_refused(half, fields):
    x, out, _ = fields
    with pytest.raises(ValueError, match="rows got"):
        half.add_product(x[:-1], out)
    with pytest.raises(ValueError, match="rows got"):
        half.add_product(x, out[:-3])
    with pytest.raises(ValueError, match="of shape"):
        half.squares(np.zeros((half.order, 4)))
    with pytest.raises(TypeError, match="contiguous"):
        half.squares(np.zeros((4, 3, half.order // 3)).T)
    with pytest.raises(TypeError, match="contiguous"):
        half.add_product(x, np.zeros(2 * x.size)[::2])


def test_a_matrix_without_a_diagonal_block_is_refused():
    blocks = np.ones((2, 3, 3))
    with pytest.raises(ValueError, match="diagonal"):
        SymmetricBlocks.of(sp.bsr_matrix((blocks, [1, 0], [0, 1, 2]), shape=(6, 6)))


def test_both_triangles_and_the_diagonal(K, half):
    full = half.matrix()
    assert (full != K).nnz == 0
    assert full.has_sorted_indices and full.blocksize == (3, 3)
    assert np.array_equal(half.diagonal(), K.diagonal())
    assert half.order == K.shape[0]

"""Products with K and μ against scipy."""

import numba
import numpy as np
import pytest
import scipy.sparse as sp

from maggi.elements.assembly import assemble_solids
from maggi.elements.products import elastic_and_inertia, mass_product, stiffness_product
from maggi.model.materials import Material


@pytest.fixture(scope="module")
def mesh(box):
    X, cells = box("tet10", count=(3, 3, 3), jitter=0.2)
    return assemble_solids(X, {"tet10": cells}, Material(1.0, 1.0, 0.3))


@pytest.fixture(scope="module")
def fields(mesh):
    return np.random.default_rng(5).normal(size=(2, mesh.mass.shape[0], 3))


def test_products_agree_with_scipy(mesh, fields):
    x, a = fields
    out = np.full_like(x, np.nan)
    Kx = (mesh.stiffness @ x.ravel()).reshape(x.shape)
    assert stiffness_product(mesh.stiffness, x, out) is out
    np.testing.assert_allclose(out, Kx, rtol=0, atol=1e-14 * abs(Kx).max())
    np.testing.assert_allclose(mass_product(mesh.mass, a, out), mesh.mass @ a, rtol=0, atol=1e-16)
    elastic_and_inertia(mesh.stiffness, mesh.mass, x, a, out)
    np.testing.assert_allclose(out, Kx + mesh.mass @ a, rtol=0, atol=1e-14 * abs(Kx).max())


def test_flat_vectors_and_nodal_fields_are_the_same(mesh, fields):
    x, _ = fields
    flat = stiffness_product(mesh.stiffness, x.ravel(), np.empty(x.size))
    assert np.array_equal(flat, stiffness_product(mesh.stiffness, x, np.empty_like(x)).ravel())


def test_same_bits_for_any_number_of_threads(mesh, fields):
    x, a = fields
    before = numba.get_num_threads()
    results = []
    for threads in {1, before}:
        numba.set_num_threads(threads)
        results.append(elastic_and_inertia(mesh.stiffness, mesh.mass, x, a, np.empty_like(x)))
    numba.set_num_threads(before)
    assert all(np.array_equal(result, results[0]) for result in results)


def test_rows_without_entries_give_zero():
    mu = sp.csr_matrix((np.array([2.0]), np.array([1], np.int32), np.array([0, 0, 1, 1], np.int32)), shape=(3, 3))
    out = mass_product(mu, np.ones((3, 3)), np.full((3, 3), np.nan))
    assert out.tolist() == [[0.0] * 3, [2.0] * 3, [0.0] * 3]


def test_arrays_that_do_not_fit_are_refused(mesh, fields):
    x, a = fields
    with pytest.raises(ValueError, match="rows got"):
        stiffness_product(mesh.stiffness, x[:-1], np.empty_like(x))
    with pytest.raises(ValueError, match="contiguous"):
        mass_product(mesh.mass, a, np.empty((3, len(a))).T)
    with pytest.raises(ValueError, match="different node graphs"):
        elastic_and_inertia(mesh.stiffness, sp.eye(len(x), format="csr"), x, a, np.empty_like(x))

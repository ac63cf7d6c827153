"""Passes that numba's threads share: every part is done, in place, with whatever kinds of arrays."""

import numba
import numpy as np
import pytest

from maggi.linalg.shared import SharedPass


@SharedPass
def scale(part, parts, x, factor, times, done):
    """x *= factor**times, by parts."""
    for i in range(x.shape[0] * part // parts, x.shape[0] * (part + 1) // parts):
        for _ in range(times):
            x[i] *= factor


@SharedPass
def totals(part, parts, table, indices, out, done):
    """out[part]: the sum of the chosen rows."""
    out[part] = 0.0
    for i in range(indices.size * part // parts, indices.size * (part + 1) // parts):
        for j in range(table.shape[1]):
            out[part] += table[indices[i], j]


@pytest.mark.parametrize("parts", [1, 2, 7])
@pytest.mark.parametrize("size", [0, 1, 100])
def test_all_parts_are_done_in_place(parts, size):
    x = np.arange(float(size))
    scale(parts, x, 3.0, 2)
    np.testing.assert_array_equal(x, 9.0 * np.arange(size))


@pytest.mark.parametrize("kind", [np.int32, np.int64])
def test_kinds_of_arrays(kind):
    """Another kind of index is another compilation, and nothing is copied on the way."""
    table = np.random.default_rng(0).normal(size=(20, 3))
    out = np.full(4, np.nan)
    totals(4, table, np.arange(0, 20, 2, dtype=kind), out)
    assert out.sum() == pytest.approx(table[::2].sum(), rel=1e-14)


def test_read_only_arrays_can_be_read():
    table = np.ones((4, 3))
    table.setflags(write=False)
    out = np.zeros(2)
    totals(2, table, np.arange(4), out)
    np.testing.assert_array_equal(out, [6.0, 6.0])


def test_arrays_that_are_not_contiguous_are_refused():
    """Kernels take arrays for C-contiguous ones; also where such have been passed before."""
    scale(2, np.ones(4), 1.0, 1)
    with pytest.raises(ValueError, match="argument 0 of the pass scale is not C-contiguous"):
        scale(2, np.ones(8)[::2], 1.0, 1)


def test_same_bits_for_any_number_of_threads():
    table, before = np.random.default_rng(1).normal(size=(1000, 3)), numba.get_num_threads()
    results = []
    for threads in {1, before}:
        numba.set_num_threads(threads)
        out = np.zeros(5)
        totals(5, table, np.arange(1000), out)
        results.append(out)
    numba.set_num_threads(before)
    for out in results:
        np.testing.assert_array_equal(out, results[0])

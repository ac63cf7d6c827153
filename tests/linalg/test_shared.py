"""Passes that numba's threads share: every part is done, in place."""

from dataclasses import dataclass

import numba
import numpy as np
import pytest
from numba import njit
from numpy.typing import NDArray

from maggi.linalg.shared import SharedPass, crew
from maggi.linalg.table import Table, address
from maggi.linalg.team import share


@dataclass(frozen=True, eq=False)
class Scaling(Table):
    x: NDArray[np.float64]
    factor: float


@SharedPass
def scale(of, part, parts):
    """x *= factor, by parts."""
    x = of.x
    for i in range(x.shape[0] * part // parts, x.shape[0] * (part + 1) // parts):
        x[i] *= of.factor


@dataclass(frozen=True, eq=False)
class Sums(Table):
    table: NDArray[np.float64]
    indices: NDArray[np.int64] | NDArray[np.int32]
    out: NDArray[np.float64]


@SharedPass
def totals(of, part, parts):
    """out[part]: the sum of the chosen rows."""
    table, indices, out = of.table, of.indices, of.out
    out[part] = 0.0
    for i in range(indices.size * part // parts, indices.size * (part + 1) // parts):
        for j in range(table.shape[1]):
            out[part] += table[indices[i], j]


@pytest.mark.parametrize("parts", [1, 2, 7])
@pytest.mark.parametrize("size", [0, 1, 100])
def test_all_parts_are_done_in_place(parts, size):
    x = np.arange(float(size))
    scale(Scaling(x, 3.0), parts)
    np.testing.assert_array_equal(x, 3.0 * np.arange(size))


@pytest.mark.parametrize("kind", [np.int32, np.int64])
def test_kinds_of_tables(kind):
    """A table with another kind of index is another compilation."""
    table = np.random.default_rng(0).normal(size=(20, 3))
    out = np.full(4, np.nan)
    totals(Sums(table, np.arange(0, 20, 2, dtype=kind), out), 4)
    assert out.sum() == pytest.approx(table[::2].sum(), rel=1e-14)


@njit
def scale_twice(of, entry, crew, parts):
    for _ in range(2):
        share(crew, entry, address(of), parts)


@pytest.mark.parametrize("parts", [1, 2, 7])
def test_compiled_code_shares_passes_too(parts):
    x = np.arange(100.0)
    of = Scaling(x, 3.0)
    scale_twice(of, scale.entry(of), crew(), parts)
    np.testing.assert_array_equal(x, 9.0 * np.arange(100))


def test_same_bits_for_any_number_of_threads():
    table, before = np.random.default_rng(1).normal(size=(1000, 3)), numba.get_num_threads()
    results = []
    for threads in {1, before}:
        numba.set_num_threads(threads)
        out = np.zeros(5)
        totals(Sums(table, np.arange(1000), out), 5)
        results.append(out)
    numba.set_num_threads(before)
    for out in results:
        np.testing.assert_array_equal(out, results[0])


def test_what_is_not_finite_is_nobodys_warning():
    x = np.array([0.0, 1.0, 1e308])
    scale(Scaling(x, np.inf), 1)
    assert np.isnan(x[0]) and np.isinf(x[1:]).all()

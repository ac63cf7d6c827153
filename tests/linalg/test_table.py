"""Tables in compiled code: the same arrays, numbers and tables that Python sees, by one pointer."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numba import njit

from maggi.linalg.links import Link, call3, call5
from maggi.linalg.table import Table


@dataclass(frozen=True, eq=False)
class Inner(Table):
    values: np.ndarray
    counts: np.ndarray


@dataclass(frozen=True, eq=False)
class Outer(Table):
    cube: np.ndarray
    factor: float
    inner: Inner


def table() -> Outer:
    rng = np.random.default_rng(0)
    return Outer(rng.normal(size=(2, 3, 4)), 2.5, Inner(rng.normal(size=5), np.arange(6).reshape(2, 3)))


@njit
def total(outer):
    value = 0.0
    for i in range(outer.cube.shape[0]):
        for j in range(outer.cube.shape[1]):
            for k in range(outer.cube.shape[2]):
                value += outer.cube[i, j, k]
    part = outer.inner.values[1:3]
    return outer.factor * value + part.sum() + outer.inner.counts[1, 2]


@njit
def double(outer):
    row = outer.cube[1, 2]
    for k in range(row.shape[0]):
        row[k] *= 2.0
    outer.inner.counts[0, 1] += 10


def test_a_kernel_reads_what_python_reads() -> None:
    one = table()
    expected = 2.5 * one.cube.sum() + one.inner.values[1:3].sum() + one.inner.counts[1, 2]
    assert total(one) == pytest.approx(expected, rel=1e-14)


def test_a_kernel_writes_into_the_arrays() -> None:
    one = table()
    before = one.cube.copy()
    double(one)
    np.testing.assert_array_equal(one.cube[1, 2], 2.0 * before[1, 2])
    np.testing.assert_array_equal(one.cube[0], before[0])
    assert one.inner.counts[0, 1] == 11


def test_copies_and_replacements_have_their_own_arrays() -> None:
    one = table()
    two, three = one.copy(), replace(one, cube=np.zeros((2, 3, 4)))
    double(two)
    assert one.inner.counts[0, 1] == 1 and two.inner.counts[0, 1] == 11
    assert total(three) == pytest.approx(total(one) - 2.5 * one.cube.sum())
    double(three)  # what is not replaced is shared
    assert one.inner.counts[0, 1] == 11


def test_tables_of_one_class_share_a_compiled_kernel() -> None:
    total(table())
    count = len(total.signatures)
    total(Outer(np.zeros((7, 1, 1)), 0.0, Inner(np.zeros(3), np.zeros((2, 3), dtype=np.int64))))
    assert len(total.signatures) == count


@pytest.mark.parametrize("values", [np.zeros(5, dtype=np.float32), np.zeros((5, 2))[:, 0], np.zeros(5, dtype=bool)])
def test_arrays_that_kernels_cannot_read_are_refused(values: np.ndarray) -> None:
    with pytest.raises(TypeError, match=r"Inner\.values"):
        Inner(values, np.zeros((1, 1), dtype=np.int64))


@Link
def add(a: Inner, b: Inner, c: Inner, t: float) -> None:
    for i in range(a.values.shape[0]):
        c.values[i] = a.values[i] + t * b.values[i]


@Link
def gather(a: Inner, b: Inner, c: Inner, d: Inner, e: Inner, t: float) -> None:
    e.values[0] = a.values[0] + b.values[0] + c.values[0] + d.values[0] + t


@njit
def through(links, a, b, c):
    call3(links[0], a, b, c, 3.0)
    call5(links[1], a, b, c, a, b, 0.5)


def test_a_link_is_called_by_address() -> None:
    a, b, c = (Inner(np.array([x, 2.0 * x]), np.zeros((1, 1), dtype=np.int64)) for x in (1.0, 10.0, 0.0))
    add(a, b, c, 2.0)
    np.testing.assert_array_equal(c.values, [21.0, 42.0])
    links = np.array([add.address(a, b, c), gather.address(a, b, c, a, b)])
    assert (links != 0).all()
    through(links, a, b, c)
    np.testing.assert_array_equal(c.values, [31.0, 62.0])
    assert b.values[0] == 1.0 + 10.0 + 31.0 + 1.0 + 0.5

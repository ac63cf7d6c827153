"""Four numbers at once against numpy."""

import numpy as np
from numba import njit

from maggi.linalg.lanes import WIDTH, farther, four, four_at, number, put_four


@njit(fastmath={"contract"})
def combined(x, y, factor, out):
    """``out = x y + factor x + 1``, wherever in the arrays."""
    total = four(0.0)
    for place in range(0, x.size, 4):
        a, b = four_at(x, place), four_at(y, place)
        found = a * b + factor * a + four(1.0)
        put_four(out, place, found)
        total += found
    return number(total, 0) + number(total, 1) + number(total, 2) + number(total, 3)


def test_arrays_of_any_number_of_dimensions():
    rng = np.random.default_rng(0)
    x, y, out = rng.normal(size=(2, 2, 6)), rng.normal(size=24), np.zeros((24, 1))
    total = combined(x, y, 0.5, out)
    expected = x.ravel() * y + 0.5 * x.ravel() + 1.0
    np.testing.assert_allclose(out.ravel(), expected, rtol=1e-15)
    np.testing.assert_allclose(total, expected.sum(), rtol=1e-14)


def test_any_place():
    @njit
    def reverse(x, place):
        """Four of them the other way round, one place further."""
        these = four_at(x, place)
        for k in range(WIDTH):
            x[place + 1 + k] = number(these, 3 - k)

    x = np.arange(10.0)
    reverse(x, 3)
    np.testing.assert_array_equal(x, [0, 1, 2, 3, 6, 5, 4, 3, 8, 9])


def test_the_largest_of_every_lane():
    @njit
    def largest(x, out):
        far = four(0.0)
        for place in range(0, x.size, WIDTH):
            far = farther(far, four_at(x, place))
        put_four(out, 0, far)

    x, out = np.random.default_rng(1).normal(size=(5, WIDTH)), np.empty(WIDTH)
    x[2, 1] = -7.0
    largest(x, out)
    np.testing.assert_array_equal(out, np.abs(x).max(axis=0))

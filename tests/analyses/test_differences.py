"""Central differences: exact for polynomials of their order, and of that order."""

import numpy as np
import pytest

from maggi.analyses.differences import CENTRAL, central_differences


@pytest.mark.parametrize("order", list(CENTRAL))
def test_exact_for_polynomials(order):
    found = central_differences(
        lambda x: np.array([x[0] ** order, x[0] * x[1]]), np.array([0.7, -2.0]), np.ones(2), order
    )
    np.testing.assert_allclose(found, [[order * 0.7 ** (order - 1), 0.0], [-2.0, 0.7]], rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize(("order", "error"), [(2, 1e-9), (4, 1e-11), (6, 1e-12)])
def test_error_of_a_smooth_function(order, error):
    """exp and sin over changes of one: round-off and the formula's error together."""
    found = central_differences(
        lambda x: np.array([np.exp(x[0]), np.sin(x[1])]), np.array([0.3, 1.1]), np.ones(2), order
    )
    np.testing.assert_allclose(found, np.diag([np.exp(0.3), np.cos(1.1)]), atol=error)


def test_no_components():
    assert central_differences(lambda x: x, np.empty(0), np.empty(0), 2).shape == (0, 0)

"""Shape functions of every registered solid element."""

import numpy as np
import pytest

from maggi.elements.solids import SOLIDS


@pytest.fixture(params=list(SOLIDS.values()), ids=list(SOLIDS))
def element(request):
    return request.param


def interior(element, count=20, seed=1):
    """Random points of the reference cell: random convex combinations of its corners."""
    return np.random.default_rng(seed).dirichlet(np.ones(element.node_count), count) @ element.nodes


def test_one_at_its_node_and_zero_at_the_others(element):
    np.testing.assert_allclose(element.values(element.nodes), np.eye(element.node_count), atol=1e-15)


def test_partition_of_unity(element):
    points = interior(element)
    np.testing.assert_allclose(element.values(points).sum(axis=1), 1.0, atol=2e-15)
    np.testing.assert_allclose(element.gradients(points).sum(axis=1), 0.0, atol=2e-15)


def test_reproduces_positions(element):
    points = interior(element)
    np.testing.assert_allclose(element.values(points) @ element.nodes, points, atol=2e-15)


def test_gradients_are_the_derivatives(element):
    points, h = interior(element), 1e-5
    for i in range(3):
        step = h * np.eye(3)[i]
        slope = (element.values(points + step) - element.values(points - step)) / (2 * h)
        # Central differences of polynomials of degree <= 4 in one variable: h² times the third derivative.
        np.testing.assert_allclose(element.gradients(points)[:, :, i], slope, atol=1e-9)

"""Quadrature rules against the exact integrals of monomials."""

from itertools import product
from math import factorial

import numpy as np
import pytest

from maggi.elements import quadrature


def line(n):
    """∫ x^n over [-1, 1]."""
    return 2.0 / (n + 1) if n % 2 == 0 else 0.0


def triangle(i, j):
    """∫ r^i s^j over the reference triangle."""
    return factorial(i) * factorial(j) / factorial(i + j + 2)


def tetrahedron(i, j, k):
    """∫ r^i s^j t^k over the reference tetrahedron."""
    return factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3)


def integral(rule, i, j, k):
    x, y, z = rule.points.T
    return rule.weights @ (x**i * y**j * z**k)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_hexahedron_is_exact_to_its_degree(count):
    rule = quadrature.hexahedron(count)
    for powers in product(range(2 * count), repeat=3):
        assert integral(rule, *powers) == pytest.approx(np.prod([line(n) for n in powers]), abs=1e-14)
    assert integral(rule, 2 * count, 0, 0) != pytest.approx(4 * line(2 * count), rel=1e-6)


@pytest.mark.parametrize(
    ("rule", "degree"),
    [(quadrature.tetrahedron(n), 2 * n - 1) for n in (1, 2, 4)] + [(quadrature.tetrahedron4(), 2)],
)
def test_tetrahedron_is_exact_to_its_degree(rule, degree):
    worst = {}
    for powers in product(range(degree + 2), repeat=3):
        error = abs(integral(rule, *powers) / tetrahedron(*powers) - 1.0)
        worst[sum(powers)] = max(worst.get(sum(powers), 0.0), error)
    assert max(worst[d] for d in range(degree + 1)) < 1e-13
    assert worst[degree + 1] > 1e-6
    assert (rule.weights > 0.0).all()


@pytest.mark.parametrize(
    ("rule", "triangle_degree", "line_degree"), [(quadrature.wedge(2, 3), 3, 5), (quadrature.wedge6_point(), 2, 3)]
)
def test_wedge_is_exact_to_its_degrees(rule, triangle_degree, line_degree):
    for i, j, k in product(range(triangle_degree + 1), range(triangle_degree + 1), range(line_degree + 1)):
        if i + j <= triangle_degree:
            assert integral(rule, i, j, k) == pytest.approx(triangle(i, j) * line(k), abs=1e-14)

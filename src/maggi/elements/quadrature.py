"""Quadrature rules on the reference cells, each with its exactness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rule:
    """A quadrature rule: points (p, 3) and weights (p,), which sum to the reference cell's volume."""

    points: Array
    weights: Array


def gauss_legendre(count: int) -> tuple[Array, Array]:
    """Points and weights on [-1, 1], exact to degree ``2 count - 1``."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return points, weights


def hexahedron(count: int) -> Rule:
    """Tensor-product Gauss rule on [-1, 1]³, exact to degree ``2 count - 1`` in each variable."""
    x, w = gauss_legendre(count)
    return Rule(_product(x, x, x), _product(w, w, w).prod(axis=1))


def tetrahedron(count: int) -> Rule:
    """Conical (Stroud) product rule of count³ points, exact to total degree ``2 count - 1``, all weights positive."""
    u, wu = _jacobi(count, 2)
    v, wv = _jacobi(count, 1)
    w, ww = _jacobi(count, 0)
    U, V, W = _product(u, v, w).T
    points = np.column_stack([U, V * (1.0 - U), W * (1.0 - U) * (1.0 - V)])
    return Rule(points, _product(wu, wv, ww).prod(axis=1))


def tetrahedron4() -> Rule:
    """The symmetric 4-point rule of total degree 2 (Hammer, Marlowe, Stroud 1956)."""
    inner = (5.0 - np.sqrt(5.0)) / 20.0
    points = np.full((4, 3), inner)
    points[np.arange(1, 4), np.arange(3)] = 1.0 - 3.0 * inner
    return Rule(points, np.full(4, 1.0 / 24.0))


def wedge(triangle_count: int, line_count: int) -> Rule:
    """Triangle (conical product, degree ``2 triangle_count - 1``) times Gauss line (``2 line_count - 1``)."""
    u, wu = _jacobi(triangle_count, 1)
    v, wv = _jacobi(triangle_count, 0)
    t, wt = gauss_legendre(line_count)
    U, V, T = _product(u, v, t).T
    return Rule(np.column_stack([U, V * (1.0 - U), T]), _product(wu, wv, wt).prod(axis=1))


def wedge6_point() -> Rule:
    """Symmetric 3-point triangle rule (degree 2) times the 2-point Gauss line (degree 3)."""
    t = 1.0 / np.sqrt(3.0)
    triangle = np.array([[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]]) / 6.0
    points = np.vstack([np.column_stack([triangle, np.full(3, z)]) for z in (-t, t)])
    return Rule(points, np.full(6, 1.0 / 6.0))


def _jacobi(count: int, power: int) -> tuple[Array, Array]:
    """Gauss–Jacobi rule on [0, 1] for the weight ``(1 - x)^power``."""
    from scipy.special import roots_jacobi  # not at the start of every run: it brings much along

    x, w = roots_jacobi(count, float(power), 0.0)
    return (np.asarray(x) + 1.0) / 2.0, np.asarray(w) / 2.0 ** (power + 1)


def _product(x: Array, y: Array, z: Array) -> NDArray[Any]:
    return np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)

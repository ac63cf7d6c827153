"""Shape functions given as expressions in x, y, z, and how they are to be integrated over a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .expression import Program
from .geometry import Matrix, Vector
from .operations import evaluate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ExpressionShapes:
    """n shape functions by expressions: rows x, y, z of N(x), each with n compiled programs in (x, y, z)."""

    rows: tuple[tuple[Program, ...], tuple[Program, ...], tuple[Program, ...]]

    @property
    def count(self) -> int:
        """The number n of shape functions."""
        return len(self.rows[0])

    def __call__(self, points: Array) -> Array:
        """N at points (p, 3) in the body frame (m): (p, 3, n). Not finite outside a function's domain."""
        x, y, z = (np.ascontiguousarray(column) for column in np.asarray(points, dtype=np.float64).T)
        result = np.empty((x.size, 3, self.count))
        for i, row in enumerate(self.rows):
            for j, program in enumerate(row):
                result[:, i, j] = evaluate(program.codes, program.values, (x, y, z))
        return result


@dataclass(frozen=True)
class LineQuadrature:
    """Gauss points along the body's x axis, from 0 to `length` (m), each for its share of ``area · length`` (area in m²)."""

    length: float
    area: float
    order: int


@dataclass(frozen=True)
class BoxQuadrature:
    """Gauss points in the box between two corners (body frame, m), `order` along each axis."""

    low: Vector
    high: Vector
    order: int


@dataclass(frozen=True, eq=False)
class RitzIntegrals:
    """A Ritz body's constants as integrals still to be done: over a quadrature of its shape functions.

    density (kg/m³), constant. stiffness (n, n) and damping (n, n; None: none) are given, since they need the
    material's law. J0: the inertia tensor about the frame's origin (kg m²) where the quadrature does not see all
    of it, as along a line, whose points have no extent of section; None takes the integral.
    """

    density: float
    quadrature: LineQuadrature | BoxQuadrature
    stiffness: Array
    damping: Array | None = None
    J0: Matrix | None = None

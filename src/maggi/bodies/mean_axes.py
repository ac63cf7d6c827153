"""Mean axes on a body's freedoms: the rigid motions Φ, their inertia C = M Φ, and the projections by both (Eq. T6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.table import Table

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RigidColumns(Table):
    """A matrix (nd, 6) whose first blocks of three rows are ``[s I, −p̃]`` and whose others are dense.

    scale (f,), arm (f, 3): s and p of the first f blocks. rest (b − f, 3, 6). So Φ has s = 1 and p = X at a free
    node, and C its share of the mass and of the first moment; eleven numbers are read where dense columns have 18.
    """

    scale: Array
    arm: Array
    rest: Array

    @staticmethod
    def of(columns: Array, scale: Array, arm: Array) -> RigidColumns:
        """From the dense columns (nd, 6), of which the first blocks are known to be made of scale and arm."""
        rest = columns.reshape(-1, 3, 6)[len(scale) :].copy()  # no view, which would keep the others
        return RigidColumns(np.ascontiguousarray(scale), np.ascontiguousarray(arm), rest)

    def dense(self) -> Array:
        """The matrix itself (nd, 6)."""
        first, p = self.scale.size, self.arm
        blocks = np.zeros((first + len(self.rest), 3, 6))
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            blocks[:first, i, i] = self.scale
            blocks[:first, i, 3 + j] = p[:, k]
            blocks[:first, i, 3 + k] = -p[:, j]
        blocks[first:] = self.rest
        return blocks.reshape(-1, 6)

    def transposed_times(self, x: Array) -> Array:
        """Its transpose times x (nd,): (6,)."""
        return np.array(_sums(self, x.reshape(-1, 3)))


@dataclass(frozen=True, eq=False)
class MeanAxes(Table):
    """The projections of a floating body: ``P = I − Φ J₆⁻¹ Cᵀ`` of displacements, and Pᵀ of forces.

    Phi, C (nd, 6): Φ and its inertia. inverse (6, 6): J₆⁻¹.
    """

    Phi: RigidColumns
    C: RigidColumns
    inverse: Array

    @staticmethod
    def of(Phi: RigidColumns, C: RigidColumns, J6: Array) -> MeanAxes:
        """With J₆ (6, 6)."""
        return MeanAxes(Phi, C, np.ascontiguousarray(np.linalg.inv(J6)))

    def project(self, x: Array) -> None:
        """``x ← P x``, (nd,)."""
        project(self, x)

    def project_forces(self, force: Array) -> None:
        """``force ← Pᵀ force``, (nd,)."""
        _subtract(self.Phi, self.C, self.inverse, force.reshape(-1, 3))


@kernel
def project(axes: MeanAxes, x: Array) -> None:
    """``x ← P x``, (nd,)."""
    _subtract(axes.C, axes.Phi, axes.inverse, x.reshape(-1, 3))


@kernel
def _sums(B, x):  # type: ignore[no-untyped-def]
    """Bᵀ x, six numbers; x (b, 3)."""
    scale, arm, rest = B.scale, B.arm, B.rest
    first = scale.size
    f0 = f1 = f2 = m0 = m1 = m2 = 0.0
    for n in range(first):
        x0, x1, x2 = x[n, 0], x[n, 1], x[n, 2]
        p0, p1, p2 = arm[n, 0], arm[n, 1], arm[n, 2]
        f0 += scale[n] * x0
        f1 += scale[n] * x1
        f2 += scale[n] * x2
        m0 += p1 * x2 - p2 * x1
        m1 += p2 * x0 - p0 * x2
        m2 += p0 * x1 - p1 * x0
    for k in range(rest.shape[0]):
        for i in range(3):
            y, row = x[first + k, i], rest[k, i]
            f0 += row[0] * y
            f1 += row[1] * y
            f2 += row[2] * y
            m0 += row[3] * y
            m1 += row[4] * y
            m2 += row[5] * y
    return f0, f1, f2, m0, m1, m2


@kernel
def _subtract(B, A, inverse, x):  # type: ignore[no-untyped-def]
    """``x −= A J⁻¹ Bᵀ x``; inverse: J⁻¹; x (b, 3)."""
    scale, arm, rest = A.scale, A.arm, A.rest
    first = scale.size
    g0, g1, g2, h0, h1, h2 = times_six(inverse, _sums(B, x))
    for n in range(first):
        p0, p1, p2 = arm[n, 0], arm[n, 1], arm[n, 2]
        x[n, 0] -= scale[n] * g0 + h1 * p2 - h2 * p1
        x[n, 1] -= scale[n] * g1 + h2 * p0 - h0 * p2
        x[n, 2] -= scale[n] * g2 + h0 * p1 - h1 * p0
    for k in range(rest.shape[0]):
        for i in range(3):
            row = rest[k, i]
            x[first + k, i] -= row[0] * g0 + row[1] * g1 + row[2] * g2 + row[3] * h0 + row[4] * h1 + row[5] * h2


@inner_kernel
def times_six(A, x):  # type: ignore[no-untyped-def]
    """A x of six numbers, six numbers; A (6, 6)."""
    return (
        _times_row(A[0], x),
        _times_row(A[1], x),
        _times_row(A[2], x),
        _times_row(A[3], x),
        _times_row(A[4], x),
        _times_row(A[5], x),
    )


@inner_kernel
def _times_row(a, x):  # type: ignore[no-untyped-def]
    """a · x of six numbers."""
    return a[0] * x[0] + a[1] * x[1] + a[2] * x[2] + a[3] * x[3] + a[4] * x[4] + a[5] * x[5]

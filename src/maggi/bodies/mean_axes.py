"""Mean axes on a body's freedoms: the rigid motions Φ, their inertia C = M Φ, and the projections by both (Eq. T6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.compiling import kernel

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RigidColumns:
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
        return np.asarray(_sums(self.scale, self.arm, self.rest, x.reshape(-1, 3)))


class MeanAxes:
    """The projections of a floating body: ``P = I − Φ J₆⁻¹ Cᵀ`` of displacements, and Pᵀ of forces.

    Phi, C (nd, 6): Φ and its inertia. inverse (6, 6): J₆⁻¹.
    """

    def __init__(self, Phi: RigidColumns, C: RigidColumns, J6: Array) -> None:
        self.Phi, self.C = Phi, C
        self.inverse = np.ascontiguousarray(np.linalg.inv(J6))

    def project(self, x: Array) -> None:
        """``x ← P x``, (nd,)."""
        self._subtract(self.C, self.Phi, x)

    def project_forces(self, force: Array) -> None:
        """``force ← Pᵀ force``, (nd,)."""
        self._subtract(self.Phi, self.C, force)

    def _subtract(self, measure: RigidColumns, out: RigidColumns, x: Array) -> None:
        _subtract(
            measure.scale,
            measure.arm,
            measure.rest,
            out.scale,
            out.arm,
            out.rest,
            self.inverse,
            x.reshape(-1, 3),
        )


@kernel
def _sums(scale, arm, rest, x):  # type: ignore[no-untyped-def]
    """Bᵀ x (6,) for B of scale, arm, rest; x (b, 3)."""
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
    total = np.empty(6)
    total[0], total[1], total[2], total[3], total[4], total[5] = f0, f1, f2, m0, m1, m2
    for k in range(rest.shape[0]):
        for i in range(3):
            for j in range(6):
                total[j] += rest[k, i, j] * x[first + k, i]
    return total


@kernel
def _subtract(scale, arm, rest, out_scale, out_arm, out_rest, inverse, x):  # type: ignore[no-untyped-def]
    """``x −= A J⁻¹ Bᵀ x`` for B of scale, arm, rest and A of out_scale, out_arm, out_rest; x (b, 3)."""
    first = scale.size
    total = _sums(scale, arm, rest, x)
    g = np.zeros(6)
    for i in range(6):
        for j in range(6):
            g[i] += inverse[i, j] * total[j]
    g0, g1, g2, h0, h1, h2 = g[0], g[1], g[2], g[3], g[4], g[5]
    for n in range(first):
        p0, p1, p2 = out_arm[n, 0], out_arm[n, 1], out_arm[n, 2]
        x[n, 0] -= out_scale[n] * g0 + h1 * p2 - h2 * p1
        x[n, 1] -= out_scale[n] * g1 + h2 * p0 - h0 * p2
        x[n, 2] -= out_scale[n] * g2 + h0 * p1 - h1 * p0
    for k in range(rest.shape[0]):
        for i in range(3):
            for j in range(6):
                x[first + k, i] -= out_rest[k, i, j] * g[j]

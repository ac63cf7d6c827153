"""What inertia does to a meshed body in a moving frame, whatever its elements."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.elements.moving_frame import InertiaConstants
from maggi.linalg.factor import Factor

from .mean_axes import MeanAxes

Array = NDArray[np.float64]


class InertiaForces(Protocol):
    """The inertia forces of one set of fields, to be found again and again."""

    def residual(self, drive: Array, frame: Array) -> tuple[Array, Array]:
        """Inertia forces on the freedoms, in the array that they were asked for in, and on the frame, `frame` (6,).

        drive (3, 3): acceleration a_O of the frame's origin less gravity, ω and ε, body axes. Eq. T2, T5, T5a. Returns the
        first moment S (3,) and the inertia J (3, 3) about the frame's origin, deformed, J to first order lumped in u²; valid
        until the next call.
        """


class MeshInertia(Protocol):
    """What a meshed body's motion does to it, whatever its elements. u, u̇, ü are on the body's freedoms (nd,)."""

    mass: float
    S0: Array
    J0: Array

    @property
    def matrix(self) -> sp.csr_matrix:
        """M on the body's freedoms, made anew each time."""

    def set_aside(self) -> None:
        """Lets the system take back the memory of M until it is next read."""

    def forces(
        self,
        u: Array,
        ud: Array,
        udd: Array,
        nodal: Array,
        relative: Array | None = None,
        axes: MeanAxes | None = None,
    ) -> InertiaForces:
        """Of the fields in these arrays, at any time, on the freedoms, `nodal` (nd,).

        relative (2,): p and q, if given; then ``M (p u + q u̇)`` is added to the forces on the freedoms, not to those on the
        frame. axes: if given, forces on the freedoms are Pᵀ of what they would be (T6).
        """

    def squares(self, fields: Array) -> Array:
        """xᵀM x (4,) of four fields (nd/3, 3, 4), the last index theirs."""

    def kinetic_energy(self, v: Array, w: Array, u: Array, ud: Array) -> float:
        """Kinetic energy (J); v, w: the frame's twist, body axes."""

    def product(self, x: Array) -> Array:
        """M x (nd, k) of columns (nd, k), without making M."""

    def constants(self, basis: Array) -> InertiaConstants:
        """The constants of T3 and T5a for coordinates e that the freedoms follow, ``u = basis e``; basis (nd, n)."""

    def factorised(self) -> Factor:
        """M, factorised."""

    def mean_axes(self, Phi: Array, C: Array, J6: Array) -> MeanAxes:
        """The projections by the rigid motions Phi (nd, 6) and C = M Phi."""

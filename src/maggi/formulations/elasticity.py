"""What resists a body's deformation: given matrices, or strains at points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from maggi.model.materials import Damping

Array = NDArray[np.float64]


class Elasticity(Protocol):
    """Elastic and damping forces of a body."""

    def force(self, e: Array, rate: Array) -> Array:
        """Generalised forces (n,) at elastic coordinates e (n,) with rates (n,)."""


@dataclass(frozen=True, eq=False)
class Rigid:
    """None: a rigid body has no elastic coordinates."""

    def force(self, e: Array, rate: Array) -> Array:
        return np.zeros_like(e)


@dataclass(frozen=True, eq=False)
class GivenMatrices:
    """Stiffness and damping (n, n) as the description of a Ritz body gives them."""

    stiffness: Array
    damping: Array

    def force(self, e: Array, rate: Array) -> Array:
        return np.asarray(-self.stiffness @ e - self.damping @ rate)


@dataclass(frozen=True, eq=False)
class Strains:
    """Strains at q quadrature points.

    strain (q, r, n): r components for unit elastic coordinates. modulus (q, r, r): what takes them to the stresses, times
    the volume that the point stands for.
    """

    strain: Array
    modulus: Array


@dataclass(frozen=True, eq=False)
class HookesLaw:
    """Stresses by strains, and Rayleigh damping.

    shapes (p, 3, n), masses (p,): of the mass points, which mass-proportional damping holds back in the body's frame.
    """

    strains: tuple[Strains, ...]
    shapes: Array
    masses: Array
    damping: Damping

    def force(self, e: Array, rate: Array) -> Array:
        drag = self.damping.mass * self.masses[:, None] * (self.shapes @ rate)
        result = -np.einsum("pin,pi->n", self.shapes, drag)
        for part in self.strains:
            stress = np.einsum("qrs,qs->qr", part.modulus, part.strain @ (e + self.damping.stiffness * rate))
            result -= np.einsum("qrn,qr->n", part.strain, stress)
        return np.asarray(result)

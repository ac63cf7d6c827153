"""Isotropic elastic materials."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Damping:
    """Rayleigh damping ``D = mass·M + stiffness·K`` (mass in 1/s, stiffness in s)."""

    mass: float = 0.0
    stiffness: float = 0.0


@dataclass(frozen=True)
class Material:
    """Isotropic linear elastic material: density (kg/m³), Young's modulus (Pa), Poisson's ratio."""

    density: float
    young: float
    poisson: float
    damping: Damping = field(default_factory=Damping)

"""Materials of the model file."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ...model import units
from ...model.materials import Damping, Material
from .fields import Number, PositiveDensity, Section


class DampingSection(Section):
    """Rayleigh damping: mass·M + stiffness·K."""

    mass: Annotated[float, Field(ge=0), Number(units.PER_TIME)] = Field(
        0.0, description="factor of the mass matrix (1/s)"
    )
    stiffness: Annotated[float, Field(ge=0), Number(units.TIME)] = Field(
        0.0, description="factor of the stiffness matrix (s)"
    )


class MaterialSection(Section):
    """An isotropic linear elastic material."""

    density: PositiveDensity = Field(description="density (kg/m³)")
    young: Annotated[float, Field(gt=0), Number(units.PRESSURE)] = Field(description="Young's modulus (Pa)")
    poisson: Annotated[float, Field(gt=-1, lt=0.5), Number(units.NUMBER)] = Field(description="Poisson's ratio")
    damping: DampingSection | None = Field(None, description="Rayleigh damping; none if left out")

    def build(self) -> Material:
        """The frozen description."""
        damping = Damping(self.damping.mass, self.damping.stiffness) if self.damping else Damping()
        return Material(self.density, self.young, self.poisson, damping)

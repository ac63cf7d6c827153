"""The solid elements: a registry of shape functions and quadrature rules. A new element is one entry.

Exactness, for element K = ∫BᵀDB dV and scalar mass μ_ab = ∫ρN_aN_b dV:

=======  ===========  ==================================================  =======================================
element  stiffness    stiffness is exact on                               mass (exact on every cell, curved too)
=======  ===========  ==================================================  =======================================
tet4     1 point      every cell                                          8 points, degree 3 (integrand 2)
tet10    4 points     affine (straight-edged) cells (integrand 2)         64 points, degree 7 (N² 4 + Jacobian 3)
hex8     2×2×2        parallelepipeds (integrand 2 per variable)          3×3×3, degree 5 (N² 2 + Jacobian 2)
hex20    3×3×3        parallelepipeds (integrand 4 per variable)          5×5×5, degree 9 (N² 4 + Jacobian 5)
wedge6   3×2          affine prisms (integrand 2 in triangle and line)    2²×3, degree 3 and 5 (3 and 4 needed)
=======  ===========  ==================================================  =======================================

Integration is full everywhere: no hourglass modes, no stabilisation constants. Mass is exact so that total mass, centre
and inertia tensor of a meshed body are those of its (curved) geometry to round-off. The linear elements (tet4, hex8,
wedge6) are stiff in bending by their nature; use the quadratic ones where bending matters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from . import quadrature, shapes
from .quadrature import Rule

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SolidElement:
    """A solid element with isotropic interpolation ``N = Σ N_a I₃``.

    nodes : reference nodes (k, 3). values, gradients : points (p, 3) to (p, k) and (p, k, 3).
    make_stiffness_rule, make_mass_rule : the rules of the module's table, made when they are first asked for.
    """

    name: str
    nodes: Array
    values: Callable[[Array], Array]
    gradients: Callable[[Array], Array]
    make_stiffness_rule: Callable[[], Rule]
    make_mass_rule: Callable[[], Rule]

    @cached_property
    def stiffness_rule(self) -> Rule:
        """Points and weights for the stiffness."""
        return self.make_stiffness_rule()

    @cached_property
    def mass_rule(self) -> Rule:
        """Points and weights for the mass."""
        return self.make_mass_rule()

    @property
    def node_count(self) -> int:
        """Number k of nodes."""
        return len(self.nodes)

    @cached_property
    def mass_products(self) -> Array:
        """Upper triangles of ``w N_a N_b`` at the mass points, (p, k(k+1)/2), row by row."""
        N = self.values(self.mass_rule.points)
        a, b = np.triu_indices(self.node_count)
        return np.ascontiguousarray(self.mass_rule.weights[:, None] * N[:, a] * N[:, b])

    @cached_property
    def mass_gradients(self) -> Array:
        """Reference gradients at the mass points, (p, 3, k)."""
        return np.ascontiguousarray(self.gradients(self.mass_rule.points).transpose(0, 2, 1))

    @cached_property
    def stiffness_gradients(self) -> Array:
        """Reference gradients at the stiffness points, (p, 3, k)."""
        return np.ascontiguousarray(self.gradients(self.stiffness_rule.points).transpose(0, 2, 1))


def _registry(*elements: SolidElement) -> Mapping[str, SolidElement]:
    return MappingProxyType({element.name: element for element in elements})


SOLIDS: Mapping[str, SolidElement] = _registry(
    SolidElement(
        "tet4",
        shapes.TET_CORNERS,
        shapes.tet4,
        shapes.tet4_gradients,
        partial(quadrature.tetrahedron, 1),
        partial(quadrature.tetrahedron, 2),
    ),
    SolidElement(
        "tet10",
        shapes.TET10_NODES,
        shapes.tet10,
        shapes.tet10_gradients,
        quadrature.tetrahedron4,
        partial(quadrature.tetrahedron, 4),
    ),
    SolidElement(
        "hex8",
        shapes.HEX_CORNERS,
        shapes.hex8,
        shapes.hex8_gradients,
        partial(quadrature.hexahedron, 2),
        partial(quadrature.hexahedron, 3),
    ),
    SolidElement(
        "hex20",
        shapes.HEX20_NODES,
        shapes.hex20,
        shapes.hex20_gradients,
        partial(quadrature.hexahedron, 3),
        partial(quadrature.hexahedron, 5),
    ),
    SolidElement(
        "wedge6",
        shapes.WEDGE_CORNERS,
        shapes.wedge6,
        shapes.wedge6_gradients,
        quadrature.wedge6_point,
        partial(quadrature.wedge, 2, 3),
    ),
)

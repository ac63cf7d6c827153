"""The paper's general element: any shape functions N(x), any quadrature, integrated to the constants of T3 and T5a."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from maggi.model.bodies import RitzTerms
from maggi.model.errors import ModelError
from maggi.model.materials import Damping, Material
from maggi.model.shapes import BoxQuadrature, LineQuadrature, RitzIntegrals

from .materials import CellMaterials, check_materials
from .moving_frame import inertia_constants
from .quadrature import gauss_legendre, hexahedron

Array = NDArray[np.float64]
Field = Callable[[Array], Array]


def integrate_ritz(
    shapes: Field,
    points: Array,
    weights: Array,
    density: float | Array,
    *,
    stiffness: Array | None = None,
    material: Material | None = None,
    gradients: Field | None = None,
    damping: Array | Damping | None = None,
) -> RitzTerms:
    """Integrate the constants of a body with shape functions N(x) (Eq. T2, T3, T5a; paper (6), (A1)–(A6)).

    Parameters
    ----------
    shapes : N(x), points (p, 3) in m to (p, 3, n).
    points, weights : quadrature over the undeformed body, (p, 3) m and (p,) m³ (`line_quadrature`, `box_quadrature`).
    density : kg/m³, one number or (p,).
    stiffness : k (n, n) in N per unit of the coordinates, given; or else
    material, gradients : isotropic law and ``∂N_ia/∂x_j`` as a function of points to (p, 3, 3, n) [i, j, a], for
        ``k = ∫ BᵀDB dV``. The material's own density is not used.
    damping : D (n, n), or Rayleigh factors ``D = mass·m + stiffness·k``. Without it: the material's.

    Raises ModelError where shapes, gradients or matrices have the wrong shape or values that are not finite, for
    an impossible density or material, and unless the stiffness is given in exactly one way.
    """
    points, weights = np.asarray(points, dtype=np.float64), np.asarray(weights, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or weights.shape != points.shape[:1]:
        raise ModelError(
            f"quadrature points have shape {points.shape}, weights {weights.shape}", remedy="give (p, 3) and (p,)"
        )
    _finite("quadrature points", points)
    _finite("quadrature weights", weights)
    rho = np.broadcast_to(np.asarray(density, dtype=np.float64), weights.shape)
    if not (np.isfinite(rho).all() and (rho > 0.0).all()):
        raise ModelError(f"density is {rho.min():g}", remedy="give a positive density in kg/m³")
    N = _evaluate("shapes", shapes, points, (3,))
    count = N.shape[-1]
    inertia = inertia_constants(N, points, rho * weights)
    k = _stiffness(count, points, weights, stiffness, material, gradients)
    if damping is None and material is not None:
        damping = material.damping
    if damping is None:
        D = np.zeros((count, count))
    elif isinstance(damping, Damping):
        D = damping.mass * inertia.m + damping.stiffness * k
    else:
        D = _square("damping", damping, count)
    return RitzTerms(
        mass=float(inertia.mass),
        S0=inertia.S0,
        J0=inertia.J0,
        m=inertia.m,
        k=k,
        D=D,
        m_O=inertia.m_O,
        G=inertia.G,
        H=inertia.H,
        s=inertia.s,
        s2=inertia.s2,
    )


def ritz_terms(shapes: Field, integrals: RitzIntegrals) -> RitzTerms:
    """Carry out the integrals that a model describes; as `integrate_ritz`.

    Raises ModelError also for an inertia tensor J0 that is not symmetric and positive semidefinite.
    """
    match integrals.quadrature:
        case LineQuadrature(length, area, order):
            points, weights = line_quadrature(length, area, order)
        case BoxQuadrature(low, high, order):
            points, weights = box_quadrature(np.array(low), np.array(high), order)
    terms = integrate_ritz(
        shapes,
        points,
        weights,
        integrals.density,
        stiffness=integrals.stiffness,
        damping=integrals.damping,
    )
    if integrals.J0 is None:
        return terms
    J0 = _square("J0", np.array(integrals.J0), 3)
    size = np.abs(J0).max()
    if np.abs(J0 - J0.T).max() > 1e-9 * size or np.linalg.eigvalsh(J0)[0] < -1e-9 * size:
        raise ModelError(
            f"J0 is {J0.tolist()}", remedy="an inertia tensor is symmetric and has no negative principal moments"
        )
    return replace(terms, J0=J0)


def line_quadrature(length: float, area: float, order: int) -> tuple[Array, Array]:
    """Gauss points (order, 3) along x from 0 to `length` (m), weights (order,) m³ for a cross-section of `area` (m²).

    Exact for polynomials of degree ``2 order - 1`` in x; the section's own extent is left out.
    """
    _positive("length", length)
    _positive("area", area)
    _order(order)
    x, w = gauss_legendre(order)
    points = np.zeros((order, 3))
    points[:, 0] = (x + 1.0) * (length / 2.0)
    return points, w * (area * length / 2.0)


def box_quadrature(low: Array, high: Array, order: int) -> tuple[Array, Array]:
    """Gauss points (order³, 3) in the box between the corners `low` and `high` (3,), and weights (order³,) m³.

    Exact to degree ``2 order - 1`` in each coordinate.
    """
    low, high = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    if low.shape != (3,) or high.shape != (3,) or not (np.isfinite(high - low).all() and (high > low).all()):
        raise ModelError(f"the box from {low.tolist()} to {high.tolist()} has no volume", remedy="give low < high")
    _order(order)
    rule = hexahedron(order)
    half = (high - low) / 2.0
    return low + (rule.points + 1.0) * half, rule.weights * half.prod()


def _stiffness(
    count: int,
    points: Array,
    weights: Array,
    stiffness: Array | None,
    material: Material | None,
    gradients: Field | None,
) -> Array:
    if stiffness is not None:
        if material is not None or gradients is not None:
            raise ModelError("the stiffness is given twice", remedy="give either stiffness or material and gradients")
        k = _square("stiffness", stiffness, count)
        if np.abs(k - k.T).max(initial=0.0) > 1e-9 * np.abs(k).max(initial=0.0):
            raise ModelError("the stiffness matrix is not symmetric", remedy="k must be the Hessian of an energy")
        return k
    if material is None or gradients is None:
        raise ModelError("the stiffness is missing", remedy="give stiffness, or material and gradients")
    law = CellMaterials.uniform(material, 1)
    check_materials("ritz", 1, law)
    gradient = _evaluate("gradients", gradients, points, (3, 3))
    if gradient.shape[-1] != count:
        raise ModelError(f"gradients are of {gradient.shape[-1]} functions, shapes of {count}")
    strain = (gradient + gradient.transpose(0, 2, 1, 3)) / 2.0
    dilation = np.einsum("piia->pa", gradient)
    k = law.lame[0] * np.einsum("p,pa,pb->ab", weights, dilation, dilation)
    k += 2.0 * law.shear[0] * np.einsum("p,pija,pijb->ab", weights, strain, strain, optimize=True)
    return np.asarray((k + k.T) / 2.0)


def _evaluate(name: str, function: Field, points: Array, middle: tuple[int, ...]) -> Array:
    values = np.asarray(function(points), dtype=np.float64)
    expected = (len(points), *middle)
    if values.ndim != len(expected) + 1 or values.shape[:-1] != expected or values.shape[-1] == 0:
        wanted = ", ".join(map(str, expected))
        raise ModelError(
            f"{name} gave an array of shape {values.shape} at {len(points)} points", remedy=f"return ({wanted}, n)"
        )
    _finite(name, values)
    return values


def _square(name: str, matrix: Array, count: int) -> Array:
    matrix = np.array(matrix, dtype=np.float64)
    if matrix.shape != (count, count):
        raise ModelError(f"{name} has shape {matrix.shape}", remedy=f"give ({count}, {count}), one row per function")
    _finite(name, matrix)
    return matrix


def _finite(name: str, values: Array) -> None:
    if not np.isfinite(values).all():
        raise ModelError(f"{name} has values that are not finite", remedy="look for a division by zero or an overflow")


def _positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise ModelError(f"{name} is {value:g}", remedy=f"give a positive {name}")


def _order(order: int) -> None:
    if not 1 <= order <= 100:
        raise ModelError(f"the quadrature order is {order}", remedy="give 1 to 100 points per direction")

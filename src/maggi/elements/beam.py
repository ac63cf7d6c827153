"""A 3-D beam of 12 freedoms in a moving frame (T2, T3), and meshes of it.

Freedoms of a node: u, v, w (m) and θx, θy, θz (rad). Timoshenko's theory with interdependent interpolation
(Przemieniecki, Theory of Matrix Structural Analysis, 1968, chapter 5; Reddy 1997): the static solution for end loads,
so that the stiffness is exact and nothing locks; shear factors of 0 give the Euler–Bernoulli beam. Inertia is that of
the 3-D field of rigid cross-sections, rotary terms included:

    f = (u + z θy − y θz,  v − z θx,  w + y θx)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.model.errors import MeshError, ModelError
from maggi.model.materials import Material
from maggi.model.meshes import Section

from .materials import CellMaterials, Labels, cell_label, check_materials
from .moving_frame import InertiaConstants, inertia_constants, reorient
from .quadrature import gauss_legendre

Array = NDArray[np.float64]

# Of the 14 matrices of T3 the element blocks are held at once, 60 kB an element.
ELEMENT_LIMIT = 20_000


@dataclass(frozen=True, eq=False)
class BeamTerms:
    """Assembled terms of a beam mesh in body axes; nd = 6 × nodes, freedoms (u, v, w, θx, θy, θz) node by node.

    M, K : BSR (nd, nd) with 3×3 blocks over (translation, rotation) of every node. G : 3 BSR; H : 3×3 BSR, H[k][l].
    m_O (nd, 3), s (3, nd), s2 (3, 3, nd), mass (kg), S0 (3,), J0 (3, 3): as in `moving_frame.InertiaTerms`.
    """

    M: sp.bsr_matrix
    K: sp.bsr_matrix
    G: tuple[sp.bsr_matrix, ...]
    H: tuple[tuple[sp.bsr_matrix, ...], ...]
    m_O: Array
    s: Array
    s2: Array
    mass: float
    S0: Array
    J0: Array


def beam_shapes(points: Array, length: Array, phi_y: Array, phi_z: Array) -> Array:
    """``N(x, y, z)`` (c, p, 3, 12) of beams of lengths (c,) at points ``(x/length, y, z)``, (p, 3).

    phi_y, phi_z : shear flexibilities ``Φ = 12 E I/(G k A L²)`` of bending along y and along z, (c,).
    """
    xi, y, z = points[:, 0], points[:, 1], points[:, 2]
    L = length[:, None]
    N = np.zeros((len(length), len(points), 3, 12))
    N[:, :, 0, 0], N[:, :, 0, 6] = 1.0 - xi, xi
    N[:, :, 1, 3], N[:, :, 1, 9] = -z * (1.0 - xi), -z * xi
    N[:, :, 2, 3], N[:, :, 2, 9] = y * (1.0 - xi), y * xi
    # Bending along y turns by θz = v', bending along z by θy = −w': hence the sign.
    for phi, row, columns, sign, lever in (
        (phi_y, 1, (1, 5, 7, 11), 1.0, -y),
        (phi_z, 2, (2, 4, 8, 10), -1.0, z),
    ):
        deflection, rotation = _bending(xi, L, phi[:, None])
        for i, column in enumerate(columns):
            turn = sign if i % 2 else 1.0
            N[:, :, row, column] = turn * deflection[i]
            N[:, :, 0, column] = lever * sign * turn * rotation[i]
    return N


def _bending(xi: Array, L: Array, phi: Array) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Deflection and rotation of the section for unit v₁, θ₁, v₂, θ₂ (θ = v' without shear)."""
    f = 1.0 / (1.0 + phi)
    eta = 1.0 - xi
    bubble = xi * eta
    deflection = (
        f * (1.0 - 3.0 * xi**2 + 2.0 * xi**3 + phi * eta),
        f * L * bubble * (eta + phi / 2.0),
        f * (3.0 * xi**2 - 2.0 * xi**3 + phi * xi),
        -f * L * bubble * (xi + phi / 2.0),
    )
    rotation = (
        -6.0 * f * bubble / L,
        f * (1.0 - 4.0 * xi + 3.0 * xi**2 + phi * eta),
        6.0 * f * bubble / L,
        f * (3.0 * xi**2 - 2.0 * xi + phi * xi),
    )
    return deflection, rotation


def shear_flexibilities(length: Array, section: Section, material: Material) -> tuple[Array, Array]:
    """``Φ = 12 E I/(G k A L²)`` of bending along y (with Iz) and along z (with Iy), (c,) each; 0 where k is 0."""
    ratio = 24.0 * (1.0 + material.poisson) / (section.area * length**2)
    phi_y = ratio * section.Iz / section.ky if section.ky else np.zeros_like(length)
    phi_z = ratio * section.Iy / section.kz if section.kz else np.zeros_like(length)
    return phi_y, phi_z


def beam_inertia(length: Array, section: Section, material: Material) -> InertiaConstants:
    """Inertia constants of beams along x from their first node, in their own axes; leading axis (c,). Exact.

    The integrands are of degree 6 in x (4 Gauss points) and quadratic in y, z, so four points of the section that have
    its area and second moments stand for it exactly.
    """
    x, wx = gauss_legendre(4)
    y, z = np.sqrt(2.0 * section.Iz / section.area), np.sqrt(2.0 * section.Iy / section.area)
    yz = np.array([[y, 0.0], [-y, 0.0], [0.0, z], [0.0, -z]])
    points = np.column_stack([np.repeat((x + 1.0) / 2.0, 4), np.tile(yz, (4, 1))])
    weights = np.repeat(wx / 2.0, 4) / 4.0 * (material.density * section.area) * length[:, None]
    r = np.broadcast_to(points, (len(length), *points.shape)).copy()
    r[:, :, 0] *= length[:, None]
    return inertia_constants(beam_shapes(points, length, *shear_flexibilities(length, section, material)), r, weights)


def beam_stiffness(length: Array, section: Section, material: Material) -> Array:
    """Exact stiffness (c, 12, 12) of beams in their own axes; Przemieniecki (1968), chapter 5."""
    E = material.young
    shear = E / (2.0 * (1.0 + material.poisson))
    phi_y, phi_z = shear_flexibilities(length, section, material)
    K = np.zeros((len(length), 12, 12))
    for first, second, value in ((0, 6, E * section.area / length), (3, 9, shear * section.J / length)):
        K[:, first, first] = K[:, second, second] = value
        K[:, first, second] = K[:, second, first] = -value
    for phi, inertia, columns, sign in (
        (phi_y, section.Iz, (1, 5, 7, 11), 1.0),
        (phi_z, section.Iy, (2, 4, 8, 10), -1.0),
    ):
        L, one = length, np.ones_like(length)
        block = np.array(
            [
                [12.0 * one, 6.0 * L, -12.0 * one, 6.0 * L],
                [6.0 * L, (4.0 + phi) * L**2, -6.0 * L, (2.0 - phi) * L**2],
                [-12.0 * one, -6.0 * L, 12.0 * one, -6.0 * L],
                [6.0 * L, (2.0 - phi) * L**2, -6.0 * L, (4.0 + phi) * L**2],
            ]
        )
        block *= E * inertia / (length**3 * (1.0 + phi))
        turn = np.array([1.0, sign, 1.0, sign])
        K[np.ix_(range(len(length)), columns, columns)] = np.einsum("ijc,i,j->cij", block, turn, turn)
    return K


def beam_axes(directions: Array) -> Array:
    """Rotations (c, 3, 3), beam axes to body axes, of beams along `directions` (c, 3).

    Local z is as near to the body's z as can be, so that a beam along x has the body's own axes. A beam within 1e-6 rad
    of the z axis takes its local y nearest to the body's y instead.
    """
    x = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    y = np.cross([0.0, 0.0, 1.0], x)
    upright = np.linalg.norm(y, axis=1) < 1e-6
    y[upright] = np.array([0.0, 1.0, 0.0]) - x[upright, 1, None] * x[upright]
    y /= np.linalg.norm(y, axis=1, keepdims=True)
    return np.stack([x, y, np.cross(x, y)], axis=2)


def assemble_beam(
    nodes: Array, cells: NDArray[np.int64], section: Section, material: Material, labels: Labels | None = None
) -> BeamTerms:
    """Terms of a mesh of two-node beams of one section.

    nodes (n, 3) m; cells (c, 2) node indices; labels: ``beam2`` → (c,) labels for messages. The section's
    axes are those of `beam_axes`.

    Raises MeshError for a missing node, a cell without length or more than `ELEMENT_LIMIT` cells, ModelError for an
    impossible section or material.
    """
    nodes = np.asarray(nodes, dtype=np.float64)
    check_materials("beam2", len(cells), CellMaterials.uniform(material, len(cells)), labels)
    _check_section(section)
    if cells.ndim != 2 or cells.shape[1] != 2 or not len(cells):
        raise MeshError(f"beam cells have shape {cells.shape}", remedy="give (c, 2) node indices, at least one cell")
    if len(cells) > ELEMENT_LIMIT:
        raise MeshError(f"{len(cells)} beam cells are more than {ELEMENT_LIMIT}", remedy="use fewer elements")
    if cells.min() < 0 or cells.max() >= len(nodes):
        raise MeshError(
            f"beam cells name node indices {cells.min()} to {cells.max()}; the mesh has {len(nodes)} nodes",
            remedy="indices count from 0; check the mesh's connectivity",
        )
    spans = nodes[cells[:, 1]] - nodes[cells[:, 0]]
    length = np.linalg.norm(spans, axis=1)
    short = np.flatnonzero(~(length > 1e-12 * np.abs(nodes).max()))
    if short.size:
        row = int(short[0])
        raise MeshError(
            f"beam cell {cell_label('beam2', row, labels)} has length {length[row]:g} m",
            remedy="its two nodes must lie apart",
        )
    rotation = beam_axes(spans)
    T = np.zeros((len(cells), 12, 12))
    for i in range(0, 12, 3):
        T[:, i : i + 3, i : i + 3] = rotation
    inertia = reorient(beam_inertia(length, section, material), rotation, T, nodes[cells[:, 0]])
    stiffness = T @ beam_stiffness(length, section, material) @ T.transpose(0, 2, 1)

    freedoms = (6 * cells[:, :, None] + np.arange(6)).reshape(-1, 12)
    size = 6 * len(nodes)

    def matrix(blocks: Array) -> sp.bsr_matrix:
        rows, columns = np.repeat(freedoms, 12, axis=1), np.tile(freedoms, 12)
        entries = (blocks.ravel(), (rows.ravel(), columns.ravel()))
        return sp.coo_matrix(entries, shape=(size, size)).tobsr((3, 3))

    def vectors(values: Array) -> Array:
        """Sum (c, …, 12) into (…, nd)."""
        result = np.zeros((size, *values.shape[1:-1]))
        np.add.at(result, freedoms, np.moveaxis(values, -1, 1))
        return np.moveaxis(result, 0, -1)

    return BeamTerms(
        M=matrix(inertia.m),
        K=matrix(stiffness),
        G=tuple(matrix(inertia.G[:, k]) for k in range(3)),
        H=tuple(tuple(matrix(inertia.H[:, k, l]) for l in range(3)) for k in range(3)),
        m_O=np.ascontiguousarray(vectors(np.swapaxes(inertia.m_O, 1, 2)).T),
        s=vectors(inertia.s),
        s2=vectors(inertia.s2),
        mass=float(inertia.mass.sum()),
        S0=inertia.S0.sum(axis=0),
        J0=inertia.J0.sum(axis=0),
    )


def _check_section(section: Section) -> None:
    for key in ("area", "Iy", "Iz", "J"):
        value = getattr(section, key)
        if not (np.isfinite(value) and value > 0.0):
            raise ModelError(f"the section has {key} {value:g}", remedy=f"give a positive {key}")
    for key in ("ky", "kz"):
        value = getattr(section, key)
        if not (np.isfinite(value) and value >= 0.0):
            raise ModelError(f"the section has {key} {value:g}", remedy="give a shear factor, or 0 for no shear")

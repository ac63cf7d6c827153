"""Mass and stiffness of a mesh of solid cells (T2, T4; Maggi's step (28) for nodes shared by elements).

Tying elements at shared nodes is Maggi's projection ``Aᵀ [blockdiag] A`` with the 0/1 matrix A of paper (28); summing
element entries into the rows of their nodes is that product carried out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.linalg.threads import in_parts
from maggi.model.errors import MeshError
from maggi.model.materials import Material

from . import cell_kernels
from .graph import NodeGraph, node_graph
from .materials import LARGEST, CellMaterials, Labels, cell_label, check_materials
from .solids import SOLIDS, SolidElement

Array = NDArray[np.float64]
Cells = Mapping[str, NDArray[np.int64]]
Materials = Material | Mapping[str, CellMaterials]

# Numbers in the element matrices of a chunk (16 MB): few chunks, since each waits for its threads twice.
CHUNK = 2**21

# A determinant below this share of the cell's extent cubed is a flat cell up to round-off.
FLAT = 1e-13


@dataclass(frozen=True, eq=False)
class SolidMatrices:
    """Matrices of a mesh on one node graph.

    mass : scalar mass ``μ_ab = ∫ρN_aN_b dV``, CSR (n, n), kg; the mass matrix is μ ⊗ I₃.
    stiffness : BSR (3n, 3n) with 3×3 blocks, N/m; freedoms are x, y, z of node 0, of node 1, …
    """

    graph: NodeGraph
    mass: sp.csr_matrix
    stiffness: sp.bsr_matrix


def assemble_solids(nodes: Array, cells: Cells, materials: Materials, labels: Labels | None = None) -> SolidMatrices:
    """Scalar mass and stiffness of a mesh.

    Parameters
    ----------
    nodes : (n, 3) coordinates, m.
    cells : type (a name in `SOLIDS`) → (c, k) node indices. Several types may be mixed.
    materials : one material, or constants per cell for every type.
    labels : type → (c,) labels that error messages name; rows are named without them.

    Raises MeshError for an unknown type of cell, a missing node, and inverted or flat cells (with their least
    Jacobian determinant); ModelError for impossible material constants. Deterministic: bitwise the
    same for any number of threads, and K and μ are exactly symmetric.
    """
    nodes = _checked_nodes(nodes)
    constants = _checked_cells(nodes, cells, materials, labels)
    graph = node_graph(len(nodes), cells)
    mass = np.zeros((graph.indices.size, 1))
    stiffness = np.zeros((graph.indices.size, 9))
    for name, connectivity in graph.cells.items():
        element, law, slots = SOLIDS[name], constants[name], graph.slots[name]
        least = np.empty(len(connectivity))
        constant = np.ascontiguousarray(law.density), element.mass_gradients, element.mass_products
        _sum(cell_kernels.masses, nodes, connectivity, constant, slots, mass, least)
        _refuse_inverted(nodes, element, connectivity, least, labels)
        elastic = law.lame, law.shear, element.stiffness_gradients, element.stiffness_rule.weights
        _sum(cell_kernels.stiffnesses, nodes, connectivity, elastic, slots, stiffness, least)
        _refuse_inverted(nodes, element, connectivity, least, labels)
    size = graph.node_count
    return SolidMatrices(
        graph,
        sp.csr_matrix((mass.ravel(), graph.indices, graph.indptr), shape=(size, size)),
        sp.bsr_matrix((stiffness.reshape(-1, 3, 3), graph.indices, graph.indptr), shape=(3 * size, 3 * size)),
    )


def _sum(
    kernel: Callable[..., None],
    nodes: Array,
    cells: NDArray[np.int32],
    constants: tuple[Array, ...],
    slots: NDArray[np.int32],
    out: Array,
    least: Array,
) -> None:
    """Add the matrices that a kernel makes of all cells to out (nnz, w), chunk by chunk."""
    count, width = cells.shape
    chunk = CHUNK // (out.shape[1] * width**2)
    buffer = np.empty((min(chunk, count), width, width, out.shape[1]))
    for base in range(0, count, chunk):
        top = min(base + chunk, count)
        in_parts(kernel, nodes, cells, *constants, base, top, buffer, least)
        in_parts(cell_kernels.add_cells, base, top, cells, slots, buffer, out)


def element_masses(name: str, nodes: Array, cells: NDArray[np.int64], density: Array) -> Array:
    """Scalar mass of every cell of one type, (c, k, k), kg."""
    element, connectivity = SOLIDS[name], np.ascontiguousarray(cells, dtype=np.int32)
    count, k = connectivity.shape
    out = np.empty((count, k, k, 1))
    least = np.empty(count)
    nodes = _checked_nodes(nodes)
    constant = density, element.mass_gradients, element.mass_products
    in_parts(cell_kernels.masses, nodes, connectivity, *constant, 0, count, out, least)
    _refuse_inverted(nodes, element, connectivity, least, None)
    return out[..., 0]


def element_stiffnesses(name: str, nodes: Array, cells: NDArray[np.int64], law: CellMaterials) -> Array:
    """Stiffness of every cell of one type, (c, 3k, 3k), N/m, node by node."""
    element, connectivity = SOLIDS[name], np.ascontiguousarray(cells, dtype=np.int32)
    count, k = connectivity.shape
    out = np.empty((count, k, k, 9))
    least = np.empty(count)
    nodes = _checked_nodes(nodes)
    constant = law.lame, law.shear, element.stiffness_gradients, element.stiffness_rule.weights
    in_parts(cell_kernels.stiffnesses, nodes, connectivity, *constant, 0, count, out, least)
    _refuse_inverted(nodes, element, connectivity, least, None)
    return out.reshape(count, k, k, 3, 3).transpose(0, 1, 3, 2, 4).reshape(count, 3 * k, 3 * k)


def _checked_nodes(nodes: Array) -> Array:
    nodes = np.ascontiguousarray(nodes, dtype=np.float64)
    if nodes.ndim != 2 or nodes.shape[1] != 3:
        raise MeshError(f"nodes have shape {nodes.shape}", remedy="give (n, 3) coordinates")
    bad = np.flatnonzero(~(np.abs(nodes) < LARGEST).all(axis=1))
    if bad.size:
        raise MeshError(f"node at row {bad[0]} has coordinates {nodes[bad[0]].tolist()}", remedy="repair the mesh")
    return nodes


def _checked_cells(
    nodes: Array, cells: Cells, materials: Materials, labels: Labels | None
) -> Mapping[str, CellMaterials]:
    """Constants of every type, after all that can be wrong with types and materials was looked at."""
    constants: dict[str, CellMaterials] = {}
    if not any(len(c) for c in cells.values()):
        raise MeshError("the mesh has no solid cells", remedy=f"mesh the volume with {', '.join(SOLIDS)}")
    for name, connectivity in cells.items():
        if name not in SOLIDS:
            raise MeshError(f"cells of type {name!r} are not solid elements", remedy=f"use {', '.join(SOLIDS)}")
        width = SOLIDS[name].node_count
        if connectivity.ndim != 2 or connectivity.shape[1] != width:
            raise MeshError(f"{name} cells have shape {connectivity.shape}", remedy=f"give (c, {width}) node indices")
        count = len(connectivity)
        if isinstance(materials, Material):
            constants[name] = CellMaterials.uniform(materials, count)
        elif name in materials:
            constants[name] = materials[name]
        else:
            raise MeshError(f"no material is given for the {name} cells", remedy="give one per cell")
        check_materials(name, count, constants[name], labels)
    return constants


def _refuse_inverted(
    nodes: Array, element: SolidElement, cells: NDArray[np.int32], least: Array, labels: Labels | None
) -> None:
    """Raise MeshError if the least Jacobian determinant of a cell is not clearly positive."""
    # The extent is needed only to tell flat from small, so first look whether any cell can be in question.
    if least.size == 0:
        return
    suspects = np.flatnonzero(~(least > FLAT * np.ptp(nodes, axis=0).max() ** 3))
    extent = np.ptp(nodes[cells[suspects]], axis=1).max(axis=1, initial=0.0)
    bad = suspects[~(least[suspects] > FLAT * extent**3)]
    if bad.size:
        row = int(bad[0])
        kind = "is inverted" if least[row] < 0.0 else "has no volume"
        others = f"; {bad.size - 1} more {element.name} cells are bad" if bad.size > 1 else ""
        raise MeshError(
            f"{element.name} cell {cell_label(element.name, row, labels)} {kind}: "
            f"least Jacobian determinant {least[row]:.3g} m³{others}",
            remedy="check the order of its nodes, or mesh that place again",
        )

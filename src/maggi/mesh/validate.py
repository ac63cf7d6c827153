"""What every mesh must satisfy before a body is made of it.

Cells turned inside out or without volume are found where shape functions are: in `elements`.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from maggi.model.errors import MeshError

from .cells import CELL_TYPES
from .labels import sample
from .mesh import IntArray, Mesh

_COINCIDENT = 1e-6  # of the mesh's size
_SHOWN = 5


def validate(mesh: Mesh) -> None:
    """Raise MeshError, naming node, cell or set, for a mesh that cannot make one body.

    That is: no cells; unknown types, arrays of wrong shape, indices beyond the nodes; labels used twice;
    coordinates that are not finite or all the same; a node twice in one cell; nodes in no cell; several
    disconnected parts.
    """
    _require_shapes(mesh)
    _require_distinct_labels(mesh)
    _require_finite(mesh)
    _require_distinct_nodes_in_cells(mesh)
    _require_no_dangling_nodes(mesh)
    _require_connected(mesh)


def _fail(mesh: Mesh, message: str, remedy: str) -> MeshError:
    return MeshError(message, file=mesh.source, remedy=remedy)


def _require_shapes(mesh: Mesh) -> None:
    remedy = "correct the mesh's arrays"
    if mesh.n_nodes == 0 or mesh.n_cells == 0:
        message = f"the mesh is empty: {mesh.n_nodes} nodes, {mesh.n_cells} cells"
        raise _fail(mesh, message, "mesh the part and write its solid cells")
    if mesh.nodes.shape != (mesh.n_nodes, 3) or mesh.node_labels.shape != (mesh.n_nodes,):
        message = f"nodes of shape {mesh.nodes.shape} with labels of shape {mesh.node_labels.shape}"
        raise _fail(mesh, message, remedy)
    for kind, cells in mesh.cells.items():
        if kind not in CELL_TYPES:
            raise _fail(mesh, f"unknown cell type '{kind}'", f"use {', '.join(CELL_TYPES)}")
        labels = mesh.cell_labels.get(kind)
        if cells.shape != (len(cells), CELL_TYPES[kind].nodes) or labels is None or labels.shape != (len(cells),):
            raise _fail(mesh, f"the {kind} cells or their labels have a wrong shape, {cells.shape}", remedy)
        wrong = np.flatnonzero(((cells < 0) | (cells >= mesh.n_nodes)).any(axis=1))
        if len(wrong):
            raise _fail(mesh, f"{kind} cell {labels[wrong[0]]} has a node that does not exist", remedy)
    for name, nodes in mesh.node_sets.items():
        if len(nodes) and (nodes.min() < 0 or nodes.max() >= mesh.n_nodes):
            raise _fail(mesh, f"node set '{name}' has a node that does not exist", remedy)


def _require_distinct_labels(mesh: Mesh) -> None:
    for what, labels in (("node", mesh.node_labels), ("cell", np.concatenate(list(mesh.cell_labels.values())))):
        values, counts = np.unique(labels, return_counts=True)
        if len(values) < len(labels):
            message = f"{what} labels used more than once: {sample(values[counts > 1])}"
            raise _fail(mesh, message, f"give every {what} its own number")


def _require_finite(mesh: Mesh) -> None:
    wrong = ~np.isfinite(mesh.nodes).all(axis=1)
    if wrong.any():
        message = f"coordinates that are not finite, at nodes {sample(mesh.node_labels[wrong])}"
        raise _fail(mesh, message, "write the mesh again")
    low, high = mesh.bounding_box()
    with np.errstate(over="ignore"):
        size = np.linalg.norm(high - low)
    if not (np.isfinite(size) and size > 0.0):
        raise _fail(mesh, f"the mesh has size {size:g}", "check the coordinates and the unit")


def _require_distinct_nodes_in_cells(mesh: Mesh) -> None:
    for kind, cells in mesh.cells.items():
        ordered = np.sort(cells, axis=1)
        repeated = ordered[:, 1:] == ordered[:, :-1]
        wrong = np.flatnonzero(repeated.any(axis=1))
        if len(wrong):
            first = wrong[0]
            node = mesh.node_labels[ordered[first, 1:][repeated[first]][0]]
            message = f"{kind} cell {mesh.cell_labels[kind][first]} has node {node} twice"
            raise _fail(mesh, message, "collapsed cells are not supported: use the proper cell type there")


def _require_no_dangling_nodes(mesh: Mesh) -> None:
    used = np.zeros(mesh.n_nodes, dtype=np.bool_)
    for cells in mesh.cells.values():
        used[cells] = True
    if not used.all():
        count = np.count_nonzero(~used)
        message = f"{count} nodes belong to no cell: {sample(mesh.node_labels[~used])}"
        raise _fail(mesh, message, "delete them, or write the cells that use them")


def _require_connected(mesh: Mesh) -> None:
    links = [
        np.column_stack([np.repeat(cells[:, 0], cells.shape[1] - 1), cells[:, 1:].ravel()])
        for cells in mesh.cells.values()
    ]
    first, second = np.concatenate(links).T
    graph = coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(mesh.n_nodes, mesh.n_nodes))
    count, part = connected_components(graph.tocsr(), directed=False)
    if count == 1:
        return
    sizes = np.bincount(part, minlength=count)
    order = np.argsort(-sizes, kind="stable")
    texts = [_describe(mesh, part, int(i), int(sizes[i])) for i in order[:_SHOWN]]
    more = f"; and {count - _SHOWN} more" if count > _SHOWN else ""
    message = f"the mesh falls into {count} parts that share no node: {'; '.join(texts)}{more}"
    touching = _coincident(mesh, part)
    if touching:
        a, b = touching[0]
        remedy = (
            f"{len(touching)} nodes of different parts coincide, such as {a} and {b}: "
            "merge duplicate nodes in the mesher (in Gmsh: Coherence or BooleanFragments before meshing)"
        )
    else:
        remedy = "make one body of each part, or join them in the mesher"
    raise _fail(mesh, message, remedy)


def _describe(mesh: Mesh, part: IntArray, which: int, size: int) -> str:
    for kind, cells in mesh.cells.items():
        inside = np.flatnonzero(part[cells[:, 0]] == which)
        if len(inside):
            return f"{size} nodes around {kind} cell {mesh.cell_labels[kind][inside[0]]}"
    return f"{size} nodes"


def _coincident(mesh: Mesh, part: IntArray) -> list[tuple[int, int]]:
    """Labels of pairs of nodes of different parts at one place: for each node its nearest other, once."""
    low, high = mesh.bounding_box()
    reach = _COINCIDENT * float(np.linalg.norm(high - low))
    from scipy.spatial import cKDTree  # not at the start of every run: it brings much along

    distance, neighbour = cKDTree(mesh.nodes).query(mesh.nodes, k=2, distance_upper_bound=reach)
    own = np.arange(mesh.n_nodes)
    other = np.where(neighbour[:, 0] == own, neighbour[:, 1], neighbour[:, 0])
    near = (other < mesh.n_nodes) & np.isfinite(distance[:, 1])
    pairs = np.column_stack([own[near], other[near]])
    pairs = pairs[part[pairs[:, 0]] != part[pairs[:, 1]]]
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    return [(int(mesh.node_labels[a]), int(mesh.node_labels[b])) for a, b in pairs]

"""Which nodes of a mesh a selection means."""

from __future__ import annotations

import difflib

import numpy as np
from numpy.typing import NDArray

from maggi.model.attachments import BoxSet, NamedSet, NodeSelection, PlaneSet
from maggi.model.errors import MeshError

from .mesh import Array, IntArray, Mesh

_ROUND_OFF = 1e-9  # of the mesh's size: nodes that lie on a box's face but for round-off are inside
_SHOWN = 30


def select(mesh: Mesh, selection: NodeSelection, path: str = "") -> IntArray:
    """The selected nodes: sorted indices, (s,), at least one.

    A box takes the nodes on its faces too, within 1e-9 of the mesh's size.
    path : where in the model, for messages. Raises MeshError for unknown sets, for boxes and planes that are
    none, and where no node is selected.
    """
    match selection:
        case NamedSet(name):
            return _named(mesh, name, path)
        case BoxSet(low, high):
            return _in_box(mesh, np.array(low, dtype=np.float64), np.array(high, dtype=np.float64), path)
        case PlaneSet(point, normal, tolerance):
            return _on_plane(
                mesh, np.array(point, dtype=np.float64), np.array(normal, dtype=np.float64), tolerance, path
            )


def _named(mesh: Mesh, name: str, path: str) -> IntArray:
    if name not in mesh.node_sets:
        names = sorted(mesh.node_sets)
        by_fold = {known.casefold(): known for known in names}
        near = difflib.get_close_matches(name.casefold(), by_fold, n=3, cutoff=0.6)
        hint = f"did you mean {' or '.join(repr(by_fold[key]) for key in near)}? " if near else ""
        shown = ", ".join(names[:_SHOWN]) + (f", … ({len(names)} in all)" if len(names) > _SHOWN else "")
        remedy = f"{hint}the mesh has: {shown}" if names else "the mesh has no named sets: use box: or plane:"
        raise MeshError(f"unknown node set '{name}' in {mesh.source}", path=path, remedy=remedy)
    nodes = mesh.node_sets[name]
    if len(nodes) == 0:
        remedy = "check in the mesher that the set lies on the solid and is saved with the mesh"
        raise MeshError(f"the node set '{name}' of {mesh.source} is empty", path=path, remedy=remedy)
    return nodes


def _in_box(mesh: Mesh, low: Array, high: Array, path: str) -> IntArray:
    if not (np.isfinite(low).all() and np.isfinite(high).all() and (low <= high).all()):
        message = f"the box from {low.tolist()} to {high.tolist()} is none"
        raise MeshError(message, path=path, remedy="give the lowest corner first, then the highest")
    slack = _ROUND_OFF * _size(mesh)
    inside: NDArray[np.bool_] = np.all((mesh.nodes >= low - slack) & (mesh.nodes <= high + slack), axis=1)
    return _not_empty(mesh, inside, f"the box from {low.tolist()} to {high.tolist()}", path)


def _on_plane(mesh: Mesh, point: Array, normal: Array, tolerance: float, path: str) -> IntArray:
    length = float(np.linalg.norm(normal))
    if not (np.isfinite(point).all() and np.isfinite(length) and length > 0.0):
        message = f"the plane through {point.tolist()} with normal {normal.tolist()} is none"
        raise MeshError(message, path=path, remedy="give a point and a normal that is not zero")
    if not (np.isfinite(tolerance) and tolerance >= 0.0):
        message = f"the plane's tolerance must not be negative, found {tolerance}"
        raise MeshError(message, path=path, remedy="give a length in metres")
    distance = np.abs((mesh.nodes - point) @ (normal / length))
    what = f"the plane through {point.tolist()} with normal {normal.tolist()} and tolerance {tolerance:g} m"
    return _not_empty(mesh, distance <= tolerance, what, path, f"; the nearest is {distance.min():.4g} m away")


def _not_empty(mesh: Mesh, chosen: NDArray[np.bool_], what: str, path: str, more: str = "") -> IntArray:
    if not chosen.any():
        low, high = mesh.bounding_box()
        span = " to ".join(f"[{', '.join(f'{x:.6g}' for x in corner)}]" for corner in (low, high))
        remedy = f"the mesh spans {span} m: check place and unit"
        raise MeshError(f"no node lies in {what}{more}", path=path, remedy=remedy)
    return np.flatnonzero(chosen)


def _size(mesh: Mesh) -> float:
    low, high = mesh.bounding_box()
    return float(np.linalg.norm(high - low))

"""What an audit found, as data that other programs can read and as a text that a person can."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from maggi.model.errors import ModelError
from maggi.model.geometry import Vector

from .freedoms import ElasticFreedoms, Freedom
from .integrability import PartIntegrability
from .mobility import Mobility
from .remedies import Remedy

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NodeSetReport:
    """A named node set: how many nodes, and the shape fitted to them (see `mesh.set_geometry`), body frame, m."""

    name: str
    nodes: int
    kind: str
    centroid: Array | None
    axis: Array | None
    radius: float | None


@dataclass(frozen=True, eq=False)
class AttachmentReport:
    """An attachment: position (3,) global and at (3,) body frame, m; of a mesh, its nodes and their coupling."""

    name: str
    position: Array
    at: Array
    nodes: int
    coupling: str


@dataclass(frozen=True, eq=False)
class ReductionReport:
    """What a mesh of so many freedoms was reduced to.

    modes : modes with the attachments held, up to highest (Hz; None without modes). interface : motions of the
    attachments. coordinates : shapes in all. range : lowest and highest frequency (Hz) of the body that has only these
    shapes and that nothing holds; None on a prescribed frame without elastic shapes.
    """

    method: str
    freedoms: int
    modes: int
    highest: float | None
    interface: int
    coordinates: int
    range: tuple[float, float] | None


@dataclass(frozen=True, eq=False)
class BodyReport:
    """A body: kind ``rigid``, ``ritz``, ``mesh`` or ``reduced``; frame ``floating`` or ``prescribed``.

    mass, kg; center_of_mass (3,), global, m; inertia (3, 3) about it, body axes, kg m²; both undeformed. freedoms:
    velocities without liaisons. bounding_box: lowest and highest corner, body frame, m; cells by type.
    """

    name: str
    kind: str
    frame: str
    mass: float
    center_of_mass: Array
    inertia: Array
    freedoms: int
    bounding_box: tuple[Array, Array] | None
    nodes: int
    cells: Mapping[str, int]
    attachments: tuple[AttachmentReport, ...]
    node_sets: tuple[NodeSetReport, ...]
    reduction: ReductionReport | None = None


@dataclass(frozen=True, eq=False)
class LiaisonReport:
    """A joint or driver: kind, ends, number of rows, point and axis (3,), global; a driver's joint, quantity, function."""

    name: str
    kind: str
    first: str
    second: str
    rows: int
    position: Array
    axis: Array | None
    drives: tuple[str, str, str] | None


@dataclass(frozen=True)
class ForceReport:
    """A force other than gravity: kind, and what it acts on."""

    name: str
    kind: str
    on: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Audit:
    """What a model is.

    size: the mechanism's extent, m. mobility: freedoms at the initial pose. motions, elastic: what they are. remedies: joints
    that would do where rows repeat each other. integrability: of rows that hold no position. notes: what the user should know.
    unused: attachments that nothing uses. problems: why a run would be refused.
    """

    title: str
    gravity: Vector
    size: float
    bodies: tuple[BodyReport, ...]
    liaisons: tuple[LiaisonReport, ...]
    forces: tuple[ForceReport, ...]
    mobility: Mobility
    motions: tuple[Freedom, ...]
    elastic: tuple[ElasticFreedoms, ...]
    remedies: tuple[Remedy, ...]
    integrability: tuple[PartIntegrability, ...]
    notes: tuple[str, ...]
    unused: tuple[str, ...]
    problems: tuple[ModelError, ...]

    def data(self) -> dict[str, Any]:
        """Everything as dictionaries, lists, texts and numbers, ready for `json.dumps`."""
        plain = _plain(self)
        assert isinstance(plain, dict)
        return plain

    def text(self) -> str:
        """Everything in lines for a person."""
        from .audit_text import audit_text

        return audit_text(self)


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, ModelError):
        return {"path": value.path, "message": value.message, "remedy": value.remedy}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value

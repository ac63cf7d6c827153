"""Attachments: the frames on a body that joints and forces hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .geometry import Matrix, Vector

ZERO: Matrix = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class PointMass:
    """A rigid mass (kg) on an attachment: offset of its centre (body axes, m), inertia about it (kg m²)."""

    mass: float
    offset: Vector = (0.0, 0.0, 0.0)
    inertia: Matrix = ZERO


@dataclass(frozen=True)
class NamedSet:
    """The nodes of a named set of the mesh."""

    name: str


@dataclass(frozen=True)
class BoxSet:
    """The nodes inside a box (body frame, m), its faces included."""

    low: Vector
    high: Vector


@dataclass(frozen=True)
class PlaneSet:
    """The nodes within `tolerance` (m) of a plane (body frame)."""

    point: Vector
    normal: Vector
    tolerance: float = 1e-6


NodeSelection = NamedSet | BoxSet | PlaneSet


@dataclass(frozen=True)
class Attachment:
    """An attachment frame, body axes.

    On a rigid or a Ritz body `at` (body frame, m) is its point. On an elastic body `nodes` selects the
    nodes that carry it, `coupling` says whether they are made rigid (RBE2) or averaged (RBE3), and its
    point is their centroid.
    """

    at: Vector | None = None
    nodes: NodeSelection | None = None
    coupling: Literal["rigid", "average"] = "rigid"
    point_masses: tuple[PointMass, ...] = ()

"""A mechanism ready to be computed: the tables of the small system, its meshed bodies, and the names of everything."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.mesh_body import MeshBody
from maggi.bodies.motions import MotionTable
from maggi.bodies.tables import BodyTable, MotionState
from maggi.forces.tables import ForceTable
from maggi.liaisons.tables import DRIVEN, OFFSET, PRODUCT, LiaisonTable
from maggi.model.model import Model

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class BodyEntry:
    """A body of the mechanism: its row in the tables; helpers (welded point masses, held frames) are not visible."""

    name: str
    index: int
    visible: bool = True


@dataclass(frozen=True)
class AttachmentEntry:
    """A named attachment: its body's name and its row in the tables."""

    body: str
    name: str
    index: int


@dataclass(frozen=True, eq=False)
class LiaisonEntry:
    """A joint or a driver: rows and coordinates in the tables, and what its ends are called.

    joint: row of the joint that it acts in (a driver's is its joint's). reference: attachment on the second
    body at whose point force and torque are reported.
    """

    name: str
    kind: str
    joint: int
    rows: IntArray
    coordinates: IntArray
    first: str
    second: str
    position: Array
    axis: Array | None
    visible: bool = True


@dataclass(frozen=True, eq=False)
class System:
    """Bodies, liaisons and forces on one vector of velocities (the small coordinates of `BodyTable`).

    size: the mechanism's extent (m), the length that position residuals are scaled with.
    inertia_floor (b,): kg m², see `stepping.kernels.compliances`. start: the motion at the initial pose.
    mesh_bodies: by row in the tables.
    """

    model: Model
    bodies: BodyTable
    motions: MotionTable
    liaisons: LiaisonTable
    forces: ForceTable
    body_entries: tuple[BodyEntry, ...]
    attachment_entries: tuple[AttachmentEntry, ...]
    liaison_entries: tuple[LiaisonEntry, ...]
    mesh_bodies: dict[int, MeshBody]
    size: float
    inertia_floor: Array
    start: MotionState

    @property
    def coordinates(self) -> int:
        """Number of small coordinates."""
        return int(self.bodies.offset[-1])

    @property
    def rows(self) -> int:
        """Number of liaison rows."""
        return int(self.liaisons.row_kind.size)

    def body(self, name: str) -> BodyEntry:
        """The entry of a body by name."""
        return next(entry for entry in self.body_entries if entry.name == name)

    def row_name(self, row: int) -> str:
        """What a row does, for messages: ``crankpin: offset along its z axis``."""
        table = self.liaisons
        owner = self.liaison_entries[table.row_owner[row]].name
        kind, k, l = int(table.row_kind[row]), int(table.row_first[row]), int(table.row_second[row])
        if kind == OFFSET:
            return f"{owner}: offset along its {'xyz'[k]} axis"
        if kind == PRODUCT:
            return f"{owner}: rotation about its {'xyz'[3 - k - l]} axis"
        return f"{owner}: driven coordinate" if kind == DRIVEN else f"{owner}: driven speed"

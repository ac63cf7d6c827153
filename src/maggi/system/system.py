"""A mechanism ready to be computed: the tables of the small system, its meshed bodies, and the names of everything."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.motions import MotionTable
from maggi.bodies.tables import BodyTable, MotionState
from maggi.forces.tables import ForceTable
from maggi.liaisons.callbacks import RowFunction
from maggi.liaisons.tables import ROW_HOLONOMIC, ROW_OWNER, LiaisonTable
from maggi.model.model import Model

if TYPE_CHECKING:
    from maggi.bodies.mesh_body import MeshBody
    from maggi.bodies.reduced import ReducedBody

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
    """A joint, a coupler or a driver: rows and coordinates in the tables, and what its ends are called.

    labels: what each row restricts, such as ``rotation about its y axis``. reference: the attachment on the second
    body at whose point force and torque are reported. position, axis: global, in the initial pose.
    """

    name: str
    kind: str
    rows: IntArray
    labels: tuple[str, ...]
    coordinates: IntArray
    first: str
    second: str
    reference: int
    position: Array
    axis: Array | None
    visible: bool = True


@dataclass(frozen=True, eq=False)
class System:
    """Bodies, liaisons and forces on one vector of velocities (the small coordinates of `BodyTable`).

    size: the mechanism's extent (m), the length that position residuals are scaled with.
    inertia_floor (b,): kg m², see `stepping.block_kernels.compliances`. start: the motion at the initial pose.
    mesh_bodies, reduced: by row in the tables; of a reduced body the elastic coordinates are those of its shapes.
    row_functions: Python functions whose addresses the liaison table holds.
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
    reduced: dict[int, ReducedBody]
    size: float
    inertia_floor: Array
    start: MotionState
    row_functions: tuple[RowFunction, ...] = ()

    @property
    def coordinates(self) -> int:
        """Number of small coordinates."""
        return int(self.bodies.offset[-1])

    @property
    def rows(self) -> int:
        """Number of liaison rows."""
        return len(self.liaisons.row)

    @property
    def holonomic(self) -> NDArray[np.bool_]:
        """Which rows have a position residual (r,)."""
        return np.asarray(self.liaisons.row[:, ROW_HOLONOMIC] == 1)

    @property
    def driven(self) -> NDArray[np.bool_]:
        """Which rows belong to drivers (r,)."""
        of_drivers = np.array([entry.kind == "driver" for entry in self.liaison_entries], dtype=np.bool_)
        return of_drivers[self.liaisons.row[:, ROW_OWNER]]

    def owner(self, row: int) -> LiaisonEntry:
        """The liaison that a row belongs to."""
        return self.liaison_entries[int(self.liaisons.row[row, ROW_OWNER])]

    def mesh(self, body: int) -> MeshBody | None:
        """The mesh of a body by its row, reduced or not."""
        reduced = self.reduced.get(body)
        return self.mesh_bodies.get(body) if reduced is None else reduced.body

    def body(self, name: str) -> BodyEntry:
        """The entry of a body by name."""
        return next(entry for entry in self.body_entries if entry.name == name)

    def row_name(self, row: int) -> str:
        """What a row does, for messages: ``crankpin: offset along its z axis``."""
        return f"{self.owner(row).name}: {self.row_label(row)}"

    def row_label(self, row: int) -> str:
        """What a row does, without its liaison's name."""
        owner = self.owner(row)
        return owner.labels[int(np.flatnonzero(owner.rows == row)[0])]

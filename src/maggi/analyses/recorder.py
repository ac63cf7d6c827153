"""What a transient run hands over, in rows, and the protocol of whatever keeps it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .outline import Outline

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class BodyLayout:
    """One body as the results describe it.

    kind: ``rigid``, ``mesh``, ``reduced`` or ``ritz``. attachments: their names, in order; at (a, 3): where they are on
    the undeformed body, body frame, m. For a body with a mesh `nodes` (n, 3), body frame, and `cells` by type (n_cells,
    nodes per cell). For a Ritz or reduced body `modes` is the number of its coordinates, and for a reduced one `basis`
    (n, 3, modes) the nodal displacements of each.
    """

    name: str
    kind: str
    attachments: tuple[str, ...]
    at: Array
    nodes: Array | None = None
    cells: dict[str, IntArray] | None = None
    modes: int = 0
    basis: Array | None = None


@dataclass(frozen=True)
class JointLayout:
    """One joint or driver: its kind, the names of its ends, and the unit (``m`` or ``rad``) of each coordinate.

    A weld has no coordinate, a revolute one, a cylindrical two, translation before rotation. outline: what is to be drawn
    of it beside its point.
    """

    name: str
    kind: str
    first: str
    second: str
    units: tuple[str, ...]
    outline: Outline | None = None


@dataclass(frozen=True, eq=False)
class Layout:
    """The shape of every row of a run, and what the result file says about it once; gravity (3,), m/s², global."""

    bodies: tuple[BodyLayout, ...]
    joints: tuple[JointLayout, ...]
    rows: int
    attributes: dict[str, str | float | int]
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Rows:
    """The states at m output times, global components unless said otherwise. The first index of every array is the time.

    time (m,), s. Per body: origin (m, b, 3), rotation (m, b, 3, 3) body to global. Per attachment, in the order
    of the layout, body by body: position (m, a, 3), attachment_rotation (m, a, 3, 3), velocity (m, a, 3),
    angular_velocity (m, a, 3). displacement: for each mesh body nodal displacements (m, n_nodes, 3), body frame;
    modal: for each Ritz or reduced body its coordinates (m, modes). Per joint (drivers included): joint_position (m, j, 3), its point
    on the second body, force (m, j, 3), torque (m, j, 3) about that point, unique (m, j): 0 where others would do the same and
    these are the least ones, and coordinate: one array (m, k) per joint, k as
    in the layout. energy (m, 5): kinetic, strain, gravity, dissipated, work (J). residuals (m, 3): position, velocity,
    acceleration, scaled. iterations (m,): back-substitutions or Newton iterations of the last step.
    """

    time: Array
    origin: Array
    rotation: Array
    position: Array
    attachment_rotation: Array
    velocity: Array
    angular_velocity: Array
    displacement: tuple[Array, ...]
    modal: tuple[Array, ...]
    joint_position: Array
    force: Array
    torque: Array
    unique: IntArray
    coordinate: tuple[Array, ...]
    energy: Array
    residuals: Array
    iterations: IntArray


class Recorder(Protocol):
    """Keeps the rows of a run. `write` is called in order of time; `end` always, also after a failure."""

    def begin(self, layout: Layout) -> None: ...

    def write(self, rows: Rows) -> None: ...

    def end(self, status: str) -> None:
        """status: ``complete``, ``failed: <why>`` or ``interrupted``."""


class Progress(Protocol):
    """Told how far a run is."""

    def stage(self, text: str) -> None:
        """A new stage of the work, such as "factorising rod (30,123 freedoms)"."""

    def advance(self, step: int, steps: int, time: float, note: str) -> None:
        """Step `step` of `steps` is done, at `time` (s); called a few times a second."""


class Silent:
    """Progress for nobody."""

    def stage(self, text: str) -> None:
        """See `Progress.stage`."""

    def advance(self, step: int, steps: int, time: float, note: str) -> None:
        """See `Progress.advance`."""

"""Results of a run, read by name; the same whether they lie in a file or in memory."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from maggi.analyses.outline import Outline
from maggi.model.errors import ModelError

from .contract import ENERGIES
from .recovered import Recovered
from .source import Frames, Source, Table

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Results:
    """Results of a run; a context manager where they lie in a file (`results.read.read`).

    Arrays are read when asked for; n is the number of rows.
    """

    def __init__(self, source: Source) -> None:
        self._source = source
        self._displacements: dict[str, Recovered] = {}

    @property
    def name(self) -> str:
        """Where the results come from: the file's name, or ``memory``."""
        return self._source.name

    @property
    def attributes(self) -> Mapping[str, Any]:
        """What is said once: ``model`` (text), ``model_sha256``, ``version``, ``status``, …"""
        return self._source.attributes("")

    @property
    def status(self) -> str:
        """``complete``, ``failed: <why>``, ``interrupted``, or ``running`` (also after the process was killed)."""
        return str(self.attributes.get("status", ""))

    @property
    def title(self) -> str:
        """The model's title; empty if it has none."""
        return str(self.attributes.get("title", ""))

    @property
    def time(self) -> Array:
        """Times of the rows (n,), s."""
        return self._array("time")

    @property
    def gravity(self) -> Array:
        """Acceleration of gravity (3,), global, m/s²; zero where the file does not say."""
        table = self._find("gravity")
        return np.zeros(3) if table is None else np.asarray(table[:], dtype=np.float64)

    @property
    def iterations(self) -> IntArray:
        """Back-substitutions or Newton iterations of the last step before each row (n,)."""
        return np.asarray(self._frames("solver/iterations")[:], dtype=np.int64)

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies, in the order of the model."""
        return self._source.children("bodies")

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints and drivers, in the order of the model."""
        return self._source.children("joints")

    def body(self, name: str) -> BodyResults:
        """One body's results.

        Raises
        ------
        ModelError : there is no such body.
        """
        return BodyResults(self, _known(name, self.bodies, "body", self.name))

    def joint(self, name: str) -> JointResults:
        """One joint's or driver's results.

        Raises
        ------
        ModelError : there is no such joint.
        """
        return JointResults(self, _known(name, self.joints, "joint", self.name))

    @property
    def energy(self) -> EnergyResults:
        """Energies of the whole mechanism."""
        return EnergyResults(self)

    @property
    def residuals(self) -> ResidualResults:
        """Residuals of the liaisons."""
        return ResidualResults(self)

    def has(self, path: str) -> bool:
        """Whether the table at a path of the contract was kept or can be recovered, such as ``bodies/rod/displacement``."""
        return self._find(path) is not None

    def series(self, path: str) -> Array:
        """The table at a path of the contract, such as ``joints/motor/torque``, whole: (n, ...).

        Raises
        ------
        ModelError : it was not kept.
        """
        return self._array(path)

    def frames(self, path: str) -> Frames:
        """The table at a path of the contract, to be read row by row.

        Raises
        ------
        ModelError : it was not kept.
        """
        return self._frames(path)

    def close(self) -> None:
        """Close the file, if there is one."""
        self._source.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _table(self, path: str) -> Table:
        table = self._find(path)
        if table is None:
            raise ModelError(
                f"{self.name} holds no {path}",
                remedy="it was not kept (outputs.quantities), or this kind of body or joint does not have it",
            )
        return table

    def _find(self, path: str) -> Table | None:
        table = self._source.table(path)
        body, _, name = path.rpartition("/")
        if table is not None or name != "displacement":
            return table
        if body not in self._displacements:
            modal, basis = (self._source.table(f"{body}/{part}") for part in ("modal", "basis"))
            if modal is None or basis is None:
                return None
            self._displacements[body] = Recovered(modal, basis)
        return self._displacements[body]

    def _frames(self, path: str) -> Frames:
        return Frames(self._table(path), self._source.rows)

    def _array(self, path: str) -> Array:
        return self._frames(path)[:]


class BodyResults:
    """Results of one body; global components unless said otherwise."""

    def __init__(self, results: Results, name: str) -> None:
        self._results = results
        self._path = f"bodies/{name}"
        self.name = name

    @property
    def kind(self) -> str:
        """``rigid``, ``mesh``, ``reduced`` or ``ritz``."""
        return str(self._results._source.attributes(self._path).get("kind", ""))

    @property
    def origin(self) -> Array:
        """Origin of the body frame (n, 3), m."""
        return self._results._array(f"{self._path}/origin")

    @property
    def rotation(self) -> Array:
        """Rotation matrices (n, 3, 3), body axes to global."""
        return self._results._array(f"{self._path}/rotation")

    @property
    def displacement(self) -> Frames:
        """Nodal displacements (n, nodes, 3), body frame, m; read frame by frame, for they may be large.

        Those of a reduced body are recovered from `modal` and `basis`.
        """
        return self._results._frames(f"{self._path}/displacement")

    @property
    def modal(self) -> Array:
        """Coordinates of the shapes of a Ritz or reduced body (n, modes)."""
        return self._results._array(f"{self._path}/modal")

    @property
    def basis(self) -> Array:
        """Nodal displacements (nodes, 3, modes) of each coordinate of a reduced body, body frame."""
        return np.asarray(self._results._table(f"{self._path}/basis")[:])

    @property
    def nodes(self) -> Array:
        """Undeformed nodes of the mesh (nodes, 3), body frame, m."""
        return np.asarray(self._results._table(f"{self._path}/mesh/nodes")[:])

    @property
    def cells(self) -> dict[str, IntArray]:
        """Cells by type, (cells, nodes per cell) each, counted from 0; empty without a mesh."""
        path = f"{self._path}/mesh/cells"
        return {
            kind: np.asarray(self._results._table(f"{path}/{kind}")[:]) for kind in self._results._source.children(path)
        }

    @property
    def attachments(self) -> tuple[str, ...]:
        """Names of the attachments."""
        return self._results._source.children(f"{self._path}/attachments")

    def attachment(self, name: str) -> AttachmentResults:
        """One attachment's results.

        Raises
        ------
        ModelError : the body has no such attachment.
        """
        known = _known(name, self.attachments, f"attachment of {self.name}", self._results.name)
        return AttachmentResults(self._results, self.name, known)


class AttachmentResults:
    """Motion of an attachment, global components."""

    def __init__(self, results: Results, body: str, name: str) -> None:
        self._results = results
        self._path = f"bodies/{body}/attachments/{name}"
        self.name = name

    @property
    def at(self) -> Array:
        """Its point on the undeformed body (3,), body frame, m."""
        return np.asarray(self._results._table(f"{self._path}/at")[:])

    @property
    def position(self) -> Array:
        """Position (n, 3), m."""
        return self._results._array(f"{self._path}/position")

    @property
    def rotation(self) -> Array:
        """Rotation matrices (n, 3, 3), the attachment's axes to global."""
        return self._results._array(f"{self._path}/rotation")

    @property
    def velocity(self) -> Array:
        """Velocity (n, 3), m/s."""
        return self._results._array(f"{self._path}/velocity")

    @property
    def angular_velocity(self) -> Array:
        """Angular velocity (n, 3), rad/s."""
        return self._results._array(f"{self._path}/angular_velocity")


class JointResults:
    """Results of a joint or driver; force and torque are those of first on second, at the joint's point on second."""

    def __init__(self, results: Results, name: str) -> None:
        self._results = results
        self._path = f"joints/{name}"
        self.name = name

    @property
    def kind(self) -> str:
        """Its kind in the model: ``revolute``, …, or ``driver``."""
        return self._said("kind")

    @property
    def ends(self) -> tuple[str, str]:
        """First and second: ``ground``, a body, or ``body.attachment``; a driver has those of its joint."""
        return self._said("first"), self._said("second")

    @property
    def units(self) -> tuple[str, ...]:
        """``m`` or ``rad`` for each coordinate."""
        return tuple(self._said("coordinate_units").split())

    @property
    def position(self) -> Array:
        """The joint's point on second (n, 3), m."""
        return self._results._array(f"{self._path}/position")

    @property
    def force(self) -> Array:
        """Force (n, 3), global components, N."""
        return self._results._array(f"{self._path}/force")

    @property
    def torque(self) -> Array:
        """Torque (n, 3), global components, N m."""
        return self._results._array(f"{self._path}/torque")

    @property
    def unique(self) -> NDArray[np.bool_]:
        """Where (n,) force and torque are unique; elsewhere joints repeat each other and these are the least ones."""
        return np.asarray(self._results._array(f"{self._path}/unique") > 0)

    @property
    def coordinate(self) -> Array:
        """Coordinates (n, k) in `units`, translation before rotation; k = 0 for joints without any."""
        path = f"{self._path}/coordinate"
        return self._results._array(path) if self._results.has(path) else np.zeros((self._results._source.rows, 0))

    @property
    def outline(self) -> Outline:
        """What is drawn of the joint beside its point: lines fixed in its bodies."""
        found = (self._results._find(f"{self._path}/outline_{side}") for side in ("first", "second"))
        return Outline(*(np.zeros((0, 3)) if table is None else np.asarray(table[:]) for table in found))

    def _said(self, name: str) -> str:
        return str(self._results._source.attributes(self._path).get(name, ""))


class EnergyResults:
    """Energies (n,), J."""

    def __init__(self, results: Results) -> None:
        self._results = results

    @property
    def kinetic(self) -> Array:
        """Kinetic energy."""
        return self._results._array("energy/kinetic")

    @property
    def strain(self) -> Array:
        """Elastic energy of bodies and springs."""
        return self._results._array("energy/strain")

    @property
    def gravity(self) -> Array:
        """Potential energy of gravity."""
        return self._results._array("energy/gravity")

    @property
    def dissipated(self) -> Array:
        """Energy dissipated since the start."""
        return self._results._array("energy/dissipated")

    @property
    def work(self) -> Array:
        """Work of drivers and loads since the start."""
        return self._results._array("energy/work")

    @property
    def balance(self) -> Array:
        """kinetic + strain + gravity + dissipated − work, less its first value: zero but for the method's error."""
        kinetic, strain, gravity, dissipated, work = (self._results._array(f"energy/{name}") for name in ENERGIES)
        total = kinetic + strain + gravity + dissipated - work
        return total - total[:1]


class ResidualResults:
    """Largest residuals of the liaisons (n,), scaled by the mechanism's size and speed."""

    def __init__(self, results: Results) -> None:
        self._results = results

    @property
    def position(self) -> Array:
        """At position level."""
        return self._results._array("residuals/position")

    @property
    def velocity(self) -> Array:
        """At velocity level."""
        return self._results._array("residuals/velocity")

    @property
    def acceleration(self) -> Array:
        """At acceleration level."""
        return self._results._array("residuals/acceleration")


def _known(name: str, names: tuple[str, ...], what: str, where: str) -> str:
    if name in names:
        return name
    near = difflib.get_close_matches(name, names, 1)
    remedy = f"did you mean {near[0]}?" if near else f"there are: {', '.join(names) or 'none'}"
    raise ModelError(f"{where} has no {what} named {name!r}", remedy=remedy)

"""The result file's contract as data: which tables there are, their paths, shapes, units and meaning.

Writers (file, memory), readers and exports all go by the columns listed here, so that the contract
stands in one place. Paths are those of an HDF5 file without the leading slash.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from maggi import __version__
from maggi.analyses.recorder import BodyLayout, Layout
from maggi.model.errors import ModelError

FORMAT = "maggi results"
FORMAT_VERSION = 1
ENERGIES = ("kinetic", "strain", "gravity", "dissipated", "work")
RESIDUALS = ("position", "velocity", "acceleration")
AXES = ("x", "y", "z")

# Unit and description of the motion of a frame, by field of `Rows`.
_FRAME_FIELDS = {
    "position": ("position", (3,), "m", "position of the attachment, global components"),
    "rotation": ("attachment_rotation", (3, 3), "1", "rotation matrix of the attachment, its axes to global"),
    "velocity": ("velocity", (3,), "m/s", "velocity of the attachment, global components"),
    "angular_velocity": ("angular_velocity", (3,), "rad/s", "angular velocity of the attachment, global components"),
}
_ENERGY_TEXT = {
    "kinetic": "kinetic energy",
    "strain": "elastic energy of bodies and springs",
    "gravity": "potential energy of gravity",
    "dissipated": "energy dissipated so far, integrated from damping forces and velocities",
    "work": "work of drivers and loads so far, integrated from forces and velocities",
}


@dataclass(frozen=True)
class Column:
    """One time-dependent table of the results: where it is, and where in `Rows` it comes from.

    path : in the result file; the table is (n, *shape), n rows in time.
    field, part : the field of `Rows` and, where the field is a tuple of arrays, the place in it.
    index : the place along the field's first axis that this column takes; None takes everything.
    """

    path: str
    field: str
    part: int | None
    index: int | None
    shape: tuple[int, ...]
    unit: str
    description: str
    integer: bool = False

    @property
    def dtype(self) -> type[np.float64] | type[np.int64]:
        """Type of the table's numbers."""
        return np.int64 if self.integer else np.float64

    @property
    def row_bytes(self) -> int:
        """Bytes that one row takes."""
        return 8 * int(np.prod(self.shape, dtype=np.int64))


@dataclass(frozen=True, eq=False)
class Constant:
    """A table that does not change in time, such as a mesh's nodes."""

    path: str
    values: NDArray[Any]
    unit: str
    description: str


def columns(layout: Layout, quantities: tuple[str, ...]) -> tuple[Column, ...]:
    """Every time-dependent table of a run that keeps the given `quantities` (names of `Outputs`)."""
    listed = [Column("time", "time", None, None, (), "s", "time of the rows")]
    if "bodies" in quantities:
        listed += _body_columns(layout)
    if "attachments" in quantities:
        listed += _attachment_columns(layout)
    if "displacement" in quantities:
        listed += _shape_columns(layout)
    if "joints" in quantities:
        listed += _joint_columns(layout)
    if "energy" in quantities:
        listed += [
            Column(f"energy/{name}", "energy", None, i, (), "J", _ENERGY_TEXT[name]) for i, name in enumerate(ENERGIES)
        ]
    if "residuals" in quantities:
        listed += [
            Column(
                f"residuals/{name}", "residuals", None, i, (), "1", f"largest liaison residual at {name} level, scaled"
            )
            for i, name in enumerate(RESIDUALS)
        ]
    text = "back-substitutions or Newton iterations of the last step"
    listed.append(Column("solver/iterations", "iterations", None, None, (), "1", text, integer=True))
    return tuple(listed)


def _body_columns(layout: Layout) -> Iterator[Column]:
    for i, body in enumerate(layout.bodies):
        at = f"bodies/{body.name}"
        yield Column(f"{at}/origin", "origin", None, i, (3,), "m", "origin of the body frame, global components")
        yield Column(f"{at}/rotation", "rotation", None, i, (3, 3), "1", "rotation matrix, body axes to global")


def _attachment_columns(layout: Layout) -> Iterator[Column]:
    names = [(body.name, attachment) for body in layout.bodies for attachment in body.attachments]
    for i, (body_name, attachment) in enumerate(names):
        for name, (field, shape, unit, text) in _FRAME_FIELDS.items():
            path = f"bodies/{body_name}/attachments/{attachment}/{name}"
            yield Column(path, field, None, i, shape, unit, text)


def _shape_columns(layout: Layout) -> Iterator[Column]:
    for i, body in enumerate(mesh_bodies(layout)):
        assert body.nodes is not None
        path = f"bodies/{body.name}/displacement"
        text = "nodal displacements from the undeformed mesh, body frame"
        yield Column(path, "displacement", i, None, (len(body.nodes), 3), "m", text)
    for i, body in enumerate(modal_bodies(layout)):
        path = f"bodies/{body.name}/modal"
        yield Column(path, "modal", i, None, (body.modes,), "m", "coordinates of the shape functions")


def _joint_columns(layout: Layout) -> Iterator[Column]:
    side = "exerted by first on second, global components, about the joint's point on second"
    for i, joint in enumerate(layout.joints):
        at = f"joints/{joint.name}"
        yield Column(f"{at}/position", "joint_position", None, i, (3,), "m", "the joint's point on second, global")
        yield Column(f"{at}/force", "force", None, i, (3,), "N", f"force {side}")
        yield Column(f"{at}/torque", "torque", None, i, (3,), "N m", f"torque {side}")
        text = "1: force and torque are unique; 0: joints repeat each other, these are the least that do the same"
        yield Column(f"{at}/unique", "unique", None, i, (), "1", text, integer=True)
        if joint.units:
            text = "coordinates of second relative to first, translation before rotation, zero initially"
            unit = ", ".join(dict.fromkeys(joint.units))
            yield Column(f"{at}/coordinate", "coordinate", i, None, (len(joint.units),), unit, text)


def mesh_bodies(layout: Layout) -> tuple[BodyLayout, ...]:
    """The bodies with nodal displacements, in the order of `Rows.displacement`."""
    return tuple(body for body in layout.bodies if body.kind == "mesh")


def modal_bodies(layout: Layout) -> tuple[BodyLayout, ...]:
    """The bodies with coordinates of shapes, in the order of `Rows.modal`."""
    return tuple(body for body in layout.bodies if body.kind in ("ritz", "reduced"))


def constants(layout: Layout) -> tuple[Constant, ...]:
    """Every table that does not change in time: gravity, attachments on undeformed bodies, meshes, outlines of joints."""
    listed = [Constant("gravity", np.array(layout.gravity), "m/s^2", "acceleration of gravity, global components")]
    for body in layout.bodies:
        for name, point in zip(body.attachments, body.at, strict=True):
            text = "point of the attachment on the undeformed body, body frame"
            listed.append(Constant(f"bodies/{body.name}/attachments/{name}/at", point, "m", text))
        if body.basis is not None:
            text = "nodal displacements of every coordinate, body frame: displacement = basis · modal"
            listed.append(Constant(f"bodies/{body.name}/basis", body.basis, "1", text))
        if body.nodes is None:
            continue
        at = f"bodies/{body.name}/mesh"
        listed.append(Constant(f"{at}/nodes", body.nodes, "m", "undeformed nodes, body frame"))
        for kind, cells in (body.cells or {}).items():
            text = f"{kind} cells: places of their nodes in mesh/nodes, from 0"
            listed.append(Constant(f"{at}/cells/{kind}", cells, "1", text))
    for joint in layout.joints:
        if joint.outline is None:
            continue
        for side, points in (("first", joint.outline.first), ("second", joint.outline.second)):
            if len(points):
                text = f"what is drawn of the joint on its {side} body: points of a line, that body's frame"
                listed.append(Constant(f"joints/{joint.name}/outline_{side}", points, "m", text))
    return tuple(listed)


def groups(layout: Layout) -> dict[str, dict[str, str]]:
    """Every group of bodies, attachments and joints, with what it says about itself."""
    listed: dict[str, dict[str, str]] = {}
    for body in layout.bodies:
        listed[f"bodies/{body.name}"] = {"kind": body.kind}
        listed |= {f"bodies/{body.name}/attachments/{name}": {} for name in body.attachments}
    for joint in layout.joints:
        said = {"kind": joint.kind, "first": joint.first, "second": joint.second}
        listed[f"joints/{joint.name}"] = said | {"coordinate_units": " ".join(joint.units)}
    return listed


def head(layout: Layout, quantities: tuple[str, ...], text: str) -> dict[str, str | float | int]:
    """The attributes of the whole: what made the results, when, from which model text; what the run adds stands too."""
    attributes: dict[str, str | float | int] = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "program": "maggi",
        "version": __version__,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "units": "SI, radians",
        "model": text,
    }
    attributes |= layout.attributes
    attributes["model_sha256"] = hashlib.sha256(str(attributes["model"]).encode()).hexdigest()
    return attributes | {"quantities": " ".join(quantities), "status": "running", "rows": 0}


def check_names(layout: Layout) -> None:
    """Refuse names that cannot stand in the path of a table.

    Raises
    ------
    ModelError : a body's, attachment's or joint's name is empty, a dot, or holds ``/`` or a NUL.
    """
    named = [("bodies", body.name) for body in layout.bodies] + [("joints", joint.name) for joint in layout.joints]
    named += [(f"bodies.{body.name}.attachments", name) for body in layout.bodies for name in body.attachments]
    for group, name in named:
        if not name or name == "." or "/" in name or "\0" in name:
            raise ModelError(f"name {name!r} cannot stand in a result file", path=group, remedy="choose a plain name")

"""Joints of a model, from their descriptions to attachments, frames, coordinates and rows."""

from __future__ import annotations

import math
from functools import singledispatchmethod

import numpy as np
from numpy.typing import NDArray

from maggi.liaisons.callbacks import RowFunction
from maggi.liaisons.registry import JOINTS, JointKind, row_label
from maggi.liaisons.sums import POSE
from maggi.liaisons.tables import (
    BLADE,
    CALLBACK,
    DISTANCE,
    OFFSET,
    PFAFFIAN,
    RATE_RELATION,
    RELATION,
    ROLL,
    ROLL_SPHERE,
    SURFACE,
)
from maggi.model.curves import ExpressionSurface
from maggi.model.errors import ModelError
from maggi.model.expression import expression
from maggi.model.functions import Formula, TimeFunction
from maggi.model.joints import (
    VELOCITIES,
    Cam,
    Coupler,
    Distance,
    Driver,
    End,
    Joint,
    KnifeEdge,
    Liaison,
    Pfaffian,
    PfaffianFunction,
    PfaffianRow,
    PointOnCurve,
    PointOnSurface,
    RollingDisc,
    RollingSphere,
)
from maggi.model.operations import Operation

from .body_list import BodyList
from .curve_builder import CurveBuilder, surface_data
from .frames import around, joint_frames, unit
from .liaison_list import LiaisonList, RowPlan
from .places import Places

Array = NDArray[np.float64]
FLAT = 1e-3  # rad; a disc that leans less than this against its plane lies flat


class JointBuilder:
    """Adds liaisons to the list, one description after the other."""

    def __init__(self, bodies: BodyList, places: Places, liaisons: LiaisonList) -> None:
        self._bodies = bodies
        self._places = places
        self._liaisons = liaisons
        self._curves = CurveBuilder(bodies, liaisons)

    @singledispatchmethod
    def add(self, liaison: Liaison, name: str) -> None:
        """Add a liaison of any kind. Raises ModelError naming it, the value and the remedy."""
        raise TypeError(f"no builder for {type(liaison).__name__}")

    # joints between two frames

    @add.register
    def _joint(self, joint: Joint, name: str) -> None:
        path = f"joints.{name}"
        if joint.kind not in JOINTS:
            raise ModelError(
                f"there is no joint type {joint.kind!r}", path=f"{path}.type", remedy=f"use one of {', '.join(JOINTS)}"
            )
        kind = JOINTS[joint.kind]
        first, second = self._ends(joint.first, joint.second, joint.at, path)
        frames = joint_frames(kind, joint, path)
        self.add_joint(name, kind, first, second, frames, (str(joint.first), str(joint.second)), pitch=joint.pitch)

    def add_joint(
        self,
        name: str,
        kind: JointKind,
        first: int,
        second: int,
        frames: tuple[Array, Array],
        ends: tuple[str, str],
        *,
        pitch: float | None = None,
        visible: bool = True,
    ) -> None:
        """A joint between two attachments; `frames`: its axes as columns on both, global, in the initial pose."""
        liaisons = self._liaisons
        joint = liaisons.add_ends(first, second, *frames)
        coordinates = [liaisons.add_coordinate(joint, what, axis) for what, axis in kind.coordinates]
        rows = [
            RowPlan(what, joint, k, l, (first, second), row_label(what, k, l), angular=what != OFFSET)
            for what, k, l in kind.rows
        ]
        if kind.screw:
            if pitch is None or pitch == 0.0 or not math.isfinite(pitch):
                raise ModelError(
                    f"the pitch of the screw is {pitch}",
                    path=f"joints.{name}.pitch",
                    remedy="give the displacement in one turn, not zero; a joint without pitch is a revolute",
                )
            lead = pitch / (2.0 * math.pi)
            codes = (Operation.VARIABLE, Operation.CONSTANT, Operation.VARIABLE, Operation.MULTIPLY, Operation.SUBTRACT)
            thread = TimeFunction(
                "displacement - pitch/(2*pi)*angle", tuple(map(int, codes)), (1.0, lead, 2.0, 0.0, 0.0)
            )
            rows.append(self._relation(thread, coordinates, joint, "displacement by the thread"))
        axis = {"axis": frames[0][:, 2], "axes": frames[0][:, 0], "shafts": frames[0][:, 2], "": None}[kind.placed_by]
        liaisons.add_liaison(name, kind.name, rows, coordinates, ends, second, axis, visible)

    # drivers and couplers

    @add.register
    def _driver(self, driver: Driver, name: str) -> None:
        liaisons = self._liaisons
        coordinate = liaisons.coordinate(driver.joint, driver.quantity, f"joints.{name}.joint")
        of = liaisons.entry(driver.joint)
        f = driver.function
        # −(f − q): the function first, so that its stack is no deeper than it was
        codes = (*f.codes, Operation.VARIABLE, Operation.SUBTRACT, Operation.NEGATE)
        defect = TimeFunction(f.text, tuple(map(int, codes)), (*f.values, 1.0, 0.0, 0.0))
        rates = driver.quantity == "speed"
        joint = liaisons.coordinate_joint(coordinate)
        row = self._relation(defect, [coordinate], joint, "driven speed" if rates else "driven coordinate", rates)
        liaisons.add_liaison(name, "driver", [row], [coordinate], (of.first, of.second), of.reference, of.axis)

    @add.register
    def _coupler(self, coupler: Coupler, name: str) -> None:
        liaisons, path = self._liaisons, f"joints.{name}"
        coordinates = [
            liaisons.coordinate(one.joint, one.quantity, f"{path}.joints") for one in coupler.coordinates.values()
        ]
        places = {"t": 0, **{alias: k + 1 for k, alias in enumerate(coupler.coordinates)}}
        relation = _with_places(coupler.relation, places)
        joints = [liaisons.entry(one.joint) for one in coupler.coordinates.values()]
        label = "relation of speeds" if coupler.rates else "relation of coordinates"
        row = self._relation(relation, coordinates, liaisons.coordinate_joint(coordinates[-1]), label, coupler.rates)
        names = ", ".join(joint.name for joint in joints[:-1]) or joints[-1].name
        last = joints[-1]
        liaisons.add_liaison(name, coupler.kind, [row], [], (names, last.name), last.reference, last.axis)

    def _relation(
        self, function: TimeFunction, coordinates: list[int], joint: int, label: str, rates: bool = False
    ) -> RowPlan:
        liaisons = self._liaisons
        start = liaisons.add_integers([liaisons.add_function(function), *coordinates])
        return RowPlan(
            RATE_RELATION if rates else RELATION,
            joint,
            start,
            len(coordinates),
            liaisons.coordinate_ends(coordinates),
            label,
            holonomic=not rates,
            angular=all(liaisons.is_rotation(c) for c in coordinates),
        )

    # rods, curves, surfaces, cams

    @add.register
    def _distance(self, rod: Distance, name: str) -> None:
        path = f"joints.{name}"
        first, second = (self._places.point(end, f"{path}.between") for end in (rod.first, rod.second))
        p, q = (self._bodies.attachment_position(end) for end in (first, second))
        length = float(np.linalg.norm(q - p))
        if length == 0.0:
            raise ModelError(
                "the rod's ends coincide, so it has no direction",
                path=f"{path}.between",
                remedy="move one end, or use a spherical joint",
            )
        joint = self._liaisons.add_ends(first, second, np.eye(3))
        function = self._liaisons.add_function(expression(length) if rod.length is None else rod.length)
        row = RowPlan(DISTANCE, joint, function, 0, (first, second), "distance")
        names = (str(rod.first), str(rod.second))
        self._liaisons.add_liaison(name, "distance", [row], [], names, second, (q - p) / length)

    @add.register
    def _point_on_curve(self, joint: PointOnCurve, name: str) -> None:
        path = f"joints.{name}"
        first, second = self._carrier_and_point(joint.first, joint.second, joint.at, path)
        pair = self._liaisons.add_ends(first, second, self._body_axes(first))
        rows, coordinate = self._curves.point(pair, joint.curve, path)
        names = (str(joint.first), str(joint.second))
        self._liaisons.add_liaison(name, "point-on-curve", rows, [coordinate], names, second)

    @add.register
    def _point_on_surface(self, joint: PointOnSurface, name: str) -> None:
        path = f"joints.{name}"
        first, second = self._carrier_and_point(joint.first, joint.second, joint.at, path)
        pair = self._liaisons.add_ends(first, second, self._body_axes(first))
        surface = joint.surface
        shift = [-x for x in self._bodies.attachment_point(first)]
        if isinstance(surface, ExpressionSurface):
            F = _with_places(surface.F, {"x": 0, "y": 1, "z": 2})
            function, data = self._liaisons.add_function(F), shift
        else:
            function, data = -1, [*shift, *surface_data(surface, f"{path}.surface")]
        row = RowPlan(
            SURFACE, pair, function, self._liaisons.add_data(data), (first, second), "offset from the surface"
        )
        names = (str(joint.first), str(joint.second))
        self._liaisons.add_liaison(name, "point-on-surface", [row], [], names, second)

    @add.register
    def _cam(self, cam: Cam, name: str) -> None:
        path = f"joints.{name}"
        first, second = self._carrier_and_point(cam.first, cam.second, cam.at, path)
        axis = unit(cam.axis, f"{path}.axis")
        second_frame = None if cam.face is None else around(unit(cam.face, f"{path}.face"))
        pair = self._liaisons.add_ends(first, second, self._body_axes(first), second_frame)
        row, coordinate = self._curves.cam(pair, cam, axis, path)
        names = (str(cam.first), str(cam.second))
        self._liaisons.add_liaison(name, "cam", [row], [coordinate], names, second, axis)

    # contacts without slip

    @add.register
    def _rolling_disc(self, disc: RollingDisc, name: str) -> None:
        path = f"joints.{name}"
        axis = unit(disc.axis, f"{path}.axis")
        normal = unit(disc.plane.normal, f"{path}.plane.normal")
        heading = np.cross(axis, normal)
        if np.linalg.norm(heading) < FLAT:
            raise ModelError(
                "the disc lies flat on the plane: its axis is the plane's normal",
                path=f"{path}.axis",
                remedy="turn the disc so that it touches the plane in one point",
            )
        self._roll(disc, name, ROLL, axis, normal, heading)

    @add.register
    def _rolling_sphere(self, sphere: RollingSphere, name: str) -> None:
        normal = unit(sphere.plane.normal, f"joints.{name}.plane.normal")
        self._roll(sphere, name, ROLL_SPHERE, normal, normal, around(normal)[:, 0])

    def _roll(
        self, roll: RollingDisc | RollingSphere, name: str, kind: int, axis: Array, normal: Array, heading: Array
    ) -> None:
        path = f"joints.{name}"
        if not (roll.radius > 0.0 and math.isfinite(roll.radius)):
            raise ModelError(f"the radius is {roll.radius} m", path=f"{path}.radius", remedy="give a positive radius")
        point = np.array(roll.plane.point, dtype=np.float64)
        second = self._center(roll.second, roll.at, path)
        first = self._places.marker(roll.first, point, f"{path}.between")
        if self._bodies.is_elastic(self._bodies.attachment_body(first)):
            point = self._bodies.attachment_position(first)
        if normal @ (self._bodies.attachment_position(second) - point) < 0.0:
            normal = -normal
        heading = heading / np.linalg.norm(heading)
        frame = np.column_stack([heading, np.cross(normal, heading), normal])
        joint = self._liaisons.add_ends(first, second, frame, around(axis))
        data = self._liaisons.add_data([roll.radius])
        ends = (first, second)
        rows = [RowPlan(kind, joint, 2, data, ends, "height above the plane")]
        rows += [
            RowPlan(kind, joint, k, data, ends, f"slip along the plane's {'xy'[k]} axis", holonomic=False)
            for k in range(2)
        ]
        kind_name = "rolling-disc" if kind == ROLL else "rolling-sphere"
        names = (str(roll.first), str(roll.second))
        self._liaisons.add_liaison(name, kind_name, rows, [], names, second, axis if kind == ROLL else normal)

    @add.register
    def _knife_edge(self, blade: KnifeEdge, name: str) -> None:
        path = f"joints.{name}"
        direction = unit(blade.direction, f"{path}.direction")
        normal = unit(blade.normal, f"{path}.normal")
        sideways = np.cross(normal, direction)
        if np.linalg.norm(sideways) < FLAT:
            raise ModelError(
                "the blade's direction is the normal of what it slides on",
                path=f"{path}.direction",
                remedy="give the permitted direction of motion, along the surface",
            )
        sideways /= np.linalg.norm(sideways)
        second = self._center(blade.second, blade.at, path)
        first = self._places.marker(blade.first, self._bodies.attachment_position(second), f"{path}.between")
        frame = np.column_stack([np.cross(sideways, normal), sideways, normal])
        joint = self._liaisons.add_ends(first, second, frame)
        row = RowPlan(BLADE, joint, 1, 0, (first, second), "sideways motion", holonomic=False)
        names = (str(blade.first), str(blade.second))
        self._liaisons.add_liaison(name, "knife-edge", [row], [], names, second, direction)

    # rows that the user writes

    @add.register
    def _pfaffian(self, pfaffian: Pfaffian, name: str) -> None:
        ends, names = self._named_ends(pfaffian, name)
        joint = self._liaisons.add_ends(ends[0], ends[-1], np.eye(3))
        places = {"t": 0}
        for k, alias in enumerate(pfaffian.ends):
            parts = ["x", "y", "z", *(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))]
            places |= {f"{alias}.{part}": 1 + POSE * k + l for l, part in enumerate(parts)}
        order = list(pfaffian.ends)
        rows = [
            self._pfaffian_row(row, joint, ends, order, places, f"row {number + 1}")
            for number, row in enumerate(pfaffian.rows)
        ]
        self._liaisons.add_liaison(name, "pfaffian", rows, [], names, ends[-1])

    def _pfaffian_row(
        self, row: PfaffianRow, joint: int, ends: tuple[int, ...], order: list[str], places: dict[str, int], label: str
    ) -> RowPlan:
        liaisons = self._liaisons
        index = [-1 if row.constant is None else liaisons.add_function(_with_places(row.constant, places))]
        for (alias, velocity), coefficient in row.coefficients.items():
            function = liaisons.add_function(_with_places(coefficient, places))
            index += [order.index(alias), VELOCITIES.index(velocity), function]
        start, terms = liaisons.add_integers(index), len(row.coefficients)
        return RowPlan(PFAFFIAN, joint, start, terms, ends, label, holonomic=False)

    @add.register
    def _pfaffian_function(self, pfaffian: PfaffianFunction, name: str) -> None:
        ends, names = self._named_ends(pfaffian, name)
        if pfaffian.rows < 1:
            raise ModelError(
                f"{pfaffian.rows} rows are asked for", path=f"joints.{name}.rows", remedy="give at least 1"
            )
        function = RowFunction(name, pfaffian.rows, len(ends), pfaffian.function)
        self._liaisons.row_functions.append(function)
        position = np.array([self._bodies.attachment_position(end) for end in ends])
        rotation = np.array([self._bodies.rotation(self._bodies.attachment_body(end)) for end in ends])
        try:
            A, b = function.rows_at(0.0, position, rotation)
        except Exception as error:  # it is the user's function: whatever it raises is told as it is
            raise ModelError(
                f"the function fails in the initial pose: {type(error).__name__}: {error}", path=f"joints.{name}"
            ) from error
        if not (np.isfinite(A).all() and np.isfinite(b).all()):
            raise ModelError("the function's rows are not finite in the initial pose", path=f"joints.{name}")
        joint = self._liaisons.add_ends(ends[0], ends[-1], np.eye(3))
        start = self._liaisons.add_integers([function.address, function.rows])
        rows = [RowPlan(CALLBACK, joint, start, k, ends, f"row {k + 1}", holonomic=False) for k in range(function.rows)]
        self._liaisons.add_liaison(name, "pfaffian", rows, [], names, ends[-1])

    # ends

    def _named_ends(self, pfaffian: Pfaffian | PfaffianFunction, name: str) -> tuple[tuple[int, ...], tuple[str, str]]:
        path = f"joints.{name}.between"
        if not pfaffian.ends:
            raise ModelError("the rows act on nothing", path=path, remedy="name at least one attachment")
        ends = tuple(self._places.point(end, path) for end in pfaffian.ends.values())
        texts = [str(end) for end in pfaffian.ends.values()]
        return ends, (", ".join(texts[:-1]) or "ground", texts[-1])

    def _ends(self, first: End, second: End, at: tuple[float, ...] | None, path: str) -> tuple[int, int]:
        """Both attachments of a joint at one place."""
        named = [end for end in (first, second) if end.attachment is not None]
        if at is None and not named:
            raise ModelError(
                "the joint has no place",
                path=path,
                remedy="give `at: [x, y, z]` or name an attachment in `between`",
            )
        positions = [self._bodies.attachment_position(self._places.attachment(end, f"{path}.between")) for end in named]
        if len(named) == 2 and at is not None:
            raise ModelError(
                f"`at` is given though both attachments are named "
                f"({np.linalg.norm(positions[1] - positions[0]):.3g} m apart)",
                path=f"{path}.at",
                remedy="leave out `at`: the attachments say where the joint is",
            )
        place = positions[0] if at is None else np.array(at, dtype=np.float64)
        self._places.extent.append(place)
        markers = [self._places.marker(end, place, f"{path}.between", at is not None) for end in (first, second)]
        return markers[0], markers[1]

    def _center(self, second: End, at: tuple[float, ...] | None, path: str) -> int:
        """The point of a contact on its second body: `at`, the named attachment, or the body's origin."""
        if at is None:
            return self._places.point(second, f"{path}.between")
        self._places.extent.append(np.array(at, dtype=np.float64))
        return self._places.marker(second, np.array(at, dtype=np.float64), f"{path}.between")

    def _carrier_and_point(self, first: End, second: End, at: tuple[float, ...] | None, path: str) -> tuple[int, int]:
        """The attachment that carries a curve or surface, and the point that stays on it."""
        if at is None and second.attachment is None:
            raise ModelError(
                "the joint has no point", path=path, remedy="give `at: [x, y, z]` or name an attachment of the second"
            )
        return self._places.point(first, f"{path}.between"), self._center(second, at, path)

    def _body_axes(self, attachment: int) -> Array:
        return self._bodies.rotation(self._bodies.attachment_body(attachment))


def _with_places(formula: Formula, places: dict[str, int]) -> TimeFunction:
    """A formula as a program whose variables are numbered as the kernels want them."""
    order = [float(places[name]) for name in formula.variables]
    values = tuple(
        order[int(value)] if code == Operation.VARIABLE else value
        for code, value in zip(formula.codes, formula.values, strict=True)
    )
    return TimeFunction(formula.text, formula.codes, values)

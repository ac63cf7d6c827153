"""Joints with their frames and coordinates and all rows of a model, collected into the liaison table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from maggi.liaisons.callbacks import RowFunction
from maggi.liaisons.tables import ROTATION, ROTATION_SECOND, TRANSLATION, LiaisonTable
from maggi.linalg.ordering import skyline_order
from maggi.model.errors import ModelError
from maggi.model.functions import Formula, TimeFunction

from .body_list import BodyList
from .packing import FunctionList, integers, numbers
from .system import LiaisonEntry

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class RowPlan:
    """A row to be: its columns in the table, the attachments that it acts on, and what it restricts."""

    kind: int
    joint: int
    first: int
    second: int
    ends: tuple[int, ...]
    label: str
    holonomic: bool = True
    angular: bool = False


class LiaisonList:
    """What the table is made of; at the end the rows in a good order."""

    def __init__(self, bodies: BodyList) -> None:
        self._bodies = bodies
        self._functions = FunctionList()
        self._ends: list[tuple[int, int]] = []
        self._frames: list[tuple[Array, Array]] = []
        self._coordinates: list[tuple[int, int, int]] = []
        self._curves: list[tuple[int, int, int, int]] = []
        self._integers: list[int] = []
        self._data: list[float] = []
        self._entries: list[LiaisonEntry] = []
        self._rows: list[list[RowPlan]] = []  # of each liaison
        self._names: dict[str, int] = {}
        self.row_functions: list[RowFunction] = []

    def add_ends(self, first: int, second: int, frame: Array, second_frame: Array | None = None) -> int:
        """A pair of attachments with axes as columns (3, 3), global, in the initial pose; returns the joint's row."""
        frames = (frame, frame if second_frame is None else second_frame)
        ends = (first, second)
        rotations = [self._bodies.rotation(self._bodies.attachment_body(end)) for end in ends]
        self._ends.append(ends)
        self._frames.append((rotations[0].T @ frames[0], rotations[1].T @ frames[1]))
        return len(self._ends) - 1

    def ends(self, joint: int) -> tuple[int, int]:
        """The attachments of a joint."""
        return self._ends[joint]

    def add_coordinate(self, joint: int, kind: int, axis: int) -> int:
        """A joint coordinate; `axis` is the curve's row for curve parameters."""
        self._coordinates.append((joint, kind, axis))
        return len(self._coordinates) - 1

    def coordinate_joint(self, coordinate: int) -> int:
        """The pair of ends that a coordinate is measured between."""
        return self._coordinates[coordinate][0]

    def coordinate_ends(self, coordinates: Sequence[int]) -> tuple[int, ...]:
        """First and second attachment of every coordinate's joint."""
        return tuple(end for c in coordinates for end in self._ends[self._coordinates[c][0]])

    def is_rotation(self, coordinate: int) -> bool:
        """Whether a coordinate is an angle."""
        return self._coordinates[coordinate][1] in (ROTATION, ROTATION_SECOND)

    def add_function(self, function: TimeFunction | Formula) -> int:
        """A function for rows; returns its number."""
        return self._functions.add(function)

    def add_integers(self, values: Sequence[int]) -> int:
        """Integers for a row; returns where they start."""
        self._integers += values
        return len(self._integers) - len(values)

    def add_data(self, values: Sequence[float]) -> int:
        """Numbers for a row; returns where they start."""
        self._data += values
        return len(self._data) - len(values)

    def add_curve(self, function: int, data: int, pieces: int, closed: bool) -> int:
        """A curve; returns its row."""
        self._curves.append((function, data, pieces, int(closed)))
        return len(self._curves) - 1

    def add_liaison(
        self,
        name: str,
        kind: str,
        rows: Sequence[RowPlan],
        coordinates: Sequence[int],
        ends: tuple[str, str],
        reference: int,
        axis: Array | None = None,
        visible: bool = True,
    ) -> None:
        """A joint, coupler or driver with its rows; `reference`: the attachment where its forces are reported."""
        self._names[name] = len(self._entries)
        self._rows.append(list(rows))
        self._entries.append(
            LiaisonEntry(
                name,
                kind,
                integers([]),
                tuple(row.label for row in rows),
                integers(list(coordinates)),
                *ends,
                reference,
                self._bodies.attachment_position(reference),
                axis,
                visible,
            )
        )

    def entry(self, name: str) -> LiaisonEntry:
        """A liaison by name, as far as it is known yet."""
        return self._entries[self._names[name]]

    def coordinate(self, joint_name: str, quantity: str | None, path: str) -> int:
        """The coordinate of a joint that ``angle``, ``displacement`` or ``speed`` (or None: the only one) means."""
        if joint_name not in self._names:
            raise ModelError(f"there is no joint {joint_name!r}", path=path, remedy="name a joint of the model")
        entry = self.entry(joint_name)
        wanted = {
            "angle": (ROTATION, ROTATION_SECOND),
            "displacement": (TRANSLATION,),
        }.get(quantity or "", (ROTATION, ROTATION_SECOND, TRANSLATION))
        found = [int(c) for c in entry.coordinates if self._coordinates[c][1] in wanted and entry.kind != "driver"]
        if entry.kind == "screw" and quantity in ("speed", None):
            found = found[1:]  # its angle: the displacement follows
        if len(found) != 1:
            raise ModelError(
                f"joint {joint_name!r} ({entry.kind}) has {len(found)} coordinates that "
                f"`{quantity or 'its coordinate'}` could mean",
                path=path,
                remedy="an angle belongs to a revolute or cylindrical joint, a displacement to a prismatic or "
                "cylindrical one",
            )
        return found[0]

    def finish(self, body_count: int, offset: IntArray) -> tuple[LiaisonTable, tuple[LiaisonEntry, ...]]:
        """The table, rows ordered so that its skyline is short, and the entries with their row numbers."""
        rows: list[tuple[RowPlan, int]] = []
        owned: dict[int, list[int]] = {owner: [] for owner in range(len(self._entries))}
        for owner in self._order():
            for row in self._rows[owner]:
                owned[owner].append(len(rows))
                rows.append((row, owner))
        entries = tuple(replace(entry, rows=integers(owned[owner])) for owner, entry in enumerate(self._entries))
        width = np.diff(offset)
        ends: list[tuple[int, int]] = []
        cursor = 0
        incidence: list[list[tuple[int, int]]] = [[] for _ in range(body_count)]
        first: list[int] = []
        earliest: dict[int, int] = {}
        for i, (row, _) in enumerate(rows):
            for attachment in row.ends:
                body = self._bodies.attachment_body(attachment)
                ends.append((attachment, cursor))
                # prescribed bodies too: the liaison forces on them are what drives them
                incidence[body].append((i, cursor))
                cursor += int(width[body])
            moving = self._moving(row)
            first.append(min([i, *(earliest.get(body, i) for body in moving)]))
            for body in moving:
                earliest.setdefault(body, i)
        function_start, codes, values = self._functions.tables()
        table = LiaisonTable(
            joint=integers(self._ends, (-1, 2)),
            frame=numbers(self._frames, (-1, 2, 3, 3)),
            coordinate=integers(self._coordinates, (-1, 3)),
            row=integers(
                [
                    (row.kind, row.joint, row.first, row.second, owner, row.holonomic, row.angular)
                    for row, owner in rows
                ],
                (-1, 7),
            ),
            end_start=_starts([len(row.ends) for row, _ in rows]),
            end=integers(ends, (-1, 2)),
            incidence_start=_starts([len(x) for x in incidence]),
            incidence=integers([pair for x in incidence for pair in x], (-1, 2)),
            skyline_first=integers(first),
            skyline_start=_starts([i - f + 1 for i, f in enumerate(first)]),
            function_start=function_start,
            function_codes=codes,
            function_values=values,
            curve=integers(self._curves, (-1, 4)),
            measured=np.arange(len(self._coordinates)),
            special=np.zeros(2, dtype=np.int64),
            integers=integers(self._integers),
            data=numbers(self._data),
        )
        return table, entries

    def _moving(self, row: RowPlan) -> set[int]:
        """The bodies that a row acts on and that have unknown velocities."""
        bodies = {self._bodies.attachment_body(end) for end in row.ends}
        return {body for body in bodies if self._bodies.moves(body)}

    def _order(self) -> list[int]:
        """Liaisons by reverse Cuthill–McKee: neighbours, which share a moving body, stand close together."""
        count = len(self._entries)
        if count == 0:
            return []
        by_body: dict[int, list[int]] = {}
        for owner, rows in enumerate(self._rows):
            for body in sorted({body for row in rows for body in self._moving(row)}):
                by_body.setdefault(body, []).append(owner)
        pairs = [(a, b) for members in by_body.values() for a in members for b in members]
        return skyline_order(count, pairs)


def _starts(counts: Sequence[int]) -> IntArray:
    return np.concatenate([[0], np.cumsum(np.array(counts, dtype=np.int64))]).astype(np.int64)

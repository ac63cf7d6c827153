"""Joints and drivers of a model, collected into the liaison table."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import reverse_cuthill_mckee

from maggi.liaisons.registry import JOINTS, JointKind
from maggi.liaisons.tables import DRIVEN, DRIVEN_RATE, ROTATION, ROTATION_SECOND, TRANSLATION, LiaisonTable
from maggi.model.errors import ModelError
from maggi.model.functions import TimeFunction

from .body_list import BodyList
from .packing import FunctionList, integers, numbers
from .system import LiaisonEntry

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class LiaisonList:
    """Joints with their frames and coordinates, drivers on them, and at the end the rows in a good order."""

    def __init__(self, bodies: BodyList) -> None:
        self._bodies = bodies
        self._functions = FunctionList()
        self._ends: list[tuple[int, int]] = []
        self._frames: list[tuple[Array, Array]] = []
        self._kinds: list[JointKind] = []
        self._coordinates: list[tuple[int, int, int]] = []
        self._entries: list[LiaisonEntry] = []
        self._rows: list[list[tuple[int, int, int, int]]] = []  # per liaison: kind, joint, first, second
        self._names: dict[str, int] = {}

    def add_joint(
        self,
        name: str,
        kind: JointKind,
        first: int,
        second: int,
        frame: Array,
        ends: tuple[str, str],
        visible: bool = True,
    ) -> int:
        """A joint between two attachments; `frame` (3, 3): its axes as columns, global, in the initial pose."""
        bodies = self._bodies
        joint = len(self._ends)
        self._ends.append((first, second))
        self._frames.append(
            (
                bodies.rotation(bodies.attachment_body(first)).T @ frame,
                bodies.rotation(bodies.attachment_body(second)).T @ frame,
            )
        )
        self._kinds.append(kind)
        numbers_of = range(len(self._coordinates), len(self._coordinates) + len(kind.coordinates))
        self._coordinates += [(joint, what, axis) for what, axis in kind.coordinates]
        self._rows.append([(what, joint, k, l) for what, k, l in kind.rows])
        axis = {"axis": frame[:, 2], "axes": frame[:, 0], "": None}[kind.placed_by]
        self._entries.append(
            LiaisonEntry(
                name,
                kind.name,
                joint,
                integers([]),
                integers(list(numbers_of)),
                *ends,
                bodies.attachment_position(second),
                axis,
                visible,
            )
        )
        self._names[name] = joint
        return joint

    def add_driver(self, name: str, joint_name: str, quantity: str, function: TimeFunction) -> None:
        """A driver of a joint's coordinate; raises ModelError if the joint has no such coordinate, or several."""
        path = f"joints.{name}"
        coordinate = self.coordinate(joint_name, quantity, f"{path}.joint")
        joint = self._names[joint_name]
        kind = DRIVEN_RATE if quantity == "speed" else DRIVEN
        self._rows.append([(kind, joint, coordinate, self._functions.add(function))])
        of = self._entries[joint]
        self._entries.append(
            LiaisonEntry(
                name,
                "driver",
                joint,
                integers([]),
                integers([coordinate]),
                of.first,
                of.second,
                of.position,
                of.axis,
            )
        )

    def coordinate(self, joint_name: str, quantity: str, path: str) -> int:
        """The coordinate of a joint that ``angle``, ``displacement`` or ``speed`` (the only one) means."""
        if joint_name not in self._names:
            raise ModelError(f"there is no joint {joint_name!r}", path=path, remedy="name a joint of the model")
        joint = self._names[joint_name]
        wanted = {
            "angle": (ROTATION, ROTATION_SECOND),
            "displacement": (TRANSLATION,),
            "speed": (ROTATION, ROTATION_SECOND, TRANSLATION),
        }[quantity]
        found = [c for c, (j, what, _) in enumerate(self._coordinates) if j == joint and what in wanted]
        if len(found) != 1:
            kind = self._kinds[joint].name
            raise ModelError(
                f"joint {joint_name!r} ({kind}) has {len(found)} coordinates that `{quantity}` could mean",
                path=path,
                remedy="an angle drives a revolute or cylindrical joint, a displacement a prismatic or cylindrical one",
            )
        return found[0]

    def joint(self, name: str) -> int | None:
        """The row of a joint by name."""
        return self._names.get(name)

    def finish(self, body_count: int, offset: IntArray) -> tuple[LiaisonTable, tuple[LiaisonEntry, ...]]:
        """The table, rows ordered so that its skyline is short, and the entries with their row numbers."""
        order = self._order()
        rows: list[tuple[int, int, int, int, int]] = []  # kind, joint, first, second, owner
        owned: dict[int, list[int]] = {owner: [] for owner in range(len(self._entries))}
        for owner in order:
            for row in self._rows[owner]:
                owned[owner].append(len(rows))
                rows.append((*row, owner))
        entries = tuple(
            LiaisonEntry(
                e.name,
                e.kind,
                e.joint,
                integers(owned[owner]),
                e.coordinates,
                e.first,
                e.second,
                e.position,
                e.axis,
                e.visible,
            )
            for owner, e in enumerate(self._entries)
        )
        width = np.diff(offset)
        segments, cursor = [], 0
        incidence: list[list[tuple[int, int]]] = [[] for _ in range(body_count)]
        touched: list[set[int]] = []
        for i, (_, joint, *_rest) in enumerate(rows):
            pair = []
            touched.append(set())
            for attachment in self._ends[joint]:
                body = self._bodies.attachment_body(attachment)
                pair.append(cursor)
                # prescribed bodies too: the liaison forces on them are what drives them
                incidence[body].append((i, cursor))
                if self._bodies.moves(body):
                    touched[i].add(body)
                cursor += int(width[body])
            segments.append(pair)
        first = []
        earliest: dict[int, int] = {}
        for i, bodies in enumerate(touched):
            first.append(min([i, *(earliest.get(body, i) for body in bodies)]))
            for body in bodies:
                earliest.setdefault(body, i)
        start = np.concatenate([[0], np.cumsum([i - f + 1 for i, f in enumerate(first)])])
        function_start, codes, values = self._functions.tables()
        table = LiaisonTable(
            first=integers([a for a, _ in self._ends]),
            second=integers([b for _, b in self._ends]),
            first_frame=numbers([f for f, _ in self._frames], (-1, 3, 3)),
            second_frame=numbers([f for _, f in self._frames], (-1, 3, 3)),
            coordinate_joint=integers([c[0] for c in self._coordinates]),
            coordinate_kind=integers([c[1] for c in self._coordinates]),
            coordinate_axis=integers([c[2] for c in self._coordinates]),
            row_kind=integers([r[0] for r in rows]),
            row_joint=integers([r[1] for r in rows]),
            row_first=integers([r[2] for r in rows]),
            row_second=integers([r[3] for r in rows]),
            row_owner=integers([r[4] for r in rows]),
            holonomic=integers([r[0] != DRIVEN_RATE for r in rows]),
            segment=integers(segments, (-1, 2)),
            incidence_start=integers(np.concatenate([[0], np.cumsum([len(x) for x in incidence])]).tolist()),
            incidence_row=integers([i for x in incidence for i, _ in x]),
            incidence_segment=integers([s for x in incidence for _, s in x]),
            skyline_first=integers(first),
            skyline_start=integers(start.tolist()),
            function_start=function_start,
            function_codes=codes,
            function_values=values,
        )
        return table, entries

    def _order(self) -> list[int]:
        """Liaisons by reverse Cuthill–McKee: neighbours, which share a moving body, stand close together."""
        count = len(self._entries)
        if count == 0:
            return []
        by_body: dict[int, list[int]] = {}
        for owner, entry in enumerate(self._entries):
            for attachment in self._ends[entry.joint]:
                body = self._bodies.attachment_body(attachment)
                if self._bodies.moves(body):
                    by_body.setdefault(body, []).append(owner)
        pairs = [(a, b) for members in by_body.values() for a in members for b in members]
        graph = sp.coo_matrix(
            (np.ones(len(pairs)), ([a for a, _ in pairs], [b for _, b in pairs])), shape=(count, count)
        )
        return [int(i) for i in reverse_cuthill_mckee(graph.tocsr(), symmetric_mode=True)]


def joint_kind(name: str, path: str) -> JointKind:
    """A kind of joint by its model-file name; raises ModelError listing the names there are."""
    if name not in JOINTS:
        raise ModelError(f"there is no joint type {name!r}", path=path, remedy=f"use one of {', '.join(JOINTS)}")
    return JOINTS[name]

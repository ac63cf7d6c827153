"""Rows on their way to a store: copied as they come, handed on in blocks, and never with a NaN."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from maggi.analyses.recorder import Layout, Rows
from maggi.model.errors import SimulationError

from .contract import Column

MOST_ROWS = 4096
# Of memory: what many small rows may take, since handing them on costs something for each of hundreds of columns, and
# what few large ones may.
MOST_BYTES, BYTES_OF_LARGE, LARGE_ROW = 32 << 20, 8 << 20, 64 << 10

_WHOLE = (
    "time", "origin", "rotation", "position", "attachment_rotation", "velocity", "angular_velocity",
    "joint_position", "force", "torque", "unique", "energy", "residuals", "iterations",
)  # fmt: skip
_INTEGERS = ("unique", "iterations")
_PARTS = ("displacement", "modal", "coordinate")


class RowBuffer:
    """Collects rows and gives them back as one array per column.

    Rows are copied, so that a run may reuse its arrays. Copying goes by the fields of `Rows`: a dozen
    arrays however many bodies there are.

    Parameters
    ----------
    layout : shape of every row.
    columns : the columns to keep; fields that no column needs are not copied.
    """

    def __init__(self, layout: Layout, columns: tuple[Column, ...]) -> None:
        self._columns = columns
        self._count = 0
        row_bytes = sum(column.row_bytes for column in columns)
        most_bytes = MOST_BYTES if row_bytes < LARGE_ROW else BYTES_OF_LARGE
        self.capacity = max(1, min(MOST_ROWS, layout.rows, most_bytes // row_bytes))
        shapes = _field_shapes(layout)
        used = {(column.field, column.part) for column in columns}
        self._whole: dict[str, NDArray[Any]] = {
            name: np.empty((self.capacity, *shapes[name]), np.int64 if name in _INTEGERS else np.float64)
            for name in _WHOLE
            if (name, None) in used
        }
        self._parts: dict[tuple[str, int], NDArray[np.float64]] = {
            (column.field, column.part): np.empty((self.capacity, *column.shape))
            for column in columns
            if column.part is not None
        }

    @property
    def full(self) -> bool:
        """Whether the rows must be taken before another one is appended."""
        return self._count == self.capacity

    def __len__(self) -> int:
        return self._count

    def append(self, rows: Rows, first: int) -> int:
        """Copy rows from the `first` on, as many as there is room for; how many that were."""
        start = self._count
        count = min(self.capacity - start, len(rows.time) - first)
        here, there = slice(start, start + count), slice(first, first + count)
        for name, array in self._whole.items():
            array[here] = getattr(rows, name)[there]
        for (name, part), array in self._parts.items():
            array[here] = getattr(rows, name)[part][there]
        self._count = start + count
        return count

    def blocks(self) -> list[tuple[Column, NDArray[Any]]]:
        """Every column with its (count, *shape) values; views, valid until `clear`."""
        return [(column, self._values(column)) for column in self._columns]

    def clear(self) -> None:
        """Forget the rows."""
        self._count = 0

    def drop_from_first_nan(self) -> SimulationError | None:
        """Cut the rows off before the first that holds a number that is not finite; says which, or None."""
        worst: tuple[int, Column] | None = None
        for column, values in self.blocks():
            finite = np.isfinite(values)
            if finite.all():
                continue
            first = int(np.argmin(finite.reshape(self._count, -1).all(axis=1)))
            if worst is None or first < worst[0]:
                worst = first, column
        if worst is None:
            return None
        first, column = worst
        time = float(self._whole["time"][first])
        self._count = first
        return SimulationError(
            f"{column.path} is no longer a finite number at t = {time:.6g} s; nothing from there on is kept. "
            "Try a smaller simulation.step"
        )

    def _values(self, column: Column) -> NDArray[Any]:
        if column.part is not None:
            return self._parts[column.field, column.part][: self._count]
        values = self._whole[column.field][: self._count]
        return values if column.index is None else values[:, column.index]


def _field_shapes(layout: Layout) -> dict[str, tuple[int, ...]]:
    bodies = len(layout.bodies)
    attachments = sum(len(body.attachments) for body in layout.bodies)
    joints = len(layout.joints)
    return {
        "time": (),
        "origin": (bodies, 3),
        "rotation": (bodies, 3, 3),
        "position": (attachments, 3),
        "attachment_rotation": (attachments, 3, 3),
        "velocity": (attachments, 3),
        "angular_velocity": (attachments, 3),
        "joint_position": (joints, 3),
        "force": (joints, 3),
        "torque": (joints, 3),
        "unique": (joints,),
        "energy": (5,),
        "residuals": (3,),
        "iterations": (),
    }

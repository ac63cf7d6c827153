"""A run kept in memory, for the Python interface."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from maggi.analyses.recorder import Layout, Rows
from maggi.model.errors import ModelError
from maggi.model.simulation import QUANTITIES

from .buffer import RowBuffer
from .contract import Column, check_names, columns, constants, groups, head
from .results import Results
from .source import Table


class MemoryRecorder:
    """Keeps a run in arrays; `results` gives them with the interface that a result file has.

    Parameters
    ----------
    quantities : what to keep (names of `Outputs.quantities`).
    text : the model file's text, where there is one.

    Raises
    ------
    ModelError : by `begin`, if the rows do not fit in memory.
    SimulationError : by `write` and `end`, if a row holds a NaN; rows before it are kept.
    """

    def __init__(self, quantities: tuple[str, ...] = QUANTITIES, text: str = "") -> None:
        self._quantities = quantities
        self._text = text
        self._source: MemorySource | None = None
        self._columns: tuple[Column, ...] = ()
        self._buffer: RowBuffer | None = None

    def begin(self, layout: Layout) -> None:
        """Make the arrays."""
        check_names(layout)
        self._columns = columns(layout, self._quantities)
        needed = layout.rows * sum(column.row_bytes for column in self._columns)
        try:
            self._source = MemorySource(layout, self._columns, head(layout, self._quantities, self._text))
        except (MemoryError, ValueError) as error:
            raise ModelError(
                f"the results would take {needed / 1e9:.3g} GB of memory",
                path="outputs",
                remedy="write them to a file, raise outputs.every, or leave displacement out of outputs.quantities",
            ) from error
        self._buffer = RowBuffer(layout, self._columns)

    def write(self, rows: Rows) -> None:
        """Keep rows."""
        assert self._buffer is not None, "begin() comes first"
        taken = 0
        while taken < len(rows.time):
            taken += self._buffer.append(rows, taken)
            if self._buffer.full:
                self._commit()

    def end(self, status: str) -> None:
        """Take over the rows still waiting and note the status."""
        if self._source is None:
            return
        self._source.attributes("")["status"] = status
        self._commit()

    def results(self) -> Results:
        """The rows kept so far."""
        if self._source is None:
            raise ModelError("there are no results yet", remedy="run the model first")
        self._commit()
        return Results(self._source)

    def _commit(self) -> None:
        assert self._source is not None and self._buffer is not None
        not_finite = self._buffer.drop_from_first_nan()
        self._source.extend(self._buffer)
        self._buffer.clear()
        if not_finite is not None:
            self._source.attributes("")["status"] = f"failed: {not_finite}"
            raise not_finite


class MemorySource:
    """Arrays as a `results.Source`."""

    def __init__(self, layout: Layout, kept: tuple[Column, ...], attributes: dict[str, str | float | int]) -> None:
        self.name = "memory"
        self.rows = 0
        self._tables: dict[str, NDArray[Any]] = {
            column.path: np.empty((layout.rows, *column.shape), column.dtype) for column in kept
        }
        self._tables |= {constant.path: constant.values for constant in constants(layout)}
        self._children: dict[str, tuple[str, ...]] = {
            "bodies": tuple(body.name for body in layout.bodies),
            "joints": tuple(joint.name for joint in layout.joints),
        }
        self._attributes: dict[str, dict[str, Any]] = {"": {**attributes}, **groups(layout)}
        for body in layout.bodies:
            self._children[f"bodies/{body.name}/attachments"] = body.attachments
            self._children[f"bodies/{body.name}/mesh/cells"] = tuple(body.cells or ())

    def extend(self, buffer: RowBuffer) -> None:
        """Append the buffer's rows."""
        end = self.rows + len(buffer)
        for column, values in buffer.blocks():
            self._tables[column.path][self.rows : end] = values
        self.rows = end
        self._attributes[""]["rows"] = end

    def attributes(self, path: str) -> dict[str, Any]:
        """Attributes of a group; the empty path is the whole."""
        return self._attributes.get(path, {})

    def children(self, path: str) -> tuple[str, ...]:
        """Names in a group, in the order of the model."""
        return self._children.get(path, ())

    def table(self, path: str) -> Table | None:
        """A table, or None if it was not kept."""
        return self._tables.get(path)

    def close(self) -> None:
        """Nothing to close."""

"""Nodal displacements of a reduced body, which are not kept: they follow from the coordinates of its shapes."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .source import Table

Array = NDArray[np.float64]


class Recovered:
    """A table of displacements (n, nodes, 3) whose rows are computed when they are read: basis · modal.

    Parameters
    ----------
    modal : table (n, modes), m. basis : table (nodes, 3, modes), read whole at the first use.
    """

    def __init__(self, modal: Table, basis: Table) -> None:
        self._modal = modal
        self._table = basis
        self.shape = (modal.shape[0], *basis.shape[:2])

    def __getitem__(self, key: Any, /) -> Array:
        modal = np.asarray(self._modal[key])
        fields = modal @ self._basis.T
        return np.asarray(fields.reshape(*modal.shape[:-1], *self.shape[1:]))

    @cached_property
    def _basis(self) -> Array:
        """(3 · nodes, modes)."""
        return np.asarray(self._table[:]).reshape(-1, self._modal.shape[1])

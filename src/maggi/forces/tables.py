"""Gravity, springs and loads as flat arrays: what the compiled kernels read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.table import Table

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ForceTable(Table):
    """Constants of all forces. s springs, q torsion springs, l loads.

    gravity (3,). spring_ends (s, 2): attachments; spring_data (s, 3): stiffness, damping, free length.
    torsion_coordinate (q,): joint coordinate; torsion_data (q, 3): stiffness, damping, free angle.
    load_attachment (l,); load_kind (l, 2): 0 force or 1 torque, 0 global or 1 body axes;
    function_start (3 l + 1,), function_codes, function_values: three functions of time for each load.
    """

    gravity: Array
    spring_ends: IntArray
    spring_data: Array
    torsion_coordinate: IntArray
    torsion_data: Array
    load_attachment: IntArray
    load_kind: IntArray
    function_start: IntArray
    function_codes: IntArray
    function_values: Array

    @property
    def empty(self) -> bool:
        """Whether there is nothing but gravity."""
        return self.spring_ends.size + self.torsion_coordinate.size + self.load_attachment.size == 0

"""A chart of the mechanism's positions and a basis of its velocities, as the flat arrays that the kernels read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from maggi.bodies.tables import Array, IntArray, MotionState
from maggi.linalg.table import Table


@dataclass(frozen=True, eq=False)
class ChartTable(Table):
    """Constants of a chart. n small coordinates, u unknown velocities (prescribed frames left out), r rows.

    unknown (u,): which small coordinates they are; slot (n,): the reverse, −1 for prescribed ones.
    scale (u,): the size of one unit of each velocity.
    row_scale (r,): one over the size of a row at the base; mass (u,): the inertia that would be usual of a velocity.
    Positions, of the holonomic rows: x = E_s s + N_s z with P_s x = s; rows_s: a maximal independent set of them.
    Velocities, of all rows: v = E ν + N z with P v = ν; rows likewise. s has p, ν has f components, p ≥ f.
    length: m, what position corrections are compared with.
    """

    unknown: IntArray
    slot: IntArray
    scale: Array
    row_scale: Array
    mass: Array
    P_s: Array
    E_s: Array
    N_s: Array
    rows_s: IntArray
    P: Array
    E: Array
    N: Array
    rows: IntArray
    length: float


@dataclass(frozen=True, eq=False)
class ChartState(Table):
    """What an evaluation leaves behind. x (n,): coordinates of the present state in the chart; turns (b, 3, 3): exp(θ̃) of the frames from the base.

    S_s (u, p), drift (u,): dependent coordinates' answer to s and t, by which the next evaluation is predicted; at (1,)
    the time and s (p,) that they belong to.
    A (r, u), b, gamma (r,): rows (T7), with the motion of prescribed frames in b and γ. S (u, f), a_p (u,): T8, T9.
    vd (u,): v̇. loads (n,): Q; forces (u,): Q − h. residual (u,): Q − h − M v̇ = Aᵀλ (T11). multipliers (r,): λ, zero for the rows left
    out as dependent. power (4,): energy stored in springs (J), power of dampers, of loads, and of drivers and
    prescribed frames (W).
    massless (2,): the number of freedoms without inertia, and the largest force on one over the largest of all.
    pivots (2,): the smallest pivot of the dependent directions at position and at velocity level; generic (2,): in general
    position.
    """

    x: Array
    turns: Array
    S_s: Array
    drift: Array
    at: Array
    s: Array
    A: Array
    b: Array
    gamma: Array
    S: Array
    a_p: Array
    v: Array
    vd: Array
    loads: Array
    forces: Array
    residual: Array
    multipliers: Array
    power: Array
    massless: Array
    pivots: Array
    generic: Array
    motion: MotionState

    def smooth(self) -> list[Array]:
        """What varies smoothly with the state: all arrays but those about the pivots."""
        return [
            value
            for value in self
            if isinstance(value, np.ndarray) and value is not self.pivots and value is not self.generic
        ]

"""Charts: all positions near a base state in as many numbers s as there are free positions (Theory §4).

The tangent-space local parametrisation: ``q(s, t) = q₀ ∘ (E_s s + N_s z)`` with the dependent z solved from Φ = 0.
Together with the independent velocities ν it makes the mechanism's state a vector y = (s, ν) of the true freedoms.
Of nonholonomic mechanisms s is longer than ν.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.attachment_kernels import attachment_motion
from maggi.bodies.motions import prescribe
from maggi.bodies.tables import FIXED, RITZ, AttachmentState, MotionState
from maggi.liaisons.kernels import evaluate_rows
from maggi.liaisons.tables import LiaisonState
from maggi.system.dense import new_attachments, new_rows, velocity_scale
from maggi.system.system import System

from . import chart_kernels as kernels
from .chart_tables import ChartState, ChartTable
from .splitting import Splitting
from .tangent import displace

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


MOST_PARTS = 27  # that the way from one state to the next is divided into
SINGULAR_ZONE = 0.02  # of the general size of the smallest pivot; the equations' round-off grows as its inverse cube
ACROSS_STEP = 0.06  # rad, or sizes, between the states that are interpolated
ACROSS = (4 / 5, -2 / 5, 4 / 35, -1 / 70)
"""Weights of the interpolation of a function at 0 from its values at ±1, ±2, ±3, ±4."""


@dataclass(frozen=True, eq=False)
class Chart:
    """A base state at time t and the splittings that are kept while this chart is used.

    coordinates (c,): the joints' at the base, from which they are unwrapped.
    """

    base: MotionState
    t: float
    coordinates: Array
    positions: Splitting
    velocities: Splitting
    table: ChartTable

    @property
    def position_count(self) -> int:
        """Number of s."""
        return self.positions.freedoms

    @property
    def velocity_count(self) -> int:
        """Number of ν: the freedoms."""
        return self.velocities.freedoms


def unknown_velocities(system: System) -> IntArray:
    """Which small coordinates are unknown: all but the twists of prescribed frames (u,)."""
    bodies = system.bodies
    parts = [
        np.arange(bodies.offset[b] + (0 if bodies.floating[b] else 6), bodies.offset[b + 1])
        for b in range(bodies.kind.size)
        if bodies.kind[b] != FIXED
    ]
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])


def make_chart(
    system: System,
    motion: MotionState,
    t: float,
    coordinates: Array,
    A: Array,
    positions: Splitting,
    velocities: Splitting,
) -> Chart:
    """A chart about a state whose rows on the unknown velocities are A (r, u)."""
    unknown = unknown_velocities(system)
    slot = np.full(system.coordinates, -1)
    slot[unknown] = np.arange(len(unknown))
    size = np.linalg.norm(A / velocity_scale(system)[unknown], axis=1)
    # a row that vanishes at a singular position is as large as others elsewhere
    size = np.where(size > 1e-6 * size.max(initial=0.0), size, max(float(size.max(initial=0.0)), 1e-300))
    holonomic = np.flatnonzero(system.holonomic)
    table = ChartTable(
        unknown=unknown,
        slot=slot,
        scale=positions.scale,
        row_scale=1.0 / size,
        mass=_usual_inertia(system)[unknown],
        P_s=_flat(positions.P),
        E_s=_flat(positions.E),
        N_s=_flat(positions.N),
        rows_s=holonomic[positions.rows],
        P=_flat(velocities.P),
        E=_flat(velocities.E),
        N=_flat(velocities.N),
        rows=velocities.rows,
        length=system.size,
    )
    base = MotionState(*(part.copy() for part in motion))
    return Chart(base, t, coordinates.copy(), positions, velocities, table)


class ChartEvaluation:
    """The equations on one chart: ṡ, ν̇ and everything else of the state evaluated last.

    At a singular position the rows lose rank and the equations become 0/0 there, but along the branch on which the
    mechanism moves they have a limit. Close to one, positions, velocities, S and all that follows are interpolated
    between states before and after it on the same path (error of order eight in their distance).

    generic (2,): smallest pivots at position and velocity level in general position; default: those at the base.
    """

    def __init__(self, system: System, chart: Chart, generic: Array | None = None) -> None:
        n, r, u = system.coordinates, system.rows, len(chart.table.unknown)
        p, f = chart.position_count, chart.velocity_count
        self.system = system
        self.chart = chart
        self.attachments: AttachmentState = new_attachments(system.bodies.attachment_body.size)
        self.rows: LiaisonState = new_rows(system)
        self.rows.previous[:] = chart.coordinates
        self.state = ChartState(
            x=np.zeros(n),
            turns=np.zeros((system.bodies.kind.size, 3, 3)),
            S_s=chart.table.E_s.copy(),
            drift=np.zeros(u),
            at=np.array([chart.t]),
            s=np.zeros(p),
            A=np.zeros((r, u)),
            b=np.zeros(r),
            gamma=np.zeros(r),
            S=np.zeros((u, f)),
            a_p=np.zeros(u),
            v=np.zeros(u),
            vd=np.zeros(u),
            loads=np.zeros(n),
            forces=np.zeros(u),
            residual=np.zeros(u),
            multipliers=np.zeros(r),
            power=np.zeros(4),
            massless=np.zeros(2),
            pivots=np.full(2, np.inf),
            generic=np.ones(2),
            motion=MotionState(*(part.copy() for part in chart.base)),
        )
        self._direction = np.zeros(1 + p)
        self._evaluate(chart.t, np.zeros(p), np.zeros(f))
        self._base_sizes = self._sizes()
        self.state.generic[:] = np.where(np.isfinite(self.state.pivots), self.state.pivots, 1.0)
        if generic is not None:
            self.state.generic[:] = np.maximum(self.state.generic, generic)
        self.settle()

    def rates(self, t: float, s: Array, nu: Array) -> tuple[int, Array, Array]:
        """Whether it went well (`chart_kernels.DONE`), ṡ (p,), ν̇ (f,)."""
        result = self._anywhere(t, s, nu)
        if result[0] != kernels.DONE:
            self._return()
            result = self._anywhere(t, s, nu)
        return result

    def settle(self) -> None:
        """Remember the state evaluated last: one on the motion, to which evaluations that fail return."""
        self._home = [part.copy() for part in self._memory()]

    def _return(self) -> None:
        for part, kept in zip(self._memory(), self._home, strict=True):
            part[:] = kept

    def _memory(self) -> tuple[Array, ...]:
        """What the next evaluation starts from."""
        state = self.state
        return state.x, state.S_s, state.drift, state.at, state.s, state.pivots, self.rows.previous, self._direction

    def _anywhere(self, t: float, s: Array, nu: Array) -> tuple[int, Array, Array]:
        """The equations, also close to singular positions."""
        reason, sd, nud = self._reach(t, s, nu)
        if self.pivots() < SINGULAR_ZONE:
            return self._across(t, s, nu)
        if reason == kernels.DONE:
            self._direction[0] = 1.0
            self._direction[1:] = sd
        return reason, sd, nud

    def _across(self, t: float, s: Array, nu: Array) -> tuple[int, Array, Array]:
        """The same close to a singular position, from states before and after it on the path of the last evaluation."""
        system, state, motion = self.system, self.state, self.state.motion
        direction = self._direction / self._pace()
        sd, nud = np.zeros_like(s), np.zeros_like(nu)
        smooth = state.smooth()
        sums = [np.zeros_like(part) for part in smooth]
        # from the side on which the last evaluation was, so that only the step over the singular position is long
        ahead = (state.at[0] - t) * direction[0] + (state.s - s) @ direction[1:] > 0.0
        for k in (4, 3, 2, 1, -1, -2, -3, -4) if ahead else (-4, -3, -2, -1, 1, 2, 3, 4):
            step = k * ACROSS_STEP * direction
            reason, one, two = self._reach(t + step[0], s + step[1:], nu)
            if reason != kernels.DONE or self.pivots() < 0.5 * SINGULAR_ZONE:
                return kernels.SINGULAR, sd, nud
            weight = ACROSS[abs(k) - 1]
            sd += weight * one
            nud += weight * two
            for part, total in zip(smooth, sums, strict=True):
                total += weight * part
        for part, total in zip(smooth, sums, strict=True):
            part[:] = total
        prescribe(system.motions, system.bodies, t, motion)
        displace(system.bodies, self.chart.base, state.x, state.turns, motion)
        motion.v[self.chart.table.unknown] = state.v
        motion.vd[self.chart.table.unknown] = state.vd
        attachment_motion(system.bodies, motion, self.attachments)
        evaluate_rows(system.liaisons, system.bodies, motion, self.attachments, self.rows, t)
        self.rows.previous[:] = self.rows.coordinate[:, 0]
        return kernels.DONE, sd, nud

    def _pace(self) -> float:
        """How fast the mechanism moves in the direction of the last evaluation (rad/s, or sizes a second)."""
        state, scale = self.state, self.chart.positions.scale
        rates = scale * (state.S_s @ self._direction[1:] + state.drift * self._direction[0])
        return max(float(np.abs(rates).max(initial=0.0)) / self.system.size, 1e-6)

    def _reach(self, t: float, s: Array, nu: Array) -> tuple[int, Array, Array]:
        """The compiled equations; where the state is far from the last one, by way of states between them."""
        result = self._evaluate(t, s, nu)
        parts = 1
        while result[0] in (kernels.NOT_CLOSED, kernels.TOO_FAR) and parts < MOST_PARTS:
            parts *= 3
            t0, s0 = float(self.state.at[0]), self.state.s.copy()
            for k in range(1, parts + 1):
                share = k / parts
                result = self._evaluate(t0 + share * (t - t0), s0 + share * (s - s0), nu)
                if result[0] != kernels.DONE:
                    result = (kernels.TOO_FAR if k < parts else result[0], *result[1:])
                    break
        return result

    def _evaluate(self, t: float, s: Array, nu: Array) -> tuple[int, Array, Array]:
        """The compiled equations, as they are."""
        system, state = self.system, self.state
        sd, nud = np.empty_like(s), np.empty_like(nu)
        reason = kernels.evaluate(
            system.bodies,
            system.motions,
            system.liaisons,
            system.forces,
            self.chart.base,
            self.chart.table,
            float(t),
            s,
            nu,
            self.attachments,
            self.rows,
            state,
            sd,
            nud,
        )
        if reason == kernels.DONE:
            self.rows.previous[:] = self.rows.coordinate[:, 0]
        return reason, sd, nud

    def inertia(self) -> Array:
        """SᵀMS (f, f) of the state evaluated last (T10)."""
        S = self.state.S
        MS = np.empty_like(S)
        kernels.inertia_product(self.system.bodies, self.chart.table.slot, self.state.motion, S, MS)
        return np.asarray(S.T @ MS)

    def turned(self) -> float:
        """The largest rotation (rad) of a body from the base."""
        bodies, x = self.system.bodies, self.state.x
        frames = bodies.offset[:-1][(bodies.kind != FIXED) & (bodies.floating == 1)]
        if frames.size == 0:
            return 0.0
        theta = x[frames[:, None] + np.arange(3, 6)]
        return float(np.sqrt((theta * theta).sum(axis=1).max()))

    def grown(self) -> float:
        """How many times further than at the base one of s or ν moves the mechanism, at most: 1 is as good as there."""
        return float((self._sizes() / self._base_sizes).max(initial=1.0))

    def pivots(self) -> float:
        """The smallest pivot of the dependent directions over what it is in general: 0 at a singular position."""
        return float((self.state.pivots / self.state.generic).min())

    def _sizes(self) -> Array:
        """How far, or how fast, everything moves with each of s and ν (p + f,), scaled."""
        parts = (self.state.S_s, self.chart.positions), (self.state.S, self.chart.velocities)
        return np.concatenate([np.linalg.norm(S * split.scale[:, None], axis=0) for S, split in parts])


def _usual_inertia(system: System) -> Array:
    """For every small coordinate the inertia that would be usual (n,): m, m·size², a shape's own mass."""
    bodies = system.bodies
    out = np.zeros(system.coordinates)
    for b in range(bodies.kind.size):
        if bodies.kind[b] == FIXED:
            continue
        o, e = int(bodies.offset[b]), int(bodies.offset[b + 1])
        out[o : o + 3] = bodies.mass[b]
        out[o + 3 : o + 6] = bodies.mass[b] * system.size**2
        if bodies.kind[b] == RITZ:
            m = e - o - 6
            q = int(bodies.ritz_square[b])
            out[o + 6 : e] = np.diag(bodies.m[q : q + m * m].reshape(m, m))
    return out


def _flat(matrix: Array) -> Array:
    return np.ascontiguousarray(matrix, dtype=np.float64)

"""Configurations near a pose: how to go from one to the next, and what the liaison rows are there.

The manifold is that of all frames (left-invariant coordinates on SE(3)), elastic coordinates and time, which counts as a
coordinate so that rows with b(q, t) are forms like the others: A dq + b dt. Increments x are without unit: 1 moves by
the mechanism's size, or by a time in which driven motions move about as far.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from maggi.bodies.attachment_kernels import move
from maggi.bodies.motions import prescribe
from maggi.bodies.tables import MotionState
from maggi.stepping.allocate import copy_motion
from maggi.system.dense import dense_rows, velocity_scale
from maggi.system.system import System

from .parts import unknown_velocities

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

CLOSED = 1e-11  # what |Φ| may be left with, relative to the mechanism's size
_ATTEMPTS = 30
_DEPENDENT = 1e-9  # pivots of rows of length about one, below which they count as dependent
DIFFERENCE = 2e-4  # step of differences, of the mechanism's size
_STENCIL = ((-2, 1.0 / 12.0), (-1, -8.0 / 12.0), (1, 8.0 / 12.0), (2, -1.0 / 12.0))


@dataclass(frozen=True, eq=False)
class Place:
    """A configuration at a time (s). Of its velocities only those of prescribed frames mean anything; others are zero."""

    motion: MotionState
    time: float


@dataclass(frozen=True, eq=False)
class Chart:
    """Increments x (k + 1,) of the given small coordinates (k,), and of time last, about places of a system.

    unit (k + 1,): m, rad or s for each increment of one. frames: where in x the six of each floating frame start.
    """

    system: System
    columns: IntArray
    unit: Array
    frames: tuple[int, ...]

    def moved(self, place: Place, x: Array) -> Place:
        """The place reached from another by an increment: frames on SE(3), the rest added."""
        system = self.system
        step = np.zeros(system.coordinates)
        step[self.columns] = (x * self.unit)[:-1]
        motion, time = copy_motion(place.motion), place.time + float(x[-1] * self.unit[-1])
        move(system.bodies, place.motion, step, motion)
        prescribe(system.motions, system.bodies, time, motion)
        return Place(motion, time)

    def rows(self, place: Place) -> tuple[Array, Array]:
        """All rows as forms (r, k + 1) on increments, and Φ (r,), zero where a row holds no position."""
        at = dense_rows(self.system, place.motion, place.time)
        # b for resting unknown velocities; what prescribed frames contribute is in it
        forms = np.column_stack([at.A[:, self.columns], at.velocity])
        return forms * self.unit, np.where(self.system.holonomic, at.position, 0.0)

    def bracket(self, x: Array, y: Array) -> Array:
        """[X, Y] (…, k + 1) of fields with constant components x and y (…, k + 1): the commutator of se(3), frame by frame."""
        a, b = x * self.unit, y * self.unit
        out = np.zeros(np.broadcast_shapes(x.shape, y.shape))
        linear = np.array(self.frames, dtype=np.int64)[:, None] + np.arange(3)
        v, w, p, q = a[..., linear], a[..., linear + 3], b[..., linear], b[..., linear + 3]
        out[..., linear] = np.cross(w, p) - np.cross(q, v)
        out[..., linear + 3] = np.cross(w, q)
        return out / self.unit

    def derivative(self, place: Place, x: Array, step: float = DIFFERENCE) -> Iterator[tuple[float, Place]]:
        """Weights and places whose weighted sum is the derivative along x, exact to the fourth order of `step`."""
        size = max(1.0, float(np.abs(x).max(initial=0.0)))
        h = step / size
        yield from ((weight / h, self.moved(place, k * h * x)) for k, weight in _STENCIL)

    def held(self, place: Place, rows: IntArray) -> Place | None:
        """The nearest place at the same time where Φ = 0 in the given rows (Newton, least increments), if there is one."""
        size = self.system.size
        best = np.inf
        for _ in range(_ATTEMPTS):
            forms, Phi = self.rows(place)
            if not (np.isfinite(forms[rows]).all() and np.isfinite(Phi[rows]).all()):
                return None
            worst = float(np.abs(Phi[rows]).max(initial=0.0))
            if worst <= CLOSED * size:
                return place
            if worst > 10.0 * best:
                return None
            best = min(best, worst)
            x = np.zeros(len(self.unit))
            x[:-1] = np.linalg.lstsq(forms[rows, :-1], -Phi[rows], rcond=_DEPENDENT)[0]
            place = self.moved(place, x)
        return None

    def nearby(self, place: Place, rows: IntArray, rng: np.random.Generator, reach: float) -> Place | None:
        """A random place about `reach` away that holds the given rows' positions; None where none was found."""
        for shorter in (1.0, 0.25, 0.05):
            forms, _ = self.rows(place)
            if not np.isfinite(forms[rows]).all():
                return None
            free = kernel(forms[rows])
            x = free @ rng.normal(size=free.shape[1])
            # functions of time need have no values before t = 0
            x[-1] = abs(x[-1]) if self.unit[-1] > 0.0 else 0.0
            length = float(np.linalg.norm(x))
            found = self.held(self.moved(place, x * (shorter * reach / length if length > 0.0 else 0.0)), rows)
            if found is not None:
                return found
        return None

    def admitted(self, place: Place, rows: IntArray) -> int:
        """How many independent velocities the given rows admit at one time."""
        return int(kernel(self.rows(place)[0][rows, :-1]).shape[1])

    def distance(self, a: Place, b: Place) -> float:
        """How far apart two places are: of the mechanism's size, angles counted by it."""
        away = np.linalg.norm(a.motion.origin - b.motion.origin) / self.system.size
        turned = np.linalg.norm(a.motion.rotation - b.motion.rotation) / np.sqrt(2.0)
        return float(np.hypot(away, turned))


def chart(system: System, columns: IntArray, place: Place, *, time: bool = True) -> Chart:
    """Increments of some small coordinates and of time, in a unit in which rows that depend on time do so gently.

    time : whether it passes; otherwise its unit is zero.
    """
    unit = np.append(system.size / velocity_scale(system)[columns], 1.0)
    offset, bodies = system.bodies.offset, system.bodies
    starts = [int(offset[b]) for b in range(bodies.kind.size) if bodies.floating[b] == 1]
    at = {int(c): k for k, c in enumerate(columns)}
    made = Chart(system, columns, unit, tuple(at[start] for start in starts if start in at))
    return _with_time_unit(made, place) if time else replace(made, unit=np.append(unit[:-1], 0.0))


def _with_time_unit(given: Chart, place: Place) -> Chart:
    simulation = given.system.model.simulation
    forms, _ = given.rows(place)
    width = np.linalg.norm(forms[:, :-1], axis=1)
    speeds = np.abs(forms[width > 0.0, -1]) / width[width > 0.0]
    speed = float(speeds[np.isfinite(speeds)].max(initial=0.0))
    longest = 1.0 if simulation is None else simulation.duration
    unit = given.unit.copy()
    unit[-1] = min(longest, 1.0 / speed) if speed > 0.0 else longest
    along_time = np.zeros(len(unit))
    along_time[-1] = 1.0
    for _ in range(12):
        made = replace(given, unit=unit.copy())
        later = made.moved(place, 0.1 * along_time)
        # the places of one stencil: differences of second and of fourth order must agree
        values = [made.rows(there)[0] for _, there in made.derivative(later, along_time)]
        if not all(np.isfinite(value).all() for value in values):
            return made
        fourth = sum(weight * value for (_, weight), value in zip(_STENCIL, values, strict=True)) / DIFFERENCE
        second = (values[2] - values[1]) / (2.0 * DIFFERENCE)
        if np.abs(fourth - second).max(initial=0.0) <= 1e-6 * max(1.0, np.abs(fourth).max(initial=0.0)):
            return made
        unit[-1] *= 0.25
    return made


def at_rest(system: System, motion: MotionState, time: float = 0.0) -> Place:
    """The configuration of a motion: its unknown velocities are zero, those of prescribed frames stay."""
    resting = copy_motion(motion)
    resting.v[unknown_velocities(system)] = 0.0
    return Place(resting, time)


def kernel(forms: Array, lengths: Array | None = None) -> Array:
    """An orthonormal basis (k, d) of the increments on which all the forms (r, k) vanish.

    lengths (r,) : beside which a form counts as dependent on others or as zero; by default their own.
    """
    size = np.linalg.norm(forms, axis=1) if lengths is None else lengths
    used = forms[size > 0.0] / size[size > 0.0, None]
    if not len(used):
        return np.eye(forms.shape[1])
    Q, R, _ = qr(used.T, pivoting=True)
    return np.asarray(Q[:, int(np.sum(np.abs(np.diag(R)) > _DEPENDENT)) :])

"""Whether rows without a position are nonholonomic: Frobenius' test, and the positions that can be reached.

Rows A dq + b dt = 0 are forms α_i on the manifold of frames, elastic coordinates and time. They integrate to relations of
positions if and only if every bracket of admissible fields is admissible again, that is where

    dα_i(s_a, s_b) = (∂A_i/∂q·s_a) s_b − (∂A_i/∂q·s_b) s_a − A_i [s_a, s_b] = 0          (Frobenius)

for all admissible s_a, s_b. Twists are quasi-velocities: the last term is the commutator of se(3), without which a
body's own rotation would look like a nonholonomic liaison. γ = Ȧ v is of no use here, being the symmetric part. Rows with a
position have dα = 0 where they hold and only decide what is admissible: the test is made on Φ = 0, with time as a
coordinate, so that a driven speed integrates and ẏ = t ẋ does not.

Where brackets lead out of the admissible directions, brackets with those are added until nothing new comes (the involutive
closure, Chow's theorem): its dimension is that of the positions that can be reached. A bracket may vanish at one pose and
not beside it, so that random nearby places that hold the liaisons are looked at too and the largest result counts.

Source: Bloch, "Nonholonomic mechanics and control", §§2.5, 2.6; the test on quasi-velocities is the paper's (A17) with
Hamel's coefficients of SE(3).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq, qr

from maggi.bodies.tables import MotionState
from maggi.liaisons.tables import ROW_OWNER
from maggi.system.system import System

from .chart import Chart, Place, at_rest, chart, kernel
from .parts import Part, parts

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Word = int | tuple[int, "Word"]
"""An admissible field by its number, or the bracket of one with a word."""

INTEGRABLE = 1e-6
"""The largest |dα|, rows and directions of length one and lengths in mechanism sizes, that still counts as zero."""
PLACES = 3  # random ones, beside the pose itself
REACH = 0.1  # how far away they are, of the mechanism's size
_NESTED = ((2e-2, 1e-2), (4e-3, 2e-3), (8e-4, 4e-4))  # pairs of steps of nested differences, of the mechanism's size
_AGREE = 0.2  # what a bracket found with the two of a pair may differ by
_NEW = 1e-5  # part of a bracket outside the directions known so far, from which on it is a new one
_LONGEST = 5  # fields in a bracket: round-off is divided by the step with each
_MOST_ROWS = 60_000  # evaluated in search of the closure


@dataclass(frozen=True)
class Integrability:
    """Rows without a position of one liaison or of all that are tied together.

    liaisons : whose rows. rows : how many of them are independent of those that hold positions.
    positions, velocities : freedoms of the part they are in, without and with these rows. reachable : the freedoms of
    position that remain, between the two; at least so many where `complete` is false.
    defect : the largest |dα|, see `INTEGRABLE`. tested : at how many places; none where the rows are not finite.
    """

    liaisons: tuple[str, ...]
    rows: int
    positions: int
    velocities: int
    reachable: int
    complete: bool
    defect: float
    tested: int

    @property
    def hidden(self) -> int:
        """Relations of positions that the rows integrate to."""
        return self.positions - self.reachable

    @property
    def integrable(self) -> bool:
        """Whether the rows are holonomic in disguise."""
        return self.reachable == self.velocities


@dataclass(frozen=True)
class PartIntegrability:
    """Each liaison with rows without a position of one part, and all of them together (the last where they are several)."""

    liaisons: tuple[Integrability, ...]
    together: Integrability


def integrability(system: System, motion: MotionState) -> tuple[PartIntegrability, ...]:
    """Frobenius' test for every liaison with rows that hold no position, and for all in each part of the mechanism."""
    found = []
    for part in parts(system):
        velocity_rows = part.rows[~system.holonomic[part.rows]]
        if velocity_rows.size:
            found.append(_of_part(system, motion, part, velocity_rows))
    return tuple(found)


def _of_part(system: System, motion: MotionState, part: Part, velocity_rows: IntArray) -> PartIntegrability:
    holding = part.rows[system.holonomic[part.rows]]
    here = at_rest(system, motion)
    around = chart(system, part.columns, here)
    rng = np.random.default_rng(0)
    places = [here, *(there for _ in range(PLACES) if (there := around.nearby(here, holding, rng, REACH)) is not None)]
    held = [one for place in places if (one := _Held.at(around, place, holding)) is not None]
    owner = system.liaisons.row[:, ROW_OWNER]
    singles = []
    for one in dict.fromkeys(owner[velocity_rows].tolist()):
        name = system.liaison_entries[one].name
        singles.append(_of_rows((name,), held, velocity_rows[owner[velocity_rows] == one]))
    if len(singles) == 1:
        return PartIntegrability(tuple(singles), singles[0])
    names = tuple(one.liaisons[0] for one in singles)
    return PartIntegrability(tuple(singles), _of_rows(names, held, velocity_rows))


def _of_rows(names: tuple[str, ...], held: Sequence[_Held], velocity_rows: IntArray) -> Integrability:
    tested = [one for place in held if (one := _Distribution.at(place, velocity_rows)) is not None]
    if not tested:
        return Integrability(names, 0, 0, 0, 0, False, 0.0, 0)
    # where brackets lead furthest the place is a general one
    best = max(tested, key=lambda one: (-one.fields.shape[1], len(one.pairs)))
    spatial = best.held.spatial
    positions = spatial.shape[1]
    forms = best.held.forms[velocity_rows]
    velocities = kernel(forms[:, :-1] @ spatial, np.linalg.norm(forms, axis=1)).shape[1]
    clock = best.fields.shape[1] - velocities  # 1: time passes along with the admissible velocities
    dimension, complete = best.closure(positions + clock)
    return Integrability(
        names,
        positions - velocities,
        positions,
        velocities,
        dimension - clock,
        complete,
        max(one.defect for one in tested),
        len(tested),
    )


@dataclass(frozen=True, eq=False)
class _Held:
    """A place with its rows as forms (r, k + 1), those that hold positions, and the increments that these admit.

    admitted (k + 1, d), and spatial (k, p) at one time: orthonormal.
    """

    chart: Chart
    place: Place
    holding: IntArray
    forms: Array
    admitted: Array
    spatial: Array

    @staticmethod
    def at(around: Chart, place: Place, holding: IntArray) -> _Held | None:
        """None where the rows are not finite."""
        forms, _ = around.rows(place)
        if not np.isfinite(forms[holding]).all():
            return None
        return _Held(around, place, holding, forms, kernel(forms[holding]), kernel(forms[holding, :-1]))


@dataclass(frozen=True, eq=False)
class _Distribution:
    """The increments that some rows without a position admit beside those that hold positions.

    rows : all that must hold, an independent set. fields (k + 1, d): orthonormal. pairs : those whose brackets lead out of
    the fields, independently; directions (k + 1, j): where to, orthonormal and at right angles to the fields.
    """

    held: _Held
    rows: IntArray
    fields: Array
    pairs: tuple[tuple[int, int], ...]
    directions: Array
    defect: float

    @staticmethod
    def at(held: _Held, velocity_rows: IntArray) -> _Distribution | None:
        """The distribution at a place; None where the rows are not finite there or beside it."""
        forms = held.forms
        if not np.isfinite(forms[velocity_rows]).all():
            return None
        weight = np.linalg.norm(forms[velocity_rows], axis=1)
        fields = held.admitted @ kernel(forms[velocity_rows] @ held.admitted, weight)
        values = _exterior_derivative(held.chart, held.place, velocity_rows, fields)
        if values is None:
            return None
        values = values / np.where(weight > 0.0, weight, 1.0)[:, None, None]
        defect = float(np.abs(values).max(initial=0.0))
        above = np.triu_indices(fields.shape[1], 1)
        table = values[:, above[0], above[1]]
        all_rows = np.concatenate([held.holding, velocity_rows])
        pairs: tuple[tuple[int, int], ...] = ()
        directions = np.zeros((len(fields), 0))
        if table.size and defect > INTEGRABLE:
            R, chosen = qr(table, mode="r", pivoting=True)
            found = int(np.sum(np.abs(np.diag(R)) > INTEGRABLE * max(1.0, defect)))
            pairs = tuple((int(above[0][k]), int(above[1][k])) for k in chosen[:found])
            # α([X, Y]) = −dα(X, Y), and zero for the rows that hold positions
            right = np.zeros((len(all_rows), found))
            right[len(held.holding) :] = -table[:, chosen[:found]]
            directions = np.linalg.qr(lstsq(_unit_rows(forms[all_rows]), right)[0])[0]
        order = qr(_unit_rows(forms[all_rows]).T, mode="r", pivoting=True)[1]
        rank = forms.shape[1] - fields.shape[1]
        return _Distribution(held, all_rows[np.sort(order[:rank])], fields, pairs, directions, defect)

    def closure(self, most: int) -> tuple[int, bool]:
        """Dimension of the involutive closure, which is at most `most`, and whether it was found."""
        count = self.fields.shape[1]
        known = np.column_stack([self.fields, self.directions])
        if not self.pairs or known.shape[1] >= most:
            return min(known.shape[1], most), True
        complete = True
        words: list[Word] = [(a, pair) for pair in self.pairs for a in range(count)]
        budget = _MOST_ROWS // max(1, len(self.held.forms))
        for length in range(3, _LONGEST + 1):
            kept: list[Word] = []
            for word in words:
                budget -= _cost(length)
                if budget < 0:
                    return known.shape[1], False
                rest, sure = self._new_direction(word, known)
                complete = complete and sure
                if rest is not None:
                    known = np.column_stack([known, rest])
                    kept.append(word)
                    if known.shape[1] >= most:
                        return most, True
            if not kept:
                return known.shape[1], complete
            words = [(a, word) for word in kept for a in range(count)]
        return known.shape[1], False

    def _new_direction(self, word: Word, known: Array) -> tuple[Array | None, bool]:
        """The direction that a bracket adds to orthonormal ones (k + 1, d), if any, and whether that is sure.

        Two steps of differences must agree on it: otherwise it is what truncation or round-off, which each level of a bracket
        magnifies, has made of nothing.
        """
        for steps in _NESTED:
            rests, small = [], 0
            for step in steps:
                value = self._value(word, self.held.place, step)
                if not np.isfinite(value).all():
                    break
                rest = value - known @ (known.T @ value)
                rests.append(np.asarray(rest - known @ (known.T @ rest)))
                small += bool(np.linalg.norm(rest) <= _NEW * max(1.0, float(np.linalg.norm(value))))
            if small == len(steps):
                return None, True
            if small == 0 and len(rests) == len(steps):
                coarse, fine = rests
                length = float(np.linalg.norm(fine))
                if np.linalg.norm(coarse - fine) <= _AGREE * length:
                    return fine / length, True
        return None, False

    def _value(self, word: Word, place: Place, step: float) -> Array:
        """A word's field at a place: [X, Y] = (∂Y·X) − (∂X·Y) + the commutator of constant components."""
        if isinstance(word, int):
            return self._field(word, place)
        first, second = word
        X, Y = self._field(first, place), self._value(second, place, step)
        along_x = self._sum(
            (w, self._value(second, there, step)) for w, there in self.held.chart.derivative(place, X, step)
        )
        along_y = self._sum((w, self._field(first, there)) for w, there in self.held.chart.derivative(place, Y, step))
        return along_x - along_y + self.held.chart.bracket(X, Y)

    def _field(self, number: int, place: Place) -> Array:
        """The field through fields[:, number] here: that vector, projected on what the rows admit there."""
        constant = self.fields[:, number]
        forms = self.held.chart.rows(place)[0][self.rows]
        Q = np.linalg.qr(forms.T)[0]
        return np.asarray(constant - Q @ (Q.T @ constant))

    @staticmethod
    def _sum(terms: Iterator[tuple[float, Array]]) -> Array:
        return np.asarray(sum(weight * value for weight, value in terms))


def _exterior_derivative(around: Chart, place: Place, rows: IntArray, fields: Array) -> Array | None:
    """dα (m, d, d) of some rows on all pairs of fields (k + 1, d); None where a neighbour's rows are not finite.

    Derivatives are taken along an orthonormal basis of what the fields are in the coordinates that the rows act on: a form
    depends on no others.
    """
    forms = around.rows(place)[0][rows]
    acting = _acting(around, rows)
    U, values, V = np.linalg.svd(fields[acting], full_matrices=False)
    used = values > 1e-9
    basis, coordinates = np.zeros((len(fields), int(used.sum()))), values[used, None] * V[used]
    basis[acting] = U[:, used]
    d = basis.shape[1]
    rate = np.empty((d, len(rows), d))
    for a in range(d):
        rate[a] = sum(
            weight * (around.rows(there)[0][rows] @ basis) for weight, there in around.derivative(place, basis[:, a])
        )
    if not np.isfinite(rate).all():
        return None
    brackets = around.bracket(basis.T[:, None, :], basis.T[None, :, :])
    out = rate.transpose(1, 0, 2) - rate.transpose(1, 2, 0) - np.einsum("mk,abk->mab", forms, brackets)
    return np.asarray(np.einsum("ap,mab,bq->mpq", coordinates, out, coordinates))


def _cost(length: int) -> int:
    """Evaluations of all rows for a bracket of so many fields with one pair of steps."""
    one = 1
    for _ in range(length - 1):
        one = 4 * one + 5
    return 2 * one


def _acting(around: Chart, rows: IntArray) -> NDArray[np.bool_]:
    """Which increments change the rows: of the bodies at their ends, and time."""
    system = around.system
    table, bodies = system.liaisons, system.bodies
    acted = {
        int(bodies.attachment_body[end])
        for i in rows
        for end in table.end[table.end_start[i] : table.end_start[i + 1], 0]
    }
    of_column = np.searchsorted(bodies.offset, around.columns, side="right") - 1
    return np.append(np.isin(of_column, sorted(acted)), True)


def _unit_rows(forms: Array) -> Array:
    size = np.linalg.norm(forms, axis=1)
    return np.asarray(forms / np.where(size > 0.0, size, 1.0)[:, None])

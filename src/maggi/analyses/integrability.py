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
_NESTED = 1e-2  # step of nested differences: each level divides round-off by it
_NEW = 1e-5  # part of a bracket outside the directions known so far, from which on it is a new one
_LONGEST = 7  # fields in a bracket
_MOST_FIELDS = 300  # beyond so many admissible directions only brackets of two are looked at


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
    owner = system.liaisons.row[:, ROW_OWNER]
    singles = []
    for one in dict.fromkeys(owner[velocity_rows].tolist()):
        name = system.liaison_entries[one].name
        singles.append(_of_rows((name,), around, places, holding, velocity_rows[owner[velocity_rows] == one]))
    if len(singles) == 1:
        return PartIntegrability(tuple(singles), singles[0])
    names = tuple(one.liaisons[0] for one in singles)
    return PartIntegrability(tuple(singles), _of_rows(names, around, places, holding, velocity_rows))


def _of_rows(
    names: tuple[str, ...], around: Chart, places: Sequence[Place], holding: IntArray, velocity_rows: IntArray
) -> Integrability:
    tested = [
        one
        for place in places
        if (one := _Distribution.at(around, place, np.concatenate([holding, velocity_rows]), velocity_rows)) is not None
    ]
    if not tested:
        return Integrability(names, 0, 0, 0, 0, False, 0.0, 0)
    # where brackets lead furthest the place is a general one
    best = max(tested, key=lambda one: (-one.fields.shape[1], one.brackets.shape[1]))
    spatial = best.forms[holding, :-1]
    positions = kernel(spatial).shape[1]
    velocities = kernel(best.forms[np.concatenate([holding, velocity_rows]), :-1]).shape[1]
    clock = best.fields.shape[1] - velocities  # 1: time passes along with the admissible velocities
    dimension, complete = best.closure(positions + clock)
    defect = max(one.defect for one in tested)
    return Integrability(
        names,
        positions - velocities,
        positions,
        velocities,
        dimension - clock,
        complete or defect <= INTEGRABLE,
        defect,
        len(tested),
    )


@dataclass(frozen=True, eq=False)
class _Distribution:
    """The admissible increments at a place.

    rows : all that must hold, an independent set. fields (k + 1, d): orthonormal. forms (r, k + 1): all rows.
    brackets (m, j): dα on j chosen pairs of fields, independent; pairs : which.
    """

    chart: Chart
    place: Place
    rows: IntArray
    forms: Array
    fields: Array
    brackets: Array
    pairs: tuple[tuple[int, int], ...]
    defect: float

    @staticmethod
    def at(around: Chart, place: Place, rows: IntArray, velocity_rows: IntArray) -> _Distribution | None:
        """The distribution of some rows and dα of those without a position; None where they are not finite."""
        forms, _ = around.rows(place)
        if not np.isfinite(forms[rows]).all():
            return None
        fields = kernel(forms[rows])
        rank = forms.shape[1] - fields.shape[1]
        order = qr(_unit_rows(forms[rows]).T, mode="r", pivoting=True)[1]
        values = _exterior_derivative(around, place, velocity_rows, fields)
        if values is None:
            return None
        # combinations of the rows of length one beside the rows that hold positions
        weight = np.linalg.norm(forms[velocity_rows], axis=1)
        values = values / np.where(weight > 0.0, weight, 1.0)[:, None, None]
        defect = float(np.abs(values).max(initial=0.0))
        above = np.triu_indices(fields.shape[1], 1)
        table = values[:, above[0], above[1]]
        brackets = np.zeros((len(velocity_rows), 0))
        pairs: tuple[tuple[int, int], ...] = ()
        if table.size and defect > INTEGRABLE:
            R, chosen = qr(table, mode="r", pivoting=True)
            found = int(np.sum(np.abs(np.diag(R)) > INTEGRABLE * max(1.0, defect)))
            brackets = table[:, chosen[:found]]
            pairs = tuple((int(above[0][k]), int(above[1][k])) for k in chosen[:found])
        return _Distribution(around, place, rows[np.sort(order[:rank])], forms, fields, brackets, pairs, defect)

    def closure(self, most: int) -> tuple[int, bool]:
        """Dimension of the involutive closure, which is at most `most`, and whether it was found."""
        count = self.fields.shape[1]
        dimension = count + len(self.pairs)
        if not self.pairs or dimension >= most:
            return min(dimension, most), True
        if count > _MOST_FIELDS:
            return dimension, False
        known = self.fields
        words: list[Word] = [(a, b) for a, b in self.pairs]
        length = 2
        while words:
            kept: list[Word] = []
            for word in words:
                value = self._value(word, self.place)
                rest = value - known @ (known.T @ value)
                rest -= known @ (known.T @ rest)
                size = float(np.linalg.norm(rest))
                if size > _NEW * max(1.0, float(np.linalg.norm(value))):
                    known = np.column_stack([known, rest / size])
                    kept.append(word)
                    if known.shape[1] >= most:
                        return most, True
            length += 1
            if length > _LONGEST:
                return known.shape[1], False
            words = [(a, word) for word in kept for a in range(count)]
        return known.shape[1], True

    def _value(self, word: Word, place: Place) -> Array:
        """A word's field at a place: [X, Y] = (∂Y·X) − (∂X·Y) + the commutator of constant components."""
        if isinstance(word, int):
            return self._field(word, place)
        first, second = word
        X, Y = self._field(first, place), self._value(second, place)
        along_x = self._sum((w, self._value(second, there)) for w, there in self.chart.derivative(place, X, _NESTED))
        along_y = self._sum((w, self._field(first, there)) for w, there in self.chart.derivative(place, Y, _NESTED))
        return along_x - along_y + self.chart.bracket(X, Y)

    def _field(self, number: int, place: Place) -> Array:
        """The field through fields[:, number] here: that vector, projected on what the rows admit there."""
        constant = self.fields[:, number]
        forms = self.chart.rows(place)[0][self.rows]
        return np.asarray(constant - lstsq(forms, forms @ constant)[0])

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
    out = np.empty((len(rows), d, d))
    for a in range(d):
        for b in range(d):
            out[:, a, b] = rate[a, :, b] - rate[b, :, a] - forms @ around.bracket(basis[:, a], basis[:, b])
    return np.asarray(np.einsum("ap,mab,bq->mpq", coordinates, out, coordinates))


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

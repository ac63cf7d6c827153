"""Joints whose rows repeat each other, or lock a mechanism, and the joints that would do instead.

The dependences of rows A v = 0 are the left null space Zᵀ A = 0. Rows X may be taken away without giving the mechanism a
new motion if and only if Z, restricted to them, has full rank, and they are then all redundant; where that rank falls short by one, their
absence sets one motion free. So every replacement of a joint by one that holds fewer of the same motions can be tried
without building anything.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, islice, product
from types import MappingProxyType

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from maggi.liaisons.registry import JOINTS
from maggi.liaisons.tables import OFFSET, PRODUCT, ROW_OWNER, TWIST
from maggi.model.forces import TorsionSpring
from maggi.model.joints import Coupler, Driver
from maggi.system.system import LiaisonEntry, System

from .chart import kernel

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_SHARE = 1e-6  # of a row in the dependences, from which on it takes part in them
_CLEAR = 1e-2  # smallest singular value of Z on rows that are taken away: their directions are told apart by the others
_MOST_JOINTS = 3
_MOST_TRIALS = 20_000
_Row = tuple[int, int, int]
_TURN_X, _TURN_Y, _TURN_Z = (PRODUCT, 1, 2), (PRODUCT, 0, 2), (PRODUCT, 0, 1)


@dataclass(frozen=True)
class _Instead:
    """What may stand in a joint's place: rows of `registry.JOINTS` that it lacks, whether the joint's coordinates stay, and
    whether it is what one turns to last.
    """

    by: str
    lacks: tuple[_Row, ...]
    keeps: bool = False
    exotic: bool = False


_SLOT = "point-on-curve along its axis"
_INSTEAD: Mapping[str, tuple[_Instead, ...]] = MappingProxyType(
    {
        "revolute": (
            _Instead("cylindrical joint", ((OFFSET, 2, 0),), keeps=True),
            _Instead("spherical joint", (_TURN_X, _TURN_Y)),
            _Instead("universal joint turning about its x too", (_TURN_X,)),
            _Instead("universal joint turning about its y too", (_TURN_Y,)),
            _Instead(_SLOT, ((OFFSET, 2, 0), _TURN_X, _TURN_Y), exotic=True),
        ),
        "prismatic": (
            _Instead("cylindrical joint", (_TURN_Z,), keeps=True),
            _Instead(_SLOT, (_TURN_Z, _TURN_X, (PRODUCT, 2, 0)), exotic=True),
        ),
        "cylindrical": (_Instead(_SLOT, (_TURN_X, _TURN_Y), exotic=True),),
        "planar": (_Instead("point-on-surface in its plane", (_TURN_X, _TURN_Y), exotic=True),),
        "universal": (_Instead("spherical joint", (_TURN_Z,)),),
        "constant-velocity": (_Instead("spherical joint", ((TWIST, 0, 1),)),),
        "weld": (
            _Instead("revolute joint about x", (_TURN_X,)),
            _Instead("revolute joint about y", ((PRODUCT, 2, 0),)),
            _Instead("revolute joint about z", (_TURN_Z,)),
            _Instead("spherical joint", (_TURN_Z, _TURN_X, (PRODUCT, 2, 0))),
        ),
    }
)
_LAST = {one.by for options in _INSTEAD.values() for one in options if one.exotic}
LEFT_OUT = "nothing"


@dataclass(frozen=True)
class Replacement:
    """A joint of kind `now`, what may stand in its place (``nothing``: it can be left out), and how many rows fewer."""

    joint: str
    now: str
    by: str
    rows: int

    def __str__(self) -> str:
        if self.by == LEFT_OUT:
            return f"{self.joint} left out"
        return f"a {self.by} in place of the {self.now} {self.joint}"


@dataclass(frozen=True)
class Remedy:
    """What makes the rows of some joints independent without changing how anything moves.

    joints : those whose rows depend on each other. redundant : how many rows too many they have. replacements : all made
    together; none where nothing was found.
    """

    joints: tuple[str, ...]
    redundant: int
    replacements: tuple[Replacement, ...]


def remedies(system: System, A: Array) -> tuple[Remedy, ...]:
    """For the joints whose rows in A (r, n) depend on each other, replacements that take away what is too many.

    Rows of zeros do not count: they have nothing to act on.
    """
    found = []
    acting = np.flatnonzero(np.abs(A).max(axis=1, initial=0.0) > 0.0)
    for within, Z in dependences(system, A[acting], acting):
        rows = acting[within]
        owners = sorted(set(system.liaisons.row[rows, ROW_OWNER].tolist()))
        names = tuple(system.liaison_entries[k].name for k in owners if system.liaison_entries[k].visible)
        found.append(Remedy(names, Z.shape[1], _fewest(system, rows, Z, owners)))
    return tuple(found)


def releases(
    system: System, A: Array, acting: IntArray, joints: Sequence[str]
) -> Iterator[tuple[Replacement, IntArray]]:
    """Single replacements that set exactly one motion free, and the rows that they take away; the simplest joints first.

    A : all rows (r, n), of which the `acting` ones count.
    """
    Z = np.zeros((len(A), 0))
    for within, of in dependences(system, A[acting], acting):
        block = np.zeros((len(A), of.shape[1]))
        block[acting[within]] = of
        Z = np.column_stack([Z, block])
    options = [
        option for entry in system.liaison_entries if entry.name in joints for option in _options(system, entry, True)
    ]
    for replacement, rows in sorted(options, key=lambda one: (one[0].by in _LAST, one[0].rows)):
        values = np.linalg.svd(Z[rows], compute_uv=False)
        if len(rows) - int(np.sum(values > _SHARE)) == 1:
            yield replacement, rows


def dependences(system: System, A: Array, rows: IntArray) -> list[tuple[IntArray, Array]]:
    """Which of A (k, n), the given rows (k,) of the system, depend on each other, those of joints in common together.

    Each set (j,) comes with an orthonormal Z (j, d).
    """
    size = np.linalg.norm(A, axis=1)
    if not A.size:
        return []
    Z = kernel((A / np.where(size > 0.0, size, 1.0)[:, None]).T)
    involved = np.flatnonzero(np.linalg.norm(Z, axis=1) > _SHARE)
    owner = system.liaisons.row[rows[involved], ROW_OWNER]
    together = (np.abs(Z[involved] @ Z[involved].T) > _SHARE) | (owner[:, None] == owner)
    count, label = connected_components(sp.csr_matrix(together), directed=False)
    found = []
    for k in range(count):
        within = involved[label == k]
        W, values, _ = np.linalg.svd(Z[within], full_matrices=False)
        found.append((within, np.asarray(W[:, values > 0.5])))  # they are ones and zeros
    return found


def _fewest(system: System, rows: IntArray, Z: Array, owners: Sequence[int]) -> tuple[Replacement, ...]:
    """The fewest replacements that together take away d rows on which Z (r, d) is regular, the most clearly so."""
    for exotic in (False, True):
        options = [
            usable
            for k in owners
            if (usable := list(_redundant_options(system, rows, Z, system.liaison_entries[k], exotic)))
        ]
        for count in range(1, _MOST_JOINTS + 1):
            best = _clearest(options, count, Z)
            if best:
                return best
    return _left_out(system, rows, Z, owners)


def _redundant_options(
    system: System, rows: IntArray, Z: Array, entry: LiaisonEntry, exotic: bool
) -> Iterator[tuple[Replacement, list[int]]]:
    """Replacements of one joint that take away nothing but redundant rows, and those among `rows`."""
    place = {int(row): k for k, row in enumerate(rows)}
    for replacement, taken in _options(system, entry, exotic):
        within = [place[int(row)] for row in taken if int(row) in place]
        if len(within) == len(taken) and _regularity(Z[within]) > _CLEAR:
            yield replacement, within


def _clearest(
    options: Sequence[Sequence[tuple[Replacement, list[int]]]], count: int, Z: Array
) -> tuple[Replacement, ...]:
    """Of all choices of `count` replacements in different joints that take away all d rows, the most regular one."""
    best: tuple[float, tuple[Replacement, ...]] = (0.0, ())
    choices = (choice for joints in combinations(options, count) for choice in product(*joints))
    for choice in islice(choices, _MOST_TRIALS):
        taken = [row for _, within in choice for row in within]
        if len(taken) == Z.shape[1]:
            # to two digits, so that of equals the first in the model's order stays
            clear = round(_regularity(Z[taken]), 2)
            if clear > max(best[0], _CLEAR):
                best = clear, tuple(replacement for replacement, _ in choice)
    return best[1]


def _left_out(system: System, rows: IntArray, Z: Array, owners: Sequence[int]) -> tuple[Replacement, ...]:
    """The last liaison all of whose rows are redundant, and no others."""
    for k in reversed(owners):
        entry = system.liaison_entries[k]
        taken = np.isin(rows, entry.rows)
        if taken.sum() == len(entry.rows) == Z.shape[1] and _regularity(Z[taken]) > _CLEAR:
            return (Replacement(entry.name, entry.kind, LEFT_OUT, len(entry.rows)),)
    return ()


def _options(system: System, entry: LiaisonEntry, exotic: bool) -> Iterator[tuple[Replacement, IntArray]]:
    """What may stand in a joint's place, and the rows that are then no longer there."""
    if not entry.visible:
        return
    used = entry.name in _measured(system)
    for one in _INSTEAD.get(entry.kind, ()):
        if (used and not one.keeps) or (one.exotic and not exotic):
            continue  # a driver, coupler or spring acts on a coordinate that the other joint does not have
        kinds = JOINTS[entry.kind].rows
        rows = np.array([entry.rows[k] for k, row in enumerate(kinds) if row in one.lacks], dtype=np.int64)
        yield Replacement(entry.name, entry.kind, one.by, len(rows)), rows


def _measured(system: System) -> set[str]:
    """Joints on whose coordinates something acts."""
    joints, forces = system.model.joints.values(), system.model.forces.values()
    named = {one.joint for one in joints if isinstance(one, Driver)}
    named |= {one.joint for one in forces if isinstance(one, TorsionSpring)}
    return named | {c.joint for one in joints if isinstance(one, Coupler) for c in one.coordinates.values()}


def _regularity(Z: Array) -> float:
    """Smallest singular value of some rows of Z; zero where there are more rows than columns."""
    if Z.shape[0] > Z.shape[1]:
        return 0.0
    return float(np.linalg.svd(Z, compute_uv=False)[-1])

"""Quantities with their time derivatives at one instant, by truncated Taylor arithmetic.

A mechanism's accelerations are what is asked for, so a quantity's highest derivative is kept as an affine function of
the unknowns: its value with all unknowns zero, and one slope for each. With positions carried to second order the
unknowns are v̇; carried to first order they are v, and the slopes are Kane's partial velocities. Nothing is
differentiated by hand: whoever writes a position has its acceleration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LEVI_CIVITA = np.zeros((3, 3, 3))
for _i in range(3):
    _LEVI_CIVITA[_i, (_i + 1) % 3, (_i + 2) % 3] = 1.0
    _LEVI_CIVITA[_i, (_i + 2) % 3, (_i + 1) % 3] = -1.0
SKEW: Array = np.ascontiguousarray(_LEVI_CIVITA.transpose(1, 0, 2))
"""SKEW[k] is the matrix of e_k ×."""


@dataclass(frozen=True, eq=False)
class Taylor:
    """A quantity of shape S with derivatives up to order 1 or 2.

    known : x, ẋ, … below the highest, each of shape S; there are `order` of them.
    highest : (1 + n, *S): the highest derivative with all unknowns zero, then its slope to each of n unknowns. What
        depends on no unknown may have one row only.
    """

    known: tuple[Array, ...]
    highest: Array

    @property
    def order(self) -> int:
        """Order of the highest derivative."""
        return len(self.known)

    @property
    def value(self) -> Array:
        """The quantity itself, of shape S."""
        return self.known[0]

    @property
    def rate(self) -> Array:
        """Its first derivative with all unknowns zero, of shape S."""
        return self.known[1] if self.order > 1 else np.asarray(self.highest[0])

    def derivative(self) -> Taylor:
        """Its rate as a quantity of one order less. Needs order 2."""
        return Taylor(self.known[1:], self.highest)

    def lower(self) -> Taylor:
        """The same quantity with one derivative less, which then depends on no unknown. Needs order 2."""
        return Taylor(self.known[:-1], self.known[-1][None])

    def __getitem__(self, index: int | slice | tuple[int | slice, ...]) -> Taylor:
        rows = (slice(None), *index) if isinstance(index, tuple) else (slice(None), index)
        return Taylor(tuple(np.asarray(x[index]) for x in self.known), self.highest[rows])

    def __neg__(self) -> Taylor:
        return Taylor(tuple(-x for x in self.known), -self.highest)

    def __add__(self, other: Taylor | Array | float) -> Taylor:
        if not isinstance(other, Taylor):
            return Taylor((self.known[0] + other, *self.known[1:]), self.highest)
        a, b = _same_order(self, other)
        known = tuple(x + y for x, y in zip(a.known, b.known, strict=True))
        x, y = _same_rows(a.highest, b.highest)
        return Taylor(known, x + y)

    def __sub__(self, other: Taylor | Array | float) -> Taylor:
        return self + (-other)

    def __mul__(self, factor: float) -> Taylor:
        """A constant multiple."""
        return Taylor(tuple(factor * x for x in self.known), factor * self.highest)


def constant(value: Array | float, order: int = 2) -> Taylor:
    """What does not change in time."""
    x = np.asarray(value, dtype=np.float64)
    return Taylor((x, *(np.zeros_like(x) for _ in range(order - 1))), np.zeros((1, *x.shape)))


def time(t: float, order: int = 2) -> Taylor:
    """Time itself, t in s."""
    derivatives = [np.array(t), np.array(1.0), np.array(0.0)]
    return Taylor(tuple(derivatives[:order]), derivatives[order][None])


def product(subscripts: str, a: Taylor, b: Taylor | Array) -> Taylor:
    """A bilinear product, written as for `numpy.einsum` (letters other than z), by Leibniz' rule.

    b may be a constant array. Examples: ``"ij,j->i"`` a matrix times a vector, ``"i,i->"`` a scalar product.
    """
    inputs, result = subscripts.split("->")
    first, second = inputs.split(",")
    rows_first, rows_second = f"z{first},{second}->z{result}", f"{first},z{second}->z{result}"
    if not isinstance(b, Taylor):
        constant_factor = np.asarray(b, dtype=np.float64)
        known = tuple(np.einsum(subscripts, x, constant_factor) for x in a.known)
        return Taylor(known, np.einsum(rows_first, a.highest, constant_factor))
    a, b = _same_order(a, b)
    x, y = _same_rows(
        np.einsum(rows_first, a.highest, b.known[0]),
        np.einsum(rows_second, a.known[0], b.highest),
    )
    highest = x + y
    value = np.asarray(np.einsum(subscripts, a.known[0], b.known[0]))
    if a.order == 1:
        return Taylor((value,), highest)
    rate = np.einsum(subscripts, a.known[1], b.known[0]) + np.einsum(subscripts, a.known[0], b.known[1])
    highest[0] += 2.0 * np.einsum(subscripts, a.known[1], b.known[1])
    return Taylor((value, np.asarray(rate)), highest)


def dot(a: Taylor, b: Taylor | Array) -> Taylor:
    """Scalar product of two vectors (3,)."""
    return product("i,i->", a, b)


def cross(a: Taylor, b: Taylor | Array) -> Taylor:
    """Vector product of two vectors (3,)."""
    pairs = product("j,k->jk", a, b)
    return product("jk,ijk->i", pairs, _LEVI_CIVITA)


def scaled(factor: Taylor, vector: Taylor | Array) -> Taylor:
    """A vector (or any one-dimensional quantity) times a scalar quantity."""
    return product(",i->i", factor, vector)


def compose(value: Array | float, first: Sequence[Array | float], second: Array, *arguments: Taylor) -> Taylor:
    """A function of scalar quantities, from its value and partial derivatives there, by the chain rule.

    first (k,) and second (k, k): gradient and Hessian to the k `arguments`. A derivative that is infinite counts only
    where its argument moves.
    """
    order = min(x.order for x in arguments)
    arguments = tuple(x.lower() if x.order > order else x for x in arguments)
    count = max(len(x.highest) for x in arguments)
    highest = np.zeros(count)
    rate = np.zeros(())
    for x, slope in zip(arguments, first, strict=True):
        moving = x.highest != 0.0
        highest[: len(moving)][moving] += slope * x.highest[moving]
        if order == 2 and x.known[1] != 0.0:
            rate = rate + slope * x.known[1]
    if order == 1:
        return Taylor((np.asarray(value, dtype=np.float64),), highest)
    for i, x in enumerate(arguments):
        for j, y in enumerate(arguments):
            if x.known[1] != 0.0 and y.known[1] != 0.0:
                highest[0] += second[i, j] * x.known[1] * y.known[1]
    return Taylor((np.asarray(value, dtype=np.float64), np.asarray(rate)), highest)


def function(value: float, first: float, second: float, argument: Taylor) -> Taylor:
    """A function of one scalar quantity, from its value and first two derivatives there."""
    return compose(value, [first], np.array([[second]]), argument)


def sine(x: Taylor) -> Taylor:
    """sin x of a scalar quantity."""
    s, c = float(np.sin(x.value)), float(np.cos(x.value))
    return function(s, c, -s, x)


def cosine(x: Taylor) -> Taylor:
    """cos x of a scalar quantity."""
    s, c = float(np.sin(x.value)), float(np.cos(x.value))
    return function(c, -s, -c, x)


def reciprocal(x: Taylor) -> Taylor:
    """1/x of a scalar quantity."""
    r = 1.0 / float(x.value)
    return function(r, -r * r, 2.0 * r**3, x)


def square_root(x: Taylor) -> Taylor:
    """√x of a positive scalar quantity."""
    r = float(np.sqrt(x.value))
    return function(r, 0.5 / r, -0.25 / r**3, x)


def arc_tangent(y: Taylor, x: Taylor) -> Taylor:
    """The angle atan2(y, x) of two scalar quantities, in (−π, π]."""
    b, a = float(y.value), float(x.value)
    square = a * a + b * b
    mixed, pure = (b * b - a * a) / square**2, 2.0 * a * b / square**2
    return compose(np.arctan2(b, a), [a / square, -b / square], np.array([[-pure, mixed], [mixed, pure]]), y, x)


def norm(a: Taylor) -> Taylor:
    """Length of a vector (3,) that is not zero."""
    return square_root(dot(a, a))


def unit(a: Taylor) -> Taylor:
    """A vector (3,) divided by its length."""
    return scaled(reciprocal(norm(a)), a)


def stack(parts: Sequence[Taylor]) -> Taylor:
    """Scalar quantities as one vector."""
    order = min(x.order for x in parts)
    parts = [x.lower() if x.order > order else x for x in parts]
    rows = max(len(x.highest) for x in parts)
    highest = np.zeros((rows, len(parts)))
    for i, x in enumerate(parts):
        highest[: len(x.highest), i] = x.highest
    return Taylor(tuple(np.array([x.known[k] for x in parts]) for k in range(order)), highest)


def skew(a: Taylor) -> Taylor:
    """The matrix (3, 3) of ``a ×``."""
    return product("j,ijk->ik", a, _LEVI_CIVITA)


def rotation_matrix(theta: Taylor) -> Taylor:
    """exp(θ̃) (3, 3) of a rotation vector θ (3,): ``I + s θ̃ + c θ̃θ̃`` with s = sin|θ|/|θ|, c = (1 − cos|θ|)/|θ|².

    Both coefficients are power series in |θ|², summed here; for |θ| up to 2π they are good to round-off.
    """
    square = dot(theta, theta)
    s, c = (function(*_series(float(square.value), first), square) for first in (1, 2))
    matrix = skew(theta)
    twice = product("ij,jk->ik", matrix, matrix)
    return product(",ij->ij", s, matrix) + product(",ij->ij", c, twice) + np.eye(3)


def angular_velocity(rotation: Taylor) -> Taylor:
    """ω (3,), global, of a rotation matrix (body to global), of one order less: ``ω̃ = Ṙ Rᵀ``. Needs order 2."""
    spin = product("ij,kj->ik", rotation.derivative(), rotation.lower())
    return product("jk,ijk->i", spin, -0.5 * _LEVI_CIVITA)


def partial_rotations(rotation: Taylor) -> Array:
    """Slopes (n, 3), global, of the angular velocity (order 1) or angular acceleration (order 2) of a rotation."""
    spins = rotation.highest[1:] @ rotation.value.T
    return np.asarray(np.einsum("njk,ijk->ni", spins, -0.5 * _LEVI_CIVITA))


def _series(x: float, first: int) -> tuple[float, float, float]:
    """Σ (−x)^k/(2k + first)! with its first two derivatives to x."""
    value = slope = bend = 0.0
    factorial = 1.0 if first == 1 else 2.0
    power = (1.0, 0.0, 0.0)  # (−1)^k times x^k, x^(k−1), x^(k−2)
    for k in range(40):
        value += power[0] / factorial
        slope += k * power[1] / factorial
        bend += k * (k - 1) * power[2] / factorial
        power = (-x * power[0], -power[0], -power[1])
        factorial *= (2 * k + first + 1) * (2 * k + first + 2)
    return value, slope, bend


def _same_order(a: Taylor, b: Taylor) -> tuple[Taylor, Taylor]:
    order = min(a.order, b.order)
    return a if a.order == order else a.lower(), b if b.order == order else b.lower()


def _same_rows(a: Array, b: Array) -> tuple[Array, Array]:
    """Both with as many rows as the longer: a missing slope is zero."""
    rows = max(len(a), len(b))
    return _padded(a, rows), _padded(b, rows)


def _padded(a: Array, rows: int) -> Array:
    if len(a) == rows:
        return a
    return np.concatenate([a, np.zeros((rows - len(a), *a.shape[1:]))])

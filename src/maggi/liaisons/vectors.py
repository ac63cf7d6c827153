"""Compiled operations on small vectors, and axes that turn with attachments.

Vectors in arrays, and as tuples of three numbers where rows are evaluated most often: those stay in registers.
"""

from __future__ import annotations

from numba import njit

from .tables import Array


@njit(cache=True)
def axis(rotation: Array, frame: Array, k: int, out: Array) -> None:
    """Axis k of a joint's frame, global components."""
    for i in range(3):
        out[i] = rotation[i, 0] * frame[0, k] + rotation[i, 1] * frame[1, k] + rotation[i, 2] * frame[2, k]


@njit(cache=True)
def dot(a: Array, b: Array) -> float:
    """a · b."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@njit(cache=True)
def cross(a: Array, b: Array, out: Array) -> None:
    """out = a × b; out may be a or b."""
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    out[0] = x
    out[1] = y
    out[2] = z


@njit(cache=True)
def to_global(rotation: Array, a: Array, out: Array) -> None:
    """out = R a; out must not be a."""
    for i in range(3):
        out[i] = rotation[i, 0] * a[0] + rotation[i, 1] * a[1] + rotation[i, 2] * a[2]


@njit(cache=True)
def to_local(rotation: Array, a: Array, out: Array) -> None:
    """out = Rᵀ a; out must not be a."""
    for i in range(3):
        out[i] = rotation[0, i] * a[0] + rotation[1, i] * a[1] + rotation[2, i] * a[2]


Triple = tuple[float, float, float]


@njit(cache=True)
def row(a: Array, i: int) -> Triple:
    """Row i of an array (…, 3)."""
    return a[i, 0], a[i, 1], a[i, 2]


@njit(cache=True)
def turned_axis(rotation: Array, a: int, frame: Array, j: int, side: int, k: int) -> Triple:
    """Axis k of a joint's frame on one side, turning with attachment a, global components."""
    x, y, z = frame[j, side, 0, k], frame[j, side, 1, k], frame[j, side, 2, k]
    return (
        rotation[a, 0, 0] * x + rotation[a, 0, 1] * y + rotation[a, 0, 2] * z,
        rotation[a, 1, 0] * x + rotation[a, 1, 1] * y + rotation[a, 1, 2] * z,
        rotation[a, 2, 0] * x + rotation[a, 2, 1] * y + rotation[a, 2, 2] * z,
    )


@njit(cache=True)
def vector_product(a: Triple, b: Triple) -> Triple:
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def scalar_product(a: Triple, b: Triple) -> float:
    """a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def difference(a: Triple, b: Triple) -> Triple:
    """a − b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(cache=True)
def total(a: Triple, b: Triple) -> Triple:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]

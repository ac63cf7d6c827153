"""Compiled operations on small vectors, and axes that turn with attachments."""

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

"""Rotations and rigid motions: exponentials, logarithm and left tangent, as kernels that allocate nothing.

All vectors are (3,), all matrices (3, 3), float64. `theta` is a rotation vector (rad): its direction is the axis,
its length the angle. A kernel writes into its last argument or arguments, which must not overlap its inputs unless
its docstring allows it. `rotation_matrix` and `rotation_vector` are the allocating forms for use outside kernels.

Notation: S = skew(theta), t = |theta|, x = t². The three entire functions of x

    a = sin t / t,   b = (1 - cos t) / t²,   c = (t - sin t) / t³

give exp(S) = I + a S + b S² (Rodrigues) and the left tangent T_l = I + b S + c S² of Theory §3. They are summed as
Taylor series below x = 1, where the closed forms cancel, so that every kernel is accurate to round-off for every angle.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


# Taylor coefficients in powers of x; the first term left out is below 1e-19 of the sum for x < 1.
TERMS = 10
A = tuple((-1) ** n / math.factorial(2 * n + 1) for n in range(TERMS))
B = tuple((-1) ** n / math.factorial(2 * n + 2) for n in range(TERMS))
C = tuple((-1) ** n / math.factorial(2 * n + 3) for n in range(TERMS))
DB = tuple((n + 1) * (-1) ** (n + 1) / math.factorial(2 * n + 4) for n in range(TERMS))
DC = tuple((n + 1) * (-1) ** (n + 1) / math.factorial(2 * n + 5) for n in range(TERMS))


@njit(cache=True)
def _coefficients(x: float) -> tuple[float, float, float]:
    """a, b, c of the module's docstring as functions of x = |theta|²."""
    if x < 1.0:
        a, b, c = 0.0, 0.0, 0.0
        for n in range(TERMS - 1, -1, -1):
            a = a * x + A[n]
            b = b * x + B[n]
            c = c * x + C[n]
        return a, b, c
    t = math.sqrt(x)
    half = math.sin(0.5 * t)
    sine = math.sin(t)
    return sine / t, 2.0 * half * half / x, (t - sine) / (t * x)


@njit(cache=True)
def _coefficient_derivatives(x: float) -> tuple[float, float]:
    """db/dx and dc/dx; in closed form (a - 2b)/(2x) and (b - 3c)/(2x)."""
    if x < 1.0:
        db, dc = 0.0, 0.0
        for n in range(TERMS - 1, -1, -1):
            db = db * x + DB[n]
            dc = dc * x + DC[n]
        return db, dc
    a, b, c = _coefficients(x)
    return 0.5 * (a - 2.0 * b) / x, 0.5 * (b - 3.0 * c) / x


@njit(cache=True)
def _quadratic(theta: Array, first: float, second: float, out: Array) -> None:
    """out = I + first·S + second·S², with S² = theta thetaᵀ - x I."""
    p, q, r = theta[0], theta[1], theta[2]
    out[0, 0] = 1.0 - second * (q * q + r * r)
    out[1, 1] = 1.0 - second * (p * p + r * r)
    out[2, 2] = 1.0 - second * (p * p + q * q)
    out[0, 1] = second * p * q - first * r
    out[1, 0] = second * p * q + first * r
    out[0, 2] = second * p * r + first * q
    out[2, 0] = second * p * r - first * q
    out[1, 2] = second * q * r - first * p
    out[2, 1] = second * q * r + first * p


@njit(cache=True)
def skew(a: Array, out: Array) -> None:
    """The skew matrix of `a`: out @ b = a × b."""
    out[0, 0] = 0.0
    out[1, 1] = 0.0
    out[2, 2] = 0.0
    out[0, 1] = -a[2]
    out[1, 0] = a[2]
    out[0, 2] = a[1]
    out[2, 0] = -a[1]
    out[1, 2] = -a[0]
    out[2, 1] = a[0]


@njit(cache=True)
def exp_so3(theta: Array, out: Array) -> None:
    """The rotation matrix exp(skew(theta)) (Rodrigues)."""
    a, b, _ = _coefficients(theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2])
    _quadratic(theta, a, b, out)


@njit(cache=True)
def log_so3(R: Array, out: Array) -> None:
    """The rotation vector of the rotation matrix `R`, of length at most π; the inverse of `exp_so3`.

    By way of the unit quaternion, formed around its largest component (Shepperd 1978), so that it is accurate near
    π as well. At π itself, where both signs are right, the largest component of the result is positive.
    `R` is taken to be orthonormal.
    """
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    # The quaternion (w, v) times a positive factor, which the arc tangent below does not see.
    if trace > R[0, 0] and trace > R[1, 1] and trace > R[2, 2]:
        w = 1.0 + trace
        out[0] = R[2, 1] - R[1, 2]
        out[1] = R[0, 2] - R[2, 0]
        out[2] = R[1, 0] - R[0, 1]
    else:
        i = 0
        if R[1, 1] > R[0, 0]:
            i = 1
        if R[2, 2] > R[i, i]:
            i = 2
        j = (i + 1) % 3
        k = (i + 2) % 3
        w = R[k, j] - R[j, k]
        out[i] = 1.0 + R[i, i] - R[j, j] - R[k, k]
        out[j] = R[j, i] + R[i, j]
        out[k] = R[k, i] + R[i, k]
        if w < 0.0:
            w = -w
            for n in range(3):
                out[n] = -out[n]
    size = math.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])
    factor = 2.0 / w if size == 0.0 else 2.0 * math.atan2(size, w) / size
    for n in range(3):
        out[n] *= factor


@njit(cache=True)
def left_tangent(theta: Array, out: Array) -> None:
    """T_l(theta) = I + (1-cos t)/t² S + (t-sin t)/t³ S² (Theory §3).

    With R = exp(skew(theta)) and theta a function of time, d/dt R = skew(T_l thetadot) R: T_l takes thetadot to the
    angular velocity in the frame that theta starts from.
    """
    _, b, c = _coefficients(theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2])
    _quadratic(theta, b, c, out)


@njit(cache=True)
def left_tangent_rates(theta: Array, thetadot: Array, thetaddot: Array, w: Array, wdot: Array) -> None:
    """Angular velocity w = T_l thetadot (rad/s) and acceleration wdot = T_l thetaddot + (d/dt T_l) thetadot (rad/s²).

    Both in the frame that `theta` starts from. `w` and `wdot` may each overlap `thetadot` and `thetaddot`.
    """
    p, q, r = theta[0], theta[1], theta[2]
    x = p * p + q * q + r * r
    _, b, c = _coefficients(x)
    db, dc = _coefficient_derivatives(x)
    u0, u1, u2 = thetadot[0], thetadot[1], thetadot[2]
    z0, z1, z2 = thetaddot[0], thetaddot[1], thetaddot[2]
    # xdot = 2 theta·thetadot takes db/dx, dc/dx to rates.
    xdot = 2.0 * (p * u0 + q * u1 + r * u2)
    db *= xdot
    dc *= xdot
    # S u and S S u; S z and S S z.
    su0, su1, su2 = q * u2 - r * u1, r * u0 - p * u2, p * u1 - q * u0
    ssu0, ssu1, ssu2 = q * su2 - r * su1, r * su0 - p * su2, p * su1 - q * su0
    sz0, sz1, sz2 = q * z2 - r * z1, r * z0 - p * z2, p * z1 - q * z0
    ssz0, ssz1, ssz2 = q * sz2 - r * sz1, r * sz0 - p * sz2, p * sz1 - q * sz0
    # (d/dt S²) u = (Sdot S + S Sdot) u = u × (theta × u), since Sdot u = u × u = 0.
    uu0, uu1, uu2 = u1 * su2 - u2 * su1, u2 * su0 - u0 * su2, u0 * su1 - u1 * su0
    w[0] = u0 + b * su0 + c * ssu0
    w[1] = u1 + b * su1 + c * ssu1
    w[2] = u2 + b * su2 + c * ssu2
    wdot[0] = z0 + b * sz0 + c * (ssz0 + uu0) + db * su0 + dc * ssu0
    wdot[1] = z1 + b * sz1 + c * (ssz1 + uu1) + db * su1 + dc * ssu1
    wdot[2] = z2 + b * sz2 + c * (ssz2 + uu2) + db * su2 + dc * ssu2


@njit(cache=True)
def exp_se3_update(R: Array, r: Array, q: Array, theta: Array, R_out: Array, r_out: Array) -> None:
    """A pose moved by the SE(3) exponential of the body-frame twist increment (q, theta) (Theory §5, step 1).

    R_out = R exp(skew(theta)),   r_out = r + R T_l(theta) q

    R, r : rotation (body to global) and origin (global, m) before; `R_out`, `r_out` may be the same arrays.
    q, theta : translation (m) and rotation (rad) increments, body-frame components.
    """
    x = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]
    a, b, c = _coefficients(x)
    p0, p1, p2 = theta[0], theta[1], theta[2]
    s0, s1, s2 = p1 * q[2] - p2 * q[1], p2 * q[0] - p0 * q[2], p0 * q[1] - p1 * q[0]
    d0 = q[0] + b * s0 + c * (p1 * s2 - p2 * s1)
    d1 = q[1] + b * s1 + c * (p2 * s0 - p0 * s2)
    d2 = q[2] + b * s2 + c * (p0 * s1 - p1 * s0)
    for i in range(3):
        u0, u1, u2 = R[i, 0], R[i, 1], R[i, 2]
        r_out[i] = r[i] + u0 * d0 + u1 * d1 + u2 * d2
        # Row i of R exp(S) is exp(-S) applied to row i of R.
        v0, v1, v2 = u1 * p2 - u2 * p1, u2 * p0 - u0 * p2, u0 * p1 - u1 * p0
        R_out[i, 0] = u0 + a * v0 + b * (v1 * p2 - v2 * p1)
        R_out[i, 1] = u1 + a * v1 + b * (v2 * p0 - v0 * p2)
        R_out[i, 2] = u2 + a * v2 + b * (v0 * p1 - v1 * p0)


def rotation_matrix(theta: Array) -> Array:
    """exp(skew(theta)) as a new (3, 3) array; `theta` (3,) in rad."""
    out = np.empty((3, 3))
    exp_so3(np.asarray(theta, dtype=np.float64), out)
    return out


def rotation_vector(R: Array) -> Array:
    """The rotation vector (3,) (rad, length at most π) of the rotation matrix `R` (3, 3), as a new array."""
    out = np.empty(3)
    log_so3(np.asarray(R, dtype=np.float64), out)
    return out

"""Radau IIA of order 5 with three stages, for stiff equations y' = f(t, y) where high accuracy is wanted.

Stiffly accurate and L-stable: what a step cannot resolve is damped at once. The three stages are solved together by a
simplified Newton iteration in the eigenvectors of A⁻¹, one real and one complex system of the size of y a step size.
Source: Hairer, Wanner, Solving Ordinary Differential Equations II, sections IV.5 and IV.8. It knows no bodies.

As a `scipy.integrate.OdeSolver` it can be given to `solve_ivp` by `method=RadauIIA`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DenseOutput, OdeSolver
from scipy.linalg import lu_factor, lu_solve

Array = NDArray[np.float64]
Function = Callable[[float, Array], Array]

ORDER = 5
MOST_ITERATIONS = 7
SAFETY = 0.9
KEPT = (0.95, 1.2)  # a new step size in this range of the old one is not worth a factorisation
SLOW = 1e-3  # contraction below which the Jacobian is good enough to be kept


def butcher() -> tuple[Array, Array]:
    """A (3, 3) and c (3,): collocation at the zeros of the Radau polynomial, the last at the end of the step."""
    root = np.sqrt(6.0)
    c = np.array([(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0])
    powers = np.arange(3)
    # ∫₀^c_i of the Lagrange polynomials: A V = W with V = c^k, W = c^(k+1)/(k+1)
    A = np.linalg.solve((c[:, None] ** powers).T, ((c[:, None] ** (powers + 1)) / (powers + 1)).T).T
    return np.asarray(A, dtype=np.float64), np.asarray(c, dtype=np.float64)


def _eigenvectors(A: Array) -> tuple[float, complex, NDArray[Any], NDArray[Any]]:
    """Real eigenvalue μ and one of the complex pair of A⁻¹, with the rows that take stages to them and columns back."""
    values, vectors = np.linalg.eig(np.linalg.inv(A))
    real = int(np.argmin(np.abs(values.imag)))
    pair = int(np.argmin(values.imag))
    columns = vectors[:, [real, pair]]
    rows = np.linalg.inv(vectors)[[real, pair]]
    # scaled so that the real part is real
    scale = columns[0, 0]
    columns[:, 0] /= scale
    rows[0] *= scale
    return float(values[real].real), complex(values[pair]), rows, columns


A, C = butcher()
MU, MU_PAIR, TO_MODES, FROM_MODES = _eigenvectors(A)
# the embedded formula of order 3 that also uses f at the beginning, with weight 1/μ (Hairer, Wanner, IV.8)
ERROR = np.array([-13.0 - 7.0 * np.sqrt(6.0), -13.0 + 7.0 * np.sqrt(6.0), -1.0]) / 3.0
# stage values, with zero at the beginning, to coefficients of θ, θ², θ³
INTERPOLATION = np.linalg.inv(C[:, None] ** np.arange(1, 4))


class RadauIIA(OdeSolver):  # type: ignore[misc]  # scipy has no types
    """One integration; see `scipy.integrate.OdeSolver` for `step`, `dense_output` and the attributes.

    Parameters
    ----------
    jacobian : ∂f/∂y as a function of t and y (n, n); default: forward differences of f.
    rtol, atol : the local error is kept below ``atol + rtol |y|``, in the mean over components.
    first_step, max_step : s.
    """

    t: float
    y: Array
    n: int

    def __init__(
        self,
        f: Function,
        t0: float,
        y0: Array,
        t_bound: float,
        *,
        rtol: float = 1e-6,
        atol: float | Array = 1e-9,
        jacobian: Function | None = None,
        first_step: float | None = None,
        max_step: float = np.inf,
        vectorized: bool = False,
        **_: Any,
    ) -> None:
        super().__init__(f, t0, y0, t_bound, vectorized)
        self.rtol, self.atol, self.max_step = rtol, np.asarray(atol, dtype=np.float64), max_step
        self._jacobian = jacobian
        self._f = self.fun(self.t, self.y)
        self._h = first_step if first_step is not None else self._first_step()
        self._J = self._slopes(self.t, self.y, self._f)
        self._fresh = True
        self._factored: tuple[float, Any, Any] | None = None
        self._before: tuple[float, float] | None = None  # step and error before, for the controller
        self._Q: Array | None = None  # interpolation of the last step
        self._start, self._length = self.y, 0.0
        self._newton = max(10.0 * np.finfo(float).eps / rtol, min(0.03, rtol**0.5))

    def _scale(self, y: Array) -> Array:
        return np.asarray(self.atol + self.rtol * np.abs(y))

    def _first_step(self) -> float:
        """Where an explicit Euler step changes y by about 1 % (Hairer, Nørsett, Wanner I, II.4)."""
        scale = self._scale(self.y)
        size, slope = _norm(self.y / scale), _norm(self._f / scale)
        span = abs(self.t_bound - self.t)
        guess = 1e-6 if size < 1e-5 or slope < 1e-5 else 0.01 * size / slope
        return float(min(guess, span, self.max_step))

    def _slopes(self, t: float, y: Array, f: Array) -> Array:
        self.njev += 1
        if self._jacobian is not None:
            return np.asarray(self._jacobian(t, y))
        J = np.empty((self.n, self.n))
        for k in range(self.n):
            change = np.sqrt(np.finfo(float).eps) * max(abs(y[k]), float(np.broadcast_to(self._scale(y), y.shape)[k]))
            moved = y.copy()
            moved[k] += change
            J[:, k] = (self.fun(t, moved) - f) / (moved[k] - y[k])
        return J

    def _factors(self, h: float) -> tuple[Any, Any]:
        """LU factors of μ/h − J, real and complex; kept while the step size is."""
        if self._factored is None or self._factored[0] != h:
            unit = np.eye(self.n)
            self._factored = h, lu_factor(MU / h * unit - self._J), lu_factor(MU_PAIR / h * unit - self._J)
            self.nlu += 2
        return self._factored[1], self._factored[2]

    def _step_impl(self) -> tuple[bool, str | None]:
        t, y, f = self.t, self.y, self._f
        scale = self._scale(y)
        least = 10.0 * abs(np.nextafter(t, self.direction * np.inf) - t)
        h_abs = min(max(self._h, least), self.max_step)
        rejected = False
        while True:
            if h_abs < least:
                return False, self.TOO_SMALL_STEP
            t_new = t + h_abs * self.direction
            if self.direction * (t_new - self.t_bound) > 0.0:
                t_new = self.t_bound
            h = t_new - t
            h_abs = abs(h)
            Z = np.zeros((3, self.n)) if self._Q is None else self._continued(h)
            converged, iterations, Z, rate = self._solve_stages(t, y, h, Z, scale)
            if not converged:
                if self._fresh:
                    h_abs *= 0.5
                else:
                    self._renew(t, y, f)
                continue
            y_new = y + Z[2]
            error = lu_solve(self._factors(h)[0], f + Z.T @ ERROR / h)
            new_scale = self._scale(np.maximum(np.abs(y), np.abs(y_new)))
            size = _norm(error / new_scale)
            if rejected and size > 1.0:
                # a second look at the error in stiff components (IV.8, (8.20))
                error = lu_solve(self._factors(h)[0], self.fun(t, y + error) + Z.T @ ERROR / h)
                size = _norm(error / new_scale)
            safety = SAFETY * (2 * MOST_ITERATIONS + 1) / (2 * MOST_ITERATIONS + iterations)
            if size <= 1.0:
                break
            h_abs *= max(0.2, safety * self._growth(h_abs, size))
            rejected = True
        factor = min(8.0, safety * self._growth(h_abs, size))
        self._before = h_abs, size
        f_new = self.fun(t_new, y_new)
        if iterations > 2 and rate > SLOW:
            self._renew(t_new, y_new, f_new)
        else:
            self._fresh = False
            if KEPT[0] <= factor <= KEPT[1]:
                factor = 1.0
        if rejected:
            factor = min(factor, 1.0)
        self._Q = INTERPOLATION @ Z
        self._start, self._length = y, h
        self._h = h_abs * factor
        self.t, self.y, self._f = t_new, y_new, f_new
        return True, None

    def _renew(self, t: float, y: Array, f: Array) -> None:
        self._J = self._slopes(t, y, f)
        self._fresh, self._factored = True, None

    def _growth(self, h: float, size: float) -> float:
        """By how much the step may change; with the step before, the error is extrapolated (Gustafsson, IV.8)."""
        if size == 0.0:
            return np.inf
        own = size**-0.25
        if self._before is None or self._before[1] == 0.0:
            return float(own)
        h_before, size_before = self._before
        return float(min(1.0, h / h_before * (size_before / size) ** 0.25) * own)

    def _continued(self, h: float) -> Array:
        """Stages of this step on the polynomial of the last one."""
        assert self._Q is not None
        theta = 1.0 + C * h / self._length
        return np.asarray((theta[:, None] ** np.arange(1, 4)) @ self._Q - (self.y - self._start))

    def _solve_stages(self, t: float, y: Array, h: float, Z: Array, scale: Array) -> tuple[bool, int, Array, float]:
        """Newton's iteration on Z_i = y_i − y; returns whether it converged, iterations, Z and the contraction."""
        real, pair = self._factors(h)
        W = TO_MODES @ Z
        before, rate = np.inf, 0.0
        for k in range(MOST_ITERATIONS):
            F = np.array([self.fun(t + h * C[i], y + Z[i]) for i in range(3)])
            if not np.isfinite(F).all():
                return False, k + 1, Z, rate
            right = TO_MODES @ F
            change = np.array(
                [
                    lu_solve(real, (right[0] - MU / h * W[0]).real).astype(complex),
                    lu_solve(pair, right[1] - MU_PAIR / h * W[1]),
                ]
            )
            size = _norm(np.concatenate([np.abs(change[0]), np.sqrt(2.0) * np.abs(change[1])]) / np.tile(scale, 2))
            if k:
                rate = size / before
                left = rate ** (MOST_ITERATIONS - 1 - k) / (1.0 - rate) * size if rate < 1.0 else np.inf
                if not left <= self._newton:
                    return False, k + 1, Z, rate
            W = W + change
            Z = (FROM_MODES[:, 0, None] * W[0]).real + 2.0 * (FROM_MODES[:, 1, None] * W[1]).real
            if size == 0.0 or (k and rate / (1.0 - rate) * size < self._newton):
                return True, k + 1, Z, rate
            before = size
        return False, MOST_ITERATIONS, Z, rate

    def _dense_output_impl(self) -> DenseOutput:
        assert self._Q is not None  # there has been a step
        return _Polynomial(self.t_old, self.t, self._start, self._Q)


class _Polynomial(DenseOutput):  # type: ignore[misc]
    """The collocation polynomial of a step: of third degree, exact to order 3 inside and to 5 at the end."""

    def __init__(self, t_old: float, t: float, start: Array, Q: Array) -> None:
        super().__init__(t_old, t)
        self._start, self._Q, self._span = start, Q, t - t_old

    def _call_impl(self, t: Any) -> Array:
        theta = (np.asarray(t) - self.t_old) / self._span
        powers = theta[..., None] ** np.arange(1, 4)
        return np.asarray((powers @ self._Q + self._start).T)


def _norm(x: NDArray[Any]) -> float:
    """Root mean square."""
    return float(np.linalg.norm(x) / np.sqrt(max(x.size, 1)))

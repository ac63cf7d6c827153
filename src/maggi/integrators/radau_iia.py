"""Radau IIA of order five, three implicit stages, adaptive, for stiff ordinary differential equations.

Hairer and Wanner: Solving Ordinary Differential Equations II, 2nd ed. 1996, IV.8. L-stable, so that vibrations too fast
to be resolved are damped away, and of order five for those that are.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import DenseOutput, OdeSolver
from scipy.linalg import lu_factor, lu_solve

Array = NDArray[np.float64]
Factors = Any  # of scipy.linalg.lu_factor

_ROOT = 6.0**0.5
C = np.array([(4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0])
"""Nodes of the stages."""
A = np.array(
    [
        [(88 - 7 * _ROOT) / 360, (296 - 169 * _ROOT) / 1800, (-2 + 3 * _ROOT) / 225],
        [(296 + 169 * _ROOT) / 1800, (88 + 7 * _ROOT) / 360, (-2 - 3 * _ROOT) / 225],
        [(16 - _ROOT) / 36, (16 + _ROOT) / 36, 1 / 9],
    ]
)
"""Weights of the stages: z_i = h Σ a_ij f(t + c_j h, y + z_j), and y + z_3 is the step's end."""
ERROR = np.array([-13.0 - 7.0 * _ROOT, -13.0 + 7.0 * _ROOT, -1.0]) / 3.0


def _eigensystem() -> tuple[float, complex, Array]:
    """A⁻¹ T = T Λ: the real eigenvalue γ, one of the complex pair, and T (3, 3) = [r, Re u, Im u]."""
    values, vectors = np.linalg.eig(np.linalg.inv(A))
    real, pair = int(np.argmin(np.abs(values.imag))), int(np.argmax(values.imag))
    T = np.column_stack([vectors[:, real].real, vectors[:, pair].real, vectors[:, pair].imag])
    return float(values[real].real), complex(values[pair]), T


GAMMA, PAIR, T = _eigensystem()
T_INVERSE = np.linalg.inv(T)

MOST_ITERATIONS = 7
SLOW = 1e-3  # contraction of Newton's iteration above which the Jacobian is renewed for the next step
SAME_STEP = (0.9, 1.2)  # wanted changes of the step between which it is kept, and with it the factors
LEAST, LARGEST, SAFETY = 0.2, 8.0, 0.9


class RadauIIA(OdeSolver):  # type: ignore[misc]
    """An integrator for SciPy's `solve_ivp` (as ``method=RadauIIA``), or to be stepped by itself.

    Parameters
    ----------
    fun, t0, y0, t_bound, max_step, first_step, rtol, atol : as of SciPy's solvers; y0 real, atol scalar or (n,).
    jac : ∂f/∂y as a function of t and y, (n, n); by forward differences where not given.

    Newton's iteration uses one real and one complex LU factorisation of n unknowns in place of one of 3 n. The error is
    estimated by an embedded formula of order three, filtered through the real factors; the step follows Gustafsson's
    predictive controller.
    """

    # what SciPy's class keeps: its own types are not known
    t: float
    t_old: float
    y: Array
    n: int
    direction: float
    t_bound: float

    def __init__(
        self,
        fun: Callable[[float, Array], Array],
        t0: float,
        y0: Array,
        t_bound: float,
        max_step: float = np.inf,
        rtol: float = 1e-6,
        atol: ArrayLike = 1e-9,
        jac: Callable[[float, Array], Array] | None = None,
        first_step: float | None = None,
        vectorized: bool = False,
    ) -> None:
        super().__init__(fun, t0, y0, t_bound, vectorized)
        self.max_step, self.rtol, self.atol = max_step, max(rtol, 1e-14), np.asarray(atol, dtype=np.float64)
        self._jac = jac
        self.f: Array = self.fun(self.t, self.y)
        self.h_abs = self._initial_step() if first_step is None else abs(first_step)
        # relative to a step's tolerance: what the iteration may leave
        self._newton_tolerance = max(10 * np.finfo(float).eps / self.rtol, min(0.03, self.rtol**0.5))
        self._J: Array = self._jacobian()
        self._fresh = True
        self._factors: tuple[float, Factors, Factors] | None = None
        self._previous: tuple[float, float] | None = None  # step and error of the last accepted step
        self._stages: tuple[float, Array] | None = None  # of the last accepted step: h, Z (3, n)
        self._y_old: Array = self.y

    def _step_impl(self) -> tuple[bool, str | None]:
        rejected = False
        while True:
            smallest = 10.0 * abs(np.nextafter(self.t, self.direction * np.inf) - self.t)
            if self.h_abs < smallest:
                return False, self.TOO_SMALL_STEP
            self.h_abs = min(self.h_abs, self.max_step)
            t_new = self.t + self.h_abs * self.direction
            if self.direction * (t_new - self.t_bound) > 0.0:
                t_new = self.t_bound
            h = t_new - self.t
            solved = self._solve_stages(h)
            if solved is None:
                if self._fresh:
                    self.h_abs = 0.5 * abs(h)
                else:
                    self._renew_jacobian()
                continue
            Z, iterations, contraction = solved
            y_new = self.y + Z[2]
            scale = self._scale(y_new)
            error = self._error(Z, h, scale, rejected)
            safety = SAFETY * (2 * MOST_ITERATIONS + 1) / (2 * MOST_ITERATIONS + iterations)
            change = self._change(h, error, safety)
            if error < 1.0:
                break
            self.h_abs = abs(h) * (change if np.isfinite(error) else LEAST)
            rejected = True
        f_new = self.fun(t_new, y_new)
        self._previous = (abs(h), max(error, 1e-2))
        self._stages = (h, Z)
        self._y_old, self.t, self.y, self.f = self.y, t_new, y_new, f_new
        self._fresh = False
        if rejected:
            change = min(change, 1.0)
        slow = iterations > 2 and contraction > SLOW
        keep = not slow and SAME_STEP[0] <= change <= SAME_STEP[1]
        self.h_abs = abs(h) * (1.0 if keep else change)
        if slow:
            self._renew_jacobian()
        return True, None

    def _solve_stages(self, h: float) -> tuple[Array, int, float] | None:
        """Z (3, n), Newton iterations and their contraction; None where they do not converge."""
        real, pair = self._factorise(h)
        Z = self._guess(h)
        W = T_INVERSE @ Z
        scale = self._scale(self.y)
        contraction, size = 0.0, np.inf
        for iteration in range(1, MOST_ITERATIONS + 1):
            F = np.array([self.fun(self.t + c * h, self.y + z) for c, z in zip(C, Z, strict=True)])
            if not np.isfinite(F).all():
                return None
            F = T_INVERSE @ F
            first = lu_solve(real, F[0] - GAMMA / h * W[0], check_finite=False)
            # Λ couples the rows 1 and 2 of W as the complex number w = W₁ − i W₂
            both = lu_solve(pair, F[1] - 1j * F[2] - PAIR / h * (W[1] - 1j * W[2]), check_finite=False)
            change = np.array([first, both.real, -both.imag])
            last, size = size, float(np.sqrt(np.mean((change / scale) ** 2))) if change.size else 0.0
            W += change
            Z = T @ W
            if iteration > 1 and last > 0.0:
                contraction = size / last
                left = MOST_ITERATIONS - iteration
                if contraction >= 1.0 or size * contraction**left / (1.0 - contraction) > self._newton_tolerance:
                    return None
            if size == 0.0 or (iteration > 1 and contraction / (1.0 - contraction) * size < self._newton_tolerance):
                return Z, iteration, contraction
        return None

    def _guess(self, h: float) -> Array:
        """The last step's collocation polynomial continued; zero in the first step."""
        if self._stages is None:
            return np.zeros((3, self.n))
        before, Z = self._stages
        ahead = _collocation(1.0 + C * h / before) @ Z
        return np.asarray(ahead - Z[2])

    def _error(self, Z: Array, h: float, scale: Array, rejected: bool) -> float:
        real, _ = self._factorise(h)
        embedded = ERROR @ Z / h
        error = lu_solve(real, self.f + embedded, check_finite=False)
        size = float(np.sqrt(np.mean((error / scale) ** 2)))
        if size >= 1.0 and (rejected or self._previous is None):
            error = lu_solve(real, self.fun(self.t, self.y + error) + embedded, check_finite=False)
            size = float(np.sqrt(np.mean((error / scale) ** 2)))
        return size

    def _change(self, h: float, error: float, safety: float) -> float:
        """By what the step is to be multiplied."""
        wanted = safety * max(error, 1e-10) ** -0.25
        if self._previous is not None and error < 1.0:
            before, was = self._previous
            wanted = min(wanted, wanted * abs(h) / before * (was / max(error, 1e-10)) ** 0.25)
        return float(min(LARGEST, max(LEAST, wanted)))

    def _factorise(self, h: float) -> tuple[Factors, Factors]:
        """LU factors of (γ/h) I − J and of its complex partner; kept while h and J are."""
        if self._factors is None or self._factors[0] != h:
            unit = np.eye(self.n)
            self._factors = (
                h,
                lu_factor(GAMMA / h * unit - self._J, check_finite=False),
                lu_factor(PAIR / h * unit - self._J, check_finite=False),
            )
            self.nlu += 2
        return self._factors[1], self._factors[2]

    def _renew_jacobian(self) -> None:
        self._J = self._jacobian()
        self._fresh = True
        self._factors = None

    def _jacobian(self) -> Array:
        self.njev += 1
        if self._jac is not None:
            return np.asarray(self._jac(self.t, self.y), dtype=np.float64)
        columns = np.empty((self.n, self.n))
        for j in range(self.n):
            y = self.y.copy()
            y[j] += np.sqrt(np.finfo(float).eps) * max(abs(y[j]), 1e-5)
            columns[:, j] = (self.fun(self.t, y) - self.f) / (y[j] - self.y[j])
        return columns

    def _scale(self, y_new: Array) -> Array:
        return np.asarray(self.atol + self.rtol * np.maximum(np.abs(self.y), np.abs(y_new)))

    def _initial_step(self) -> float:
        """A step over which y changes by about its tolerance's fourth root (Hairer I, II.4, shortened)."""
        length = abs(self.t_bound - self.t)
        if self.n == 0 or length == 0.0:
            return length
        scale = self.atol + self.rtol * np.abs(self.y)
        speed = float(np.sqrt(np.mean((self.f / scale) ** 2)))
        size = float(np.sqrt(np.mean((self.y / scale) ** 2)))
        step = 0.01 * size / speed if speed > 1e-5 and size > 1e-5 else 1e-6
        further = self.fun(self.t + step * self.direction, self.y + step * self.direction * self.f)
        bend = float(np.sqrt(np.mean(((further - self.f) / scale) ** 2))) / step
        steepest = max(speed, bend)
        second = (0.01 / steepest) ** 0.25 if steepest > 1e-15 else max(1e-6, 1e-3 * step)
        return min(100.0 * step, second, length, self.max_step)

    def _dense_output_impl(self) -> DenseOutput:
        assert self._stages is not None
        h, Z = self._stages
        return _Collocation(self.t_old, self.t, h, self._y_old, Z)


class _Collocation(DenseOutput):  # type: ignore[misc]
    """The step's collocation polynomial, of degree three through its beginning and its stages."""

    def __init__(self, t_old: float, t: float, h: float, y_old: Array, Z: Array) -> None:
        super().__init__(t_old, t)
        self._h, self._y_old, self._Z = h, y_old, Z

    def _call_impl(self, t: ArrayLike) -> Array:
        share = (np.asarray(t) - self.t_old) / self._h
        values = self._y_old + _collocation(np.atleast_1d(share)) @ self._Z
        return np.asarray(values[0] if np.ndim(t) == 0 else values.T)


def _collocation(x: Array) -> Array:
    """Lagrange's polynomials (k, 3) for the nodes 0 (where Z is zero) and C, at x (k,), in parts of the step."""
    nodes = np.concatenate([[0.0], C])
    result = np.ones((len(x), 3))
    for i in range(3):
        for j in range(4):
            if j != i + 1:
                result[:, i] *= (x - nodes[j]) / (nodes[i + 1] - nodes[j])
    return result

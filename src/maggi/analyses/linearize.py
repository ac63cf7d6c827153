"""Linearised equations of a mechanism about a state: an equilibrium, or a steady motion such as rolling straight on.

Deviations are measured from the motion itself, in axes that go along with it: with q* the motion and σ a spin of every
body, chosen such that its velocities are constant in axes that turn back by it (a wheel spins under axes that do not),

    q = q* ∘ exp(δx),   δs = P_s e^{σt} δx,   δν = P e^{σt} (v − v*)

so that of a steady motion the matrix of ``δẏ = A δy`` is constant although positions, and wheels, move on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.tables import FIXED, MotionState
from maggi.model.model import Model
from maggi.system.system import System

from .differences import central_differences
from .ode import Ode, equations_of

Array = NDArray[np.float64]

NULL = 1e-11  # of the largest entry: singular values that are round-off of the differences


@dataclass(frozen=True, eq=False)
class Linearization:
    """``δẏ = A δy`` about a state, y = (s, ν) with p positions and f velocities.

    A (p + f, p + f), 1/s. eigenvalues (p + f,), by falling real part; ignorable positions, such as those of a body in
    the plane that it rolls on, and its heading, are zeros among them.
    mass, damping, stiffness (f, f): ``M δs̈ + C δṡ + K δs = 0``, of holonomic mechanisms; else None.
    positions (n, p), velocities (n, f): small coordinates that one unit of δs moves, or one of δν, at t = 0.
    unsteady: the largest acceleration (m/s²) that is left in the axes going along, 0 about an equilibrium and in steady
        motion; otherwise A holds for the instant only.
    """

    A: Array
    eigenvalues: NDArray[np.complex128]
    mass: Array | None
    damping: Array | None
    stiffness: Array | None
    positions: Array
    velocities: Array
    unsteady: float


def linearize(
    model: Model | System,
    motion: MotionState | None = None,
    t: float = 0.0,
    *,
    coordinates: Array | None = None,
    strategy: str | None = None,
) -> Linearization:
    """The linearised equations about a state.

    Parameters
    ----------
    motion : positions and velocities on the liaisons at time t (s); default: the initial state at t = 0.
    coordinates : (c,) unwrapped joint coordinates there, see `Ode`. strategy : of choosing independent velocities.

    Derivatives are central differences of order six, good to about 1e-11 of the largest entry of A.
    Raises ModelError where the model has no equations; see `Ode`.
    """
    return linearize_at(equations_of(model, motion, t, coordinates=coordinates, strategy=strategy))


def linearize_at(ode: Ode) -> Linearization:
    """The same of equations about their initial state."""
    t, y, p = ode.t0, ode.y0, ode.chart.position_count

    def together(x: Array) -> Array:
        return np.concatenate([ode.f(t, x), ode.evaluation.state.v])

    J = central_differences(together, y, ode.typical(y), 6)
    state = ode.at(t, y).state
    f = len(y) - p
    A, of_velocities = J[: p + f], J[p + f :]
    P_s, P = ode.chart.positions.P, ode.chart.velocities.P
    S_s, S, inertia = state.S_s.copy(), state.S.copy(), ode.evaluation.inertia()
    # what the chart's own coordinates, and axes that spin, add at this instant
    spins, unsteady = _spins(ode.system, state.motion)
    along, turning = _corrections(ode.system, state.motion, spins, ode.chart.table.unknown)
    A = A.copy()
    A[:p, :p] += P_s @ along @ S_s
    A[p:] += P @ turning @ of_velocities
    typical = ode.typical(y)
    eigenvalues = eigenvalues_of(A * typical / typical[:, None])
    mass = damping = stiffness = None
    if p == f:
        mass, damping, stiffness = _second_order(A, inertia)
    return Linearization(A, eigenvalues, mass, damping, stiffness, _all(ode, S_s), _all(ode, S), unsteady)


def eigenvalues_of(A: Array) -> NDArray[np.complex128]:
    """Eigenvalues (n,) by falling real part; those that are zero by the structure of A are exactly zero.

    Null spaces are split off one after the other: in ``[N R]`` with A N = 0 the rest is RᵀA R. Straight to the solver,
    a double zero would come out as the root of the round-off.
    """
    rest, size = A, float(np.abs(A).max(initial=0.0))
    while len(rest):
        _, values, V = np.linalg.svd(rest)
        kept = int(np.sum(values > NULL * size))
        if kept == len(rest):
            break
        R = V[:kept].T
        rest = R.T @ rest @ R
    found = np.zeros(len(A), dtype=np.complex128)
    found[: len(rest)] = np.linalg.eigvals(rest)
    return found[np.lexsort((found.imag, -found.real))]


def _second_order(A: Array, inertia: Array) -> tuple[Array, Array, Array]:
    """M, C, K, given SᵀMS: with δṡ = B δs + G δν the velocities are δν = G⁻¹(δṡ − B δs), put into the second half of A."""
    p = len(A) // 2
    B, G, K, C = A[:p, :p], A[:p, p:], A[p:, :p], A[p:, p:]
    inverse = np.linalg.inv(G)
    H = G @ C @ inverse
    # δs̈ = B δṡ + G (K δs + C G⁻¹(δṡ − B δs)), with the mass matrix in front
    M = inverse.T @ inertia @ inverse
    return M, -M @ (B + H), M @ (H @ B - G @ K)


def _spins(system: System, motion: MotionState) -> tuple[Array, float]:
    """σ (b, 3): the least spin, body axes, under which a rigid body's velocities are constant; and what is not (m/s²).

    In axes that turn back by σ its velocities change by ``v̇ + σ × v`` and ``ω̇ + σ × ω``, which are to vanish.
    """
    bodies, size = system.bodies, system.size
    spins, worst = np.zeros((bodies.kind.size, 3)), 0.0
    for b in range(bodies.kind.size):
        if bodies.kind[b] == FIXED or bodies.floating[b] == 0:
            continue
        o, e = int(bodies.offset[b]), int(bodies.offset[b + 1])
        v, w = motion.v[o : o + 3] / size, motion.v[o + 3 : o + 6]
        rates = np.concatenate([motion.vd[o : o + 3] / size, motion.vd[o + 3 : o + 6]])
        rows = np.vstack([_skew(v), _skew(w)])  # v × σ = v̇
        speed = float(np.abs(rows).max())
        if e - o == 6 and speed > 0.0:
            spins[b] = np.linalg.lstsq(rows, rates, rcond=1e-8)[0]
        left = np.concatenate([rates - rows @ spins[b], motion.vd[o + 6 : e] / size])
        worst = max(worst, float(np.abs(left).max()) * size)
    return spins, worst


def _corrections(system: System, motion: MotionState, spins: Array, unknown: NDArray[np.int64]) -> tuple[Array, Array]:
    """Matrices (u, u) on δx and on δv: from deviations in the chart at the base to those in axes that go along.

    In the chart δd˙ = δv − v* × δθ, δθ˙ = δω − ½ ω* × δθ; going along, δd˙ = δv − ω* × δd − v* × δθ and
    δθ˙ = δω − ω* × δθ.
    """
    bodies = system.bodies
    along, turning = np.zeros((2, system.coordinates, system.coordinates))
    for b in range(bodies.kind.size):
        if bodies.kind[b] == FIXED or bodies.floating[b] == 0:
            continue
        o = int(bodies.offset[b])
        d, theta = slice(o, o + 3), slice(o + 3, o + 6)
        w, spin = _skew(motion.v[theta]), _skew(spins[b])
        along[d, d], along[theta, theta] = spin - w, spin - 0.5 * w
        turning[d, d] = turning[theta, theta] = spin
    chosen = np.ix_(unknown, unknown)
    return along[chosen], turning[chosen]


def _all(ode: Ode, columns: Array) -> Array:
    """Columns on the unknown velocities as columns on all small coordinates (n, k)."""
    out = np.zeros((ode.system.coordinates, columns.shape[1]))
    out[ode.chart.table.unknown] = columns
    return out


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])

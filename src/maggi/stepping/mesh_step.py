"""A full-mesh body through a step: predict, one back-substitution, correct (Theory §5, steps 1, 3, 4 and 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import cg

from maggi.bodies.mesh_body import MeshBody
from maggi.bodies.tables import BodyTable, MotionState
from maggi.elements.products import stiffness_product
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.factor import Factor, factorise
from maggi.linalg.vectors import cross

from .nodal_kernels import correct_nodal, predict_nodal
from .tables import StepVectors

Array = NDArray[np.float64]

# Below this number of freedoms a second thread costs more than it does, many times so on a busy machine.
THREADED = 10_000
PARTS = 16  # of the freedoms, summed separately so that sums do not depend on the number of threads


@dataclass(frozen=True, eq=False)
class Condensation:
    """A body's response to forces at its k attachments, for one step size: the constants of the step (Eq. T12).

    factor of Ŝ = k₁M + k₂K, k₁ = σ + γh·mass, k₂ = βh² + γh·stiffness. Y = PŜ⁻¹B (nd, 6k), Z = Ŝ⁻¹KY,
    Z_D = Ŝ⁻¹DY; W, W_Z, W_D (6k, 6k): Bᵀ of them.
    """

    factor: Factor
    Y: Array
    Z: Array
    Z_D: Array
    W: Array
    W_Z: Array
    W_D: Array


class MassSolver:
    """M x = b by conjugate gradients: a mass matrix is well conditioned, and is needed at the start only."""

    def __init__(self, matrix: sp.bsr_matrix) -> None:
        self._matrix = matrix.tocsr()
        self._preconditioner = sp.diags_array(1.0 / matrix.diagonal())
        self.order = int(matrix.shape[0])

    def solve(self, b: Array) -> Array:
        """See `Factor.solve`; raises RuntimeError where the iteration does not converge."""
        if not b.any():
            return np.zeros_like(b)
        x, info = cg(self._matrix, b, rtol=1e-14, atol=0.0, maxiter=5000, M=self._preconditioner)
        if info != 0 and np.linalg.norm(self._matrix @ x - b) > 1e-10 * np.linalg.norm(b):
            raise RuntimeError("the mass matrix could not be solved with")
        return np.asarray(x)

    def solve_many(self, B: Array) -> Array:
        """See `Factor.solve_many`."""
        return np.column_stack([self.solve(column) for column in B.T]) if B.shape[1] else np.zeros_like(B)


class MeshStep:
    """One meshed body in time: its elastic displacements u, their rates, and the step's constants.

    threaded: whether its passes are worth more than one thread.
    u, ud, udd, a: displacements (m, rad), velocities, true and algorithmic accelerations at the beginning of a
    step; the same with `_next` at its end. Body axes, relative to the frame.
    """

    def __init__(self, body: MeshBody, index: int, table: BodyTable, place: int) -> None:
        self.body = body
        self.index = index
        self._offset = int(table.offset[index])
        width = int(table.offset[index + 1]) - self._offset
        self._start, self._end = place, place + width  # in vectors of the step
        self._elastic_part = slice(self._offset + 6, self._offset + width)  # in motions
        self._block = slice(int(table.block[index]), int(table.block[index + 1]))
        size = body.size
        self.u, self.ud, self.udd, self.a, self.a_previous = (np.zeros(size) for _ in range(5))
        self.u_next, self.ud_next, self.udd_next, self.a_next = (np.zeros(size) for _ in range(4))
        self.free = np.zeros(size)
        self.correction = 0.0
        self._squares = np.zeros(PARTS)
        self._force, self._elastic, self._frame = np.zeros(size), np.zeros(size), np.zeros(6)
        self.threaded = body.size >= THREADED
        self._B_transposed = body.B.T.tocsr()
        self._solve_J6 = np.linalg.inv(body.J6)
        self._kept: dict[float, Condensation] = {}
        self.constants = self._condense(GeneralizedAlpha(0.0, 0.0, 0.0, 0.0, 0.0, 1.0), None)

    # constants of a step size

    def prepare(self, c: GeneralizedAlpha, W: Array, W_Z: Array, W_D: Array) -> bool:
        """Constants for a step, into the small system's blocks; returns whether a factorisation was made.

        Those of the last few step sizes are kept, so that changing back costs nothing.
        """
        fresh = c.h not in self._kept
        if fresh:
            if len(self._kept) == 3:
                self._kept.pop(next(iter(self._kept)))
            k1, k2 = self._weights(c)
            # one 3×3-block pattern in most cases; the sum copes with others
            factor = factorise(k1 * self.body.inertia.matrix + k2 * self.body.K)
            self._kept[c.h] = self._condense(c, factor)
        self._use(self._kept[c.h], W, W_Z, W_D)
        return fresh

    def prepare_start(self, W: Array) -> None:
        """Constants of the instant (h = 0): Ŝ = M."""
        c = GeneralizedAlpha(0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
        self._use(self._condense(c, MassSolver(self.body.inertia.matrix)), W, np.zeros(W.size), np.zeros(W.size))

    def _weights(self, c: GeneralizedAlpha) -> tuple[float, float]:
        d = self.body.damping
        return c.sigma + c.gamma * c.h * d.mass, c.beta * c.h**2 + c.gamma * c.h * d.stiffness

    def _condense(self, c: GeneralizedAlpha, factor: Factor | None) -> Condensation:
        body = self.body
        shape = (body.size, body.B.shape[1])
        if factor is None or shape[1] == 0:
            none, small = np.zeros(shape), np.zeros((shape[1], shape[1]))
            return Condensation(factor or _NoFactor(), none, none, none, small, small, small)
        Y = self._project(factor.solve_many(body.B.toarray()))
        W = body.B.T @ Y
        Z, Z_D = np.zeros(shape), np.zeros(shape)
        if c.h > 0.0:
            Z = self._project(factor.solve_many(np.ascontiguousarray(body.K @ Y)))
            k1, k2 = self._weights(c)
            d = body.damping
            Z_D = d.mass * (Y - k2 * Z) / k1 + d.stiffness * Z
        return Condensation(
            factor,
            np.ascontiguousarray(Y),
            np.ascontiguousarray(Z),
            np.ascontiguousarray(Z_D),
            0.5 * (W + W.T),
            body.B.T @ Z,
            body.B.T @ Z_D,
        )

    def _use(self, constants: Condensation, W: Array, W_Z: Array, W_D: Array) -> None:
        self.constants = constants
        width = self._end - self._start
        for target, block in ((W, constants.W), (W_Z, constants.W_Z), (W_D, constants.W_D)):
            square = target[self._block].reshape(width, width)
            square[:] = 0.0
            square[6:, 6:] = block

    def frame_compliance(self, c: GeneralizedAlpha, W: Array) -> None:
        """The frame's own block, about the deformed shape: (σ J₆(c))⁻¹. Zero where the frame is prescribed."""
        if not self.body.floating:
            return
        S, J = self.body.inertia.frame_inertia(self.u_next)
        M6 = np.zeros((6, 6))
        M6[:3, :3] = self.body.inertia.mass * np.eye(3)
        M6[:3, 3:] = np.array([[0.0, S[2], -S[1]], [-S[2], 0.0, S[0]], [S[1], -S[0], 0.0]])
        M6[3:, :3] = M6[:3, 3:].T
        M6[3:, 3:] = J
        width = self._end - self._start
        W[self._block].reshape(width, width)[:6, :6] = np.linalg.inv(c.sigma * M6)

    # a step

    def predict(self, c: GeneralizedAlpha, linear: float) -> None:
        """Newmark's state with predicted accelerations (the same formulas as `kernels.predict`)."""
        predict_nodal(
            c,
            linear,
            self.u,
            self.ud,
            self.udd,
            self.a,
            self.a_previous,
            self.u_next,
            self.ud_next,
            self.udd_next,
            self.a_next,
        )

    def solve_free(self, c: GeneralizedAlpha, motion: MotionState, gravity: Array, base: Array) -> None:
        """Residual at the end of the step without forces at the attachments, and the one back-substitution.

        Sets `base` on the body's small coordinates: the frame's residual, and the free elastic increments Bᵀx
        with ``x = −PŜ⁻¹Pᵀ(M a + K u + D u̇)``.
        """
        body = self.body
        frame, nodal = self._frame, self._force
        self._inertia_force(motion, gravity)
        d = body.damping
        if d.mass:
            nodal += d.mass * (body.inertia.matrix @ self.ud_next)
        strained = self.u_next + d.stiffness * self.ud_next if d.stiffness else self.u_next
        stiffness_product(body.K, strained, self._elastic)
        nodal += self._elastic
        if body.floating:
            nodal -= body.C @ (self._solve_J6 @ (body.Phi.T @ nodal))
        self.free = self.constants.factor.solve(nodal)
        np.negative(self.free, out=self.free)
        if body.floating:
            self.free -= body.Phi @ (self._solve_J6 @ (body.C.T @ self.free))
        base[self._start : self._start + 6] = frame
        base[self._start + 6 : self._end] = self._B_transposed @ self.free

    def _inertia_force(self, motion: MotionState, gravity: Array) -> None:
        o = self._offset
        v, w = motion.v[o : o + 3], motion.v[o + 3 : o + 6]
        a_O = motion.vd[o : o + 3] + cross(w, v) - motion.rotation[self.index].T @ gravity
        self.body.inertia.residual(
            a_O,
            w,
            motion.vd[o + 3 : o + 6],
            self.u_next,
            self.ud_next,
            self.udd_next,
            self._force,
            self._frame,
        )

    def correct(self, c: GeneralizedAlpha, force: Array, position_force: Array, velocity_force: Array) -> None:
        """Nodal increments from the free ones and the forces at the attachments, (n,) each (step 6)."""
        k = self.constants
        part = slice(self._start + 6, self._end)
        correct_nodal(
            c,
            self.free,
            k.Y,
            k.Z,
            k.Z_D,
            force[part],
            position_force[part],
            velocity_force[part],
            self.u_next,
            self.ud_next,
            self.udd_next,
            self.a_next,
            self._squares,
        )
        self.correction = float(np.sqrt(self._squares.sum() / self.u.size))

    def jump(self) -> float:
        """How much algorithmic accelerations change in the step, root mean square (m/s²): what its local error is of."""
        return float(np.linalg.norm(self.a_next - self.a) / np.sqrt(self.a.size))

    def rescale(self, ratio: float) -> None:
        """Algorithmic accelerations for steps `ratio` times as long: a = v̇ + O(h)."""
        self.a = self.udd + ratio * (self.a - self.udd)

    def accept(self) -> None:
        """Make the end of the step the present."""
        self.a_previous, self.a, self.a_next = self.a, self.a_next, self.a_previous
        self.u, self.u_next = self.u_next, self.u
        self.ud, self.ud_next = self.ud_next, self.ud
        self.udd, self.udd_next = self.udd_next, self.udd

    def settle(self) -> None:
        """Project u and u̇ on the mean axes again: round-off lets Cᵀu drift."""
        if self.body.floating:
            self.u = self._project(self.u)
            self.ud = self._project(self.ud)

    def write_small(self, motion: MotionState, vectors: StepVectors) -> None:
        """The attachments' (d, θ), rates and accelerations as elastic coordinates of the present."""
        part = slice(self._start + 6, self._end)
        motion.e[self._elastic_part] = self._B_transposed @ self.u
        vectors.nu[part] = self._B_transposed @ self.ud
        vectors.nud[part] = self._B_transposed @ self.udd
        vectors.a[part] = self._B_transposed @ self.a

    def _project(self, x: Array) -> Array:
        """P x: what is left of nodal fields without the rigid motion that mean axes put into the frame (Eq. T6)."""
        if not self.body.floating:
            return x
        return np.asarray(x - self.body.Phi @ (self._solve_J6 @ (self.body.C.T @ x)))

    # energies of the present

    def dissipation(self) -> float:
        """Power (W) that the body's damping takes at the end of the step."""
        d = self.body.damping
        if not (d.mass or d.stiffness):
            return 0.0
        power = 0.0
        if d.mass:
            power += d.mass * float(self.ud_next @ (self.body.inertia.matrix @ self.ud_next))
        if d.stiffness:
            stiffness_product(self.body.K, self.ud_next, self._elastic)
            power += d.stiffness * float(self.ud_next @ self._elastic)
        return power

    def energies(self, motion: MotionState, gravity: Array) -> tuple[float, float, float]:
        """Kinetic, strain and gravity energy (J) now."""
        o = self._offset
        inertia = self.body.inertia
        kinetic = inertia.kinetic_energy(motion.v[o : o + 3], motion.v[o + 3 : o + 6], self.u, self.ud)
        stiffness_product(self.body.K, self.u, self._elastic)
        strain = 0.5 * float(self.u @ self._elastic)
        S, _ = inertia.frame_inertia(self.u)
        b = self.index
        position = inertia.mass * motion.origin[b] + motion.rotation[b] @ S
        return kinetic, strain, -float(gravity @ position)


class _NoFactor:
    """Stands where nothing has been factorised yet."""

    order = 0

    def solve(self, b: Array) -> Array:
        raise RuntimeError("no step size has been prepared")

    def solve_many(self, B: Array) -> Array:
        raise RuntimeError("no step size has been prepared")

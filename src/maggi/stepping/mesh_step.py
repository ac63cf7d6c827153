"""A full-mesh body through a step: predict, one back-substitution, correct (Theory §5, steps 1, 3, 4 and 6)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.mesh_body import MeshBody
from maggi.bodies.mesh_inertia import InertiaForces
from maggi.bodies.tables import BodyTable, MotionState
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.lanes import WIDTH
from maggi.linalg.shared import crew

from .condensation import Condensation, Condensations
from .damping_power import DampingPower
from .mesh_kernels import (
    add_fields,
    correct,
    distance,
    frame_compliance,
    frame_drive,
    inner_product,
    respond,
    write_attachments,
)
from .nodal_kernels import Columns, NodalStep, coefficients, correct_nodal, predict_nodal
from .tables import StepVectors

Array = NDArray[np.float64]

# Below this number of freedoms a second thread costs more than it does, many times so on a busy machine.
THREADED = 8_000
PARTS = 16  # of the freedoms, summed separately so that sums do not depend on the number of threads


@dataclass(frozen=True, eq=False)
class Passes:
    """What is done on the fields of a step again and again: its fields, with the entry of their correction, and the inertia forces
    at its end, into `force`.
    """

    step: NodalStep
    correction: int
    inertia: InertiaForces


class MeshStep:
    """One meshed body in time: its elastic displacements u, their rates, and the step's constants.

    shared: what it shares with bodies that are the same. threaded: whether its passes are worth more than one thread.
    u, ud, udd, a: displacements (m, rad), velocities, true and algorithmic accelerations at the beginning of a
    step; the same with `_next` at its end, `a_next` being that of the step before until there is a prediction. Body
    axes, relative to the frame. force (nd,): the residual without forces at the attachments; solution (nd,): Ŝ⁻¹ of it.
    The two halves of the fields change places with every step.
    """

    def __init__(
        self,
        body: MeshBody,
        index: int,
        table: BodyTable,
        place: int,
        shared: Condensations | None = None,
        force: Array | None = None,
    ) -> None:
        self.body = body
        self.index = index
        self.shared = shared or Condensations(body)
        self._offset = int(table.offset[index])
        width = int(table.offset[index + 1]) - self._offset
        self._start, self._end = place, place + width  # in vectors of the step
        self._elastic_part = slice(self._offset + 6, self._offset + width)  # in motions
        self._block = slice(int(table.block[index]), int(table.block[index + 1]))
        size, places = body.size, -(-body.size // WIDTH) * WIDTH
        fields = np.zeros((2, 4, places))
        self.u, self.ud, self.udd, self.a = fields[0, :, :size]
        self.u_next, self.ud_next, self.udd_next, self.a_next = fields[1, :, :size]
        self.force = np.zeros(size) if force is None else force
        self._solution = np.zeros(places)
        self.solution = self._solution[:size]
        self.correction = self.deflection = 0.0
        self._frame = np.zeros(6)
        self._drive = np.zeros((3, 3))
        self.damping = DampingPower(body) if body.damping.mass or body.damping.stiffness else None
        self.threaded = body.size >= THREADED
        self.constants = Condensation.none(body)
        self._linear, self._forces = np.zeros(1), np.zeros((4, width - 6))
        self._loaded = np.zeros((width - 6) // 6, np.int64)
        self._relative, self._implied = np.zeros(2), np.zeros(2)
        self._columns = Columns.of(body.B)
        self._product = body.K.product(self.solution, self.force)
        self._method: GeneralizedAlpha | None = None
        self._prediction, self._gain = np.zeros((3, 4)), np.zeros(4)
        self._sizes = np.zeros((PARTS, 2))
        self._fields, self._present = fields, 0  # the half of the fields that is the present
        self._passes: tuple[Passes, Passes] | None = None

    @property
    def _ahead(self) -> Passes:
        """The passes of the step from the present."""
        if self._passes is None:
            self._passes = self._between(*self._fields), self._between(*self._fields[::-1])
        return self._passes[self._present]

    def _between(self, now: Array, following: Array) -> Passes:
        """The passes for a step between these fields, (4, N) each."""
        u, ud, udd, _ = following[:, : self.body.size]
        step = NodalStep(
            self._linear,
            self._prediction,
            self._gain,
            now,
            following,
            self._solution,
            self._implied,
            self._columns,
            self.constants.responses,
            np.array(self.constants.damping),
            self._forces,
            self._loaded,
            self._sizes,
        )
        axes = self.body.axes if self.body.floating else None
        forces = self.body.inertia.forces(u, ud, udd, self.force, self._relative, axes)
        return Passes(step, correct_nodal.entry(step), forces)

    # constants of a step size

    def prepare(self, c: GeneralizedAlpha, W: Array, W_Z: Array, W_D: Array) -> bool:
        """Constants for a step, into the small system's blocks; returns whether a factorisation was made."""
        fresh = not self.shared.has(c)
        self._use(self.shared.of(c), W, W_Z, W_D)
        return fresh

    def release(self) -> None:
        """Let go of the constants in use, so that they and those which will replace them need not be held together."""
        self.constants, self._passes = Condensation.none(self.body), None

    def prepare_start(self, W: Array) -> None:
        """Constants of the instant (h = 0): Ŝ = M."""
        self._use(self.shared.at_rest(), W, np.zeros(W.size), np.zeros(W.size))

    def _use(self, constants: Condensation, W: Array, W_Z: Array, W_D: Array) -> None:
        self.constants, self._passes = constants, None
        self._leave_stiffness_to_the_factor()
        width = self._end - self._start
        for target, block in ((W, constants.W), (W_Z, constants.W_Z), (W_D, constants.W_D)):
            square = target[self._block].reshape(width, width)
            square[:] = 0.0
            square[6:, 6:] = block

    def _leave_stiffness_to_the_factor(self) -> None:
        """What of u and u̇ is added to the accelerations that inertia forces on the freedoms are found for, and to the solution.

        For damping by mass; and ``K s = (Ŝ s − k₁M s)/k₂``, so that Ŝ⁻¹ of it takes no product with K where a body is stiff
        for the step. Elsewhere s/k₂ is so large beside what remains that its digits are lost.
        """
        (k1, k2), d = self.constants.weights, self.body.damping
        self._relative[:], self._implied[:] = (0.0, d.mass), 0.0
        if self.constants.stiff:
            self._relative -= k1 / k2, k1 / k2 * d.stiffness
            self._implied[:] = 1.0 / k2, d.stiffness / k2

    def _use_method(self, c: GeneralizedAlpha) -> None:
        if c != self._method:
            self._method = c
            self._prediction[:], self._gain[:] = coefficients(c)

    # a step

    def predict(self, c: GeneralizedAlpha, linear: float) -> None:
        """Newmark's state with predicted accelerations (the same formulas as `prediction.predict`)."""
        self._use_method(c)
        self._linear[0] = linear
        predict_nodal(self._ahead.step, PARTS)

    def residual(self, c: GeneralizedAlpha, motion: MotionState, gravity: Array, base: Array, W: Array) -> None:
        """Residual at the end of the step without forces at the attachments, ``force = PᵀM a + K s + mass·PᵀM u̇``.

        s = u + stiffness·u̇; K s and M u̇ have no part along rigid motions: KΦ = 0, and Cᵀu̇ = 0. Where the body is stiff,
        K s is left to `respond`. Sets the frame's residual in `base`, and in W the frame's own block about the deformed
        shape, ``(σ J₆(c))⁻¹``, zero where the frame is prescribed.
        """
        body, o = self.body, self._offset
        frame_drive(motion, gravity, self.index, o, self._drive)
        S, J = self._ahead.inertia.residual(self._drive, self._frame)
        base[self._start : self._start + 6] = self._frame
        if not self.constants.stiff:
            self.solution[:] = 0.0
            add_fields(1.0, self.u_next, body.damping.stiffness, self.ud_next, self.solution)
            self._product.add()
        if body.floating:
            width = self._end - self._start
            frame_compliance(c.sigma, body.inertia.mass, S, J, W[self._block].reshape(width, width))

    def respond(self, base: Array) -> None:
        """From the solution the free elastic increments Bᵀδ, ``δ = −P Ŝ⁻¹ force``, into `base`."""
        respond(self._ahead.step, self.body.axes, int(self.body.floating), base[self._start + 6 : self._end])

    def correct(self, c: GeneralizedAlpha, force: Array, position_force: Array, velocity_force: Array) -> None:
        """Nodal increments from the free ones and the forces at the attachments, (n,) each (step 6)."""
        part, ahead = slice(self._start + 6, self._end), self._ahead
        self._use_method(c)
        forces = force[part], position_force[part], velocity_force[part]
        total, self.deflection = correct(ahead.step, ahead.correction, crew(), *forces)
        self.correction = math.sqrt(total / self.u.size)

    def jump(self) -> float:
        """How much algorithmic accelerations change in the step, root mean square (m/s²): what its local error is of."""
        return distance(self.a_next, self.a) / float(np.sqrt(self.a.size))

    def rescale(self, ratio: float) -> None:
        """Algorithmic accelerations for steps `ratio` times as long: a = v̇ + O(h)."""
        self.a[:] = self.udd + ratio * (self.a - self.udd)

    def accept(self) -> None:
        """Make the end of the step the present.

        Accelerations are put on the mean axes again: what round-off takes from them is extrapolated from step to
        step, and no residual shows it. (Every tenth step only, a hinged bar of 3,000 freedoms no longer converges after 160.)
        """
        if self.body.floating:
            self.body.axes.project(self.a_next)
        self.u, self.u_next = self.u_next, self.u
        self.ud, self.ud_next = self.ud_next, self.ud
        self.udd, self.udd_next = self.udd_next, self.udd
        self.a, self.a_next = self.a_next, self.a
        self._present = 1 - self._present

    def settle(self) -> None:
        """Project u and u̇ on the mean axes again: round-off lets Cᵀu drift."""
        if self.body.floating:
            self.body.axes.project(self.u)
            self.body.axes.project(self.ud)

    def write_small(self, motion: MotionState, vectors: StepVectors) -> None:
        """The attachments' (d, θ), rates and accelerations as elastic coordinates of the present."""
        part = slice(self._start + 6, self._end)
        # accelerations are predicted as the nodes' are, by the last difference
        write_attachments(
            self._ahead.step,
            motion.e[self._elastic_part],
            vectors.nu[part],
            vectors.nud[part],
            vectors.a[part],
            vectors.a_differences[0, part],
        )

    def energies(self, motion: MotionState, gravity: Array) -> tuple[float, float, float]:
        """Kinetic, strain and gravity energy (J) now; costs a product with K."""
        self.solution[:], self.force[:] = self.u, 0.0
        self._product.add()
        strain = 0.5 * inner_product(self.u, self.force)
        o = self._offset
        inertia = self.body.inertia
        kinetic = inertia.kinetic_energy(motion.v[o : o + 3], motion.v[o + 3 : o + 6], self.u, self.ud)
        S = inertia.S0 + self.body.axes.C.transposed_times(self.u)[:3]
        b = self.index
        position = inertia.mass * motion.origin[b] + motion.rotation[b] @ S
        return kinetic, strain, -float(gravity @ position)

"""Everything a compiled step reads and writes, as tables of arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.motions import MotionTable
from maggi.bodies.tables import Array, AttachmentState, BodyTable, IntArray, MotionState
from maggi.forces.tables import ForceTable
from maggi.liaisons.tables import LiaisonState, LiaisonTable
from maggi.linalg.table import Table
from maggi.projection.tree_tables import JointPoses, Tree, TreeWork

Number = TypeVar("Number", np.float64, np.int64)

# What stands where in SmallSystem.links: the stages of a step, and what only some mechanisms need, 0 where not.
EVALUATE, REFRESH, CORRECT, ACCEPT_STEP, PREDICT_STEP = 0, 1, 2, 3, 4
PRESCRIBE, BLOCK_COMPLIANCES, BLOCK_FORCES, BLOCK_POWER, ROWS, LOADS = 5, 6, 7, 8, 9, 10
SPRING_COEFFICIENTS, ADD_SPRINGS, SPRING_FORCES, SHOW, LINKS = 11, 12, 13, 14, 15

HIGHEST_ORDER = 5  # of the polynomials that a step is predicted by, and so the number of differences kept

# StepWork.flags: whether this is a step's first correction; the highest order that the prediction may have; how many steps in a
# row could have been twice as long; the order that would have been best for the last steps; how many times in a row the same rows have depended on
# others.
FIRST, ORDER, CALM, BEST, STEADY = 0, 1, 2, 3, 4

# StepWork.numbers: sine of the smallest angle between rows; powers (W): that prescribed frames give, that damping of Ritz
# bodies takes; the local error that a step may make, 0 for steps of one size, and the one that the last has made; what
# dependent rows are off by.
SINE, GIVEN_POWER, TAKEN_POWER, BOUND, ERROR, LOOSE = 0, 1, 2, 3, 4, 5

# Instant.counts: what the last step has cost, whether rows repeat each other. Record.places: how many instants are kept, the nominal step that the
# next one is, how many steps there are between kept instants (0 to keep none), the last nominal step, which is kept in any case.
ITERATIONS, REPEATED = 0, 1
KEPT, NUMBER, EVERY, LAST = 0, 1, 2, 3


@dataclass(frozen=True, eq=False)
class SmallSystem(Table):
    """The constants of the small system: all rigid and Ritz bodies, all attachments, all liaisons and forces.

    bodies, all_liaisons: as in `System`, in the frames of the model. step_bodies: the same with the frames of the tree's
    bodies in the joints that carry them: frame_rotation (b, 3, 3), frame_position (b, 3) in the body's own frame.
    closures: the liaisons' rows that are no joints of the tree.
    links (LINKS,): addresses of the stages. floor (b,): see `System.inertia_floor`.
    joint_row_start (x + 1,), joint_row (j,), joint_end (j,): the rows of `all_liaisons` that make the joint of each tree
    body, and the end of the row on that body. closure_row (r,): the rows of `all_liaisons` that closures are.
    joint_turn (c, 3): of coordinates that a tree's joint counts: number, tree body, sign.
    """

    bodies: BodyTable
    step_bodies: BodyTable
    frame_rotation: Array
    frame_position: Array
    motions: MotionTable
    closures: LiaisonTable
    all_liaisons: LiaisonTable
    forces: ForceTable
    tree: Tree
    floor: Array
    links: IntArray
    joint_row_start: IntArray
    joint_row: IntArray
    joint_end: IntArray
    closure_row: IntArray
    joint_turn: IntArray


@dataclass(frozen=True, eq=False)
class Instant(Table):
    """A run at one instant, in the frames of the model: what rows of results are made of.

    now, attachments, rows: motion, attachments and all liaison rows. multipliers (r,): λ (Eq. T11); unique by themselves
    where no rows repeat each other. active (r,): 0 for rows that are dependent by geometry.
    power (3,): energy stored in springs (J), power of dampers and of loads (W). work (4,): work of drivers, loads and
    prescribed frames and energy dissipated (J), and their present rates (W).
    scales (5,): the mechanism's size (m), speed (m/s), acceleration (m/s²), and the least of the last two.
    residuals (3,): see `scaled_residuals`. counts (2,): see above. flat: the memory of all of these, one behind the other.
    """

    now: MotionState
    attachments: AttachmentState
    rows: LiaisonState
    multipliers: Array
    active: IntArray
    power: Array
    work: Array
    scales: Array
    residuals: Array
    counts: IntArray
    flat: Array


@dataclass(frozen=True, eq=False)
class Record(Table):
    """Instants that were kept on the way, as many as there is room for.

    instants (k, w): the memory of an `Instant` each; steps (k,): which nominal steps they end. places (4,): see above.
    """

    instants: Array
    steps: IntArray
    places: IntArray

    @property
    def kept(self) -> int:
        """How many instants there are."""
        return int(self.places[KEPT])

    @property
    def room(self) -> int:
        """For how many more there is room."""
        return len(self.steps) - self.kept

    def keep(self, instant: Instant, step: int) -> None:
        """Keep an instant that ends a nominal step."""
        k = self.kept
        self.instants[k] = instant.flat
        self.steps[k] = step
        self.places[KEPT] = k + 1

    def check_room(self, steps: int) -> None:
        """Raises ValueError where so many more steps would end with more instants than there is room for: kernels do not look."""
        number, every, last = self.places[NUMBER], self.places[EVERY], self.places[LAST]
        if every == 0:
            return
        until = number + steps
        due = until // every - number // every + (number < last <= until and last % every != 0)
        if due > self.room:
            raise ValueError(f"{due} instants are to be kept, and there is room for {self.room}")

    def last_step(self) -> int:
        """The nominal step of the last instant, −1 where there is none."""
        return int(self.steps[self.kept - 1]) if self.kept else -1

    def values(self, instant: Instant, array: NDArray[Number]) -> NDArray[Number]:
        """What one of the arrays of `instant` was at every instant kept (k, …), a view."""
        first = (array.__array_interface__["data"][0] - instant.flat.__array_interface__["data"][0]) // 8
        part = self.instants[: self.kept, first : first + array.size]
        return part.view(array.dtype).reshape(self.kept, *array.shape)

    def clear(self) -> None:
        """Forget them."""
        self.places[KEPT] = 0


@dataclass(frozen=True, eq=False)
class StepVectors(Table):
    """Vectors that a step carries. m velocities ν in relative coordinates, r closures.

    a, a_next (m,): algorithmic accelerations. a_differences (k, m): backward differences ∇a, ∇²a … of the steps before, as
    many as there have been steps of this size. nu, nu_next, nud, nud_next (m,): velocities ν and their
    true rates. increment (m,): Δq of the step. multipliers, multipliers_next, multipliers_previous (r,): λ of closures.
    shift_next, rate_shift_next (m,): sums of W Aᵀπ, W Aᵀκ over this step's corrections, by which closures are met; shift,
    rate_shift (m,): over the last's; shift_differences, rate_shift_differences (k, m): backward differences of those.
    All empty where there are full meshes, whose shifts are not predicted.
    elastic (b, 2): the largest |e| and |ë| of each body lately. contraction (2,): of the iteration, and the
    number of steps since it was last measured.
    """

    a: Array
    a_next: Array
    a_differences: Array
    nu: Array
    nu_next: Array
    nud: Array
    nud_next: Array
    increment: Array
    multipliers: Array
    multipliers_next: Array
    multipliers_previous: Array
    shift: Array
    shift_next: Array
    shift_differences: Array
    rate_shift: Array
    rate_shift_next: Array
    rate_shift_differences: Array
    elastic: Array
    contraction: Array


@dataclass(frozen=True, eq=False)
class StepState(Table):
    """The state of a run in the frames of the step, advanced in place.

    accepted: of blocks, their poses and elastic coordinates at the beginning of the step; joints: poses of the tree's
    joints then. scales (5,), power (3,), work (4,): those of the run's `Instant`. motion, attachments, rows, joints_next: all bodies, what closures look at, and the rest, at its end.
    """

    accepted: MotionState
    joints: JointPoses
    motion: MotionState
    joints_next: JointPoses
    attachments: AttachmentState
    rows: LiaisonState
    vectors: StepVectors
    scales: Array
    power: Array
    work: Array


@dataclass(frozen=True, eq=False)
class StepWork(Table):
    """Scratch arrays of the step; m velocities, r closures, q of them with springs, n small coordinates.

    W (flat blocks): compliances Ŝ⁻¹ of blocks. elastic (flat, as `BodyTable.m`): those of Ritz bodies' coordinates alone,
    for the present step size. W_Z, W_D (flat blocks): B̂ᵀŜ⁻¹KŜ⁻¹B̂ of mesh bodies and the same with D.
    L (skyline), pivot (q,), scale (r,). active (r,): 0 for rows that are dependent by geometry; kept (q,): 0 for rows that are left out for now, kept_before (q,); metric (flat blocks),
    metric_scale (r,): what that is judged in, see `range_space`.
    base (m,): mesh bodies: frame residual, and the free elastic increments. accounted (m,): liaison forces that
    mesh bodies' increments already contain. position_force, velocity_force (m,): accumulated Aᵀπ, Aᵀκ.
    given (n,): forces Aᵀλ − Q on bodies; loads (n,): Q. stiffness, on_joints (m,): of springs on single free motions, and
    their forces; unsprung (m,): zeros in the place of `stiffness`. shift_before, rate_shift_before (m,): what was predicted of `shift`, `rate_shift`. The rest are
    vectors of one iteration; product (n,): room for kernels. method (6,): coefficients of the step;
    flags (5,), numbers (6,): see above. misses (HIGHEST_ORDER + 1,): what predictions of each order were off by lately.
    """

    tree: TreeWork
    W: Array
    elastic: Array
    W_Z: Array
    W_D: Array
    L: Array
    pivot: Array
    scale: Array
    active: IntArray
    kept: IntArray
    kept_before: IntArray
    metric: Array
    metric_scale: Array
    base: Array
    accounted: Array
    position_force: Array
    velocity_force: Array
    given: Array
    loads: Array
    stiffness: Array
    unsprung: Array
    on_joints: Array
    force: Array
    delta: Array
    shift: Array
    rate_shift: Array
    shift_before: Array
    rate_shift_before: Array
    step: Array
    pi: Array
    kappa: Array
    phi: Array
    rates: Array
    product: Array
    method: Array
    flags: IntArray
    numbers: Array
    misses: Array

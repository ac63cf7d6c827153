"""Everything a compiled step reads and writes, as named tuples of arrays."""

from __future__ import annotations

from dataclasses import dataclass

from maggi.bodies.motions import MotionTable
from maggi.bodies.tables import Array, AttachmentState, BodyTable, IntArray, MotionState
from maggi.forces.tables import ForceTable
from maggi.liaisons.tables import LiaisonState, LiaisonTable
from maggi.linalg.table import Table


@dataclass(frozen=True, eq=False)
class SmallSystem(Table):
    """The constants of the small system: all rigid and Ritz bodies, all attachments, all liaisons and forces."""

    bodies: BodyTable
    motions: MotionTable
    liaisons: LiaisonTable
    forces: ForceTable


@dataclass(frozen=True, eq=False)
class StepVectors(Table):
    """What a step carries beside motions and rows. n small coordinates, r rows.

    a, a_next, a_previous (n,): algorithmic accelerations. increment (n,): Δq of the step. multipliers,
    multipliers_next, multipliers_previous (r,): λ (Eq. T11). applied (n,): forces Aᵀλ − Q in small coordinates.
    work (4,): work of drivers, loads and prescribed frames and energy dissipated (J), and their present rates (W).
    power (3,): energy stored in springs (J), power of dampers and of loads (W), at the step's end.
    scales (5,): the mechanism's size (m), speed (m/s), acceleration (m/s²), and the least of the last two.
    elastic (b, 2): the largest |e| and |ë| of each body lately. contraction (2,): of the iteration, and the
    number of steps since it was last measured.
    """

    a: Array
    a_next: Array
    a_previous: Array
    increment: Array
    multipliers: Array
    multipliers_next: Array
    multipliers_previous: Array
    applied: Array
    work: Array
    power: Array
    scales: Array
    elastic: Array
    contraction: Array


@dataclass(frozen=True, eq=False)
class StepState(Table):
    """The state of a run, advanced in place: motions at the beginning and the end of the step, the end's
    attachments and liaison rows, and the rest.

    The kernels take these parts as arguments of their own: the compiler copies a tuple whole at every access, so
    nested ones cost it minutes.
    """

    now: MotionState
    next: MotionState
    attachments: AttachmentState
    rows: LiaisonState
    vectors: StepVectors


@dataclass(frozen=True, eq=False)
class StepWork(Table):
    """Scratch arrays of the step. W (flat blocks): compliances Ŝ⁻¹ of bodies on their small coordinates. elastic (flat,
    as `BodyTable.m`): those of Ritz bodies' coordinates alone, for the present step size.

    W_Z, W_D (flat blocks): B̂ᵀŜ⁻¹KŜ⁻¹B̂ of mesh bodies and the same with D. L (skyline), pivot, scale (r,). active (r,): 0 for rows that are
    dependent by geometry; metric (flat blocks), metric_scale (r,): what that is judged in, see `range_space`.
    base (n,): mesh bodies: frame residual, and the free elastic increments. accounted (n,): liaison forces that
    mesh bodies' increments already contain. position_force, velocity_force (n,): accumulated Aᵀπ, Aᵀκ.
    spring_J, spring_W (s, n), spring_border (s, r), spring_inverse (s, s), spring_force (s,): see `springs`.
    """

    W: Array
    elastic: Array
    W_Z: Array
    W_D: Array
    L: Array
    pivot: Array
    scale: Array
    base: Array
    accounted: Array
    position_force: Array
    velocity_force: Array
    residual: Array
    loads: Array
    delta: Array
    shift: Array
    rate_shift: Array
    vector: Array
    pi: Array
    kappa: Array
    phi: Array
    active: IntArray
    metric: Array
    metric_scale: Array
    spring_J: Array
    spring_W: Array
    spring_border: Array
    spring_inverse: Array
    spring_force: Array

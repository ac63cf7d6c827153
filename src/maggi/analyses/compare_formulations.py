"""One state, five formulations: accelerations and joint forces of Maggi's equations against four other ways to them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from maggi.bodies.mesh_body import MeshBody
from maggi.bodies.tables import MotionState
from maggi.formulations import FORMULATIONS, Answer, Question, question_at
from maggi.model.bodies import CraigBampton, ElasticBody
from maggi.model.model import Model
from maggi.projection.maggi import accelerations, liaison_forces, project
from maggi.system.build import build_system
from maggi.system.system import System

from .first_instant import frames_at_start
from .initial import initial_motion

Array = NDArray[np.float64]

AGREEMENT = 1e-9
"""Relative difference, times the condition of S, up to which formulations agree: far above round-off, far below a mistake."""

FLOORED = 1e-7
"""The same where bodies were given inertia, 1e-6 of what their mass could have: their own turns are known a million times less well."""

NO_INERTIA = 1e-11
"""An admitted motion counts as one without inertia where its kinetic energy is this much less than the largest."""

COMPLETE, REDUCED = 600, 20_000
"""A full mesh of more freedoms than these is taken in a few shapes, or as rigid: the other formulations are dense."""

MODES = 4
"""With the attachments held, of meshes that are taken in a few shapes."""

SMALL_PART = 1e-3
"""Accelerations below this part of the mechanism's largest are compared with that part of it, not with themselves."""


@dataclass(frozen=True)
class Difference:
    """How far a formulation is from Maggi's equations, relative, the worst over all bodies.

    accelerations : v̇. joint_forces : generalised liaison forces on every body. single_joints : of every liaison by
        itself, where that is determined; None where the formulation does not tell liaisons apart.
    """

    formulation: str
    accelerations: float
    joint_forces: float
    single_joints: float | None


@dataclass(frozen=True)
class Comparison:
    """Maggi's equations against the other formulations at one state.

    velocities, freedoms : how many are unknown, and how many of them independent. condition : of S, with velocities
    scaled by the mechanism's size. floored : whether bodies without inertia were given some. shared : liaisons of which only the sum of their forces is determined. notes : what
    was taken otherwise than the model says.
    """

    velocities: int
    freedoms: int
    condition: float
    differences: tuple[Difference, ...]
    shared: tuple[str, ...]
    notes: tuple[str, ...]
    floored: bool = False

    @property
    def tolerance(self) -> float:
        """The largest relative difference that is round-off."""
        return (FLOORED if self.floored else AGREEMENT) * self.condition

    @property
    def agree(self) -> bool:
        """Whether all formulations give the same."""
        found = [x for d in self.differences for x in (d.accelerations, d.joint_forces, d.single_joints or 0.0)]
        return all(math.isfinite(x) and x <= self.tolerance for x in found)

    def data(self) -> dict[str, Any]:
        """Everything as dictionaries, lists, texts and numbers, ready for `json.dumps`; None for what is not finite."""
        differences = [
            {key: None if isinstance(x, float) and not math.isfinite(x) else x for key, x in asdict(d).items()}
            for d in self.differences
        ]
        return {**asdict(self), "differences": differences, "tolerance": self.tolerance, "agree": self.agree}

    def text(self) -> str:
        """Everything in lines for a person."""
        heads = ("", "accelerations", "joint forces", "joint by joint")
        rows = [
            (
                d.formulation,
                *(" " if x is None else f"{x:.1e}" for x in (d.accelerations, d.joint_forces, d.single_joints)),
            )
            for d in self.differences
        ]
        verdict = "all five agree" if self.agree else "THEY DISAGREE"
        lines = [
            "Five formulations at the initial state",
            f"  {self.velocities} velocities, {self.freedoms} of them independent; largest relative differences from Maggi's:",
            *(f"    {name:<13}{a:>15}{b:>15}{c:>16}".rstrip() for name, a, b, c in (heads, *rows)),
            f"  {verdict} (round-off is what lies below {self.tolerance:.1e})",
        ]
        if self.shared:
            lines.append(f"  only the sum of their forces is determined: {', '.join(self.shared)}")
        return "\n".join([*lines, *(f"  {note}" for note in self.notes)])


def compare_formulations(model: Model, announce: Callable[[str], None] = lambda text: None) -> Comparison:
    """Compare the formulations at a model's initial positions and velocities; needs no `simulation`.

    Full meshes of up to `COMPLETE` freedoms bend as they are, of up to `REDUCED` in a few shapes; larger ones are rigid.

    Raises ModelError where the model cannot be assembled, has no consistent initial state, or has a body without points.
    """
    meshed = {name: body for name, body in model.bodies.items() if isinstance(body, ElasticBody)}
    meshes: dict[str, MeshBody] = {}
    if meshed:
        build_system(model, rigid=frozenset(meshed), meshes=meshes, announce=announce)
    large = [name for name, body in meshed.items() if body.reduction is None and meshes[name].size > COMPLETE]
    rigid = frozenset(name for name in large if meshes[name].size > REDUCED)
    reduced = {name: replace(meshed[name], reduction=CraigBampton(MODES)) for name in large if name not in rigid}
    taken = replace(model, bodies={**model.bodies, **reduced})
    recorded = frames_at_start(model, announce)
    system = build_system(taken, recorded=recorded, rigid=rigid, dense=True, meshes=meshes, announce=announce)
    notes: list[str] = []
    motion = initial_motion(system, notes)
    for name in large:
        how = "as rigid" if name in rigid else f"with {MODES} modes and the shapes of its attachments"
        held = ", its frame free" if name in rigid and meshed[name].motion is not None else ""
        notes.append(f"{name} is taken {how}{held}: its mesh has {meshes[name].size:,} freedoms")
    return compare_at(system, motion, 0.0, notes)


def compare_at(system: System, motion: MotionState, t: float, notes: list[str] | None = None) -> Comparison:
    """Compare the formulations at a state that the liaisons admit. See `formulations.question_at`."""
    notes = list(notes or [])
    question = question_at(system, motion, t)
    floored = not determined(question)
    if floored:
        question = question_at(system, motion, t, floor=True)
        notes.append("bodies without inertia about an axis that is free were given a little of it")
    return replace(compare(question, FORMULATIONS, notes), floored=floored)


def compare(
    question: Question, formulations: Mapping[str, Callable[[Question], Answer]], notes: list[str]
) -> Comparison:
    """Compare answers to one question."""
    terms = question.terms
    S = project(terms.A, terms.scale).S
    reference = by_projection(question)
    shared = _shared(question)
    single = {name: force for name, force in reference.liaisons.items() if name not in shared}
    free = np.asarray(np.linalg.lstsq(terms.M, terms.f, rcond=NO_INERTIA)[0])
    inertia = np.asarray(np.abs(terms.M) @ np.abs(reference.accelerations) + np.abs(terms.f))
    differences = []
    for name, formulation in formulations.items():
        answer = formulation(question)
        between = [
            _difference(question, answer.liaisons[liaison], force, 1.0 / terms.scale, inertia)
            for liaison, force in single.items()
            if liaison in answer.liaisons
        ]
        differences.append(
            Difference(
                name,
                _difference(question, answer.accelerations, reference.accelerations, terms.scale, free),
                _difference(question, answer.joint_forces, reference.joint_forces, 1.0 / terms.scale, inertia),
                max(between, default=0.0) if answer.liaisons else None,
            )
        )
    scaled = S * terms.scale[:, None]
    sizes = np.linalg.norm(scaled, axis=0)
    condition = float(np.linalg.cond(scaled / sizes)) if S.shape[1] else 1.0
    return Comparison(len(terms.f), S.shape[1], condition, tuple(differences), tuple(sorted(shared)), tuple(notes))


def by_projection(question: Question) -> Answer:
    """The program's own answer: Maggi's projection (Eq. T8–T11)."""
    terms = question.terms
    projection = project(terms.A, terms.scale)
    vd = accelerations(projection, terms.M, terms.f, terms.gamma)
    multipliers = liaison_forces(projection, terms.f - terms.M @ vd)
    liaisons = {name: -terms.A[rows].T @ multipliers[rows] for name, rows in terms.owner.items()}
    return Answer(vd, -terms.A.T @ multipliers, liaisons)


def determined(question: Question) -> bool:
    """Whether every motion that the liaisons admit has inertia."""
    terms = question.terms
    S = project(terms.A, terms.scale).S
    if S.shape[1] == 0:
        return True
    S = S / np.linalg.norm(S * terms.scale[:, None], axis=0)
    energies = np.linalg.eigvalsh(S.T @ terms.M @ S)
    return bool(energies[0] > NO_INERTIA * energies[-1])


def _shared(question: Question) -> set[str]:
    """Liaisons with rows that depend on those of others: their single forces are not determined."""
    terms = question.terms
    scaled = terms.A / terms.scale
    size = np.linalg.norm(scaled, axis=1)
    dependent = null_space((scaled / np.where(size > 0.0, size, 1.0)[:, None]).T, rcond=1e-9)
    return {name for name, rows in terms.owner.items() if np.abs(dependent[rows]).max(initial=0.0) > 1e-7}


def _difference(question: Question, found: Array, expected: Array, unit: Array, natural: Array) -> float:
    """The largest difference of any body's frame or elastic part, relative to its size there.

    unit (k,): makes components of one kind. natural (k,): what the quantity would be like without liaisons; where the
    expected one all but vanishes beside that or beside other bodies, a small part of these counts instead.
    """
    if not np.isfinite(found).all():
        return math.inf
    least = SMALL_PART * max(np.abs(unit * expected).max(initial=0.0), np.abs(unit * natural).max(initial=0.0))
    worst = 0.0
    for block in _blocks(question):
        size = max(least, np.abs((unit * expected)[block]).max(initial=0.0))
        error = np.abs((unit * (found - expected))[block]).max(initial=0.0)
        if error > 0.0:
            worst = max(worst, float(error / size)) if size > 0.0 else math.inf
    return worst


def _blocks(question: Question) -> list[NDArray[np.bool_]]:
    """The moving velocities of every body's frame, and of its elastic part."""
    blocks = []
    for state in question.instant.states.values():
        for first, last in ((state.start, state.start + 6), (state.start + 6, state.start + state.size)):
            block = (question.instant.moving >= first) & (question.instant.moving < last)
            if block.any():
                blocks.append(block)
    return blocks

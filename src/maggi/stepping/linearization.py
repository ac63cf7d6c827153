"""Compiled: the matrices of the iteration, as the bodies stand (Eq. T12)."""

from __future__ import annotations

import math

from maggi.linalg.compiling import inner_kernel
from maggi.linalg.links import Link, call3
from maggi.projection.closures import closure_compliance, closure_scale
from maggi.projection.range_space import SUSPECT, factorise, factorise_kept, find_singular
from maggi.projection.tree_kernels import closure_columns, tree_factor

from .prediction import coefficients
from .tables import (
    ADD_SPRINGS,
    BLOCK_COMPLIANCES,
    LOOSE,
    SINE,
    SPRING_COEFFICIENTS,
    STEADY,
    SmallSystem,
    StepState,
    StepWork,
)

STEADILY = 20  # factors in which the same rows depended on others, before those are left out
BETWEEN = 40  # factors without them, before all are looked at again
UNMOVED = 1e-10  # what rows that are left out may be off by, scaled


@Link
def refresh(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Ŝ = L D Lᵀ of the tree, compliances of Ritz blocks, Λ and its factor, as the bodies stand.

    To `numbers` the sine of the smallest angle between rows, 1 unless a singular position is close. Rows that have depended
    on others all along are left out, until they are looked at again, no longer hold by themselves, or another row's
    pivot becomes small.
    """
    c = coefficients(work)
    work.numbers[SINE] = 1.0
    tree, bodies, rows = small.tree, small.step_bodies, state.rows
    first, start = tree.skyline_first, tree.skyline_start
    if small.links[BLOCK_COMPLIANCES] != 0:
        call3(small.links[BLOCK_COMPLIANCES], small, state, work, t)
    if small.links[SPRING_COEFFICIENTS] != 0:
        call3(small.links[SPRING_COEFFICIENTS], small, state, work, t)
    tree_factor(tree, tree.M, c.sigma, work.stiffness, work.tree)
    if first.shape[0] == 0:
        return
    if work.flags[STEADY] >= STEADILY and work.numbers[LOOSE] <= UNMOVED:
        work.flags[STEADY] += 1
        if work.flags[STEADY] == STEADILY + BETWEEN:
            work.flags[STEADY] = STEADILY - 1
        closure_columns(tree, rows.A, work.kept, work.tree)
        assemble(small, state, work, t)
        if factorise_kept(first, start, work.L, work.pivot, work.scale, work.kept) >= SUSPECT:
            return
    for i in range(work.kept.shape[0]):
        work.kept_before[i] = work.kept[i]
        work.kept[i] = 1
    closure_columns(tree, rows.A, work.kept, work.tree)
    if work.scale.shape[0] > 0 and work.scale[0] == 0.0:
        closure_scale(tree, bodies, rows.A, tree.W, c.sigma, work.W, work.product, work.scale)
    assemble(small, state, work, t)
    if factorise(first, start, work.L, work.pivot, work.scale, work.kept) < SUSPECT:
        tree_factor(tree, tree.metric, 1.0, work.unsprung, work.tree)
        closure_columns(tree, rows.A, work.kept, work.tree)
        closure_scale(tree, bodies, rows.A, tree.metric_W, 1.0, work.metric, work.product, work.metric_scale)
        closure_compliance(tree, bodies, work.metric, work.tree, work.kept, work.product, work.L)
        sine = find_singular(first, start, work.L, work.pivot, work.metric_scale, work.active)
        work.numbers[SINE] = math.sqrt(sine)
        tree_factor(tree, tree.M, c.sigma, work.stiffness, work.tree)
        closure_columns(tree, rows.A, work.kept, work.tree)
        assemble(small, state, work, t)
        factorise(first, start, work.L, work.pivot, work.scale, work.active)
        work.flags[STEADY] = 0
        return
    for i in range(work.active.shape[0]):
        work.active[i] = 1
    work.flags[STEADY] += 1
    for i in range(work.kept.shape[0]):
        work.kept[i] = 1 if work.pivot[i] > 0.0 else 0
        if work.kept[i] != work.kept_before[i]:
            work.flags[STEADY] = 1


@inner_kernel
def assemble(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Λ of the columns, with springs behind it."""
    closure_compliance(small.tree, small.step_bodies, work.W, work.tree, work.kept, work.product, work.L)
    if small.links[ADD_SPRINGS] != 0:
        call3(small.links[ADD_SPRINGS], small, state, work, t)

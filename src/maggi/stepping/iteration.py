"""The compiled step of the small system (Theory §5): predict, iterate on closures and bodies together, accept.

In relative coordinates: the free motions of the tree's joints and the velocities of blocks (`projection.tree_tables`).
"""

from __future__ import annotations

import math

from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.links import call3, call4

from .evaluation import has_forces
from .prediction import coefficients, move_blocks
from .residuals import active_residuals, correction_size, largest_of, local_error
from .tables import (
    ACCEPT_STEP,
    BOUND,
    CALM,
    CORRECT,
    ERROR,
    EVALUATE,
    EVERY,
    FIRST,
    HIGHEST_ORDER,
    ITERATIONS,
    KEPT,
    LAST,
    LOOSE,
    NUMBER,
    ORDER,
    PREDICT_STEP,
    PRESCRIBE,
    REFRESH,
    SHOW,
    SINE,
    Instant,
    Record,
    SmallSystem,
    StepState,
    StepWork,
)

CONVERGED, NOT_CONVERGED, NOT_FINITE, TOO_LARGE, COULD_BE_LONGER = 0, 1, 2, 3, 4
WHOLE_STEPS, PREDICT, ITERATE, ACCEPT = 0, 1, 2, 3
MAX_ITERATIONS = 25
REFRESH_ABOVE = 0.1  # contraction above which the iteration's matrices are made anew
ROUND_OFF = 1e-12  # liaison residuals, relative to size, speed and acceleration
STALLED = 1e-10  # accepted where round-off lets them fall no further
DROPPED = 1e-6  # what positions of dependent rows may be off by, and 100 times that their velocities
EPSILON = 2.2e-16
TWICE = 1.0 / 16.0  # of the local error allowed, which a step twice as long multiplies by eight
CALM_STEPS = 4  # of that kind in a row before steps become longer


@inner_kernel
def iterate(
    small: SmallSystem, state: StepState, work: StepWork, c: GeneralizedAlpha, t: float, tolerance: float
) -> tuple[int, int]:
    """Newton's iteration on the small system; returns (CONVERGED or why not, number of corrections).

    Full-mesh bodies enter by `work.base` (their one back-substitution) and `work.accounted` and are linear here.
    """
    scales = state.scales
    rho = state.vectors.contraction
    multipliers = state.vectors.multipliers_next
    size = scales[0]
    error = 0.0
    previous = 0.0
    contraction = rho[0]
    worst_before = math.inf
    measured = rho[1] < 10.0
    renew = True
    for i in range(work.accounted.shape[0]):
        work.accounted[i] = 0.0
        work.position_force[i] = 0.0
        work.velocity_force[i] = 0.0
    sine = 1.0  # of the smallest angle between rows
    # joints of the tree hold by themselves: where there is nothing else, nobody need look at the state of the last correction
    bare = state.rows.position.shape[0] + small.tree.block.shape[0] == 0 and not has_forces(small)
    for iteration in range(MAX_ITERATIONS + 1):
        call3(small.links[EVALUATE], small, state, work, t)
        worst, dropped = active_residuals(small.closures, state.rows, scales, work.pivot)
        if not math.isfinite(worst + dropped) or not math.isfinite(error):
            return NOT_FINITE, iteration
        if iteration > 0:
            # near a singular position accelerations along the vanishing direction are magnified round-off
            noise = 10.0 * EPSILON / sine**3 / tolerance
            round_off = max(ROUND_OFF, 10.0 * EPSILON / sine**2)
            estimate = error * contraction / (1.0 - contraction) if contraction < 1.0 else math.inf
            if error <= noise:
                estimate = 0.0
            if iteration == 1 and not measured:
                estimate = math.inf
            settled = worst <= round_off or (iteration >= 3 and worst <= STALLED and worst > 0.3 * worst_before)
            # at round-off corrections no longer fall: a stiff body answers that of the joints' positions
            stalled = (
                iteration >= 3
                and error > 0.3 * previous
                and c.beta * c.h * c.h * largest_of(work.delta) <= ROUND_OFF * size
            )
            if (estimate <= 1.0 or stalled) and settled and dropped <= DROPPED:
                if iteration >= 2:
                    rho[1] = 0.0
                else:
                    rho[1] += 1.0
                work.numbers[LOOSE] = dropped
                return CONVERGED, iteration
        if iteration == MAX_ITERATIONS:
            break
        worst_before = worst
        if renew:
            call3(small.links[REFRESH], small, state, work, t)
            sine = work.numbers[SINE]
            for i in range(multipliers.shape[0]):
                if work.pivot[i] == 0.0:
                    multipliers[i] = 0.0
            renew = False
        work.flags[FIRST] = 1 if iteration == 0 else 0
        call3(small.links[CORRECT], small, state, work, t)
        previous = error
        error = correction_size(small, c, scales, state, work.delta) / tolerance
        if iteration > 0 and previous > 0.0:
            contraction = max(min(error / previous, 2.0), 1e-3)
            if contraction > REFRESH_ABOVE:
                renew = True
            rho[0] = min(contraction, 0.5)
        if bare and (iteration > 0 or measured) and error * contraction <= 1.0 - contraction:
            rho[1] = 0.0 if iteration > 0 else rho[1] + 1.0
            return CONVERGED, iteration + 1
    return NOT_CONVERGED, MAX_ITERATIONS


@inner_kernel
def keep(instant: Instant, record: Record, step: int) -> None:
    """See `Record.keep`."""
    k = record.places[KEPT]
    kept, flat = record.instants[k], instant.flat
    for i in range(flat.shape[0]):
        kept[i] = flat[i]
    record.steps[k] = step
    record.places[KEPT] = k + 1


@kernel
def advance(
    small: SmallSystem,
    state: StepState,
    work: StepWork,
    instant: Instant,
    record: Record,
    phase: int,
    t: float,
    steps: int,
    tolerance: float,
) -> tuple[int, int, int]:
    """Up to `steps` steps from time t, or one phase of a step; returns (reason it ended, steps done, corrections).

    phase: WHOLE_STEPS, or PREDICT, ITERATE, ACCEPT of a single step to t + h for mechanisms with meshed bodies,
    whose back-substitutions come between. By what polynomial the first step predicts is in `flags`; each that follows
    takes one more, up to HIGHEST_ORDER. With a BOUND the steps end where one makes a larger local error, which is not accepted, and
    where they could be twice as long. `record` says which of whole steps end with an instant to keep, for which it has room.
    """
    bound = work.numbers[BOUND] if phase == WHOLE_STEPS else 0.0
    c, links = coefficients(work), small.links
    total, corrections = 0, 0
    for k in range(steps):
        end = t + (k + 1) * c.h
        if phase == WHOLE_STEPS or phase == PREDICT:
            call3(links[PREDICT_STEP], small, state, work, end)
            if phase == PREDICT:
                move_blocks(small, state)
                if links[PRESCRIBE] != 0:
                    call3(links[PRESCRIBE], small, state, work, end)
        if phase == WHOLE_STEPS or phase == ITERATE:
            reason, corrections = iterate(small, state, work, c, end, tolerance)
            total += corrections
            if reason != CONVERGED:
                return reason, k, total
        if bound > 0.0:
            error = local_error(small, c, state)
            work.numbers[ERROR] = error
            if not error <= bound:
                return TOO_LARGE, k, total
            work.flags[CALM] = work.flags[CALM] + 1 if error <= TWICE * bound else 0
        if phase == WHOLE_STEPS or phase == ACCEPT:
            call3(links[ACCEPT_STEP], small, state, work, end)
            work.flags[ORDER] = min(work.flags[ORDER] + 1, HIGHEST_ORDER)
        if phase == WHOLE_STEPS and record.places[EVERY] > 0:
            record.places[NUMBER] += 1
            number = record.places[NUMBER]
            if number % record.places[EVERY] == 0 or number == record.places[LAST]:
                call4(links[SHOW], small, state, work, instant, end)
                instant.counts[ITERATIONS] = corrections
                keep(instant, record, number)
        if bound > 0.0 and work.flags[CALM] >= CALM_STEPS:
            return COULD_BE_LONGER, k + 1, total
    return CONVERGED, steps, total

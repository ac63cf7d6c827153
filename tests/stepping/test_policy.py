"""The number of back-substitutions that a step gets, by scripted sizes of its corrections."""

from itertools import pairwise

import pytest

from maggi.stepping.policy import (
    CALM,
    CHECK_SOLVES,
    FIRST,
    FIRST_WAIT,
    LONGER,
    LONGEST_WAIT,
    ROUGH,
    SUDDEN,
    SolvePolicy,
)

ALLOWED, FLOOR = 1.0, 1e-12


def solves(policy, corrections, allowed=ALLOWED, floor=FLOOR):
    """How many of the corrections a step takes; it is accepted then."""
    for count in range(1, len(corrections) + 1):
        if policy.enough(corrections[:count], allowed, floor):
            policy.accepted()
            return count
    raise AssertionError("the script is too short")


def geometric(first, ratio, count=12):
    return [first * ratio**k for k in range(count)]


def settled(ratio, first=1e-3):
    """A policy past its first steps, which have shown this contraction and first corrections of this size."""
    policy = SolvePolicy()
    for _ in range(FIRST):
        solves(policy, geometric(first, ratio))
    return policy


def test_first_steps_are_checks():
    policy = SolvePolicy()
    assert [solves(policy, geometric(1e-3, 0.1)) for _ in range(FIRST)] == [CHECK_SOLVES] * FIRST
    assert solves(policy, geometric(1e-3, 0.1)) == 1


def checks_of(counts):
    """Distances between the checks among the numbers of solves of successive steps."""
    checks = [k for k, count in enumerate(counts) if count == CHECK_SOLVES]
    return [later - earlier for earlier, later in pairwise(checks)]


def test_smooth_motion_takes_one_solve_and_a_check_now_and_then():
    """Each check that finds the iteration calm lets the next one wait longer, up to a limit."""
    policy = settled(CALM / 2)
    counts = [solves(policy, geometric(1e-3, CALM / 2)) for _ in range(10 * LONGEST_WAIT)]
    assert set(counts) == {1, CHECK_SOLVES}
    distances = checks_of(counts)
    assert counts.index(CHECK_SOLVES) == FIRST_WAIT - 1
    assert distances[:2] == [LONGER * FIRST_WAIT, LONGER**2 * FIRST_WAIT]
    assert set(distances[2:]) == {LONGEST_WAIT}


def test_checks_stay_close_where_the_iteration_is_not_calm():
    policy = settled(2 * CALM)
    counts = [solves(policy, geometric(1e-3, 2 * CALM)) for _ in range(10 * FIRST_WAIT)]
    assert set(checks_of(counts)) == {FIRST_WAIT}


def test_checks_come_close_again_after_one_that_was_not_calm():
    policy = settled(CALM / 2)
    for _ in range(4 * FIRST_WAIT):
        solves(policy, geometric(1e-3, CALM / 2))
    counts = [solves(policy, geometric(1e-3, 2 * CALM)) for _ in range(10 * FIRST_WAIT)]
    assert set(checks_of(counts)) == {FIRST_WAIT}


def test_a_component_that_grows_between_checks_calls_for_one():
    """What an iteration factor of −1/2 makes of round-off: alternating, 1.37 times as large each step."""
    policy = settled(CALM / 2)
    rough, smooth, growth = 1e-9, 30.0, 1.366
    for k in range(300):
        if k > 100:
            rough *= growth
        first = smooth + rough
        corrections = [first, CALM / 2 * smooth + rough / 2, CALM**2 / 4 * smooth + rough / 4, rough / 8, rough / 16]
        if solves(policy, [*corrections, 1e-15], allowed=100.0 if k < 100 else 1.0) >= CHECK_SOLVES and k > 110:
            break
    # by schedule or by size, it is noticed before it outgrows what every step corrects anyway
    assert rough < SUDDEN * smooth
    assert k < 200


def test_a_sudden_change_is_a_check():
    policy = settled(CALM / 2)
    for size in [10.0] * 4 + [10.0 * SUDDEN * 1.01]:
        count = solves(policy, geometric(size, 0.02))
    assert count == CHECK_SOLVES
    # it is usual from now on
    assert solves(policy, geometric(10.0 * SUDDEN, 0.02)) == 1


def test_sudden_changes_that_are_allowed_anyway_are_not():
    policy = settled(CALM / 2)
    assert [solves(policy, geometric(size, CALM / 2)) for size in (1e-3, 1e-1, 1.0, 2.0)] == [1, 1, 1, 1]


def test_rough_motion_takes_two():
    """The contraction of a check's later corrections decides for the steps that follow."""
    ratio = ROUGH + 0.05
    policy = settled(ratio)
    assert policy.contraction == pytest.approx(ratio)
    assert solves(policy, geometric(1e-3, ratio)) == 2


def test_first_contraction_is_no_sign():
    """A check whose first ratio is small and whose later one is not: the later counts."""
    policy = SolvePolicy()
    for _ in range(FIRST):
        solves(policy, [1e-2, 1e-6, 0.5e-6, 0.25e-6])
    assert policy.contraction == pytest.approx(0.5)
    assert solves(policy, [1e-2, 1e-6, 1e-7]) == 2


def test_a_rough_check_is_forgotten_after_a_smooth_one():
    policy = settled(0.5)
    counts = [solves(policy, geometric(1e-3, 0.05)) for _ in range(2 * FIRST_WAIT)]
    assert counts[0] == 2
    assert counts[-FIRST_WAIT // 2] == 1


@pytest.mark.parametrize(("first", "expected"), [(8.9, 1), (9.1, 2), (89.0, 2), (91.0, 3)])
def test_what_is_left_must_be_allowed(first, expected):
    """With contraction ρ = 0.1, last·ρ/(1 − ρ) ≤ allowed means last ≤ 9."""
    assert solves(settled(0.1, first), geometric(first, 0.1)) == expected


def test_round_off_ends_a_step_at_once():
    assert SolvePolicy().enough([FLOOR / 2], ALLOWED, FLOOR)
    assert SolvePolicy(exact=True).enough([FLOOR / 2], ALLOWED, FLOOR)


def test_growing_corrections_are_never_enough():
    policy = settled(0.1)
    assert not any(policy.enough(geometric(200.0, 1.5, count), ALLOWED, FLOOR) for count in range(1, 12))


def test_exact_iterates_far_below_the_tolerance():
    policy = SolvePolicy(exact=True)
    for _ in range(2 * FIRST_WAIT):
        assert solves(policy, geometric(1.0, 0.1), allowed=1.0001) == 5  # 1e-4 of what is allowed


def test_restart_makes_checks_again():
    policy = settled(0.05)
    assert solves(policy, geometric(1e-3, 0.05)) == 1
    policy.restart()
    assert solves(policy, geometric(1e-3, 0.05)) == CHECK_SOLVES

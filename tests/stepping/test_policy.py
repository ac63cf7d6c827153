"""The number of back-substitutions that a step gets, by scripted sizes of its corrections."""

from itertools import pairwise

import pytest

from maggi.stepping.policy import CHECK_EVERY, CHECK_SOLVES, FIRST, ROUGH, SolvePolicy

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


def settled(ratio):
    """A policy past its first steps, which have shown this contraction."""
    policy = SolvePolicy()
    for _ in range(FIRST):
        solves(policy, geometric(1e-3, ratio))
    return policy


def test_first_steps_are_checks():
    policy = SolvePolicy()
    assert [solves(policy, geometric(1e-3, 0.1)) for _ in range(FIRST)] == [CHECK_SOLVES] * FIRST
    assert solves(policy, geometric(1e-3, 0.1)) == 1


def test_smooth_motion_takes_one_solve_and_a_check_now_and_then():
    policy = settled(0.05)
    counts = [solves(policy, geometric(1e-3, 0.05)) for _ in range(10 * CHECK_EVERY)]
    assert set(counts) == {1, CHECK_SOLVES}
    assert counts.count(CHECK_SOLVES) == 10
    checks = [k for k, count in enumerate(counts) if count == CHECK_SOLVES]
    assert {later - earlier for earlier, later in pairwise(checks)} == {CHECK_EVERY}


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
    counts = [solves(policy, geometric(1e-3, 0.05)) for _ in range(2 * CHECK_EVERY)]
    assert counts[0] == 2
    assert counts[-CHECK_EVERY // 2] == 1


@pytest.mark.parametrize(("first", "expected"), [(8.9, 1), (9.1, 2), (89.0, 2), (91.0, 3)])
def test_what_is_left_must_be_allowed(first, expected):
    """With contraction ρ = 0.1, last·ρ/(1 − ρ) ≤ allowed means last ≤ 9."""
    assert solves(settled(0.1), geometric(first, 0.1)) == expected


def test_round_off_ends_a_step_at_once():
    assert SolvePolicy().enough([FLOOR / 2], ALLOWED, FLOOR)
    assert SolvePolicy(exact=True).enough([FLOOR / 2], ALLOWED, FLOOR)


def test_growing_corrections_are_never_enough():
    policy = settled(0.1)
    assert not any(policy.enough(geometric(200.0, 1.5, count), ALLOWED, FLOOR) for count in range(1, 12))


def test_exact_iterates_far_below_the_tolerance():
    policy = SolvePolicy(exact=True)
    for _ in range(2 * CHECK_EVERY):
        assert solves(policy, geometric(1.0, 0.1), allowed=1.0001) == 5  # 1e-4 of what is allowed


def test_restart_makes_checks_again():
    policy = settled(0.05)
    assert solves(policy, geometric(1e-3, 0.05)) == 1
    policy.restart()
    assert solves(policy, geometric(1e-3, 0.05)) == CHECK_SOLVES

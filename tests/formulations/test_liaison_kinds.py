"""Every liaison of the library between two bodies in motion: five formulations, one answer; and a wrong γ is noticed."""

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from liaison_library import LIAISONS, NONHOLONOMIC
from random_states import state_in_motion
from workshop import Workshop

from maggi.analyses.compare_formulations import compare, compare_at
from maggi.formulations import kane, question_at
from maggi.formulations.constraints.joints import LOCKS
from maggi.liaisons.registry import JOINTS
from maggi.model import GROUND, Joint
from maggi.model.joint_kinds import JOINT_COORDINATES
from maggi.model.joints import Liaison
from maggi.system.build import build_system

T = 0.1
ROUND_OFF = 1e-10  # of the square of the speeds
KINDS = pytest.mark.parametrize("kind", LIAISONS)


def between(kind, ends, seed):
    """A system of one liaison between two bodies, in motion at time T."""
    rng = np.random.default_rng(seed)
    shop = Workshop(rng)
    first, second = (GROUND if end == "ground" else getattr(shop, end)() for end in ends)
    LIAISONS[kind](shop, first, second)
    system = build_system(shop.model())
    motion = state_in_motion(system, rng, T)
    assert motion is not None
    return system, motion


@KINDS
@pytest.mark.parametrize(
    "ends", [("rigid", "rigid"), ("ground", "rigid"), ("given", "rigid"), ("ritz", "ritz")], ids="-".join
)
def test_all_formulations_agree(kind, ends):
    found = compare_at(*between(kind, ends, 7), T)
    assert found.agree, found
    # Newton–Euler and Lagrange tell what each liaison does; nothing here is redundant
    assert not found.shared
    assert [d.formulation for d in found.differences if d.single_joints is not None] == ["Lagrange", "Newton–Euler"]


@KINDS
def test_a_wrong_sign_of_any_gamma_is_noticed(kind):
    """γ of one row after the other is turned round in what Maggi's equations are given."""
    system, motion = between(kind, ("rigid", "rigid"), 8)
    # no special state: away from the initial pose, and in motion
    assert np.abs(motion.v).max() > 0.1
    assert np.abs(motion.origin - system.start.origin).max() > 0.02
    question = question_at(system, motion, T)
    gamma = question.terms.gamma
    turned = np.flatnonzero(np.abs(gamma) > ROUND_OFF * np.abs(motion.v).max() ** 2)
    # where nothing moves relative to the other body, as in a weld, there is no γ to be wrong
    assert len(turned) or kind in ("weld", "free")
    for row in turned:
        wrong = gamma.copy()
        wrong[row] = -wrong[row]
        assert not compare(replace(question, terms=replace(question.terms, gamma=wrong)), {"Kane": kane}, []).agree


def test_every_liaison_of_the_library_is_here():
    """A new kind of joint or liaison must be written a second time too."""
    assert set(LOCKS) == set(JOINTS) == set(JOINT_COORDINATES)
    built = [between(kind, ("rigid", "rigid"), 9)[0].model.joints.values() for kind in LIAISONS]
    made = [liaison for liaisons in built for liaison in liaisons]
    assert {type(liaison) for liaison in made} == set(get_args(Liaison))
    assert {liaison.kind for liaison in made if isinstance(liaison, Joint)} == set(JOINTS)


def test_nonholonomic_kinds_hold_no_position():
    for kind in NONHOLONOMIC:
        system, _ = between(kind, ("rigid", "rigid"), 9)
        own = system.liaison_entries[-1]
        assert not system.holonomic[own.rows].all()

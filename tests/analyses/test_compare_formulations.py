"""The comparison of formulations as a whole: the example, what is told, what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import four_bar
from random_mechanisms import Features, random_model
from random_states import state_in_motion

import maggi
from maggi.analyses.compare_formulations import MODES, compare, compare_formulations
from maggi.analyses.initial import initial_motion
from maggi.formulations import FORMULATIONS, Answer, kane, question_at
from maggi.model import ModelError
from maggi.system.build import build_system

EXAMPLE = Path(maggi.__file__).parents[2] / "examples" / "slider_crank" / "slider_crank.yml"


@pytest.mark.slow
def test_the_example():
    """Crank, elastic rod, piston: the rod's mesh in a few shapes, against its quadrature points."""
    found = compare_formulations(maggi.load(EXAMPLE))
    assert found.agree
    assert [d.formulation for d in found.differences] == list(FORMULATIONS)
    assert found.velocities == 3 * 6 + 6 + MODES
    assert found.shared == ()
    assert len(found.notes) == 1 and found.notes[0].startswith(f"rod is taken with {MODES} modes")
    assert max(d.accelerations for d in found.differences) < 1e-10


def test_what_redundant_joints_share_is_named():
    """Four parallel revolutes: what each bears out of the plane is not determined, the sum on each body is."""
    found = maggi.compare(four_bar())
    assert found.agree
    assert set(found.shared) == {"j0", "j1", "j2", "j3"}
    assert (found.velocities, found.freedoms) == (18, 1)
    said = found.text()
    assert "all five agree" in said
    assert "only the sum of their forces is determined: j0, j1, j2, j3" in said


def test_data_are_plain():
    data = json.loads(json.dumps(compare_formulations(four_bar()).data()))
    assert data["agree"] is True
    assert [d["formulation"] for d in data["differences"]] == list(FORMULATIONS)
    assert data["tolerance"] == pytest.approx(1e-9 * data["condition"])


def test_what_is_not_finite_is_none_in_data():
    question = question_of(four_bar())
    nothing = Answer(np.full(18, np.nan), np.zeros(18), {})
    data = compare(question, {"nothing": lambda q: nothing}, []).data()
    assert data["differences"][0]["accelerations"] is None
    assert not data["agree"]


@pytest.mark.parametrize("part", ["M", "A", "gamma", "f"])
def test_a_wrong_entry_of_any_matrix_is_noticed(part):
    """Entry after entry of what Maggi's equations are given, changed by a millionth of the largest."""
    rng = np.random.default_rng(1)
    system = build_system(random_model(rng, Features(closed=True, elastic=True)), dense=True)
    question = question_at(system, state_in_motion(system, rng, 0.1), 0.1)
    assert compare(question, {"Kane": kane}, []).agree
    right = getattr(question.terms, part)
    for place in map(tuple, rng.permutation(np.argwhere(right != 0.0))[:12]):
        wrong = right.copy()
        wrong[place] += 1e-6 * np.abs(right).max()
        spoilt = replace(question, terms=replace(question.terms, **{part: wrong}))
        assert not compare(spoilt, {"Kane": kane}, []).agree, place


def question_of(model):
    system = build_system(model)
    return question_at(system, initial_motion(system, []), 0.0)


@pytest.mark.parametrize("what", ["accelerations", "joint_forces", "liaisons"])
def test_a_small_difference_anywhere_is_noticed(what):
    """One part in ten million of one body's share is enough; not a number is a difference too."""
    question = question_of(four_bar(("revolute", "spherical", "spherical", "revolute")))
    true = FORMULATIONS["Newton–Euler"](question)
    names = list(true.liaisons)
    assert compare(question, {"same": lambda q: true}, []).agree
    for factor in (1.0 + 1e-7, np.nan):
        if what == "liaisons":
            changed = replace(true, liaisons={**true.liaisons, names[1]: factor * true.liaisons[names[1]]})
        else:
            vector = getattr(true, what).copy()
            vector[6:12] *= factor
            changed = replace(true, **{what: vector})
        assert not compare(question, {"other": lambda q, a=changed: a}, []).agree


def test_a_mechanism_in_balance_is_compared_by_what_balances():
    """All accelerations vanish where a pendulum hangs: round-off in them is no difference."""
    question = question_of(
        replace(
            four_bar(),
            bodies={"bob": replace(four_bar().bodies["crank"], center_of_mass=(0.0, 0.0, -1.0))},
            joints={"j0": replace(four_bar().joints["j0"], second=replace(four_bar().joints["j0"].second, body="bob"))},
        )
    )
    assert np.abs(kane(question).accelerations).max() < 1e-12
    noisy = Answer(np.full(6, 1e-14), kane(question).joint_forces, {})
    assert compare(question, {"noisy": lambda q: noisy}, []).agree


def test_a_state_without_solution_is_refused():
    broken = four_bar()
    joint = replace(broken.joints["j3"], kind="weld", at=(5.0, 0.0, 0.0))
    driver = maggi.Driver("j0", "angle", maggi.expression("1 + t"))
    with pytest.raises(ModelError):
        compare_formulations(replace(broken, joints={**broken.joints, "j3": joint, "drive": driver}))

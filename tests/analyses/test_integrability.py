"""Frobenius' test against rows whose integrability is known, and the positions that can be reached against Chow's theorem."""

from __future__ import annotations

import numpy as np
import pytest
from liaison_library import LIAISONS, NONHOLONOMIC
from model_texts import FLAT, VELOCITY_ROWS, blade, model, translating
from random_states import state_in_motion
from workshop import Workshop

from maggi.analyses.chart import at_rest, chart, kernel
from maggi.analyses.initial import initial_motion
from maggi.analyses.integrability import INTEGRABLE, _exterior_derivative, integrability
from maggi.analyses.parts import unknown_velocities
from maggi.modelfile import read_text
from maggi.system.build import build_system


def analysed(text):
    system = build_system(read_text(text)[0])
    return integrability(system, initial_motion(system, []))


@pytest.mark.parametrize("name", VELOCITY_ROWS)
def test_known_rows(name):
    text, positions, velocities, reachable = VELOCITY_ROWS[name]
    (part,) = analysed(text)
    found = part.together
    assert (found.positions, found.velocities, found.reachable) == (positions, velocities, reachable)
    assert found.complete
    assert found.integrable == (reachable == velocities)
    assert found.hidden == positions - reachable
    # no case is near the threshold
    assert found.defect < 1e-3 * INTEGRABLE or found.defect > 1e3 * INTEGRABLE
    assert (found.defect > INTEGRABLE) == (reachable > velocities)


@pytest.mark.parametrize("arm", [0.1, 0.8])
def test_the_measure_of_a_blade(arm):
    """In body axes, and lengths by the extent of 1 m, the row is (0, 1, arm)/N: |dα| = 1/N² = 1/(1 + arm²), by hand.

    A left-invariant form has dα(s₁, s₂) = −A [s₁, s₂] alone, here with s₁ = (1, 0, 0), s₂ = (0, −arm, 1)/N.
    """
    (part,) = analysed(model({"a": ", attachments: {far: {at: [1, 0, 0]}}"}, FLAT, blade("k", f"[{arm}, 0, 0]")))
    assert part.together.defect == pytest.approx(1.0 / (1.0 + arm**2), rel=1e-9)


def test_rows_are_judged_alone_and_together():
    """Each skate alone is nonholonomic, the pair is not; liaisons come in the order of the rows, together last."""
    text, *_ = VELOCITY_ROWS["skates in tandem"]
    (part,) = analysed(text)
    assert sorted(one.liaisons for one in part.liaisons) == [("k",), ("l",)]
    assert [(one.velocities, one.reachable, one.integrable) for one in part.liaisons] == [(2, 3, False)] * 2
    assert sorted(part.together.liaisons) == ["k", "l"]


def test_parts_are_told_apart():
    text = model(
        {"a": "", "b": "", "c": ", pose: {origin: [0, 3, 0.05]}"},
        FLAT,
        blade("k", "[0, 0, 0]"),
        "p2: {type: prismatic, between: [ground, b], at: [0, 0, 0], axis: [1, 0, 0]}",
        "r: {type: rolling-sphere, between: [ground, c], radius: 0.05}",
    )
    found = {part.together.liaisons: part.together.reachable for part in analysed(text)}
    assert found == {("k",): 3, ("r",): 5}


def test_positions_alone_need_no_test():
    assert analysed(translating("")) == ()


def test_a_rotated_and_moved_mechanism_gives_the_same():
    """Frobenius' test is one of the rows, not of the axes they are written in: the sleigh, tilted, anywhere."""
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    x, _, z = (list(map(float, column)) for column in turn.T)
    text = model(
        {"a": f", pose: {{origin: [3, 2, 1], rotation: {np.round(turn * np.linalg.det(turn), 15).tolist()}}}"},
        f"p: {{type: planar, between: [ground, a], at: [3, 2, 1], axis: {z}}}",
        f"k: {{type: knife-edge, between: [ground, a], at: {[3 + 0.1 * x[0], 2 + 0.1 * x[1], 1 + 0.1 * x[2]]}, direction: {x}, normal: {z}}}",
    )
    (part,) = analysed(text)
    assert (part.together.positions, part.together.velocities, part.together.reachable) == (3, 2, 3)


@pytest.mark.parametrize(
    "ends", [("rigid", "rigid"), ("given", "rigid"), ("ritz", "rigid"), ("rigid", "box")], ids="-".join
)
@pytest.mark.parametrize("kind", LIAISONS)
def test_rows_with_a_position_are_closed_where_they_hold(kind, ends):
    """dα of α = dΦ vanishes on what the rows admit, for every liaison of the library at a random state that holds it.

    (Some rows are dΦ only on Φ = 0, α = dΦ + Φ β: then dα = dΦ ∧ β, and dΦ is zero on what they admit.) The library's rows
    without a position are not closed there, but for driven speeds.
    """
    rng = np.random.default_rng(3)
    shop = Workshop(rng)
    LIAISONS[kind](shop, *(getattr(shop, end)() for end in ends))
    system = build_system(shop.model())
    state = state_in_motion(system, rng, 0.1)
    here = at_rest(system, state, 0.1)
    around = chart(system, unknown_velocities(system), here)
    forms, _ = around.rows(here)
    values = _exterior_derivative(around, here, np.arange(system.rows), kernel(forms))
    assert values is not None
    largest = np.abs(values).max(axis=(1, 2), initial=0.0) / np.linalg.norm(forms, axis=1)
    # splines have a jump in the third derivative, small cams turn quickly
    assert largest[system.holonomic].max(initial=0.0) < 1e-2 * INTEGRABLE
    if kind in NONHOLONOMIC:
        assert (largest.max() > 1e-3) == ("speed-driver" not in kind)

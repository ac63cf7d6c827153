"""Joints that would do without redundant rows: each proposal is built and counted, not taken at its word."""

from __future__ import annotations

import pytest
from model_texts import FOUR_BAR, PENDULUM

from maggi.analyses.audit import audit
from maggi.analyses.remedies import _INSTEAD, LEFT_OUT
from maggi.liaisons.registry import JOINTS
from maggi.modelfile import read_text

DOOR = PENDULUM + "  upper: {type: revolute, between: [ground, arm], at: [0, 1, 1], axis: [0, 1, 0]}\n"


def checked(text):
    return audit(read_text(text)[0])


def replaced(text, joint, by):
    """The model with another type of joint, axis and place as they are."""
    lines = text.splitlines()
    (k,) = [k for k, line in enumerate(lines) if line.startswith(f"  {joint}: {{type")]
    kind = lines[k].split("type: ")[1].split(",")[0]
    lines[k] = lines[k].replace(f"type: {kind},", f"type: {by},")
    if by == "spherical":
        lines[k] = lines[k].split(", axis:")[0] + "}"
    return "\n".join(lines) + "\n"


def test_rows_that_a_replacement_lacks_are_rows_of_the_joint():
    for kind, options in _INSTEAD.items():
        for one in options:
            assert one.lacks
            assert set(one.lacks) <= set(JOINTS[kind].rows), (kind, one.by)


def test_a_four_bar():
    """Of 20 rows on 18 velocities with one freedom three are too many; RSCR is the textbook's answer."""
    found = checked(FOUR_BAR)
    (remedy,) = found.remedies
    assert (remedy.joints, remedy.redundant) == (("a", "b", "c", "d"), 3)
    assert sum(one.rows for one in remedy.replacements) == 3
    text = FOUR_BAR
    for one in remedy.replacements:
        by, _, _ = one.by.partition(" joint")
        assert by in ("spherical", "cylindrical")
        text = replaced(text, one.joint, by)
    fitted = checked(text)
    assert (fitted.mobility.rows, fitted.mobility.freedoms, fitted.mobility.redundant) == (17, 1, ())
    assert fitted.remedies == ()
    assert "the 3 redundant rows of a, b, c, d would go with a spherical joint in place of the revolute" in found.text()


def test_joints_on_whose_coordinates_something_acts_keep_them():
    for joint in "bc":
        text = FOUR_BAR + f"  motor: {{type: driver, joint: {joint}, angle: t}}\n"
        (remedy,) = checked(text).remedies
        assert all(one.joint != joint or one.by == "cylindrical joint" for one in remedy.replacements)
        assert sum(one.rows for one in remedy.replacements) == 3


def test_a_door_on_two_hinges():
    """Five rows too many: a ball on one hinge, a ball in a slot on the other."""
    (remedy,) = checked(DOOR).remedies
    assert remedy.redundant == 5
    assert {(one.joint, one.by, one.rows) for one in remedy.replacements} in (
        {("hinge", "spherical joint", 2), ("upper", "point-on-curve along its axis", 3)},
        {("upper", "spherical joint", 2), ("hinge", "point-on-curve along its axis", 3)},
    )


def test_a_liaison_that_repeats_another_altogether_can_be_left_out():
    text = PENDULUM + "  again: {type: distance, between: [[0, 0, 0], arm]}\n"
    (remedy,) = checked(text).remedies
    assert [(one.joint, one.by) for one in remedy.replacements] == [("again", LEFT_OUT)]
    assert "the redundant row of hinge, again would go with again left out" in checked(text).text()


def test_mechanisms_without_redundant_rows_need_none():
    assert checked(PENDULUM).remedies == ()


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_proposals_do_not_set_anything_free(kind):
    """Two equal joints side by side: whatever is proposed, the mobility stays."""
    text = (
        PENDULUM.replace("revolute", kind)
        + f"  other: {{type: {kind}, between: [ground, arm], at: [0, 2, 1], axis: [0, 1, 0]}}\n"
    )
    found = checked(text)
    (remedy,) = found.remedies
    assert remedy.redundant == 5
    assert remedy.replacements
    for one in remedy.replacements:
        if one.by == "cylindrical joint":
            assert checked(replaced(text, one.joint, "cylindrical")).mobility.freedoms == found.mobility.freedoms
        if one.by == "spherical joint":
            assert checked(replaced(text, one.joint, "spherical")).mobility.freedoms == found.mobility.freedoms


def test_a_tilted_axis_locks_and_a_ball_frees():
    """Four revolutes, one of them 0.1 rad off: 20 rows lock 18 velocities. With a ball there, the planar motion is back."""
    tilted = FOUR_BAR.replace("coupler.start], axis: [0, 1, 0]}", "coupler.start], axis: [0, 1, 0.1]}")
    found = checked(tilted)
    assert found.mobility.freedoms == 0
    (note,) = [note for note in found.notes if "cannot move" in note]
    assert note == (
        "crank, coupler, rocker cannot move: the joints a, b, c, d lock them by over-constraint (20 rows on 18 velocities); "
        "a spherical joint in place of the revolute b would free a motion"
    )
    freed = checked(replaced(tilted, "b", "spherical"))
    assert freed.mobility.freedoms == freed.mobility.generic_freedoms == 1
    assert not any("cannot move" in note for note in freed.notes)


def test_structures_of_welds_and_driven_mechanisms_are_not_told_to_be_locked():
    welded = PENDULUM.replace("revolute", "weld").replace(", axis: [0, 1, 0]", "")
    twice = welded + "  more: {type: weld, between: [ground, arm], at: [1, 0, 1]}\n"
    driven = FOUR_BAR + "  motor: {type: driver, joint: a, angle: t}\n"
    for text in (welded, twice, driven):
        assert not any("lock" in note for note in checked(text).notes)


def test_dependences_that_only_the_initial_pose_has_are_none_to_be_remedied():
    """All bars in one line: four rows too many there, three beside it; the answer is the one for three."""
    text = FOUR_BAR.replace("end: {at: [0, 0, 1]}}}\n  coupler", "end: {at: [1, 0, 0]}}}\n  coupler")
    text = text.replace("origin: [0, 0, 1]", "origin: [1, 0, 0]").replace(
        "end: {at: [3, 0, 1]}", "end: {at: [4, 0, 0]}"
    )
    text = text.replace("end: {at: [0, 0, 2]}", "end: {at: [2, 0, 0]}")
    found = checked(text)
    counts = found.mobility
    assert (counts.rigid_mobility, counts.generic_rigid_mobility, len(counts.redundant)) == (2, 1, 4)
    assert [remedy.redundant for remedy in found.remedies] == [3]
    assert any(
        "the initial pose is singular: rigid bodies have 2 freedoms here and 1 beside it" in note
        for note in found.notes
    )

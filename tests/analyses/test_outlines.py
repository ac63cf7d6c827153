"""What is drawn of joints lies where the joints hold: circles touch their planes, curves pass through their followers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from maggi.analyses.build_outline import build_outline
from maggi.analyses.build_scene import build_scene
from maggi.modelfile import read_text
from maggi.system.build import build_system

# The first body is turned and moved away, so that a frame left out would show.
HEAD = """\
maggi: 1
bodies:
  base: {kind: rigid, mass: 1, inertia: [1, 1, 1], pose: {origin: [1, 2, 0.3], rotation: {axis: [1, 2, 3], angle: 50 deg}}}
  part: {kind: rigid, mass: 1, inertia: [1, 1, 1], pose: {origin: [0.5, 0, 0.4], rotation: {axis: [3, 1, 1], angle: 70 deg}}}
simulation: {duration: 1, step: 1e-3}
joints:
  j: {type: %s}
"""


def lines(joint: str) -> tuple[np.ndarray, np.ndarray]:
    """First and second outline of a joint between the two bodies, global."""
    system = build_system(read_text(HEAD % joint)[0])
    outline = build_outline(system, system.liaison_entries[0])
    assert outline is not None
    return tuple(  # type: ignore[return-value]
        system.start.origin[b] + points @ system.start.rotation[b].T
        for b, points in ((1, outline.first), (2, outline.second))
    )


def base(points: np.ndarray) -> np.ndarray:
    """Points of the first body, global: its pose once more."""
    turn = Rotation.from_rotvec(np.radians(50) * np.array([1, 2, 3]) / np.sqrt(14)).as_matrix()
    return np.array([1, 2, 0.3]) + points @ turn.T


def test_a_disc_touches_its_plane_in_one_point() -> None:
    axis = np.array([0.0, 1.0, 0.5]) / np.sqrt(1.25)
    centre, low = np.array([0.5, 0.0, 0.4]), 0.4 - 0.2 * np.sqrt(1 - axis[2] ** 2)
    _, rim = lines(
        f"rolling-disc, between: [base, part], radius: 0.2, axis: [0, 1, 0.5], plane: {{point: [0, 0, {low}]}}"
    )
    arms = rim - centre
    assert np.linalg.norm(arms, axis=1) == pytest.approx(np.full(len(rim), 0.2))
    assert arms @ axis == pytest.approx(np.zeros(len(rim)), abs=1e-15)
    # of 72 points the lowest may be 2.5 degrees from the contact
    assert 0.0 <= rim[:, 2].min() - low < 0.2 * (1 - np.cos(np.radians(2.5)))
    assert rim[-1] - centre == pytest.approx(-(rim[-2] - centre))  # a diameter


def test_a_sphere_is_three_great_circles_in_one_line() -> None:
    _, line = lines("rolling-sphere, between: [base, part], radius: 0.4")
    arms = line - [0.5, 0.0, 0.4]
    assert np.linalg.norm(arms, axis=1) == pytest.approx(np.full(len(line), 0.4))
    assert np.linalg.norm(np.diff(line, axis=0), axis=1).max() < 0.4 * 0.09
    turn = Rotation.from_rotvec(np.radians(70) * np.array([3, 1, 1]) / np.sqrt(11)).as_matrix()
    assert np.ptp(arms @ turn, axis=0) == pytest.approx([0.8] * 3)  # along the body's axes


def test_a_rod_goes_from_end_to_end() -> None:
    first, second = lines("distance, between: [base, part]")
    assert np.vstack([first, second]) == pytest.approx(np.array([[1, 2, 0.3], [0.5, 0, 0.4]]))


def test_a_curve_is_that_of_its_carrier() -> None:
    place = base(np.array([0.0, 1.0, 0.0])).tolist()
    first, second = lines(
        f"point-on-curve, between: [base, part], at: {place}, curve: {{x: cos(s), y: sin(s), z: 0, s: [0, pi]}}"
    )
    s = np.linspace(0, np.pi, 201)
    assert first == pytest.approx(base(np.stack([np.cos(s), np.sin(s), 0 * s], axis=1)))
    assert len(second) == 0


@pytest.mark.parametrize("follower", ["roller: 0.1", "face: {}", ""])
def test_followers_touch_their_cam(follower: str) -> None:
    """A circle of radius 0.5 about the first body's z axis; the follower is on the body's x axis."""
    z, x = base(np.eye(3)[[2, 0]]) - base(np.zeros((1, 3)))
    reach = 0.6 if "roller" in follower else 0.5
    at = base(np.array([reach, 0.0, 0.0])).tolist()
    profile, second = lines(
        f"cam, between: [base, part], at: {at}, axis: {z.tolist()}, profile: {{radius: 0.5}}, {follower.format(x.tolist())}".rstrip(
            ", "
        )
    )
    centre = base(np.zeros(3))
    assert np.linalg.norm(profile - centre, axis=1) == pytest.approx(np.full(201, 0.5))
    assert (profile - centre) @ z == pytest.approx(np.zeros(201), abs=1e-15)
    if "roller" in follower:
        assert np.linalg.norm(second - at, axis=1) == pytest.approx(np.full(len(second), 0.1))
        assert np.linalg.norm(second - centre, axis=1).min() == pytest.approx(0.5, abs=1e-4)
    elif "face" in follower:
        assert (second - at) @ x == pytest.approx([0, 0], abs=1e-15)
        assert (second - at) @ z == pytest.approx([0, 0], abs=1e-15)
        assert np.linalg.norm(second - at, axis=1) == pytest.approx([0.6, 0.6])
    else:
        assert len(second) == 0


def test_a_blade_lies_along_its_direction() -> None:
    _, second = lines("knife-edge, between: [base, part], direction: [1, 1, 0]")
    along = second[1] - second[0]
    assert along / np.linalg.norm(along) == pytest.approx(np.array([1, 1, 0]) / np.sqrt(2))
    assert second.mean(axis=0) == pytest.approx([0.5, 0.0, 0.4])


@pytest.mark.parametrize(
    "joint", ["free, between: [base, part], at: [0, 0, 0]", "weld, between: [base, part], at: [0, 0, 0]", "pfaffian, between: [part], rows: [first.v.x]"]
)  # fmt: skip
def test_no_more_than_a_point(joint: str) -> None:
    system = build_system(read_text(HEAD % joint)[0])
    assert build_outline(system, system.liaison_entries[0]) is None


def test_scenes_have_them() -> None:
    (joint,) = build_scene(read_text(HEAD % "rolling-sphere, between: [base, part], radius: 0.4")[0]).joints
    assert joint.outline is not None and len(joint.outline.second)

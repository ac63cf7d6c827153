"""The camera and the polygons that it sees."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maggi.view.projection import axonometric, facing, plane_of, surface, upwards

# A unit cube's 12 triangles, counter-clockwise seen from outside.
CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
QUADS = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
TRIANGLES = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))])

component = st.floats(-1.0, 1.0)
directions = st.tuples(component, component, component).filter(lambda v: np.linalg.norm(v) > 1e-2)


@given(directions)
def test_cameras_are_right_handed(normal):
    camera = facing(np.array(normal))
    axes = np.stack([camera.right, camera.up, camera.toward])
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert abs(camera.toward @ normal) == pytest.approx(np.linalg.norm(normal))


@pytest.mark.parametrize(
    ("normal", "names"),
    [((0, 1, 0), ("x", "z")), ((0, -2, 0), ("x", "z")), ((1, 0, 0), ("y", "z")), ((0, 0, 1), ("x", "y"))],
)
def test_planes_read_as_usual(normal, names):
    camera = facing(np.array(normal, dtype=float))
    assert camera.axis_names() == names
    assert camera.right.max() == camera.up.max() == 1.0


def test_a_view_from_above_a_corner():
    camera = axonometric()
    assert camera.up[2] > 0.8
    assert camera.toward[2] > 0.0
    assert camera.right[0] > 0.8
    assert camera.axis_names() is None
    assert np.cross(camera.right, camera.up) == pytest.approx(camera.toward)


@pytest.mark.parametrize(
    ("gravity", "up"),
    [
        ((0, 0, 0), (0, 0, 1)),
        ((0, 0, -9.81), (0, 0, 1)),
        ((3, 0, 9), (0, 0, -1)),
        ((0, -1.6, 0), (0, 1, 0)),
        ((2, 1, 0), (-1, 0, 0)),
    ],
)
def test_up_is_against_gravity(gravity, up):
    vertical = upwards(np.array(gravity, dtype=float))
    assert vertical.tolist() == list(up)
    camera = axonometric(vertical=vertical)
    assert camera.up @ vertical > 0.8
    assert camera.toward @ vertical > 0.0
    assert np.cross(camera.right, camera.up) == pytest.approx(camera.toward)
    for normal in np.eye(3):
        camera = facing(normal, vertical)
        assert np.cross(camera.right, camera.up) == pytest.approx(camera.toward)
        assert abs(normal @ vertical) == 1.0 or camera.up == pytest.approx(vertical)
    assert facing(vertical, vertical).toward == pytest.approx(vertical)  # a horizontal plane is seen from above


def test_planes():
    angles = np.linspace(0, 6, 50)
    circle = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    assert np.abs(plane_of(circle)) == pytest.approx([0, 1, 0])
    assert plane_of(circle[:, [0, 1, 1]]) is None  # a line has no plane
    assert plane_of(np.vstack([circle, [[0.0, 0.5, 0.0]]])) is None
    assert plane_of(np.zeros((0, 3))) is None
    assert plane_of(np.zeros((4, 3))) is None
    assert plane_of(circle[:1]) is None


def area(polygon):
    x, y = polygon.T
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


@given(directions)
def test_a_cube_from_anywhere(toward):
    # Cauchy: the faces seen cover the shadow, whose area is the sum of |components| of the direction.
    camera = facing(np.array(toward))
    seen = surface(camera, CUBE, TRIANGLES)
    faces = [corners for corners, triangle in zip(seen.corners, seen.triangle, strict=True) if triangle >= 0]
    areas = np.array([area(face) for face in faces])
    assert (areas > -1e-12).all()  # each is seen from outside
    assert areas.sum() == pytest.approx(np.abs(camera.toward).sum(), abs=1e-5)
    assert ((seen.light >= 0.0) & (seen.light <= 1.0)).all()


def test_edges_of_a_cube_seen_from_a_corner():
    seen = surface(axonometric(), CUBE, TRIANGLES)
    lines = [corners for corners, triangle in zip(seen.corners, seen.triangle, strict=True) if triangle < 0]
    assert len(lines) == 9  # twelve edges, three of them hidden; no diagonals
    assert (seen.triangle >= 0).sum() == 6


def test_near_polygons_come_last():
    far = surface(
        axonometric(), np.vstack([CUBE, CUBE + 3.0 * axonometric().toward]), np.vstack([TRIANGLES, TRIANGLES + 8])
    )
    order = [triangle for triangle in far.triangle if triangle >= 0]
    assert sorted(order, key=lambda triangle: triangle >= 12) == order


def test_an_open_surface_has_an_outline():
    camera = facing(np.array([0.0, 1.0, 0.0]))
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1]])
    assert len(surface(camera, points, np.array([[0, 1, 2]])).corners) == 4
    assert len(surface(camera, points, np.array([[0, 2, 1]])).corners) == 0  # its back

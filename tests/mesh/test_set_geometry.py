"""Bores, faces, edges and solids are told apart and measured."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from maggi.mesh import Mesh, box, set_geometry


def geometry(points):
    points = np.asarray(points, dtype=float)
    count = len(points)
    mesh = Mesh(points, {}, np.arange(count), {})
    return set_geometry(mesh, np.arange(count))


def tube(radius, length, around=16, along=4, arc=2 * np.pi):
    """Points on a cylinder about z, from z = 0."""
    angle = np.arange(around) * arc / around
    z = np.linspace(0.0, length, along)
    a, h = np.meshgrid(angle, z)
    return np.column_stack([radius * np.cos(a.ravel()), radius * np.sin(a.ravel()), h.ravel()])


def rotation(axis, angle):
    axis = np.array(axis) / np.linalg.norm(axis)
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


@given(
    radius=st.floats(1e-3, 10.0),
    slender=st.floats(0.2, 5.0),
    arc=st.floats(1.2, 2 * np.pi),
    turn=st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1), st.floats(0, 3)),
    place=st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-5, 5)),
)
def test_a_cylinder_or_a_part_of_one_anywhere(radius, slender, arc, turn, place):
    assume(np.linalg.norm(turn[:3]) > 0.1)
    R = rotation(turn[:3], turn[3])
    center = radius * np.array(place)
    found = geometry(tube(radius, slender * radius, arc=arc) @ R.T + center)
    assert found.kind == "cylinder"
    assert found.radius == pytest.approx(radius, rel=1e-6)
    np.testing.assert_allclose(abs(found.axis @ R[:, 2]), 1.0, rtol=1e-10)
    assert found.residual < 1e-6 * radius
    off = found.point - center
    np.testing.assert_allclose(np.cross(off, R[:, 2]), 0.0, atol=1e-5 * radius)


def test_the_axis_is_that_of_the_cylinder_though_the_cut_is_oblique():
    points = tube(1.0, 1.0, around=40)
    points[:, 2] *= 1.5 + 0.7 * points[:, 0]
    found = geometry(points)
    assert found.kind == "cylinder"
    np.testing.assert_allclose(found.axis, [0, 0, 1], atol=1e-8)


def test_a_chordal_bore_is_a_cylinder_with_a_residual():
    corners = tube(1.0, 1.0, around=8)
    middles = 0.5 * (corners + np.vstack([np.roll(corners[i : i + 8], -1, axis=0) for i in range(0, 32, 8)]))
    found = geometry(np.vstack([corners, middles]))
    assert found.kind == "cylinder"
    # nodes at 1 and cos(22.5°) in equal numbers
    assert found.radius == pytest.approx((1 + np.cos(np.pi / 8)) / 2, rel=1e-3)
    assert found.residual == pytest.approx((1 - np.cos(np.pi / 8)) / 2, rel=1e-2)


def test_a_plane_face_has_its_normal():
    mesh = box((0.4, 0.2, 0.1), (4, 3, 2), "tet10")
    found = set_geometry(mesh, mesh.node_sets["y_max"])
    assert found.kind == "plane"
    assert found.radius is None
    np.testing.assert_allclose(found.axis, [0, 1, 0], atol=1e-14)
    np.testing.assert_allclose(found.centroid[1], 0.2)


def test_a_whole_box_and_its_sides_together_are_no_cylinder():
    mesh = box((0.4, 0.1, 0.1), (8, 4, 4))
    sides = np.unique(np.concatenate([mesh.node_sets[name] for name in ("y_min", "y_max", "z_min", "z_max")]))
    for nodes in (np.arange(mesh.n_nodes), sides):
        found = set_geometry(mesh, nodes)
        assert found.kind == "general"
        assert found.radius is None
        np.testing.assert_allclose(found.axis, [1, 0, 0], atol=1e-12)


def test_edge_point_circle():
    line = geometry([[0, 0, 0], [0, -1, 0], [0, -3, 0]])
    assert line.kind == "line"
    np.testing.assert_array_equal(line.axis, [0, 1, 0])
    point = geometry([[1, 2, 3]])
    assert (point.kind, point.axis) == ("point", None)
    np.testing.assert_array_equal(point.centroid, [1, 2, 3])
    circle = geometry(tube(0.5, 0.0, along=1, arc=np.pi) + [0, 0, 2])
    assert circle.kind == "circle"
    assert circle.radius == pytest.approx(0.5)
    np.testing.assert_allclose(circle.point, [0, 0, 2], atol=1e-12)


def test_a_rough_plane_is_no_cylinder():
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 9)))
    rough = np.random.default_rng(1).normal(scale=1e-3, size=x.size)
    assert geometry(np.column_stack([x, y, rough])).kind == "general"


@pytest.mark.parametrize("count", [2, 3, 4, 5])
def test_few_nodes_are_no_trouble(count):
    found = geometry(np.eye(5)[:count, :3] + np.arange(count)[:, None] * 0.1)
    assert found.kind in ("line", "plane", "general")
    assert np.isfinite(found.residual)

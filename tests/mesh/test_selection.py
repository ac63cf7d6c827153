"""Selections of nodes by name, box and plane, and what is refused."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from maggi.mesh import box, select
from maggi.model.attachments import BoxSet, NamedSet, PlaneSet
from maggi.model.errors import MeshError

MESH = box((0.3, 0.1, 0.1), (3, 1, 1))
PATH = "bodies.arm.attachments.tip.nodes"


def refused(selection, mesh=MESH):
    with pytest.raises(MeshError) as error:
        select(mesh, selection, PATH)
    assert error.value.path == PATH
    assert error.value.remedy
    return error.value


def test_named_set():
    np.testing.assert_array_equal(select(MESH, NamedSet("x_max")), np.flatnonzero(MESH.nodes[:, 0] == 0.3))


def test_box_takes_nodes_on_its_faces_despite_round_off():
    # 0.1 + 0.2 = 0.30000000000000004 > 0.3
    chosen = select(MESH, BoxSet((0.1 + 0.2, 0.0, 0.0), (0.4, 0.1, 0.1)))
    np.testing.assert_array_equal(chosen, MESH.node_sets["x_max"])
    assert len(select(MESH, BoxSet((-1, -1, -1), (1, 1, 1)))) == MESH.n_nodes


def test_plane_with_a_normal_of_any_length_and_within_its_tolerance():
    np.testing.assert_array_equal(select(MESH, PlaneSet((0, 0, 0.1), (0, 0, -7))), MESH.node_sets["z_max"])
    assert len(select(MESH, PlaneSet((0.02, 0, 0), (1, 0, 0), 0.03))) == 4
    assert len(select(MESH, PlaneSet((0.05, 0, 0), (1, 0, 0), 0.06))) == 8


def test_unknown_names_are_answered_by_near_and_all_names():
    error = refused(NamedSet("X_MAXX"))
    assert "'X_MAXX'" in error.message
    assert "'x_max'" in error.remedy.split("?")[0]
    assert all(name in error.remedy for name in MESH.node_sets)
    assert "the mesh has: x_max" in refused(NamedSet("bearing")).remedy


def test_a_mesh_without_sets_says_so():
    assert "no named sets" in refused(NamedSet("a"), dataclasses.replace(MESH, node_sets={})).remedy


def test_empty_sets_are_refused():
    empty = dataclasses.replace(MESH, node_sets={"pin": np.zeros(0, dtype=np.int64)})
    assert "'pin'" in refused(NamedSet("pin"), empty).message
    assert "0.3, 0.1, 0.1" in refused(BoxSet((1, 1, 1), (2, 2, 2))).remedy
    assert "0.2 m away" in refused(PlaneSet((0.5, 0, 0), (1, 0, 0))).message


@pytest.mark.parametrize(
    "selection",
    [
        BoxSet((1, 0, 0), (0, 1, 1)),
        BoxSet((float("nan"), 0, 0), (1, 1, 1)),
        PlaneSet((0, 0, 0), (0, 0, 0)),
        PlaneSet((0, float("inf"), 0), (0, 0, 1)),
        PlaneSet((0, 0, 0), (0, 0, 1), -1.0),
        PlaneSet((0, 0, 0), (0, 0, 1), float("nan")),
    ],
)
def test_boxes_and_planes_that_are_none_are_refused(selection):
    assert "none" in refused(selection).message or "tolerance" in refused(selection).message

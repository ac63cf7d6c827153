"""What is built: numbers, frames, places, the order of rows, welded point masses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from linkages import four_bar, random_mechanism
from motions import Motion, attachments_at, mesh_body, rigid_body, ritz_body, rows_at

from maggi.bodies.tables import FIXED, MESH, RIGID, RITZ
from maggi.liaisons.registry import JOINTS
from maggi.liaisons.tables import ROW_OWNER
from maggi.model.attachments import Attachment, PointMass
from maggi.model.bodies import GivenMotion, RigidBody
from maggi.model.expression import expression
from maggi.model.geometry import Pose
from maggi.model.joints import Driver, End, Joint
from maggi.model.model import Model
from maggi.system.build import build_system
from maggi.system.dense import dense_mass, dense_rows, floating_velocities, velocity_scale

LEANING = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def test_numbers_of_bodies_and_coordinates():
    rng = np.random.default_rng(0)
    bodies = {"m": mesh_body(rng), "r": rigid_body(rng), "z": ritz_body(rng, 4)}
    bodies["given"] = RigidBody(1.0, motion=GivenMotion())
    system = build_system(Model(bodies))
    assert [system.body(name).index for name in bodies] == [1, 2, 3, 4]
    np.testing.assert_array_equal(system.bodies.kind, [FIXED, MESH, RIGID, RITZ, RIGID])
    np.testing.assert_array_equal(np.diff(system.bodies.offset), [0, 6 + 12, 6, 6 + 4, 6])
    np.testing.assert_array_equal(system.bodies.floating, [0, 1, 1, 1, 0])
    np.testing.assert_array_equal(floating_velocities(system), [*range(6), *range(18, 24), *range(24, 30)])
    assert list(system.mesh_bodies) == [1]


def test_rigid_bodies_by_name_become_rigid():
    rng = np.random.default_rng(0)
    body = mesh_body(rng)
    elastic, rigid = build_system(Model({"m": body})), build_system(Model({"m": body}), rigid=frozenset({"m"}))
    assert rigid.bodies.kind[1] == RIGID and not rigid.mesh_bodies
    assert rigid.coordinates == 6
    for constant in ("mass", "S0", "J0"):
        np.testing.assert_array_equal(getattr(rigid.bodies, constant), getattr(elastic.bodies, constant))


@given(st.integers(0, 2**32 - 1), st.integers(1, 9), st.integers(0, 4))
def test_order_of_rows(seed, count, loops):
    """Every row once, with its liaison; the skyline holds all couplings; incidence is that of the coefficients."""
    system = build_system(random_mechanism(seed, count, loops, list(JOINTS)))
    table, bodies = system.liaisons, system.bodies
    assert sorted(i for entry in system.liaison_entries for i in entry.rows) == list(range(system.rows))
    for owner, entry in enumerate(system.liaison_entries):
        np.testing.assert_array_equal(table.row[entry.rows, ROW_OWNER], owner)
        assert len(entry.rows) == len(JOINTS[entry.kind].rows) + JOINTS[entry.kind].screw
    rows = dense_rows(system, system.start, 0.0)
    assert np.abs(rows.position).max(initial=0.0) < 1e-13  # joints are closed in the initial pose
    coupled = np.abs(rows.A) @ np.abs(rows.A).T > 0.0
    for i in range(system.rows):
        assert np.flatnonzero(coupled[i])[0] >= table.skyline_first[i] or not coupled[i].any()
        assert table.skyline_first[i] <= i
    np.testing.assert_array_equal(np.diff(table.skyline_start), np.arange(system.rows) - table.skyline_first + 1)
    touched = {
        (b, int(i))
        for b in range(1, bodies.kind.size)
        for i in table.incidence[table.incidence_start[b] : table.incidence_start[b + 1], 0]
    }
    for b in range(1, bodies.kind.size):
        columns = rows.A[:, bodies.offset[b] : bodies.offset[b + 1]]
        assert {(b, int(i)) for i in np.flatnonzero(np.abs(columns).sum(axis=1))} <= touched


def test_a_chain_has_a_short_skyline():
    """Joints of a long chain, given in any order: each is coupled with its neighbours only."""
    count = 30
    bodies = {f"b{i}": RigidBody(1.0) for i in range(count)}
    ends = ["ground", *bodies]
    order = np.random.default_rng(1).permutation(count)
    joints = {f"j{i}": Joint("spherical", End(ends[i]), End(ends[i + 1]), at=(float(i), 0.0, 0.0)) for i in order}
    system = build_system(Model(bodies, joints))
    width = np.arange(system.rows) - system.liaisons.skyline_first
    assert width.max() <= 5  # three rows of a joint with the three before it


def test_frames_of_joints_are_those_of_the_model():
    """z along `axis`; x and y along `axes`; in both bodies the same directions at the start."""
    bodies = {"a": RigidBody(1.0, pose=Pose((1.0, 0.0, 0.0), LEANING)), "b": RigidBody(1.0)}
    joints = {
        "pin": Joint("revolute", End("a"), End("b"), at=(1.0, 2.0, 3.0), axis=(0.0, 3.0, 4.0)),
        "cross": Joint("universal", End("a"), End("b"), at=(0.0, 0.0, 0.0), axes=((0.0, 2.0, 0.0), (0.0, 0.0, 5.0))),
        "ball": Joint("spherical", End("a"), End("b"), at=(0.0, 0.0, 0.0)),
    }
    table = build_system(Model(bodies, joints)).liaisons
    first = np.array(LEANING) @ table.frame[:, 0]
    np.testing.assert_allclose(first, table.frame[:, 1], atol=1e-15)
    np.testing.assert_allclose(first[0][:, 2], [0.0, 0.6, 0.8], atol=1e-15)
    np.testing.assert_allclose(first[1][:, :2].T, [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], atol=1e-15)
    np.testing.assert_allclose(first[2], np.eye(3), atol=1e-15)
    for frame in first:
        np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-15)
        assert np.linalg.det(frame) == pytest.approx(1.0)


def test_places_of_joints():
    """`at` is global; one named attachment gives the place; a rigid body is held where the other's attachment is."""
    bodies = {
        "a": RigidBody(1.0, pose=Pose((1.0, 0.0, 0.0), LEANING), attachments={"p": Attachment(at=(2.0, 0.0, 0.0))}),
        "b": RigidBody(1.0, pose=Pose((0.0, 5.0, 0.0))),
    }
    joints = {
        "at": Joint("spherical", End("a"), End("b"), at=(1.0, 1.0, 0.0)),
        "named": Joint("spherical", End("a", "p"), End("b")),
        "moved": Joint("spherical", End("a", "p"), End("ground"), at=(1.0, 1.0, 0.0)),
    }
    system = build_system(Model(bodies, joints))
    table, point = system.liaisons, system.bodies.attachment_point
    np.testing.assert_allclose(
        point[table.joint[:, 0]], [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0]], atol=1e-15
    )
    np.testing.assert_allclose(
        point[table.joint[:, 1]], [[1.0, -4.0, 0.0], [1.0, -3.0, 0.0], [1.0, 1.0, 0.0]], atol=1e-15
    )


@pytest.mark.parametrize("make", [rigid_body, ritz_body], ids=["rigid", "ritz"])
def test_point_masses_are_welded_bodies(make):
    """A body of their mass at their offset, in the host's axes, that follows the attachment in every motion."""
    rng = np.random.default_rng(2)
    host = make(rng, p=(0.3, 0.1, -0.4))
    inertia = ((0.1, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.3))
    masses = (PointMass(2.0, (0.0, 0.5, 0.0), inertia), PointMass(3.0))
    host.attachments["p"] = Attachment(at=(0.3, 0.1, -0.4), point_masses=masses)
    system = build_system(Model({"host": host}))
    assert [(e.name, e.visible) for e in system.body_entries] == [
        ("host", True),
        ("host.p.mass1", False),
        ("host.p.mass2", False),
    ]
    assert [(e.kind, e.visible, len(e.rows)) for e in system.liaison_entries] == [("weld", False, 6)] * 2
    np.testing.assert_allclose(system.bodies.mass[2:], [2.0, 3.0])
    np.testing.assert_allclose(system.bodies.S0[2:], [[0.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(system.bodies.J0[2], np.array(inertia) + np.diag([0.5, 0.0, 0.5]), atol=1e-15)
    np.testing.assert_allclose(rows_at(system, system.start, 0.0).position, 0.0, atol=1e-14)
    # no inertia about any axis: only then the iteration matrix gets a floor
    np.testing.assert_array_equal(system.inertia_floor > 0.0, [False, False, False, True])
    motion = Motion(system, 3)
    at = attachments_at(system, motion.at_rest(0.0))
    state = motion.at_rest(0.0)
    for b in (2, 3):
        state.origin[b], state.rotation[b] = at.position[0], at.rotation[0]
    np.testing.assert_allclose(rows_at(system, state, 0.0).position, 0.0, atol=1e-13)


def test_names_of_rows():
    model = four_bar()
    joints = {
        **model.joints,
        "motor": Driver("j0", "angle", expression("t")),
        "pace": Driver("j3", "speed", expression("1")),
    }
    system = build_system(Model(model.bodies, joints))
    names = {entry.name: [system.row_name(int(i)) for i in entry.rows] for entry in system.liaison_entries}
    assert names["j1"] == [
        "j1: offset along its x axis",
        "j1: offset along its y axis",
        "j1: offset along its z axis",
        "j1: rotation about its y axis",
        "j1: rotation about its x axis",
    ]
    assert names["motor"] == ["motor: driven coordinate"]
    assert names["pace"] == ["pace: driven speed"]


def test_size_is_the_extent_of_the_mechanism():
    """The diagonal of the box around joints, attachments and centres of mass; 1 m where all is one point."""
    bodies = {"a": RigidBody(1.0, (1.0, 0.0, 0.0), attachments={"p": Attachment(at=(0.0, 2.0, 0.0))})}
    joints = {"pin": Joint("spherical", End("ground"), End("a"), at=(0.0, 0.0, -2.0))}
    assert build_system(Model(bodies, joints)).size == pytest.approx(3.0)
    assert build_system(Model({"a": RigidBody(1.0)})).size == 1.0
    assert build_system(Model({})).size == 1.0


def test_dense_mass_and_scales():
    """Blocks of the bodies, turned to nothing else; angular velocities count with the mechanism's size."""
    rng = np.random.default_rng(5)
    system = build_system(Model({"a": rigid_body(rng), "z": ritz_body(rng, 2), "m": mesh_body(rng)}))
    M = dense_mass(system, system.start)
    np.testing.assert_allclose(M, M.T, atol=1e-14)
    assert M[0, 0] == system.bodies.mass[1] and M[6, 6] == system.bodies.mass[2]
    np.testing.assert_allclose(M[3:6, 3:6], system.bodies.J0[1])
    np.testing.assert_allclose(M[12:14, 12:14], system.model.bodies["z"].terms.m)
    assert not M[20:, 20:].any()  # the mesh's nodes are not in the small system
    s = system.size
    frame = [1.0, 1.0, 1.0, s, s, s]
    np.testing.assert_array_equal(velocity_scale(system), [*frame, *frame, 1.0, 1.0, *frame, *frame, *frame])


def test_same_meshes_can_be_given():
    rng = np.random.default_rng(6)
    model = Model({"m": mesh_body(rng)})
    told = []
    first = build_system(model, announce=told.append)
    second = build_system(model, meshes={"m": first.mesh_bodies[1]}, announce=told.append)
    assert second.mesh_bodies[1] is first.mesh_bodies[1]
    assert told == ["assembling m"]

"""Every joint of the library and its drivers: rows and coordinates against differences along random motions (Eq. T7)."""

from dataclasses import replace

import numpy as np
import pytest
from motions import Motion, derivative, hold_together, mesh_body, rigid_body, ritz_body, rows_at, second_derivative

from maggi.liaisons.registry import JOINTS, lower_pair
from maggi.liaisons.tables import COORDINATE_KIND, ROTATION, ROTATION_SECOND, ROTATION_VECTOR, TRANSLATION
from maggi.model.expression import expression
from maggi.model.joints import Driver, End, Joint
from maggi.model.model import Model
from maggi.system.build import build_system
from maggi.system.dense import dense_rows

MAKE = {
    "rigid": lambda rng: rigid_body(rng, p=(0.3, -0.2, 0.5)),
    "ritz": lambda rng: ritz_body(rng, 4, p=(0.3, 0.1, -0.4)),
    "mesh": lambda rng: mesh_body(rng),
}
ENDS = [("rigid", "rigid"), ("ground", "rigid"), ("ritz", "rigid"), ("rigid", "mesh")]
PITCH = 0.7
FUNCTION = "0.3*sin(2*t) + 0.1*t*t - 0.2*t"


def quantities(kind):
    """What of a joint can be driven: an angle or a displacement where there is one, a speed where one coordinate is.

    One of a screw's two is enough.
    """
    if kind.screw:
        return ["angle"]
    angles = sum(what in (ROTATION, ROTATION_SECOND) for what, _ in kind.coordinates)
    shifts = sum(what == TRANSLATION for what, _ in kind.coordinates)
    return ["angle"] * (angles == 1) + ["displacement"] * (shifts == 1) + ["speed"] * (angles + shifts == 1)


def pair(name, ends, seed, drivers=True):
    """Two bodies, or ground and a body, at random poses with a joint and every driver that it can have."""
    rng = np.random.default_rng(seed)
    bodies = {f"{end}{i}": MAKE[end](rng) for i, end in enumerate(ends) if end != "ground"}
    first, second = (End("ground") if end == "ground" else End(f"{end}{i}", "p") for i, end in enumerate(ends))
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    pair = None if name == "constant-velocity" else (tuple(axes[1]), tuple(axes[2]))
    joint = Joint(name, first, second, axis=tuple(axes[0]), axes=pair, pitch=PITCH)
    joints = {"joint": joint}
    if drivers:
        joints |= {what: Driver("joint", what, expression(FUNCTION)) for what in quantities(JOINTS[name])}
    return build_system(Model(bodies, joints))


def on_the_joint(system, name, ends, seed, scale=0.4):
    """A motion that satisfies the joint, with coordinates that are cubic in time."""
    kind = JOINTS[name]
    rates = scale * np.random.default_rng(seed + 100).normal(size=(4, len(kind.coordinates)))
    if kind.screw:
        rates[:, 0] = PITCH / (2.0 * np.pi) * rates[:, 1]

    def coordinates(t):
        return t ** np.arange(4) @ rates

    motion = Motion(system, seed)
    hold_together(motion, 0, kind, coordinates, ends.index("rigid") if ends[1] != "rigid" else 1)
    return motion, coordinates


EVERY = pytest.mark.parametrize(
    ("name", "ends"),
    [(name, ends) for name in JOINTS for ends in ENDS],
    ids=lambda x: x if isinstance(x, str) else "-".join(x),
)


@EVERY
def test_rows_of_a_joint_hold_for_any_motion(name, ends):
    """A v + b = Φ̇ and A v̇ + γ = Φ̈, also where the joint is open; a thread turns about an axis that both ends share."""
    system = pair(name, ends, seed=2, drivers=False)
    motion = Motion(system, 3)
    rows = rows_at(system, motion.state(), 0.0)
    assert np.abs(rows.position).max(initial=1.0) > 0.1
    own = [i for i in range(system.rows) if "thread" not in system.row_label(i)]
    rate = derivative(lambda t: rows_at(system, motion.at_rest(t), t).position)
    np.testing.assert_allclose(rows.velocity[own], rate[own], atol=1e-10)
    rate = derivative(lambda t: rows_at(system, motion.state(t), t).velocity)
    np.testing.assert_allclose(rows.acceleration[own], rate[own], atol=1e-9)


@EVERY
def test_rows_and_coordinates_on_the_joint(name, ends):
    """Motions that the definition of a joint allows: Φ = 0 and its rates vanish, coordinates are those given."""
    system = pair(name, ends, seed=4)
    motion, coordinates = on_the_joint(system, name, ends, seed=5)
    instant = 0.05
    state = motion.state(instant)
    rows, own = rows_at(system, state, instant), ~system.driven
    assert np.abs(rows.position[own]).max(initial=0.0) < 1e-13
    assert np.abs(rows.velocity[own]).max(initial=0.0) < 1e-10
    assert np.abs(rows.acceleration[own]).max(initial=0.0) < 1e-9
    np.testing.assert_allclose(rows.coordinate[:, 0], coordinates(instant), atol=1e-13)
    simple = system.liaisons.coordinate[:, COORDINATE_KIND] != ROTATION_VECTOR
    np.testing.assert_allclose(rows.coordinate[simple, 1], derivative(coordinates, instant)[simple], atol=1e-10)
    bend = second_derivative(coordinates, instant)
    np.testing.assert_allclose(rows.coordinate[simple, 2], bend[simple], atol=1e-8)


DRIVABLE = pytest.mark.parametrize(
    ("name", "ends"),
    [(name, ends) for name in JOINTS if quantities(JOINTS[name]) for ends in ENDS],
    ids=lambda x: x if isinstance(x, str) else "-".join(x),
)


@DRIVABLE
def test_rows_of_drivers(name, ends):
    """φ = coordinate − f(t) and its rates; a driven speed has no position and φ̇ = rate − f(t)."""
    system = pair(name, ends, seed=6)
    motion, coordinates = on_the_joint(system, name, ends, seed=7)
    instant = 0.07
    f = 0.3 * np.sin(2 * instant) + 0.1 * instant**2 - 0.2 * instant
    fd = 0.6 * np.cos(2 * instant) + 0.2 * instant - 0.2
    rows = rows_at(system, motion.state(instant), instant)
    rate = derivative(lambda t: rows_at(system, motion.state(t), t).velocity, instant)
    driven = np.flatnonzero(system.driven)
    assert len(driven) == len(quantities(JOINTS[name]))
    for i in driven:
        c = system.owner(i).coordinates[0]
        x, xd = coordinates(instant)[c], derivative(coordinates, instant)[c]
        holonomic = system.row_label(i) == "driven coordinate"
        assert system.holonomic[i] == holonomic
        assert rows.position[i] == pytest.approx(x - f if holonomic else 0.0, abs=1e-12)
        assert rows.velocity[i] == pytest.approx(xd - (fd if holonomic else f), abs=1e-10)
        assert rows.acceleration[i] == pytest.approx(rate[i], abs=1e-9)


@EVERY
def test_coefficients_are_those_of_the_velocities(name, ends):
    """A v + b = the value of each row for any velocities, with one A and b at one position."""
    system = pair(name, ends, seed=8)
    motion, _ = on_the_joint(system, name, ends, seed=9)
    state = motion.state()
    rng = np.random.default_rng(10)
    A = dense_rows(system, state, 0.0).A
    for _ in range(3):
        moving = replace(state, v=rng.normal(size=state.v.size), vd=rng.normal(size=state.v.size))
        rows = rows_at(system, moving, 0.0)
        np.testing.assert_allclose(A @ moving.v + rows.rhs, rows.velocity, atol=1e-13)
        still = replace(state, v=moving.v, vd=np.zeros(state.v.size))
        gamma = rows_at(system, still, 0.0).acceleration
        np.testing.assert_allclose(A @ moving.vd + gamma, rows.acceleration, atol=1e-12)


@pytest.mark.parametrize("name", JOINTS)
def test_what_a_joint_leaves_free_are_its_coordinates(name):
    """Two free bodies have 6 + (number of coordinates) velocities left, no row is redundant."""
    ends = ("rigid", "rigid")
    system = pair(name, ends, seed=11, drivers=False)
    motion, _ = on_the_joint(system, name, ends, seed=12)
    state = motion.state()
    A = dense_rows(system, state, 0.0).A
    singular = np.linalg.svd(A, compute_uv=False)
    # a screw's two coordinates move together; a constant-velocity joint bends two ways that it does not measure
    freedoms = {"screw": 1, "constant-velocity": 2}.get(name, len(JOINTS[name].coordinates))
    assert len(singular) == 6 - freedoms
    assert freedoms == 6 or singular[-1] > 1e-2 * singular[0]
    assert np.linalg.matrix_rank(A) == 12 - (6 + freedoms)


@pytest.mark.parametrize("name", [name for name in JOINTS if quantities(JOINTS[name])])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_coordinates_count_turns(name, sense):
    """Several turns in steps of up to 2.5 rad; each step starts from the coordinate before it."""
    system = pair(name, ("rigid", "rigid"), seed=13, drivers=False)
    kind = JOINTS[name]
    motion = Motion(system, 14)
    share = np.array([PITCH / (2.0 * np.pi), 1.0]) if kind.screw else np.ones(len(kind.coordinates))
    hold_together(motion, 0, kind, lambda t: share * sense * (3.0 * t + 0.5 * t * t), 1)
    previous = np.zeros(len(kind.coordinates))
    for t in np.linspace(0.0, 4.0, 12)[1:]:
        previous = rows_at(system, motion.at_rest(t), t, previous).coordinate[:, 0]
        np.testing.assert_allclose(previous, share * sense * (3.0 * t + 0.5 * t * t), rtol=1e-12)
    assert abs(previous[-1]) > 6.0 * np.pi


def test_a_lower_pair_turns_about_one_axis_or_about_all():
    with pytest.raises(ValueError, match="no lower pair is free to rotate about 'xy' alone"):
        lower_pair("odd", "", "xy")

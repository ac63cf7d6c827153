"""Reference problems of the literature by the ordinary differential equation and DOP853 (CASES A01–A03, A06, B1–B3).

Every number says how many digits of it are known: A01 and B2 are closed forms, A02 a quadrature of one freedom, A03 and
A06 integrations in quadruple precision, B1's transient and B3 are printed with the digits given here.
"""

import numpy as np
import pytest
from reference_models import (
    SQUEEZER_START,
    ball_on_turntable,
    car_axis,
    disc_in_a_circle,
    four_bars,
    pendulum,
    rolling_disc,
    sleigh,
    squeezer,
)

import maggi


def end_of(model, t, rtol=1e-11, strategy=None):
    """The equations, and the trajectory whose one state is that at time t."""
    equations = maggi.ode(model, strategy=strategy)
    return equations, equations.solve((0.0, t), rtol=rtol, t_eval=[t])


def place(found, name):
    """Origin of a body at the end."""
    return found.origin[-1, found.system.body(name).index]


def angle(found, name):
    """Unwrapped coordinate of a joint at the end."""
    entry = next(entry for entry in found.system.liaison_entries if entry.name == name)
    return found.coordinates[-1, entry.coordinates[0]]


@pytest.mark.parametrize(("rtol", "error"), [(1e-8, 1e-6), (1e-11, 1e-9)])
def test_pendulum(rtol, error):
    """A01, x and y after 10 s, by Jacobi's elliptic functions."""
    _, found = end_of(pendulum(), 10.0, rtol)
    np.testing.assert_allclose(place(found, "mass")[:2], [-0.27508746257611686, -0.961419205099125064], atol=error)


FOUR_BARS = {
    1: (0.4783850577609706, 0.8781501787912093, -1.966934719440319),
    2: (0.3284581115408154, 0.9445185381786010, -1.506642180841829),
}


@pytest.mark.parametrize("strategy", ["lu", "svd", "tree"])
@pytest.mark.parametrize("count", [1, 2])
def test_four_bars_through_singular_positions(count, strategy):
    """A02: ten times through positions where the rows lose rank; all rods stay parallel, and B0 is where it should be."""
    equations = maggi.ode(four_bars(count), strategy=strategy)
    assert equations.freedoms == 1
    found = equations.solve((0.0, 10.0), rtol=1e-10)
    rods = [found.rotation[:, found.system.body(f"rod{k}").index] for k in range(count + 1)]
    assert max(np.abs(rod - rods[0]).max() for rod in rods) < 1e-11
    x, y, rate = FOUR_BARS[count]
    first = found.system.body("rod0").index
    np.testing.assert_allclose(rods[0][-1] @ [0.0, 1.0, 0.0], [x, y, 0.0], atol=3e-7)
    assert found.v[-1, found.system.bodies.offset[first] + 5] == pytest.approx(rate, abs=1e-6)


SQUEEZER = {
    "beta": 15.8107711951537073,
    "theta": -15.7563710584118386,
    "gamma": 0.0408222401196458029,
    "phi": -0.534730116342079564,
    "delta": 0.524409965879954032,
    "omega": 0.534730116342079564,
    "epsilon": 1.04808074104193794,
}


def test_squeezer():
    """A03: the seven angles at 0.03 s, two and a half turns of β among them, to nine digits."""
    equations = maggi.ode(squeezer())
    start = equations.accelerations(0.0, equations.y0)
    beta = start[equations.system.bodies.offset[equations.system.body("K1").index] + 5]
    assert beta == pytest.approx(14222.4439199541138705911625887, rel=1e-11)
    found = equations.solve((0.0, 0.03), rtol=1e-11, t_eval=[0.03])
    angles = [angle(found, name) + start for name, start in zip(SQUEEZER, SQUEEZER_START, strict=True)]
    np.testing.assert_allclose(angles, list(SQUEEZER.values()), rtol=1e-9)


@pytest.mark.slow
def test_squeezer_to_eleven_digits():
    _, found = end_of(squeezer(), 0.03, 1e-12, "lu")
    angles = [angle(found, name) + start for name, start in zip(SQUEEZER, SQUEEZER_START, strict=True)]
    np.testing.assert_allclose(angles, list(SQUEEZER.values()), rtol=1e-11)


def test_car_axis():
    """A06: both masses at 3 s; the left slides on a prescribed frame, a rod holds them apart, neither has inertia."""
    _, found = end_of(car_axis(), 3.0, 1e-10)
    left, right = place(found, "left"), place(found, "right")
    np.testing.assert_allclose(left[:2], [0.0493455784275240936, 0.496989460230008118], atol=1e-10)
    np.testing.assert_allclose(right[:2], [1.04174252488542618, 0.373911027265365792], atol=1e-10)
    v = [found.rotation[-1, b] @ found.v[-1, found.system.bodies.offset[b] :][:3] for b in (2, 3)]
    np.testing.assert_allclose(v[0][:2], [-0.0770583684035920785, 0.00744686659206841677], atol=1e-9)
    np.testing.assert_allclose(v[1][:2], [0.0175568157535417359, 0.770341043779601109], atol=1e-9)


def test_disc_in_a_circle():
    """B1: after one turn of the centre, 2π / 1.5 s, the disc's axis and centre are where they were."""
    equations, found = end_of(disc_in_a_circle(), 2.0 * np.pi / 1.5)
    start = equations.system.start
    np.testing.assert_allclose(place(found, "disc"), start.origin[1], atol=1e-9)
    np.testing.assert_allclose(found.rotation[-1, 1][:, 2], start.rotation[1][:, 2], atol=1e-9)


def test_disc_in_a_wobble():
    """B1: leaning by 0.3 rad, 6 rad/s of spin and 0.4 of turn; axis and centre at 5 s, eleven digits of each."""
    normal = np.array([0.0, np.cos(0.3), np.sin(0.3)])
    omega = 6.0 * normal + [0.0, 0.0, 0.4]
    up = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
    velocity = np.cross(-0.5 * up / np.linalg.norm(up), omega)
    model = rolling_disc(normal, (0.0, 0.0, 0.5 * np.cos(0.3)), omega, velocity)
    _, found = end_of(model, 5.0, 1e-12)
    axis = [-0.85566939223, -0.38126984808, 0.34994741627]
    np.testing.assert_allclose(found.rotation[-1, 1][:, 2], axis, atol=1e-10)
    np.testing.assert_allclose(place(found, "disc"), [-3.34247725691, -4.45713351486, 0.46838467253], atol=1e-10)


def test_sleigh():
    """B2: place, speed, turn and its rate after 5 s, in closed form."""
    _, found = end_of(sleigh(), 5.0)
    R = found.rotation[-1, 1]
    np.testing.assert_allclose(place(found, "sleigh")[:2], [-1.238658495146, 3.887476718956], atol=1e-10)
    assert np.arctan2(R[1, 0], R[0, 0]) == pytest.approx(2.1238235043617117, abs=1e-11)
    np.testing.assert_allclose(found.v[-1, [0, 1, 5]], [0.9591636820011811, 0.0, 0.004782130533766307], atol=1e-11)


@pytest.mark.parametrize(("tilt", "expected"), [(0.0, (0.34416753, -0.15834557)), (0.05, (0.36315341, 2.83490314))])
def test_ball_on_a_turntable(tilt, expected):
    """B3: a circle about a point that drifts across the slope; eight digits after 7 s."""
    _, found = end_of(ball_on_turntable(tilt), 7.0)
    np.testing.assert_allclose(place(found, "ball")[:2], expected, atol=1e-8)

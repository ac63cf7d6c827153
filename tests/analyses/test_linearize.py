"""Linearised equations against closed forms: pendulums, rolling discs, and the bicycle of Meijaard et al. (2007)."""

from dataclasses import replace

import numpy as np
import pytest
from reference_models import Z, bicycle, diagonal, disc_in_a_circle, rolling_disc
from transient_runs import joint

from maggi.analyses.linearize import eigenvalues_of, linearize
from maggi.model import Attachment, Driver, Model, RigidBody, TorsionSpring, expression

STRATEGIES = ("lu", "qr", "svd", "tree")


def hanging(count, length=0.7, mass=1.3):
    """Bobs of a given mass on rods one below the other, in a plane."""
    bodies, joints, above = {}, {}, "ground"
    for k in range(count):
        bodies[f"rod{k}"] = RigidBody(
            mass,
            (0.0, -length, 0.0),
            diagonal(1e-3, 1e-3, 1e-3),
            attachments={"end": Attachment(at=(0.0, -length, 0.0))},
        )
        at = (0.0, -length * k, 0.0)
        bodies[f"rod{k}"] = replace(bodies[f"rod{k}"], pose=replace(bodies[f"rod{k}"].pose, origin=at))
        joints[f"hinge{k}"] = joint("revolute", above, f"rod{k}", at=at, axis=Z)
        above = f"rod{k}"
    return Model(bodies, joints, gravity=(0.0, -9.81, 0.0))


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_damped_pendulum(strategy):
    """(m l² + I) θ̈ + d θ̇ + (m g l + k) θ = 0."""
    length, mass, inertia = 0.7, 1.3, 1e-3
    model = replace(hanging(1), forces={"spring": TorsionSpring("hinge0", 2.0, 0.3)})
    found = linearize(model, strategy=strategy)
    total, stiffness = mass * length**2 + inertia, mass * 9.81 * length + 2.0
    ratio = np.array([found.damping[0, 0], found.stiffness[0, 0]]) / found.mass[0, 0]
    np.testing.assert_allclose(ratio, [0.3 / total, stiffness / total], rtol=1e-10)
    expected = np.roots([total, 0.3, stiffness])
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(expected), rtol=1e-10)
    assert found.unsteady < 1e-12


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_double_pendulum(strategy):
    """Two rods' frequencies from the mass and stiffness matrices in their absolute angles."""
    length, mass, inertia = 0.7, 1.3, 1e-3
    M = mass * length**2 * np.array([[2.0, 1.0], [1.0, 1.0]]) + inertia * np.eye(2)
    K = mass * 9.81 * length * np.diag([2.0, 1.0])
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)
    found = linearize(hanging(2), strategy=strategy)
    np.testing.assert_allclose(np.sort(found.eigenvalues.imag)[2:] ** 2, squares, rtol=1e-10)
    np.testing.assert_allclose(found.eigenvalues.real, 0.0, atol=1e-10)
    again = np.sort(np.linalg.eigvals(np.linalg.solve(found.mass, found.stiffness)).real)
    np.testing.assert_allclose(again, squares, rtol=1e-10)
    np.testing.assert_allclose(found.mass, found.mass.T, atol=1e-14)
    np.testing.assert_allclose(found.stiffness, found.stiffness.T, atol=1e-9)
    np.testing.assert_allclose(found.damping, 0.0, atol=1e-10)


def test_a_rotating_pendulum():
    """A bob on a rotor driven about the vertical: ω₀² = g/l − Ω² hanging down (the rod's own inertia left out)."""
    speed, length = 2.0, 0.7
    rotor = RigidBody(1.0, inertia=diagonal(0.1, 0.1, 0.1))
    bob = RigidBody(1.3, (0.0, 0.0, -length))
    joints = {
        "shaft": joint("revolute", "ground", "rotor", at=(0.0, 0.0, 0.0), axis=Z),
        "motor": Driver("shaft", "angle", expression(f"{speed}*t")),
        "hinge": joint("revolute", "rotor", "bob", at=(0.0, 0.0, 0.0), axis=(1.0, 0.0, 0.0)),
    }
    found = linearize(Model({"rotor": rotor, "bob": bob}, joints, gravity=(0.0, 0.0, -9.81)))
    np.testing.assert_allclose(
        found.eigenvalues.imag, [-np.sqrt(9.81 / length - speed**2), np.sqrt(9.81 / length - speed**2)], rtol=1e-10
    )


# Weave (a pair), capsize, castering: from the 2 x 2 matrices of the source's appendix, in 40 digits (CASES B5).
BICYCLE = {
    1.0: (3.526961709900694 + 0.80774027519931j, -3.134231250665784, -7.110080146374408),
    4.0: (0.4132533152112413 + 3.079108186032054j, -1.429444273613257, -12.15861426576444),
    5.0: (-0.7753418821958419 + 4.464867713788225j, -0.3228664290040871, -14.07838969279825),
    10.0: (-3.720168404372876 + 10.90681139476288j, 0.1610533865317155, -24.624596350174),
}


@pytest.mark.parametrize("strategy", STRATEGIES)
@pytest.mark.parametrize("speed", list(BICYCLE))
def test_the_bicycle(speed, strategy):
    """Seven positions, three freedoms: four eigenvalues and six zeros (place, heading, both wheels' angles, speed)."""
    found = linearize(bicycle(speed), strategy=strategy)
    assert found.A.shape == (10, 10)
    assert found.mass is None
    assert found.unsteady < 1e-11
    assert np.sum(found.eigenvalues == 0.0) == 6
    for value in BICYCLE[speed]:
        assert np.abs(found.eigenvalues - value).min() < 1e-9 * abs(value)


def test_the_bicycle_at_its_weave_and_capsize_speeds():
    """A pair crosses the imaginary axis with 3.435033848661436 rad/s, a real root crosses zero (CASES B5)."""
    weave = linearize(bicycle(4.2923825363411039587)).eigenvalues
    assert np.abs(weave - 3.435033848661436j).min() < 1e-9
    capsize = linearize(bicycle(6.0242620153883588899)).eigenvalues
    assert np.sort(np.abs(capsize))[6] < 1e-9


@pytest.mark.parametrize("strategy", STRATEGIES)
@pytest.mark.parametrize("spin", [5.0, 2.6, 2.5])
def test_an_upright_rolling_disc(spin, strategy):
    """ω² = [C (C + m r²) s² − A m g r] / [A (A + m r²)] (CASES B1), whatever the disc's own axes do."""
    r, A, C = 0.5, 0.0625, 0.125
    square = (C * (C + r**2) * spin**2 - A * 9.81 * r) / (A * (A + r**2))
    found = linearize(
        rolling_disc((1.0, 0.0, 0.0), (0.0, 0.0, r), (spin, 0.0, 0.0), (0.0, -r * spin, 0.0)), strategy=strategy
    )
    pair = np.emath.sqrt(-square) * np.array([1.0, -1.0])
    assert all(np.abs(found.eigenvalues - value).min() < 1e-9 for value in pair)
    assert np.sum(found.eigenvalues == 0.0) == 6


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_disc_in_a_steady_circle(strategy):
    """One pair of its own; of the place in the plane, seen in axes that turn with 1.5 rad/s, another; zeros else.

    The pair's frequency is that of a small disturbance in a run: see tests/verification/test_ode_references.py.
    """
    found = linearize(disc_in_a_circle(), strategy=strategy)
    assert found.unsteady < 1e-12
    frequencies = np.sort(found.eigenvalues.imag)[-2:]
    np.testing.assert_allclose(frequencies, [1.5, 3.668046], atol=1e-6)
    np.testing.assert_allclose(found.eigenvalues.real, 0.0, atol=1e-9)
    assert np.sum(found.eigenvalues == 0.0) == 4


def test_a_fall_is_unsteady():
    """What is left in the axes going along is g."""
    body = RigidBody(1.0, inertia=diagonal(1.0, 2.0, 3.0))
    assert linearize(Model({"stone": body}, gravity=(0.0, 0.0, -9.81))).unsteady == pytest.approx(9.81)


def test_eigenvalues_with_zeros_by_structure():
    """Jordan blocks of zero, of sizes 3 and 1, in other axes; and a pair."""
    J = np.zeros((6, 6))
    J[0, 1] = J[1, 2] = 1.0
    J[4, 5], J[5, 4] = 2.0, -2.0
    T = np.random.default_rng(0).normal(size=(6, 6))
    values = eigenvalues_of(T @ J @ np.linalg.inv(T))
    assert np.sum(values == 0.0) == 4
    np.testing.assert_allclose(np.sort(values.imag)[[0, -1]], [-2.0, 2.0], rtol=1e-10)
    assert eigenvalues_of(np.zeros((0, 0))).shape == (0,)

"""T2 and T5a against Lagrange's equations and point accelerations, both differentiated by sympy.

The body is a handful of mass points, each with its own N: an integral by quadrature is such a body, and nothing of the
derivation depends on more. The frame moves by given functions of time, the coordinates are free functions.
"""

from dataclasses import dataclass, replace

import mpmath
import numpy as np
import pytest
import sympy as sp

from maggi.elements.moving_frame import (
    SKEW,
    SKEW2,
    FrameMotion,
    InertiaConstants,
    frame_resultants,
    inertia_constants,
    maggi_vector,
    reorient,
)

POINTS, COUNT = 3, 3


@dataclass
class Oracle:
    terms: InertiaConstants
    motion: FrameMotion
    state: tuple[np.ndarray, np.ndarray, np.ndarray]
    lagrange: np.ndarray
    force: np.ndarray
    moment: np.ndarray


def numbers(*shape, seed):
    """Random numbers of two decimals, as exact rationals for sympy."""
    return np.random.default_rng(seed).integers(-99, 100, shape) / 100.0


@pytest.fixture(scope="module")
def oracle():
    with mpmath.workdps(30):
        return derive()


def derive():
    t = sp.Symbol("t")
    d, v, a = (sp.Matrix(sp.symbols(f"{name}0:{COUNT}")) for name in "dva")
    N, r = numbers(POINTS, 3, COUNT, seed=1), numbers(POINTS, 3, seed=2)
    weights = np.array([0.7, 1.3, 0.4])
    rational = lambda x: sp.Matrix(np.vectorize(lambda y: sp.Rational(str(y)))(x))  # noqa: E731
    origin = sp.Matrix([t**2 + sp.sin(t), t**3 / 3 - t, sp.cos(2 * t)])
    turns = [(2, t + t**2 / 2), (1, sp.sin(t) / 2), (0, t**2 - t / 3)]
    R = sp.eye(3)
    for axis, angle in turns:
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = sp.eye(3)
        turn[i, i] = turn[j, j] = sp.cos(angle)
        turn[i, j], turn[j, i] = -sp.sin(angle), sp.sin(angle)
        R = R * turn
    instant = mpmath.mpf(3) / 10
    values = numbers(3, COUNT, seed=3)
    at = {t: instant} | {
        s: mpmath.mpf(str(x)) for m, row in zip((d, v, a), values, strict=True) for s, x in zip(m, row, strict=True)
    }

    def rate(f):
        """d/dt of a function of (d, v, t)."""
        return sp.diff(f, t) + f.jacobian(d) * v + f.jacobian(v) * a

    def number(f):
        """Value with 30 digits, so that only the program's own round-off shows."""
        return np.array(sp.lambdify(list(at), sp.Matrix(f), "mpmath", cse=True)(*at.values()).tolist(), dtype=float)

    momentum, force_on_d = sp.zeros(COUNT, 1), sp.zeros(COUNT, 1)
    force, moment = np.zeros(3), np.zeros(3)
    R_now = number(R)
    for p in range(POINTS):
        c = rational(r[p]) + rational(N[p]) * d
        velocity = rate(origin + R * c)
        energy = sp.Matrix([sp.Rational(str(weights[p])) / 2 * velocity.dot(velocity)])
        momentum += energy.jacobian(v).T
        force_on_d += energy.jacobian(d).T
        inertia = weights[p] * R_now.T @ number(rate(velocity)).ravel()
        force += inertia
        moment += np.cross(number(c).ravel(), inertia)
    lagrange = number(rate(momentum) - force_on_d).ravel()

    spin = R.T * sp.diff(R, t)
    omega = sp.Matrix([spin[2, 1], spin[0, 2], spin[1, 0]])
    motion = FrameMotion(
        number(omega).ravel(), number(sp.diff(omega, t)).ravel(), R_now.T @ number(sp.diff(origin, t, 2)).ravel()
    )
    terms = inertia_constants(N, r, weights)
    return Oracle(terms, motion, tuple(values), lagrange, force, moment)


def relative(actual, expected):
    return np.abs(actual - expected).max() / np.abs(expected).max()


def test_corrected_equation_is_lagranges(oracle):
    """T2 = d/dt ∂E/∂δ̇ − ∂E/∂δ in a general moving frame."""
    assert relative(maggi_vector(oracle.terms, oracle.motion, *oracle.state), oracle.lagrange) < 1e-12


def test_printed_equation_is_not_lagranges(oracle):
    """Paper (A5) as printed: c without the Coriolis factor 2, and k(ε) under a second name instead of k(ω)."""
    terms, motion, (q, rate, _) = oracle.terms, oracle.motion, oracle.state
    correct = maggi_vector(terms, motion, *oracle.state)
    half_coriolis = np.einsum("k,kab->ab", motion.omega, terms.G) @ rate
    k_eps = np.einsum("k,kab->ab", motion.eps, terms.G)
    k_omega = np.einsum("k,l,klab->ab", motion.omega, motion.omega, terms.H)
    assert relative(correct - half_coriolis, oracle.lagrange) > 1e-2
    assert relative(correct - (k_omega - k_eps) @ q, oracle.lagrange) > 1e-2
    assert relative(correct - half_coriolis - (k_omega - k_eps) @ q, oracle.lagrange) > 1e-2


def test_frame_force_and_moment_are_those_of_the_points(oracle):
    """T5a against ∫ρ a dV and ∫ρ c × a dV with a from the second derivative of positions."""
    force, moment = frame_resultants(oracle.terms, oracle.motion, *oracle.state)
    assert relative(force, oracle.force) < 3e-14
    assert relative(moment, oracle.moment) < 3e-14


def test_moment_needs_the_unsymmetrised_constants(oracle):
    terms = oracle.terms
    H = (terms.H + terms.H.swapaxes(0, 1)) / 2.0
    s2 = (terms.s2 + terms.s2.swapaxes(0, 1)) / 2.0
    symmetrised = replace(terms, H=H, s2=s2)
    vector = maggi_vector(symmetrised, oracle.motion, *oracle.state)
    assert relative(vector, oracle.lagrange) < 1e-12
    assert relative(frame_resultants(symmetrised, oracle.motion, *oracle.state)[1], oracle.moment) > 1e-3


def test_symmetries_of_the_constants(oracle):
    """G_k skew, H_lk = H_klᵀ, and ẽ_k ẽ_l = e_l e_kᵀ − δ_kl I."""
    terms = oracle.terms
    np.testing.assert_allclose(terms.G, -terms.G.swapaxes(1, 2), atol=1e-14)
    np.testing.assert_allclose(terms.H.swapaxes(0, 1), terms.H.swapaxes(2, 3), atol=1e-14)
    for k in range(3):
        assert np.array_equal(SKEW[k] @ [1.0, 2.0, 3.0], np.cross(np.eye(3)[k], [1.0, 2.0, 3.0]))
        for l in range(3):
            assert np.array_equal(SKEW2[k, l], np.outer(np.eye(3)[l], np.eye(3)[k]) - (k == l) * np.eye(3))


def test_reorient_is_the_same_element_seen_from_another_frame():
    """Paper (10), (A7): integrate in the element's axes and turn, or integrate in the new axes."""
    rng = np.random.default_rng(8)
    N, r = rng.normal(size=(5, 7, 3, 4)), rng.normal(size=(5, 7, 3))
    weights = rng.uniform(0.5, 1.0, (5, 7))
    rotation = np.linalg.qr(rng.normal(size=(5, 3, 3)))[0]
    rotation *= np.linalg.det(rotation)[:, None, None]
    T = np.linalg.qr(rng.normal(size=(5, 4, 4)))[0]
    origin = rng.normal(size=(5, 3))
    turned = reorient(inertia_constants(N, r, weights), rotation, T, origin)
    N_new = np.einsum("cij,cpja,cba->cpib", rotation, N, T)
    r_new = origin[:, None] + np.einsum("cij,cpj->cpi", rotation, r)
    expected = inertia_constants(N_new, r_new, weights)
    for name, value in vars(expected).items():
        np.testing.assert_allclose(getattr(turned, name), value, rtol=0, atol=1e-13 * np.abs(value).max(), err_msg=name)

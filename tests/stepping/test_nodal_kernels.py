"""Passes over nodal freedoms against the formulas they are named after, in dense algebra."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from maggi.integrators.generalized_alpha import GeneralizedAlpha, generalized_alpha
from maggi.linalg.lanes import WIDTH
from maggi.stepping.nodal_kernels import CACHED, Columns, NodalStep, coefficients, correct_nodal, predict_nodal

PARTS, ATTACHMENTS = 3, 2
METHODS = [generalized_alpha(1e-2, 0.8), generalized_alpha(0.5, 0.0)]


def step(c: GeneralizedAlpha, size: int, linear: float = 1.0) -> NodalStep:
    rng = np.random.default_rng(size)
    prediction, gain = coefficients(c)
    return NodalStep(
        linear=np.array([linear]),
        prediction=prediction,
        gain=gain,
        now=rng.normal(size=(4, size)),
        following=rng.normal(size=(4, size)),
        solution=rng.normal(size=size),
        implied=np.zeros(2),
        columns=Columns.of(sp.csc_matrix((size, 6 * ATTACHMENTS))),
        responses=rng.normal(size=(ATTACHMENTS, size // WIDTH, 12, WIDTH)),
        damping=np.zeros(2),
        forces=rng.normal(size=(4, 6 * ATTACHMENTS)),
        loaded=np.ones(ATTACHMENTS, np.int64),
        sizes=np.full((PARTS, 2), np.nan),
    )


@pytest.mark.parametrize("linear", [0.0, 1.0])
@pytest.mark.parametrize("size", [8, 3 * CACHED * PARTS + 12])
@pytest.mark.parametrize("c", METHODS, ids=["rho 0.8", "rho 0"])
def test_prediction_is_newmarks(c: GeneralizedAlpha, size: int, linear: float) -> None:
    of = step(c, size, linear)
    (u, ud, udd, a), before = of.now.copy(), of.following[3].copy()
    predict_nodal(of, PARTS)
    b = a + linear * (a - before)
    expected = (
        u + c.h * ud + c.h**2 * ((0.5 - c.beta) * a + c.beta * b),
        ud + c.h * ((1.0 - c.gamma) * a + c.gamma * b),
        ((1.0 - c.alpha_m) * b + c.alpha_m * a - c.alpha_f * udd) / (1.0 - c.alpha_f),
        b,
    )
    np.testing.assert_allclose(of.following, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


@pytest.mark.parametrize("size", [8, 3 * CACHED * PARTS + 12])
@pytest.mark.parametrize("c", METHODS, ids=["rho 0.8", "rho 0"])
def test_correction(c: GeneralizedAlpha, size: int) -> None:
    """δ = −x − Y (φ + yκ) − Z (π + zκ); u, u̇, ü, a by βh²δ + Yπ, γhδ + Yκ, σδ, δ."""
    of = step(c, size)
    before, x, (combined, pi, kappa, of_Z) = of.following.copy(), of.solution.copy(), of.forces
    Y, Z = (of.responses[:, :, part].transpose(0, 2, 1, 3).reshape(-1, size).T for part in (slice(0, 6), slice(6, 12)))
    delta = -x - Y @ combined - Z @ of_Z
    moves = np.array([c.beta * c.h**2 * delta + Y @ pi, c.gamma * c.h * delta + Y @ kappa, c.sigma * delta, delta])
    correct_nodal(of, PARTS)
    np.testing.assert_allclose(of.solution, -delta, rtol=0, atol=1e-13 * np.abs(delta).max())
    np.testing.assert_allclose(of.following, before + moves, rtol=0, atol=1e-13 * np.abs(moves).max())
    assert of.sizes[:, 0].sum() == pytest.approx(delta @ delta, rel=1e-12)
    assert of.sizes[:, 1].max() == pytest.approx(np.abs(of.following[0]).max(), rel=0, abs=0)


def test_attachments_without_forces_cost_nothing() -> None:
    of = step(METHODS[0], 20)
    of.responses[1] = np.nan
    of.loaded[1] = 0
    correct_nodal(of, PARTS)
    assert np.isfinite(of.following).all()
    of.loaded[1] = 1
    correct_nodal(of, PARTS)
    assert np.isnan(of.following).all()

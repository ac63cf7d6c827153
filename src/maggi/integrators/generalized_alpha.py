"""Coefficients of the generalised-α method (Chung and Hulbert 1993; on Lie groups Arnold and Brüls 2007)."""

from __future__ import annotations

from typing import NamedTuple


class GeneralizedAlpha(NamedTuple):
    """One step of size h: with algorithmic accelerations a and true accelerations v̇,

    (1 − α_m) a₁ + α_m a₀ = (1 − α_f) v̇₁ + α_f v̇₀
    v₁ = v₀ + h (1 − γ) a₀ + h γ a₁
    Δq = h v₀ + h² (½ − β) a₀ + h² β a₁,   q₁ = q₀ ∘ exp(Δq)

    Second order for every ρ∞; an increment δ of a₁ changes v̇₁ by σ δ, v₁ by γ h δ, Δq by β h² δ.
    """

    h: float
    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    sigma: float


def generalized_alpha(h: float, rho_inf: float) -> GeneralizedAlpha:
    """Coefficients for a step h (s) and the spectral radius `rho_inf` in [0, 1] at infinite frequency.

    ρ∞ = 1 dissipates nothing, 0 kills the highest frequencies in one step.
    """
    if not 0.0 <= rho_inf <= 1.0:
        raise ValueError(f"rho_inf must lie in [0, 1], got {rho_inf}")
    alpha_m = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0)
    alpha_f = rho_inf / (rho_inf + 1.0)
    gamma = 0.5 + alpha_f - alpha_m
    beta = 0.25 * (gamma + 0.5) ** 2
    return GeneralizedAlpha(h, alpha_m, alpha_f, beta, gamma, (1.0 - alpha_m) / (1.0 - alpha_f))


def instantaneous() -> GeneralizedAlpha:
    """The coefficients that leave positions and velocities alone: a step with them finds accelerations only."""
    return GeneralizedAlpha(0.0, 0.0, 0.0, 0.0, 0.0, 1.0)

"""One finite element in a moving frame: the constants of T3 and what follows from them (T2, T4, T5a).

This is the readable reference: it holds for any shape functions N and any quadrature, and compiled code elsewhere is
tested against it. Everything is in the axes of the moving frame. ``ẽ_k`` is `SKEW[k]`, with ``ẽ_k b = e_k × b``.
The paper's misprints that are corrected here: (A5) c has the factor 2 of the Coriolis term and its second k(ε) is
k(ω); (A7) is ``M_O = T m_O Rᵀ``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# SKEW[k] is the matrix of e_k ×, SKEW2[k, l] = ẽ_k ẽ_l.
SKEW: Array = np.array(
    [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]],
    dtype=np.float64,
)
SKEW2: Array = np.einsum("kij,ljm->klim", SKEW, SKEW)


class InertiaTerms(Protocol):
    """What T2 and T5a need; `InertiaConstants` and `maggi.model.bodies.RitzTerms` have it."""

    @property
    def mass(self) -> float | Array:
        """Mass, kg."""

    @property
    def S0(self) -> Array:
        """First moment (…, 3) of the undeformed element about the frame's origin, kg m."""

    @property
    def J0(self) -> Array:
        """Inertia tensor (…, 3, 3) of the undeformed element about the frame's origin, kg m²."""

    @property
    def m(self) -> Array:
        """``∫ρNᵀN dV`` (…, n, n); (A1)–(A3)."""

    @property
    def m_O(self) -> Array:
        """``∫ρNᵀ dV`` (…, n, 3); (A4)."""

    @property
    def G(self) -> Array:
        """``∫ρNᵀẽ_kN dV`` (…, 3, n, n), skew; T3."""

    @property
    def H(self) -> Array:
        """``∫ρNᵀẽ_kẽ_lN dV`` (…, 3, 3, n, n), not symmetric in k, l; T3."""

    @property
    def s(self) -> Array:
        """``∫ρNᵀẽ_k r dV`` (…, 3, n); T3."""

    @property
    def s2(self) -> Array:
        """``∫ρNᵀẽ_kẽ_l r dV`` (…, 3, 3, n), not symmetric in k, l; T3 (s_kl)."""


@dataclass(frozen=True, eq=False)
class InertiaConstants:
    """The constants of T3 and T5a of one element, or of many with leading axes (shapes: `InertiaTerms`)."""

    mass: Array
    S0: Array
    J0: Array
    m: Array
    m_O: Array
    G: Array
    H: Array
    s: Array
    s2: Array


@dataclass(frozen=True, eq=False)
class FrameMotion:
    """Motion of the frame in its own axes: ω (3,) rad/s, ε (3,) rad/s², ``a_O = Rᵀ r̈_O − Rᵀ g`` (3,) m/s²."""

    omega: Array
    eps: Array
    a_O: Array


def inertia_constants(N: Array, r: Array, weights: Array) -> InertiaConstants:
    """The constants of T3 and T5a by quadrature.

    Parameters
    ----------
    N : shape functions (…, p, 3, n) at the p points.
    r : undeformed positions (…, p, 3), m.
    weights : ``ρ dV`` at the points (…, p), kg.

    Leading axes are elements and broadcast: solid cells share one N.
    """
    weighted = weights[..., None, None] * N
    P = np.einsum("...pia,...pjb->...ijab", weighted, N, optimize=True)
    Q = np.einsum("...pia,...pj->...ija", weighted, r, optimize=True)
    second = np.einsum("...p,...pi,...pj->...ij", weights, r, r)
    trace = np.einsum("...ii->...", second)
    return contracted(
        mass=weights.sum(axis=-1),
        S0=np.einsum("...p,...pi->...i", weights, r),
        J0=trace[..., None, None] * np.eye(3) - second,
        m_O=np.einsum("...pia->...ai", weighted),
        P=P,
        Q=Q,
    )


def contracted(mass: Array, S0: Array, J0: Array, m_O: Array, P: Array, Q: Array) -> InertiaConstants:
    """The constants that contract the products of shape functions with constant tensors, and the others as they are.

    P : ``∫ρ N_ia N_jb dV`` (…, 3, 3, n, n). Q : ``∫ρ N_ia r_j dV`` (…, 3, 3, n).
    """
    return InertiaConstants(
        mass=mass,
        S0=S0,
        J0=J0,
        m=np.einsum("...iiab->...ab", P),
        m_O=m_O,
        G=np.einsum("kij,...ijab->...kab", SKEW, P),
        H=np.einsum("klij,...ijab->...klab", SKEW2, P),
        s=np.einsum("kij,...ija->...ka", SKEW, Q),
        s2=np.einsum("klij,...ija->...kla", SKEW2, Q),
    )


def isotropic_shapes(values: Array) -> Array:
    """``N = Σ N_a I₃``, (p, 3, 3k), of scalar shape functions (p, k), freedoms node by node."""
    points, k = values.shape
    N: Array = np.einsum("pa,ij->piaj", values, np.eye(3)).reshape(points, 3, 3 * k)
    return N


def maggi_vector(terms: InertiaTerms, motion: FrameMotion, q: Array, rate: Array, acceleration: Array) -> Array:
    """Inertia part of the element's Maggi vector (n,): T2 without ``k δ − q_ext − q*``; paper (24), (A4)–(A5).

    q, rate, acceleration : δ, δ̇, δ̈, (n,) each, for one element.
    """
    omega, eps = motion.omega, motion.eps
    coriolis = 2.0 * np.einsum("k,kab->ab", omega, terms.G)
    k_eps = np.einsum("k,kab->ab", eps, terms.G)
    k_omega = np.einsum("k,l,klab->ab", omega, omega, terms.H)
    q_eps = np.einsum("k,ka->a", eps, terms.s)
    q_omega = np.einsum("k,l,kla->a", omega, omega, terms.s2)
    result: Array = (
        terms.m @ acceleration + coriolis @ rate + (k_eps + k_omega) @ q + q_eps + q_omega + terms.m_O @ motion.a_O
    )
    return result


def frame_resultants(
    terms: InertiaTerms, motion: FrameMotion, q: Array, rate: Array, acceleration: Array
) -> tuple[Array, Array]:
    """Force and moment (about the frame's origin) that the inertia of one element asks of its frame; T5a.

    Returns (3,) N and (3,) N m in the frame's axes: ``∫ρ a dV`` and ``∫ρ c × a dV`` with ``c = r + Nδ``.
    """
    omega, eps, a_O = motion.omega, motion.eps, motion.a_O
    S = terms.S0 + terms.m_O.T @ q
    crossed = np.einsum("kla,a->kl", terms.s2, q)
    quadratic = np.einsum("klab,a,b->kl", terms.H, q, q)
    J = terms.J0 - crossed - crossed.T - quadratic
    relative = terms.m_O.T @ rate
    force = (
        terms.mass * a_O
        + np.cross(eps, S)
        + np.cross(omega, np.cross(omega, S))
        + 2.0 * np.cross(omega, relative)
        + terms.m_O.T @ acceleration
    )
    lever = terms.s + np.einsum("kab,b->ka", terms.G, q)
    # The second index of s_lk, H_lk is the component of the moment: the order matters here.
    coriolis = terms.s2 + np.einsum("klab,b->kla", terms.H, q)
    moment = (
        np.cross(S, a_O)
        + J @ eps
        + np.cross(omega, J @ omega)
        + lever @ acceleration
        - 2.0 * np.einsum("l,lka,a->k", omega, coriolis, rate)
    )
    return force, moment


def nodal_acceleration(X: Array, u: Array, rate: Array, acceleration: Array, motion: FrameMotion) -> Array:
    """The field a of T4, (n, 3): with it all inertia of an isotropic interpolation is ``μ a``.

    X, u, rate, acceleration : undeformed positions, displacements and their derivatives, (n, 3) each, frame axes.
    """
    c = X + u
    omega = motion.omega
    return np.asarray(
        motion.a_O
        + np.cross(motion.eps, c)
        + np.cross(omega, np.cross(omega, c))
        + 2.0 * np.cross(omega, rate)
        + acceleration
    )


def reorient(terms: InertiaConstants, rotation: Array, T: Array, origin: Array) -> InertiaConstants:
    """Constants in another frame; paper (10), (A7) with ``M_O = T m_O Rᵀ`` corrected. Leading axes broadcast.

    Parameters
    ----------
    rotation : (…, 3, 3) from the element's axes to the new ones (the R of M_O).
    T : (…, n, n) orthogonal, ``Δ = T δ``.
    origin : (…, 3) of the element's frame in the new one.
    """
    Tt = np.swapaxes(T, -1, -2)
    m_O = T @ terms.m_O @ np.swapaxes(rotation, -1, -2)
    S = np.einsum("...ij,...j->...i", rotation, terms.S0)
    J = rotation @ terms.J0 @ np.swapaxes(rotation, -1, -2)
    mass = np.asarray(terms.mass)[..., None, None]
    # ẽ_k in new axes is Σ_j R_kj ẽ_j in the element's.
    s = np.einsum("...kj,...ab,...jb->...ka", rotation, T, terms.s)
    s2 = np.einsum("...ki,...lj,...ab,...ijb->...kla", rotation, rotation, T, terms.s2, optimize=True)
    xx = np.einsum("...i,...i->...", origin, origin)[..., None, None] * np.eye(3) - _outer(origin, origin)
    xS = np.einsum("...i,...i->...", origin, S)[..., None, None] * np.eye(3)
    return InertiaConstants(
        mass=terms.mass,
        S0=S + mass[..., 0] * origin,
        J0=J + mass * xx + 2.0 * xS - _outer(origin, S) - _outer(S, origin),
        m=T @ terms.m @ Tt,
        m_O=m_O,
        G=np.einsum("...kj,...ab,...jbc,...dc->...kad", rotation, T, terms.G, T, optimize=True),
        H=np.einsum("...ki,...lj,...ab,...ijbc,...dc->...klad", rotation, rotation, T, terms.H, T, optimize=True),
        s=s + np.einsum("...ai,kij,...j->...ka", m_O, SKEW, origin),
        s2=s2 + np.einsum("...ai,klij,...j->...kla", m_O, SKEW2, origin),
    )


def _outer(a: Array, b: Array) -> Array:
    return np.asarray(a[..., :, None] * b[..., None, :])

"""Simeon's planar slider-crank with an elastic rod (CASES C1; Simeon 1996, IVP test set "crank"): data and equations.

The equations are the case's own, in p = (φ₁, φ₂, x₃) and q, written out by hand; the program's model stands beside them.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from transient_runs import joint

from maggi.model import Attachment, Driver, Model, Pose, RigidBody, RitzBody, RitzTerms, Velocity, expression
from maggi.results.results import Results

Array = NDArray[np.float64]

CRANK, ROD, BLOCK = 0.36, 0.151104, 0.075552  # kg
L1, L2, SIDE = 0.15, 0.30, 0.008  # m
J1, J2 = 0.002727, 0.0045339259  # kg m², about the pins
YOUNG, DENSITY, SPEED = 0.2e12, 7870.0, 150.0

FM, FK, FB = DENSITY * SIDE**2 * L2, YOUNG * SIDE**2 / L2, SIDE**2 * L2


class Case:
    """The rod's constants as the case names them: c1, c2, c12, c21 and the matrices MQ, KQ, BQ.

    pi : the number used for it. longitudinal : what multiplies the mass ∫ρNᵀN of the longitudinal functions.
    """

    def __init__(self, pi: float, longitudinal: float) -> None:
        bending = FK * pi**4 / 24 * (SIDE / L2) ** 2
        self.MQ = FM * np.diag([0.5, 0.5, 0.0, 0.0])
        self.MQ[2:, 2:] = FM * longitudinal / 15 * np.array([[8.0, 1.0], [1.0, 2.0]])
        self.KQ = np.diag([bending, 16 * bending, 0.0, 0.0])
        self.KQ[2:, 2:] = FK / 3 * np.array([[16.0, -8.0], [-8.0, 7.0]])
        self.BQ = np.zeros((4, 4))
        self.BQ[0, 2:] = -16 * FB / pi**3, FB * (8 / pi**3 - 1 / pi)
        self.BQ[1, 3] = FB / (2 * pi)
        self.BQ -= self.BQ.T
        self.c1 = FB * np.array([0, 0, 2 / 3, 1 / 6])
        self.c2 = FB * np.array([2 / pi, 0, 0, 0])
        self.c12 = L2 * FB * np.array([0, 0, 1 / 3, 1 / 6])
        self.c21 = L2 * FB * np.array([1 / pi, -1 / (2 * pi), 0, 0])


# The same mechanism with shape functions, and the program's own integrals of them.
INTEGRATED = Path(__file__).parents[2] / "benchmarks" / "simeon_crank.yml"

TABULATED = Case(3.1415927, 15.0)
CONSISTENT = Case(np.pi, 1.0)

Q0 = np.array([0.0, 0.0, 0.103339863e-4, 0.169327969e-4])
QD0 = np.array([0.444896105, 0.463434311e-2, -0.178591076e-5, -0.268938672e-5])
PHI2D0, X3D0 = -74.9957670, -0.268938672e-5


def accelerations(case: Case, phi1: float, q: Array, phi1d: float, qd: Array) -> tuple[Array, Array]:
    """p̈, q̈ (7,) and λ (3,) from ``[M Gᵀ; G 0]`` at a state on the constraints; φ₂, x₃ and their rates follow."""
    phi2, phi2d, _, _ = closed(phi1, q, phi1d, qd)
    M, F, G, gamma = equations(case, np.array([phi1, phi2]), q, np.array([phi1d, phi2d]), qd)
    solution = np.linalg.solve(np.block([[M, G.T], [G, np.zeros((3, 3))]]), np.concatenate([F, -gamma]))
    return solution[:7], solution[7:]


def motion(case: Case, times: Array) -> Array:
    """φ₁, φ₂, x₃, q₁ … q₄ (n, 7) from the case's start with φ̇₁ = Ω, by DOP853 in q and q̇ alone.

    The start's velocities are first projected mass-orthogonally on the constraints.
    """
    start = np.array([SPEED, PHI2D0, X3D0, *QD0])
    M, _, G, _ = equations(case, np.zeros(2), Q0, start[:2], QD0)
    lift = np.linalg.solve(M, G.T)
    start = start - lift @ np.linalg.solve(G @ lift, G @ start - [0.0, 0.0, SPEED])

    def rates(t: float, y: Array) -> Array:
        return np.concatenate([y[4:], accelerations(case, SPEED * t, y[:4], SPEED, y[4:])[0][3:]])

    solution = solve_ivp(
        rates,
        (0.0, times[-1]),
        [*Q0, *start[3:]],
        method="DOP853",
        t_eval=times,
        rtol=1e-10,
        atol=[1e-16] * 4 + [1e-11] * 4,
    )
    q, qd = solution.y[:4].T, solution.y[4:].T
    angles = SPEED * times
    return np.array(
        [[a, *np.array(closed(a, x, SPEED, xd))[[0, 2]], *x] for a, x, xd in zip(angles, q, qd, strict=True)]
    )


def equations(case: Case, phi: Array, q: Array, phid: Array, qd: Array) -> tuple[Array, Array, Array, Array]:
    """M (7, 7), F (7,), G (3, 7) and γ (3,) of ``M a = F − Gᵀλ, G a + γ = 0`` as the case prints them.

    Constraints: l₁ sin φ₁ + (l₂ + q₄) sin φ₂ = 0, x₃ − l₁ cos φ₁ − (l₂ + q₄) cos φ₂ = 0, φ₁ − Ωt = 0.
    """
    (phi1, phi2), (phi1d, phi2d) = phi, phid
    d, r = phi1 - phi2, L2 + q[3]
    s, c = np.sin(d), np.cos(d)
    s1, c1, s2, c2 = np.sin(phi1), np.cos(phi1), np.sin(phi2), np.cos(phi2)
    M = np.zeros((7, 7))
    M[0, 0] = J1 + ROD * L1**2
    M[0, 1] = M[1, 0] = L1 * L2 * ROD * c / 2 + DENSITY * L1 * (s * case.c2 @ q + c * case.c1 @ q)
    M[1, 1] = J2 + q @ case.MQ @ q + 2 * DENSITY * case.c12 @ q
    M[2, 2] = BLOCK
    M[0, 3:] = M[3:, 0] = DENSITY * L1 * (-s * case.c1 + c * case.c2)
    M[1, 3:] = M[3:, 1] = DENSITY * (case.c21 + q @ case.BQ)
    M[3:, 3:] = case.MQ
    F = np.zeros(7)
    F[0] = -L1 * L2 * ROD * phi2d**2 * s / 2 + DENSITY * L1 * phi2d**2 * (-s * case.c1 @ q + c * case.c2 @ q)
    F[0] -= 2 * DENSITY * L1 * phi2d * (c * case.c1 @ qd + s * case.c2 @ qd)
    F[1] = L1 * L2 * ROD * phi1d**2 * s / 2 + DENSITY * L1 * phi1d**2 * (s * case.c1 @ q - c * case.c2 @ q)
    F[1] -= 2 * DENSITY * phi2d * case.c12 @ qd + 2 * phi2d * qd @ case.MQ @ q + DENSITY * qd @ case.BQ @ qd
    F[3:] = phi2d**2 * case.MQ @ q - case.KQ @ q
    F[3:] += DENSITY * (phi2d**2 * case.c12 + L1 * phi1d**2 * (c * case.c1 + s * case.c2) + 2 * phi2d * case.BQ @ qd)
    G = np.zeros((3, 7))
    G[0, [0, 1, 6]] = L1 * c1, r * c2, s2
    G[1, [0, 1, 2, 6]] = L1 * s1, r * s2, 1.0, -c2
    G[2, 0] = 1.0
    gamma = np.array(
        [
            -L1 * s1 * phi1d**2 - r * s2 * phi2d**2 + 2 * c2 * phi2d * qd[3],
            L1 * c1 * phi1d**2 + r * c2 * phi2d**2 + 2 * s2 * phi2d * qd[3],
            0.0,
        ]
    )
    return M, F, G, gamma


def closed(phi1: float, q: Array, phi1d: float, qd: Array) -> tuple[float, float, float, float]:
    """φ₂, φ̇₂, x₃, ẋ₃ that close the mechanism."""
    r = L2 + q[3]
    phi2 = -np.arcsin(L1 * np.sin(phi1) / r)
    phi2d = -(L1 * np.cos(phi1) * phi1d + np.sin(phi2) * qd[3]) / (r * np.cos(phi2))
    x3 = L1 * np.cos(phi1) + r * np.cos(phi2)
    x3d = -L1 * np.sin(phi1) * phi1d - r * np.sin(phi2) * phi2d + np.cos(phi2) * qd[3]
    return phi2, phi2d, x3, x3d


def constants(case: Case) -> RitzTerms:
    """The tabulated constants as those of T3 and T5a: x along the rod, y lateral, no z.

    The case gives ∫ρN_x, ∫ρN_y (c1, c2), ∫ρN_x x (c12), ∫ρN_y x (c21), ∫ρ(N_xᵀN_x + N_yᵀN_y) (MQ) and
    ∫ρ(N_xᵀN_y − N_yᵀN_x) (BQ); the first two functions are lateral, the others longitudinal, which splits MQ and BQ.
    """
    G, H = np.zeros((3, 4, 4)), np.zeros((3, 3, 4, 4))
    s, s2 = np.zeros((3, 4)), np.zeros((3, 3, 4))
    lateral, along = np.diag([1.0, 1.0, 0.0, 0.0]), np.diag([0.0, 0.0, 1.0, 1.0])
    G[2] = DENSITY * case.BQ.T
    H[0, 0], H[1, 1], H[2, 2] = -lateral @ case.MQ @ lateral, -along @ case.MQ @ along, -case.MQ
    H[0, 1] = DENSITY * lateral @ case.BQ.T @ along
    H[1, 0] = H[0, 1].T
    s[2] = s2[0, 1] = DENSITY * case.c21
    s2[1, 1] = s2[2, 2] = -DENSITY * case.c12
    return RitzTerms(
        mass=ROD,
        S0=np.array([ROD * L2 / 2, 0.0, 0.0]),
        J0=np.diag([ROD * SIDE**2 / 6, J2, J2]),
        m=case.MQ,
        k=case.KQ,
        D=np.zeros((4, 4)),
        m_O=DENSITY * np.stack([case.c1, case.c2, np.zeros(4)], axis=1),
        G=G,
        H=H,
        s=s,
        s2=s2,
    )


def shapes(points: Array) -> Array:
    """N (p, 3, 4) at the rod's ends, where its attachments are: only q₄ moves the far end, along the rod."""
    N = np.zeros((len(points), 3, 4))
    N[:, 0, 3] = points[:, 0] / L2
    return N


def model(phi1: float, q: Array, phi1d: float, qd: Array, phi2d: float, x3d: float) -> Model:
    """The mechanism with the tabulated constants, from a given state whose positions fit together."""
    phi2, _, x3, _ = closed(phi1, q, phi1d, qd)
    c1, s1 = np.cos(phi1), np.sin(phi1)
    flat = ((1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-4))
    bodies = {
        "crank": RigidBody(
            CRANK,
            center_of_mass=(L1 / 2, 0.0, 0.0),
            inertia=((1e-4, 0.0, 0.0), (0.0, 7e-4, 0.0), (0.0, 0.0, J1 - CRANK * L1**2 / 4)),
            pose=Pose(rotation=_about_z(phi1)),
            velocity=Velocity(angular=(0.0, 0.0, phi1d)),
            attachments={"pin": Attachment(at=(L1, 0.0, 0.0))},
        ),
        "rod": RitzBody(
            constants(TABULATED),
            shapes,
            initial=(tuple(q.tolist()), tuple(qd.tolist())),
            pose=Pose((L1 * c1, L1 * s1, 0.0), _about_z(phi2)),
            velocity=Velocity((-L1 * s1 * phi1d, L1 * c1 * phi1d, 0.0), (0.0, 0.0, phi2d)),
            attachments={"start": Attachment(at=(0.0, 0.0, 0.0)), "end": Attachment(at=(L2, 0.0, 0.0))},
        ),
        "block": RigidBody(
            BLOCK,
            inertia=flat,
            pose=Pose((x3, 0.0, 0.0)),
            velocity=Velocity(linear=(x3d, 0.0, 0.0)),
            attachments={"pin": Attachment(at=(0.0, 0.0, 0.0))},
        ),
    }
    z = (0.0, 0.0, 1.0)
    joints = {
        "bearing": joint("revolute", "ground", "crank", at=(0.0, 0.0, 0.0), axis=z),
        "crankpin": joint("revolute", "crank.pin", "rod.start", axis=z),
        "wristpin": joint("revolute", "rod.end", "block.pin", axis=z),
        "guide": joint("prismatic", "ground", "block.pin", axis=(1.0, 0.0, 0.0)),
        "motor": Driver("bearing", "angle", expression("150*t")),
    }
    return Model(bodies, joints)


def final_positions(results: Results) -> Array:
    """φ₁, φ₂, x₃, q₁ … q₄ at the end of a run."""
    R = results.body("rod").rotation[-1]
    angles = [results.joint("bearing").coordinate[-1, 0], np.arctan2(R[1, 0], R[0, 0])]
    return np.concatenate([angles, results.body("block").origin[-1, :1], results.body("rod").modal[-1]])


def _about_z(angle: float) -> tuple[tuple[float, float, float], ...]:
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))

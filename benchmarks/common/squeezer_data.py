"""Andrews' squeezer (IVP test set "andrews", IFToMM A03) as data: seven bodies in a plane, ten hinges, a motor, a spring.

Every body's frame stands in the hinge that its angle is measured in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = tuple[float, float]

MOTOR, SPRING = 0.033, (4530.0, 0.07785)  # N m about z on K1; stiffness (N/m) and free length (m) between K3's D and C
DURATION = 0.03  # s
NAMES = ("K1", "K2", "K3", "K4", "K5", "K6", "K7")
# β, Θ, γ, φ, δ, Ω, ε (rad) at the start, and at the end, recomputed to 15 digits in quadruple precision
START = np.array(
    [
        *(-0.0617138900142764496, 0.0, 0.455279819163070380, 0.222668390165885885),
        *(0.487364979543842550, -0.222668390165885885, 1.23054744454982120),
    ]
)
END = np.array(
    [
        *(15.8107711951537073, -15.7563710584118386, 0.0408222401196458029, -0.534730116342079564),
        *(0.524409965879954032, 0.534730116342079564, 1.04808074104193794),
    ]
)


@dataclass(frozen=True)
class Link:
    """A body: mass (kg), moment of inertia about its centre (kg m²), place and angle of its frame, centre, points (m)."""

    mass: float
    inertia: float
    at: Point
    angle: float
    center: Point
    points: dict[str, Point]


@dataclass(frozen=True)
class Hinge:
    """A revolute about z between two bodies' points; `ground` and its point in global coordinates."""

    first: str
    second: str
    at: Point
    closes: bool = False  # a loop


def absolute(angles: Array) -> Array:
    """The bodies' own angles (7,) of β, Θ, γ, φ, δ, Ω, ε."""
    beta, theta, gamma, phi, delta, omega, epsilon = angles
    return np.array([beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon])


def error(angles: Array) -> float:
    """The largest error of a mechanism's seven angles at the end, over 1 + |angle|; by the bodies' own angles (7,).

    Whole turns, which a rotation matrix does not know, do not count.
    """
    wrong = np.remainder(angles - absolute(END) + np.pi, 2.0 * np.pi) - np.pi
    b1, b2, b3, b4, b5, b6, b7 = wrong
    relative = np.array([b1, b2 - b1, b3, b4 - b5, b5, b6 - b7, b7])
    return float((np.abs(relative) / (1.0 + np.abs(END))).max())


def links() -> dict[str, Link]:
    """The bodies at the start."""
    beta, theta, gamma, phi, delta, omega, epsilon = START
    rr, d, ss, e, zt, zf, u = 0.007, 0.028, 0.035, 0.02, 0.04, 0.02, 0.04
    O, A, B = (0.0, 0.0), (-0.06934, -0.00227), (-0.03635, 0.03273)
    F, G, H = _beyond(O, rr, beta), _beyond(A, zt, delta), _beyond(A, u, epsilon - 0.5 * np.pi)
    return {
        "K1": Link(0.04325, 2.194e-6, O, beta, (0.00092, 0.0), {"O": O, "F": (rr, 0.0)}),
        "K2": Link(0.00365, 4.410e-7, F, beta + theta, (-0.0115, 0.0), {"F": O, "E": (-d, 0.0)}),
        "K3": Link(0.02373, 5.255e-6, B, gamma, (0.01043, -0.01874), {"B": O, "E": (0.0, -ss), "D": (0.02, -0.018)}),
        "K4": Link(0.00706, 5.667e-7, G, phi + delta, (0.0, 0.01421 - e), {"G": O, "E": (0.0, -e)}),
        "K5": Link(0.0705, 1.169e-5, A, delta, (0.02308, 0.00916), {"A": O, "G": (zt, 0.0)}),
        "K6": Link(0.00706, 5.667e-7, H, omega + epsilon, (zf - 0.01421, 0.0), {"H": O, "E": (zf, 0.0)}),
        "K7": Link(0.05498, 1.912e-5, A, epsilon, (0.00449, -0.01228), {"A": O, "H": (0.0, -u)}),
    }


ANCHOR = (0.014, 0.072)  # the spring's fixed end C
# Two ends `body.point`, the first of which may be ground
HINGES = (
    ("ground", "K1.O"),
    ("K1.F", "K2.F"),
    ("ground", "K3.B"),
    ("ground", "K5.A"),
    ("K5.G", "K4.G"),
    ("ground", "K7.A"),
    ("K7.H", "K6.H"),
    ("K2.E", "K3.E"),
    ("K2.E", "K4.E"),
    ("K2.E", "K6.E"),
)
LOOPS = 3  # closed by the last three


def hinges() -> tuple[Hinge, ...]:
    """The ten hinges, with their places at the start."""
    bodies = links()
    result = []
    for k, (first, second) in enumerate(HINGES):
        body, point = second.split(".")
        link = bodies[body]
        x, y = link.points[point]
        c, s = np.cos(link.angle), np.sin(link.angle)
        place = (link.at[0] + c * x - s * y, link.at[1] + s * x + c * y)
        result.append(Hinge(first.split(".")[0], body, place, k >= len(HINGES) - LOOPS))
    return tuple(result)


def _beyond(start: Point, length: float, angle: float) -> Point:
    return (start[0] + length * float(np.cos(angle)), start[1] + length * float(np.sin(angle)))

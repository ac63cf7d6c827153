"""How joints that are more than a point look: wheels, rods, curves, cams with their followers, blades."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def _nothing() -> Array:
    return np.zeros((0, 3))


@dataclass(frozen=True, eq=False)
class Outline:
    """Lines through points fixed in the two bodies of a joint, each in its body's frame (ground: global), m.

    first (p, 3): a curve or a cam's profile. second (q, 3): a wheel, a follower, a blade. Of a rod, one point of each: the
    line goes from the one to the other.
    """

    first: Array = field(default_factory=_nothing)
    second: Array = field(default_factory=_nothing)

"""Mechanisms for tests: closed loops with and without redundant rows, random trees with extra joints."""

import numpy as np

from maggi.model.bodies import RigidBody
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.model import Model

CORNERS = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 1.0], [1.7, 0.0, 1.4], [2.0, 0.0, 0.0]])


def four_bar(kinds=("revolute",) * 4, tilt=0.0):
    """Three links in a loop with ground; four parallel revolutes leave one freedom and three rows redundant.

    tilt turns the second joint's axis out of the common direction by that many radians.
    """
    names = ("crank", "coupler", "rocker")
    bodies = {
        name: RigidBody(
            1.0 + 0.5 * i,
            tuple(0.5 * (CORNERS[i + 1] - CORNERS[i]) + [0.0, 0.05, 0.0]),
            ((0.1, 0.01, 0.0), (0.01, 0.2, 0.0), (0.0, 0.0, 0.15)),
            Pose(tuple(CORNERS[i])),
        )
        for i, name in enumerate(names)
    }
    ends = ("ground", *names, "ground")
    joints = {}
    for i, kind in enumerate(kinds):
        angle = tilt if i == 1 else 0.0
        joints[f"j{i}"] = Joint(
            kind, End(ends[i]), End(ends[i + 1]), at=tuple(CORNERS[i]), axis=(0.0, np.cos(angle), np.sin(angle))
        )
    return Model(bodies, joints, gravity=(0.0, 0.0, -9.81))


def random_mechanism(seed, count, loops, kinds):
    """A random tree of `count` bodies from ground with `loops` more joints; every joint is closed at the start."""
    rng = np.random.default_rng(seed)
    bodies = {
        f"b{i}": RigidBody(1.0, inertia=((1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.5))) for i in range(count)
    }
    names = ["ground", *bodies]
    pairs = [(int(rng.integers(0, i + 1)), i + 1) for i in range(count)]
    pairs += [tuple(rng.choice(count + 1, 2, replace=False)) for _ in range(loops)]
    order = rng.permutation(len(pairs))
    joints = {}
    for number in order:
        first, second = pairs[number]
        axis = rng.normal(size=3)
        across = np.cross(axis, rng.normal(size=3))
        joints[f"j{number}"] = Joint(
            str(rng.choice(kinds)),
            End(names[first]),
            End(names[second]),
            at=tuple(rng.normal(size=3)),
            axis=tuple(axis),
            axes=(tuple(axis), tuple(across)),
            pitch=0.3,
        )
    return Model(bodies, joints)

"""Random mechanisms with wanted features: closed, nonholonomic, redundant, elastic, driven; with springs and loads."""

from __future__ import annotations

from dataclasses import dataclass

from liaison_library import LIAISONS
from workshop import Workshop, direction, vector

from maggi.model import (
    GROUND,
    Joint,
    PointLoad,
    SpringDamper,
    TorsionSpring,
    expression,
)

TREE = (
    "revolute",
    "prismatic",
    "cylindrical",
    "planar",
    "spherical",
    "universal",
    "constant-velocity",
    "screw",
    "free",
)
LOOP = ("spherical", "rod", "planar", "surface", "height-field", "curve", "cam-roller", "cylindrical", "universal")
NO_SLIP = ("disc", "sphere", "knife-edge", "pfaffian", "function")


@dataclass(frozen=True)
class Features:
    """What a random mechanism has, beyond rigid bodies in a tree of joints."""

    closed: bool = False
    nonholonomic: bool = False
    redundant: bool = False
    elastic: bool = False
    driven: bool = False


def random_model(rng, features):
    """A mechanism of three to five bodies with at least the given features, with springs and loads."""
    shop = Workshop(rng)
    names = []
    for i in range(int(rng.integers(3, 6))):
        if features.elastic and i == 0:
            name = shop.box() if rng.random() < 0.3 else shop.ritz()
        else:
            name = shop.ritz() if features.elastic and rng.random() < 0.3 else shop.rigid()
        parent = str(rng.choice([GROUND, *names]))
        LIAISONS[str(rng.choice(TREE))](shop, parent, name)
        names.append(name)
    boxes = [name for name in names if shop.is_meshed(name)]
    # a box is held and loaded at its own attachments only
    names = [name for name in names if name not in boxes]
    if features.closed:
        for _ in range(int(rng.integers(1, 3))):
            first, second = _two(rng, [GROUND, *names])
            LIAISONS[str(rng.choice(LOOP))](shop, first, second)
    if features.nonholonomic:
        free = shop.rigid()
        LIAISONS[str(rng.choice(("spherical", "free", "planar")))](shop, str(rng.choice([GROUND, *names])), free)
        LIAISONS[str(rng.choice(NO_SLIP))](shop, str(rng.choice([GROUND, *names])), free)
        names.append(free)
    if features.redundant:
        _hinge_pair(shop, str(rng.choice([GROUND, *names])), shop.rigid())
    if features.driven:
        kind = str(rng.choice(("angle-driver", "displacement-driver", "speed-driver", "gear", "coupler-of-rates")))
        LIAISONS[kind](shop, str(rng.choice([GROUND, *(n for n in names if not shop.is_elastic(n))])), shop.rigid())
    if rng.random() < 0.3:
        shop.point_mass(names[0])
    _forces(shop, [*names, *boxes])
    return shop.model()


def _two(rng, names):
    first, second = rng.choice(len(names), 2, replace=False)
    return names[first], names[second]


def _hinge_pair(shop, first, second):
    """Two joints of one kind on one axis: a door on two hinges, all rows of the second repeat those of the first."""
    axis, place = direction(shop.rng), shop.place(second)
    kind = str(shop.rng.choice(("revolute", "prismatic", "cylindrical")))
    for shift in (0.0, 0.4):
        shop.join(kind, first, second, place + shift * axis, axis=vector(axis))


def _forces(shop, names):
    rng = shop.rng
    first, second = _two(rng, [GROUND, *names])
    ends = [shop.attachment(name, shop.place(name)) for name in (first, second)]
    length = None if rng.random() < 0.5 else 0.3
    shop.forces[shop.name("spring")] = SpringDamper(*ends, 50.0, 2.0, length)
    on = shop.attachment(names[-1], shop.place(names[-1]))
    value = tuple(expression("a*cos(5*t)", a=float(a)) for a in 3.0 * rng.normal(size=3))
    kind, frame = str(rng.choice(("force", "torque"))), str(rng.choice(("global", "body")))
    shop.forces[shop.name("load")] = PointLoad(on, kind, value, frame)
    hinges = [name for name, joint in shop.joints.items() if isinstance(joint, Joint) and joint.kind == "revolute"]
    if hinges:
        shop.forces[shop.name("torsion")] = TorsionSpring(hinges[0], 5.0, 0.3, 0.2)

"""Which parts of a model hang together, by joints and springs: loose parts, attachments that nothing uses."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from maggi.model.bodies import RigidBody
from maggi.model.forces import Force, PointLoad, SpringDamper
from maggi.model.joints import GROUND, Coupler, Driver, End, Liaison, Pfaffian, PfaffianFunction
from maggi.model.model import Model


def force_ends(force: Force) -> tuple[str, tuple[str, ...]]:
    """The kind of a force by its model-file name, and what it acts on."""
    if isinstance(force, PointLoad):
        return force.kind, (str(force.on),)
    if isinstance(force, SpringDamper):
        return "spring-damper", (str(force.first), str(force.second))
    return "torsion-spring", (force.joint,)


def loose_parts(model: Model) -> list[str]:
    """A sentence for each group of bodies that neither joints nor springs nor a prescribed motion tie to ground."""
    names = [GROUND, *model.bodies]
    place = {name: i for i, name in enumerate(names)}
    pairs = [(place[a], place[b]) for a, b in _ties(model)]
    pairs += [(0, place[name]) for name, body in model.bodies.items() if body.motion is not None]
    ends = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    graph = sp.coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(len(names), len(names)))
    _, part = connected_components(graph, directed=False)
    sentences = []
    for group in dict.fromkeys(part.tolist()):
        if group == part[0]:
            continue
        members = [name for name in model.bodies if part[place[name]] == group]
        if len(members) == 1:
            sentences.append(f"no joint or spring holds {members[0]}: it flies free")
        else:
            sentences.append(f"{', '.join(members)} are joined to each other but not to ground: they fly free")
    return sentences


def unused_attachments(model: Model) -> list[str]:
    """Attachments, ``body.attachment``, that no joint, force, point mass or clamp uses."""
    used = {str(end) for end in _ends(model)}
    for name, body in model.bodies.items():
        used |= {f"{name}.{key}" for key, attachment in body.attachments.items() if attachment.point_masses}
        if not isinstance(body, RigidBody) and body.motion is not None:
            used |= {f"{name}.{key}" for key in body.motion.held}
    every = [f"{name}.{key}" for name, body in model.bodies.items() for key in body.attachments]
    return [name for name in every if name not in used]


def liaison_ends(liaison: Liaison) -> tuple[End, ...]:
    """The ends of a liaison; none of drivers and couplers, which act on other joints."""
    if isinstance(liaison, Driver | Coupler):
        return ()
    if isinstance(liaison, Pfaffian | PfaffianFunction):
        return tuple(liaison.ends.values())
    return liaison.first, liaison.second


def _ties(model: Model) -> list[tuple[str, str]]:
    """Pairs of bodies (or ground) that a liaison or a spring ties; ends at points are ground's."""
    tied = [liaison_ends(one) for one in model.joints.values()]
    tied += [(one.first, one.second) for one in model.forces.values() if isinstance(one, SpringDamper)]
    return [(ends[0].body, end.body) for ends in tied for end in ends[1:]]


def _ends(model: Model) -> list[End]:
    ends = [end for one in model.joints.values() for end in liaison_ends(one)]
    for force in model.forces.values():
        if isinstance(force, PointLoad):
            ends.append(force.on)
        elif isinstance(force, SpringDamper):
            ends += [force.first, force.second]
    return ends

"""Model ─► Scene: bodies, attachments and joints where they stand before anything moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from maggi.model.bodies import ElasticBody
from maggi.model.model import Model
from maggi.system.build import build_system

from .build_outline import build_outline
from .first_instant import frames_at_rest
from .scene import Scene, SceneAttachment, SceneBody, SceneJoint
from .snapshot import body_kind, visible_liaisons


def build_scene(model: Model) -> Scene:
    """What a drawing of the mechanism in its initial pose needs.

    Joints are drawn as they are given: gaps between their ends stay visible. Raises ModelError for whatever cannot
    be built, naming the body, joint or force. Reductions are not carried out: undeformed bodies look the same.
    """
    bodies_as_meshes = {
        name: replace(body, reduction=None) if isinstance(body, ElasticBody) else body
        for name, body in model.bodies.items()
    }
    system = build_system(replace(model, bodies=bodies_as_meshes), recorded=frames_at_rest(model))
    table, start = system.bodies, system.start
    bodies = []
    for entry in system.body_entries:
        if not entry.visible:
            continue
        b = entry.index
        mass, mesh = float(table.mass[b]), system.mesh_bodies.get(b)
        center = table.S0[b] / mass if mass > 0.0 else np.zeros(3)
        bodies.append(
            SceneBody(
                entry.name,
                body_kind(system, b),
                start.origin[b],
                start.rotation[b],
                start.origin[b] + start.rotation[b] @ center,
                None if mesh is None else mesh.mesh.nodes,
                None if mesh is None else mesh.mesh.cells,
            )
        )
    attachments = []
    for place in system.attachment_entries:
        b = int(table.attachment_body[place.index])
        position = start.origin[b] + start.rotation[b] @ table.attachment_point[place.index]
        attachments.append(SceneAttachment(place.body, place.name, position))
    joints = [
        SceneJoint(
            entry.name,
            entry.kind,
            entry.first,
            entry.second,
            entry.position,
            entry.axis,
            build_outline(system, entry),
        )
        for entry in visible_liaisons(system)
    ]
    return Scene(
        model.title, np.array(model.gravity, dtype=np.float64), tuple(bodies), tuple(attachments), tuple(joints)
    )

"""The audit of a model: it is assembled, and what it is comes out as data and as text.

Nothing is factorised but for the shapes of bodies with a reduction.
"""

from __future__ import annotations

import numpy as np

from maggi.bodies.mesh_body import MeshBody
from maggi.bodies.motions import prescribe
from maggi.bodies.reduced import ReducedBody
from maggi.bodies.tables import MotionState
from maggi.mesh.set_geometry import set_geometry
from maggi.model.errors import ModelError
from maggi.model.joints import Driver
from maggi.model.model import Model
from maggi.stepping.allocate import copy_motion
from maggi.system.build import build_system
from maggi.system.dense import dense_rows, floating_velocities, velocity_scale
from maggi.system.system import BodyEntry, System

from .audit_report import (
    AttachmentReport,
    Audit,
    BodyReport,
    ForceReport,
    LiaisonReport,
    NodeSetReport,
    ReductionReport,
)
from .connections import force_ends, loose_parts, unused_attachments
from .first_instant import frames_at_start
from .freedoms import elastic_freedoms, freedoms
from .initial import initial_motion, refuse_undefined
from .integrability import integrability
from .locks import locked_parts
from .mobility import SINGULAR, Mobility, mobility
from .nearby import Nearby, nearby_poses
from .recorder import Progress
from .remedies import Remedy, remedies
from .snapshot import body_kind, visible_liaisons


def audit(model: Model, progress: Progress | None = None) -> Audit:
    """What a model is: masses, node sets, liaisons, rank and freedoms at its initial pose; needs no `simulation`.

    What stands against a run, such as joints that do not meet, is in `Audit.problems`, so that everything else can be
    looked at all the same.

    Raises
    ------
    ModelError : the model cannot be assembled at all.
    """

    def announce(text: str) -> None:
        if progress is not None:
            progress.stage(text)

    system = build_system(model, recorded=frames_at_start(model, announce), announce=announce)
    notes: list[str] = []
    motion, problems = _initial(system, notes)
    nearby = nearby_poses(system, motion)
    counts = mobility(system, motion, nearby)
    notes += _singular(counts)
    if counts.smallest_kept < SINGULAR:
        notes.append(
            f"the initial pose is close to a singular one: the smallest singular value of the liaisons is "
            f"{counts.smallest_kept:.1e}"
        )
    if not problems:  # joints that do not meet look as if they locked each other
        notes += locked_parts(system, motion)
    notes += loose_parts(model)
    notes += [
        f"{body.name}: {note}"
        for body in system.body_entries
        if (mesh := system.mesh(body.index)) is not None
        for note in mesh.mesh.notes
    ]
    if model.simulation is None:
        notes.append("there is no `simulation:`, which `maggi run` needs")
    return Audit(
        model.title,
        model.gravity,
        system.size,
        tuple(_body(system, entry) for entry in system.body_entries if entry.visible),
        tuple(_liaisons(system)),
        tuple(ForceReport(name, *force_ends(force)) for name, force in model.forces.items()),
        counts,
        freedoms(system, motion),
        elastic_freedoms(system),
        _remedies(system, motion, nearby),
        integrability(system, motion),
        tuple(notes),
        tuple(unused_attachments(model)),
        problems,
    )


def _initial(system: System, notes: list[str]) -> tuple[MotionState, tuple[ModelError, ...]]:
    """The initial motion, or the poses as they are given and why there is none."""
    try:
        return initial_motion(system, notes), ()
    except ModelError as error:
        motion = copy_motion(system.start)
        prescribe(system.motions, system.bodies, 0.0, motion)
        refuse_undefined(system, motion)  # of such rows there is no rank to be told
        return motion, (error,)


def _singular(counts: Mobility) -> list[str]:
    """What is special about the initial pose."""
    if counts.shaky:
        return [
            "the joints admit a velocity of the rigid bodies in the initial pose, but no motion along it (a shaky structure): "
            "change a dimension a little and it can move, or cannot even for an instant"
        ]
    more = counts.rigid_mobility - (counts.generic_rigid_mobility or 0)
    if counts.generic_rigid_mobility is None or more <= 0:
        return []
    return [
        f"the initial pose is singular: rigid bodies have {counts.rigid_mobility} freedoms here and "
        f"{counts.generic_rigid_mobility} beside it, as in a dead centre; start a little beside it"
    ]


def _remedies(system: System, motion: MotionState, nearby: Nearby) -> tuple[Remedy, ...]:
    """Remedies for rows that repeat each other in general, with every elastic body rigid."""
    frames = floating_velocities(system)
    place = nearby.places[0].motion if nearby.places else motion
    return remedies(system, dense_rows(system, place, 0.0).A[:, frames] / velocity_scale(system)[frames])


def _body(system: System, entry: BodyEntry) -> BodyReport:
    table, start, b = system.bodies, system.start, entry.index
    mass = float(table.mass[b])
    center = table.S0[b] / mass if mass > 0.0 else np.zeros(3)
    inertia = table.J0[b] - mass * (center @ center * np.eye(3) - np.outer(center, center))
    elastic = int(table.offset[b + 1] - table.offset[b]) - 6
    mesh, reduced = system.mesh(b), system.reduced.get(b)
    floating = 6 * int(table.floating[b])
    attachments = []
    for place in system.attachment_entries:
        if place.body == entry.name:
            point = table.attachment_point[place.index]
            members, coupling = _nodes(mesh, place.name)
            position = start.origin[b] + start.rotation[b] @ point
            attachments.append(AttachmentReport(place.name, position, point, members, coupling))
    return BodyReport(
        entry.name,
        body_kind(system, b),
        "floating" if floating else "prescribed",
        mass,
        start.origin[b] + start.rotation[b] @ center,
        inertia,
        floating + elastic if mesh is None or reduced is not None else mesh.size,
        None if mesh is None else mesh.mesh.bounding_box(),
        0 if mesh is None else mesh.mesh.n_nodes,
        {} if mesh is None else {kind: len(cells) for kind, cells in mesh.mesh.cells.items()},
        tuple(attachments),
        () if mesh is None else tuple(_node_sets(mesh)),
        None if reduced is None else _reduction(reduced),
    )


def _reduction(body: ReducedBody) -> ReductionReport:
    shapes = body.shapes
    elastic = shapes.frequencies[shapes.rigid :]
    return ReductionReport(
        shapes.method,
        body.body.size,
        len(shapes.held),
        float(shapes.held[-1]) if shapes.held.size else None,
        shapes.interface,
        len(shapes.frequencies),
        (float(elastic[0]), float(elastic[-1])) if elastic.size else None,
    )


def _nodes(mesh: MeshBody | None, attachment: str) -> tuple[int, str]:
    if mesh is None:
        return 0, ""
    coupling = next(coupling for coupling in mesh.couplings if coupling.name == attachment)
    return len(coupling.nodes), "rigid" if coupling.rigid else "average"


def _node_sets(body: MeshBody) -> list[NodeSetReport]:
    reports = []
    for name, nodes in body.mesh.node_sets.items():
        if len(nodes) == 0:
            reports.append(NodeSetReport(name, 0, "empty", None, None, None))
            continue
        shape = set_geometry(body.mesh, nodes)
        reports.append(NodeSetReport(name, len(nodes), shape.kind, shape.centroid, shape.axis, shape.radius))
    return reports


def _liaisons(system: System) -> list[LiaisonReport]:
    reports = []
    for entry in visible_liaisons(system):
        given = system.model.joints[entry.name]
        drives = (given.joint, given.quantity, given.function.text) if isinstance(given, Driver) else None
        reports.append(
            LiaisonReport(
                entry.name, entry.kind, entry.first, entry.second, len(entry.rows), entry.position, entry.axis, drives
            )
        )
    return reports

"""Model ─► System: meshes are read and assembled, joints placed, everything numbered and packed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maggi.bodies.motions import MotionTable
from maggi.forces.tables import ForceTable
from maggi.liaisons.registry import JOINTS
from maggi.liaisons.special import link_special
from maggi.model.bodies import Body, ElasticBody, GivenMotion, RigidBody, RigidRunMotion, RitzBody
from maggi.model.errors import ModelError
from maggi.model.expression import expression
from maggi.model.forces import PointLoad, SpringDamper, TorsionSpring
from maggi.model.joints import Coupler, Driver, End
from maggi.model.model import Model

from .body_list import BodyList, initial_pose
from .dense import new_attachments, new_row_values
from .joint_builder import JointBuilder
from .liaison_list import LiaisonList
from .packing import FunctionList, integers, numbers
from .places import Places
from .system import AttachmentEntry, BodyEntry, System

if TYPE_CHECKING:
    from maggi.bodies.mesh_body import MeshBody
    from maggi.bodies.reduced import ReducedBody

Array = NDArray[np.float64]
Announce = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class RecordedMotion:
    """The motion of a body's frame at equidistant times: origin (n, 3), rotation (n, 3, 3), twist and rate (n, 6)."""

    step: float
    origin: Array
    rotation: Array
    twist: Array
    rate: Array


def build_system(
    model: Model,
    *,
    recorded: Mapping[str, RecordedMotion] | None = None,
    rigid: frozenset[str] = frozenset(),
    dense: bool = False,
    meshes: dict[str, MeshBody] | None = None,
    announce: Announce = lambda text: None,
) -> System:
    """Everything a computation needs, from a description.

    recorded : motions for bodies whose frame moves as in another run. rigid : elastic bodies to be taken as
    rigid. dense : full meshes become bodies with as many elastic coordinates as their motions span, so that the whole
    system is small and dense; for small meshes. meshes : meshed bodies already built, by name; those built here are added. announce : told what takes long.

    Raises ModelError for whatever cannot be built, naming the body, joint or force.
    """
    return _Builder(model, recorded or {}, rigid, dense, {} if meshes is None else meshes, announce).build()


class _Builder:
    """The lists that grow while a model is read."""

    def __init__(
        self,
        model: Model,
        recorded: Mapping[str, RecordedMotion],
        rigid: frozenset[str],
        dense: bool,
        meshes: dict[str, MeshBody],
        announce: Announce,
    ) -> None:
        self._model = model
        self._recorded = recorded
        self._rigid = rigid
        self._dense = dense
        self._meshes = meshes
        self._announce = announce
        self._bodies = BodyList()
        self._places = Places(self._bodies)
        self._liaisons = LiaisonList(self._bodies)
        self._joints = JointBuilder(self._bodies, self._places, self._liaisons)
        self._body_entries: list[BodyEntry] = []
        self._attachment_entries: list[AttachmentEntry] = []
        self._mesh_bodies: dict[int, MeshBody] = {}
        self._reduced: dict[int, ReducedBody] = {}
        self._given: list[tuple[int, GivenMotion, Array, Array]] = []
        self._replayed: list[tuple[int, RecordedMotion]] = []

    def build(self) -> System:
        model = self._model
        for name, body in model.bodies.items():
            self._add_body(name, body)
        # drivers and couplers act on the coordinates of other joints
        for late in (False, True):
            for name, liaison in model.joints.items():
                if isinstance(liaison, Driver | Coupler) == late:
                    self._joints.add(liaison, name)
        forces = self._forces()
        points = np.array(self._places.extent + self._bodies.centers())
        size = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
        size = size if size > 0.0 else 1.0
        table = self._bodies.table()
        liaisons, entries = self._liaisons.finish(len(table.kind), table.offset)
        link_special(liaisons, new_attachments(0), new_row_values(liaisons, 0))
        return System(
            model,
            table,
            self._motion_table(),
            liaisons,
            forces,
            tuple(self._body_entries),
            tuple(self._attachment_entries),
            entries,
            self._mesh_bodies,
            self._reduced,
            size,
            self._bodies.inertia_floor(size),
            self._bodies.start(),
            tuple(self._liaisons.row_functions),
        )

    # bodies

    def _add_body(self, name: str, body: Body) -> None:
        if isinstance(body, RigidBody):
            index = self._bodies.add_rigid(body)
            self._name(name, index)
            self._points(name, body, index)
            if body.motion is not None:
                self._prescribe(index, body, body.motion)
        elif isinstance(body, RitzBody):
            index = self._bodies.add_ritz(name, body)
            self._name(name, index)
            self._shape_points(name, body, index)
            if body.motion is not None:
                self._prescribe(index, body, body.motion)
        else:
            self._add_elastic(name, body)
        for key, attachment in body.attachments.items():
            for number, mass in enumerate(attachment.point_masses):
                self._weld_mass(name, key, number, RigidBody(mass.mass, mass.offset, mass.inertia))

    def _add_elastic(self, name: str, body: ElasticBody) -> None:
        mesh = self._meshes.get(name)
        if mesh is None:
            from maggi.bodies.mesh_body import build_mesh_body  # with all that meshes need: not for rigid models

            self._announce(f"assembling {name}")
            mesh = self._meshes[name] = build_mesh_body(name, body, self._model.folder, self._meshes.values())
        motion = body.motion
        pose = initial_pose(body.pose, motion if isinstance(motion, GivenMotion) else None)
        reduced = self._reduce(name, body, mesh)
        if name in self._rigid:
            index = self._bodies.add_rigidified(mesh, pose)
        elif reduced is not None:
            index = self._bodies.add_reduced(reduced, pose)
            self._reduced[index] = reduced
        else:
            index = self._bodies.add_mesh(mesh, pose)
            self._mesh_bodies[index] = mesh
        self._name(name, index)
        low, high = mesh.mesh.bounding_box()
        self._places.extent += [self._bodies.to_global(index, low), self._bodies.to_global(index, high)]
        count = len(mesh.couplings)
        for k, coupling in enumerate(mesh.couplings):
            psi = None
            if index in self._mesh_bodies:
                psi = np.zeros((6, 6 * count))
                psi[:, 6 * k : 6 * k + 6] = np.eye(6)
            elif reduced is not None:
                psi = reduced.psi[k]
            self._attach(name, coupling.name, index, coupling.point, psi)
        if motion is None or name in self._rigid:
            return
        helper = self._bodies.add_rigid(RigidBody(0.0, motion=GivenMotion()))
        self._body_entries.append(BodyEntry(f"{name}.frame", helper, visible=False))
        for target in (index, helper):
            if isinstance(motion, GivenMotion):
                self._prescribe(target, body, motion)
            else:
                self._replayed.append((target, self._recorded[name]))
        for held in motion.held:
            attachment = self._places.attachment(End(name, held), f"bodies.{name}.frame.held")
            point = self._bodies.attachment_position(attachment)
            self._joints.add_joint(
                f"{name}.{held}.held",
                JOINTS["weld"],
                self._bodies.add_attachment(helper, pose[1].T @ (point - pose[0])),
                attachment,
                (np.eye(3), np.eye(3)),
                (f"{name}.frame", f"{name}.{held}"),
                visible=False,
            )

    def _reduce(self, name: str, body: ElasticBody, mesh: MeshBody) -> ReducedBody | None:
        """The body on its shapes; None where it is rigid or its full mesh moves."""
        if name in self._rigid or (body.reduction is None and not self._dense):
            return None
        from maggi.bodies.complete import complete
        from maggi.bodies.craig_bampton import craig_bampton
        from maggi.bodies.reduced import reduce_body

        self._announce(f"reducing {name} ({mesh.size:,} freedoms)")
        if body.reduction is None:
            return reduce_body(mesh, complete(mesh, f"bodies.{name}"))
        return reduce_body(mesh, craig_bampton(mesh, body.reduction.modes, f"bodies.{name}.reduction"))

    def _name(self, name: str, index: int) -> None:
        self._places.add_body(name, index)
        self._body_entries.append(BodyEntry(name, index))

    def _attach(self, body: str, name: str, index: int, point: Array, psi: Array | None) -> None:
        row = self._bodies.add_attachment(index, point, psi)
        self._places.add_attachment(body, name, row)
        self._attachment_entries.append(AttachmentEntry(body, name, row))

    def _points(self, name: str, body: RigidBody, index: int) -> None:
        for key, attachment in body.attachments.items():
            if attachment.at is None:
                raise ModelError(
                    "an attachment of a rigid body needs a point",
                    path=f"bodies.{name}.attachments.{key}",
                    remedy="give `at: [x, y, z]` in the body's frame",
                )
            self._attach(name, key, index, np.array(attachment.at), None)

    def _shape_points(self, name: str, body: RitzBody, index: int) -> None:
        for key, attachment in body.attachments.items():
            path = f"bodies.{name}.attachments.{key}"
            if attachment.at is None:
                raise ModelError("an attachment of a Ritz body needs a point", path=path, remedy="give `at: [x, y, z]`")
            point = np.array(attachment.at)
            displacement = np.asarray(body.shapes(point[None]))[0]
            rotation = (
                np.zeros_like(displacement) if body.rotations is None else np.asarray(body.rotations(point[None]))[0]
            )
            if not (np.isfinite(displacement).all() and np.isfinite(rotation).all()):
                raise ModelError("the shape functions are not finite here", path=path, remedy="move the attachment")
            self._attach(name, key, index, point, np.vstack([displacement, rotation]))

    def _weld_mass(self, body: str, key: str, number: int, mass: RigidBody) -> None:
        """A point mass: a rigid body welded to its attachment."""
        index = self._bodies.add_rigid(mass)
        path = f"bodies.{body}.attachments.{key}"
        holder = self._places.attachment(End(body, key), path)
        start = self._bodies.attachment_position(holder)
        rotation = self._bodies.rotation(self._places.body(body, path))
        self._bodies.place(index, start, rotation)
        name = f"{body}.{key}.mass{number + 1}"
        self._body_entries.append(BodyEntry(name, index, visible=False))
        self._joints.add_joint(
            f"{name}.weld",
            JOINTS["weld"],
            holder,
            self._bodies.add_attachment(index, np.zeros(3)),
            (rotation, rotation),
            (f"{body}.{key}", name),
            visible=False,
        )

    def _prescribe(self, index: int, body: Body, motion: GivenMotion) -> None:
        self._given.append((index, motion, np.array(body.pose.origin), np.array(body.pose.rotation)))

    # forces

    def _forces(self) -> ForceTable:
        functions = FunctionList()
        springs, spring_data, torsion, torsion_data, loads, load_kind = [], [], [], [], [], []
        for name, force in self._model.forces.items():
            path = f"forces.{name}"
            if isinstance(force, PointLoad):
                loads.append(self._places.point(force.on, f"{path}.on"))
                load_kind.append((int(force.kind == "torque"), int(force.frame == "body")))
                for component in force.value:
                    functions.add(component)
            elif isinstance(force, SpringDamper):
                ends = [self._places.point(end, f"{path}.between") for end in (force.first, force.second)]
                p, q = (self._bodies.attachment_position(end) for end in ends)
                distance = float(np.linalg.norm(q - p))
                if distance == 0.0:
                    raise ModelError(
                        "the spring's ends coincide, so it has no direction",
                        path=f"{path}.between",
                        remedy="move one end, or use a torsion spring",
                    )
                springs.append(ends)
                spring_data.append((force.stiffness, force.damping, distance if force.length is None else force.length))
            elif isinstance(force, TorsionSpring):
                torsion.append(self._liaisons.coordinate(force.joint, "angle", f"{path}.joint"))
                # coordinates are zero in the initial pose
                torsion_data.append((force.stiffness, force.damping, force.angle or 0.0))
        start, codes, values = functions.tables()
        return ForceTable(
            np.array(self._model.gravity, dtype=np.float64),
            integers(springs, (-1, 2)),
            numbers(spring_data, (-1, 3)),
            integers(torsion),
            numbers(torsion_data, (-1, 3)),
            integers(loads),
            integers(load_kind, (-1, 2)),
            start,
            codes,
            values,
        )

    def _motion_table(self) -> MotionTable:
        functions = FunctionList()
        rotations, axes = [], []
        for _, motion, origin, rotation in self._given:
            for i in range(3):
                functions.add(expression(float(origin[i])) if motion.origin is None else motion.origin[i])
            functions.add(expression(0.0) if motion.angle is None else motion.angle)
            rotations.append(rotation)
            axis = np.array(motion.axis if motion.axis is not None else (0.0, 0.0, 1.0))
            axes.append(axis / np.linalg.norm(axis))
        start, codes, values = functions.tables()
        replayed = [motion for _, motion in self._replayed]
        n = len(replayed[0].origin) if replayed else 1
        return MotionTable(
            integers([g[0] for g in self._given]),
            numbers(rotations, (-1, 3, 3)),
            numbers(axes, (-1, 3)),
            start,
            codes,
            values,
            integers([b for b, _ in self._replayed]),
            replayed[0].step if replayed else 1.0,
            numbers([m.origin for m in replayed], (-1, n, 3)),
            numbers([m.rotation for m in replayed], (-1, n, 3, 3)),
            numbers([m.twist for m in replayed], (-1, n, 6)),
            numbers([m.rate for m in replayed], (-1, n, 6)),
        )


def has_recorded_motion(model: Model) -> list[str]:
    """Names of the bodies whose frame moves as in a run with them rigid."""
    return [
        name
        for name, body in model.bodies.items()
        if isinstance(body, ElasticBody) and isinstance(body.motion, RigidRunMotion)
    ]

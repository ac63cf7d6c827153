"""A model as mass points, placed liaisons and applied forces: everything from its description, nothing from matrices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.model.attachments import PointMass
from maggi.model.bodies import ElasticBody, GivenMotion, RigidBody, RitzBody
from maggi.model.errors import ModelError
from maggi.model.forces import PointLoad, SpringDamper, TorsionSpring
from maggi.model.joints import (
    GROUND,
    Cam,
    Coupler,
    Distance,
    Driver,
    End,
    Joint,
    KnifeEdge,
    Liaison,
    Pfaffian,
    PfaffianFunction,
    Plane,
    PointOnCurve,
    PointOnSurface,
    RollingDisc,
    RollingSphere,
)
from maggi.model.model import Model

from .bodies import Marker, PointBody, rigid_body, ritz_body
from .constraints.contacts import DiscGeometry, KnifeEdgeGeometry, SphereGeometry
from .constraints.curves import CurveGeometry, FaceGeometry, RollerGeometry, SurfaceGeometry, Track
from .constraints.joints import LOCKS, JointGeometry
from .constraints.locked import Geometry
from .constraints.relations import (
    CouplerGeometry,
    DriverGeometry,
    PfaffianFunctionGeometry,
    PfaffianGeometry,
    RodGeometry,
)
from .forces import AppliedForce, LoadGeometry, SpringGeometry, TorsionGeometry
from .mesh_bodies import mesh_body

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Bodies (in the order of the unknowns), liaisons and applied forces by name, and gravity (3,)."""

    bodies: Mapping[str, PointBody]
    liaisons: Mapping[str, Geometry]
    forces: Mapping[str, AppliedForce]
    gravity: Array


def mechanism_of(model: Model, fields: Mapping[str, Array]) -> Mechanism:
    """The mechanism that a model describes.

    fields : for every meshed body that is to bend, its nodal displacements for unit elastic coordinates
        (nodes, 3 or, of beams, 6, n); meshed bodies without are rigid.
    Raises ModelError where a body or a liaison has no description in points.
    """
    builder = _Builder(model, fields)
    return Mechanism(builder.bodies, builder.liaisons, builder.forces(), np.array(model.gravity))


class _Builder:
    """Places liaisons and forces on bodies, in the initial pose."""

    def __init__(self, model: Model, fields: Mapping[str, Array]) -> None:
        self._model = model
        self.bodies: dict[str, PointBody] = {}
        self.liaisons: dict[str, Geometry] = {}
        self._ground = PointBody(GROUND, np.empty(0), np.empty((0, 3)), np.empty((0, 3, 0)), np.zeros(3), np.eye(3))
        for name, body in model.bodies.items():
            self._add_body(name, body, fields)
        joints = {name: self._joint(joint) for name, joint in model.joints.items() if isinstance(joint, Joint)}
        self._joints = joints
        for name, liaison in model.joints.items():
            self.liaisons[name] = joints[name] if name in joints else self._liaison(name, liaison)

    # bodies

    def _add_body(self, name: str, body: RigidBody | RitzBody | ElasticBody, fields: Mapping[str, Array]) -> None:
        if isinstance(body, RigidBody):
            self.bodies[name] = rigid_body(name, body)
        elif isinstance(body, RitzBody):
            self.bodies[name] = ritz_body(name, body)
        else:
            self.bodies[name] = mesh_body(name, body, self._model.folder, fields.get(name))
            if name in fields and body.motion is not None:
                self._hold(name, body)
        for key, attachment in body.attachments.items():
            for number, mass in enumerate(attachment.point_masses):
                self._weld_mass(name, key, f"{name}.{key}.mass{number + 1}", mass)

    def _weld_mass(self, body: str, key: str, name: str, mass: PointMass) -> None:
        """A point mass: a rigid body welded to its attachment, with its frame there."""
        parent = self.bodies[body]
        marker = parent.attachments[key]
        point = rigid_body(name, RigidBody(mass.mass, mass.offset, mass.inertia))
        place = parent.origin + parent.rotation @ marker.point
        self.bodies[name] = PointBody(name, point.masses, point.points, point.shapes, place, parent.rotation)
        self._weld(f"{name}.weld", marker, self.bodies[name].fixed(place))

    def _hold(self, name: str, body: ElasticBody) -> None:
        """The prescribed frame of an elastic body as a body without mass, to which the held attachments are welded."""
        elastic = self.bodies[name]
        motion = body.motion if isinstance(body.motion, GivenMotion) else None
        frame = PointBody(
            f"{name}.frame",
            np.empty(0),
            np.empty((0, 3)),
            np.empty((0, 3, 0)),
            elastic.origin,
            elastic.rotation,
            motion=motion,
        )
        self.bodies[frame.name] = frame
        for held in [] if body.motion is None else body.motion.held:
            marker = elastic.attachments[held]
            place = elastic.origin + elastic.rotation @ marker.point
            self._weld(f"{name}.{held}.held", frame.fixed(place), marker)

    def _weld(self, name: str, first: Marker, second: Marker) -> None:
        turned = self._body(first.body).rotation.T @ self._body(second.body).rotation
        still = Marker(first.body, first.point, first.translation, first.rotation, turned)
        self.liaisons[name] = JointGeometry("weld", still, second)

    def _body(self, name: str) -> PointBody:
        return self._ground if name == GROUND else self.bodies[name]

    # liaisons

    def _joint(self, joint: Joint) -> JointGeometry:
        place = self._place(joint.at, joint.first, joint.second)
        if joint.kind not in LOCKS:
            raise ModelError(f"the formulations know no joint type {joint.kind!r}")
        first_axes, second_axes = _joint_axes(joint)
        return JointGeometry(
            joint.kind,
            self._marker(joint.first, place, first_axes, joint.at is not None),
            self._marker(joint.second, place, second_axes, joint.at is not None),
            joint.pitch or 0.0,
        )

    def _liaison(self, name: str, liaison: Liaison) -> Geometry:
        match liaison:
            case Driver():
                return DriverGeometry(self._joints[liaison.joint], liaison.quantity, liaison.function)
            case Coupler():
                joints = {key: (self._joints[c.joint], c.quantity) for key, c in liaison.coordinates.items()}
                return CouplerGeometry(joints, liaison.relation, liaison.rates)
            case Distance():
                first, second = self._point(liaison.first), self._point(liaison.second)
                length = self._distance(first, second) if liaison.length is None else liaison.length
                return RodGeometry(first, second, length)
            case PointOnCurve():
                second = self._centre(liaison.second, liaison.at, np.eye(3))
                return CurveGeometry(self._point(liaison.first), second, Track(liaison.curve))
            case PointOnSurface():
                second = self._centre(liaison.second, liaison.at, np.eye(3))
                return SurfaceGeometry(self._point(liaison.first), second, liaison.surface)
            case Cam():
                return self._cam(liaison)
            case RollingDisc():
                disc = self._centre(liaison.second, liaison.at, _axes_along(np.array(liaison.axis)))
                return DiscGeometry(self._plane(liaison.first, liaison.plane), disc, liaison.radius)
            case RollingSphere():
                centre = self._centre(liaison.second, liaison.at, np.eye(3))
                return SphereGeometry(self._plane(liaison.first, liaison.plane), centre, liaison.radius)
            case KnifeEdge():
                return self._knife_edge(liaison)
            case Pfaffian():
                return PfaffianGeometry({key: self._point(end) for key, end in liaison.ends.items()}, liaison.rows)
            case PfaffianFunction():
                ends = tuple(self._point(end) for end in liaison.ends.values())
                return PfaffianFunctionGeometry(ends, liaison.function)
        raise TypeError(f"{name}: no geometry for liaisons of type {type(liaison).__name__}")

    def _cam(self, cam: Cam) -> Geometry:
        first, track = self._point(cam.first), Track(cam.profile)
        if cam.face is not None:
            return FaceGeometry(first, self._centre(cam.second, cam.at, _axes_along(np.array(cam.face))), track)
        axis = self._body(cam.first.body).rotation.T @ np.array(cam.axis)
        second = self._centre(cam.second, cam.at, np.eye(3))
        return RollerGeometry(first, second, track, axis / np.linalg.norm(axis), cam.radius)

    def _knife_edge(self, edge: KnifeEdge) -> KnifeEdgeGeometry:
        along = np.array(edge.direction) / np.linalg.norm(edge.direction)
        sideways = np.cross(np.array(edge.normal), along)
        sideways /= np.linalg.norm(sideways)
        blade = self._centre(edge.second, edge.at, np.column_stack([along, sideways, np.cross(along, sideways)]))
        return KnifeEdgeGeometry(self._marker(edge.first, self._global(blade), np.eye(3), True), blade)

    def _plane(self, end: End, plane: Plane) -> Marker:
        return self._marker(end, np.array(plane.point), _axes_along(np.array(plane.normal)), True)

    def _centre(self, end: End, at: tuple[float, float, float] | None, axes: Array) -> Marker:
        """The second's point of a contact with given global axes: `at`, or the named attachment, or the body's origin."""
        return self._marker(end, self._place(at, end), axes, at is not None)

    def _place(self, at: tuple[float, float, float] | None, *ends: End) -> Array:
        """Where a liaison is, global: `at`, or the first attachment named, or the origin of the last end's body."""
        if at is not None:
            return np.array(at)
        for end in ends:
            if end.attachment is not None:
                return self._global(self._body(end.body).attachments[end.attachment])
        return self._body(ends[-1].body).origin

    def _global(self, marker: Marker) -> Array:
        body = self._body(marker.body)
        return np.asarray(body.origin + body.rotation @ marker.point)

    def _marker(self, end: End, place: Array, axes: Array, elsewhere: bool) -> Marker:
        """The named attachment with given global axes, or a point of a rigid body; `elsewhere`: `at` was given."""
        body = self._body(end.body)
        if end.attachment is None or (elsewhere and body.elastic == 0):
            return body.fixed(place, axes)
        named = body.attachments[end.attachment]
        return Marker(end.body, named.point, named.translation, named.rotation, body.rotation.T @ axes)

    def _point(self, end: End) -> Marker:
        """The point of an end: fixed in ground, a named attachment, or the body's origin; axes of the body."""
        if end.point is not None:
            return self._ground.fixed(np.array(end.point))
        body = self._body(end.body)
        return body.fixed(body.origin, body.rotation) if end.attachment is None else body.attachments[end.attachment]

    def _distance(self, first: Marker, second: Marker) -> float:
        return float(np.linalg.norm(self._global(second) - self._global(first)))

    # forces

    def forces(self) -> dict[str, AppliedForce]:
        """Applied forces by name."""
        result: dict[str, AppliedForce] = {}
        for name, force in self._model.forces.items():
            match force:
                case PointLoad():
                    result[name] = LoadGeometry(self._point(force.on), force)
                case SpringDamper():
                    first, second = self._point(force.first), self._point(force.second)
                    length = self._distance(first, second) if force.length is None else force.length
                    result[name] = SpringGeometry(first, second, force.stiffness, force.damping, length)
                case TorsionSpring():
                    joint = self._joints[force.joint]
                    result[name] = TorsionGeometry(joint, force.stiffness, force.damping, force.angle or 0.0)
        return result


def _axes_along(z: Array) -> Array:
    """Right-handed axes with the given z direction."""
    z = z / np.linalg.norm(z)
    x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _joint_axes(joint: Joint) -> tuple[Array, Array]:
    """Axes of a joint's two frames in the initial pose, global."""
    if joint.kind in ("universal", "constant-velocity") and joint.axes is not None:
        first, second = (np.array(axis) / np.linalg.norm(axis) for axis in joint.axes)
        if joint.kind == "universal":
            axes = np.column_stack([first, second, np.cross(first, second)])
            return axes, axes
        return _bent(first, second)
    if joint.axis is None:
        return np.eye(3), np.eye(3)
    axes = _axes_along(np.array(joint.axis))
    return axes, axes


def _bent(first: Array, second: Array) -> tuple[Array, Array]:
    """Axes with z along two shafts, the second turned from the first about the common normal."""
    across = np.cross(first, second)
    if np.linalg.norm(across) < 1e-12:
        axes = _axes_along(first)
        return axes, axes
    across /= np.linalg.norm(across)
    return tuple(np.column_stack([across, np.cross(z, across), z]) for z in (first, second))  # type: ignore[return-value]

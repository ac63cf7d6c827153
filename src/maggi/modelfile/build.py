"""A checked document to the frozen `Model`."""

from __future__ import annotations

from types import MappingProxyType

from ..model.forces import Force, PointLoad, SpringDamper, TorsionSpring
from ..model.geometry import Vector
from ..model.joints import GROUND, Driver, End, Joint, Liaison
from ..model.model import Model
from ..model.simulation import Outputs
from .schema.document import Document
from .schema.forces import AnyForce, LoadSection, SpringDamperSection
from .schema.joints import AnyJoint, AxisJointSection, DriverSection, UniversalJointSection


def build_model(document: Document, text: str, folder: str) -> Model:
    """The model of a document in which every name has been found right."""
    materials = {name: section.build() for name, section in document.materials.items()}
    return Model(
        bodies=MappingProxyType({name: body.build(materials) for name, body in document.bodies.items()}),
        joints=MappingProxyType({name: _liaison(joint) for name, joint in document.joints.items()}),
        forces=MappingProxyType({name: _force(force) for name, force in document.forces.items()}),
        gravity=document.gravity,
        simulation=document.simulation.build() if document.simulation else None,
        outputs=document.outputs.build() if document.outputs else Outputs(),
        title=document.title,
        text=text,
        folder=folder,
    )


def _end(text: str) -> End:
    body, _, attachment = text.partition(".")
    return End(body, attachment or None)


def _liaison(section: AnyJoint) -> Liaison:
    if isinstance(section, DriverSection):
        return Driver(section.joint, section.quantity, section.function)
    first, second = map(_end, section.between)
    axis = section.axis if isinstance(section, AxisJointSection) else None
    axes = section.axes if isinstance(section, UniversalJointSection) else None
    return Joint(section.type, first, second, section.at, axis, axes)


def _spring_end(end: str | Vector) -> End:
    return _end(end) if isinstance(end, str) else End(GROUND, point=end)


def _force(section: AnyForce) -> Force:
    if isinstance(section, LoadSection):
        return PointLoad(_end(section.on), section.type, section.value, section.frame)
    if isinstance(section, SpringDamperSection):
        first, second = map(_spring_end, section.between)
        return SpringDamper(first, second, section.stiffness, section.damping, section.length)
    return TorsionSpring(section.joint, section.stiffness, section.damping, section.angle)

"""A checked document to the frozen `Model`."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..model.bodies import Body
from ..model.forces import Force, PointLoad, SpringDamper, TorsionSpring
from ..model.joints import Liaison
from ..model.model import Model
from ..model.simulation import Outputs
from .schema.document import Document
from .schema.ends import to_end
from .schema.forces import AnyForce, LoadSection, SpringDamperSection
from .schema.joints import AnyJoint, CamSection


def build_model(document: Document, text: str, folder: str) -> Model:
    """The model of a document in which every name has been found right."""
    materials = {name: section.build() for name, section in document.materials.items()}
    bodies = {name: body.build(materials) for name, body in document.bodies.items()}
    return Model(
        bodies=MappingProxyType(bodies),
        joints=MappingProxyType({name: _liaison(joint, bodies) for name, joint in document.joints.items()}),
        forces=MappingProxyType({name: _force(force) for name, force in document.forces.items()}),
        gravity=document.gravity,
        simulation=document.simulation.build() if document.simulation else None,
        outputs=document.outputs.build() if document.outputs else Outputs(),
        title=document.title,
        text=text,
        folder=folder,
    )


def _liaison(section: AnyJoint, bodies: Mapping[str, Body]) -> Liaison:
    return section.build(bodies) if isinstance(section, CamSection) else section.build()


def _force(section: AnyForce) -> Force:
    if isinstance(section, LoadSection):
        return PointLoad(to_end(section.on), section.type, section.value, section.frame)
    if isinstance(section, SpringDamperSection):
        first, second = map(to_end, section.between)
        return SpringDamper(first, second, section.stiffness, section.damping, section.length)
    return TorsionSpring(section.joint, section.stiffness, section.damping, section.angle)

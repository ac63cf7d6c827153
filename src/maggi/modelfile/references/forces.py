"""What forces act on."""

from __future__ import annotations

from ...model import units
from ...model.joint_kinds import named_coordinates
from ..schema.forces import AnyForce, LoadSection, SpringDamperSection, TorsionSpringSection
from .findings import Findings


def check_force(found: Findings, path: str, force: AnyForce) -> None:
    """Ends, joints and functions of time of a force."""
    if isinstance(force, LoadSection):
        _load(found, path, force)
    elif isinstance(force, SpringDamperSection):
        found.points(path, force.between)
        _acts(found, path, force)
    else:
        _torsion_spring(found, path, force)


def _load(found: Findings, path: str, load: LoadSection) -> None:
    found.end(f"{path}.on", load.on, ground=False)
    wanted = units.FORCE if load.type == "force" else units.TORQUE
    for place, component in enumerate(load.value):
        at = f"{path}.value.{place}"
        found.fits(at, component, wanted, load.type)
        found.finite(at, component)


def _torsion_spring(found: Findings, path: str, spring: TorsionSpringSection) -> None:
    joint = found.joint(f"{path}.joint", spring.joint)
    if joint is not None and "angle" not in named_coordinates(joint.kind):
        found.error(
            f"{path}.joint",
            f"'{spring.joint}' is {joint.kind} and has no angle",
            "a torsion-spring acts on a revolute, cylindrical, screw or planar joint",
        )
    _acts(found, path, spring)


def _acts(found: Findings, path: str, spring: SpringDamperSection | TorsionSpringSection) -> None:
    if spring.stiffness == 0.0 and spring.damping == 0.0:
        found.error(path, "neither stiffness nor damping is given", "give one of them, or remove the spring")

"""Names in a model file that refer to other parts of it: do they exist, and do they fit?"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ..model import units
from ..model.errors import ModelError
from ..model.expression import value_at
from ..model.functions import TimeFunction
from ..model.joints import GROUND
from ..model.units import Dimension, parse_quantity
from .schema.bodies import AnyBody, ElasticBodySection
from .schema.document import Document
from .schema.forces import LoadSection, SpringDamperSection, TorsionSpringSection
from .schema.frames import GivenFrameSection
from .schema.joints import COORDINATES, DriverSection, JointSection
from .schema.meshes import BeamMeshSection, BoxMeshSection
from .schema.mistakes import MAX_MISTAKES, shown, suggestion

BOX_SETS = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
BEAM_SETS = ("start", "end")

START = 1e-12
"""Largest value of an angle (rad) or displacement (m) function at t = 0 that counts as zero."""

SAMPLES = 201
"""Times at which functions of time are tried before a run; between them the run itself looks."""


@dataclass
class References:
    """All cross-checks of a document that is right in itself; collects what is wrong in `errors`."""

    document: Document
    errors: list[ModelError] = field(default_factory=list)

    def check(self) -> list[ModelError]:
        """Every mistake, section by section."""
        for name, body in self.document.bodies.items():
            if self._enough():
                return self.errors
            self._body(f"bodies.{name}", body)
        driven: dict[tuple[str, str], str] = {}
        for name, joint in self.document.joints.items():
            if self._enough():
                return self.errors
            if isinstance(joint, DriverSection):
                self._driver(name, joint, driven)
            else:
                self._joint(f"joints.{name}", joint)
        for name, force in self.document.forces.items():
            if self._enough():
                return self.errors
            path = f"forces.{name}"
            if isinstance(force, LoadSection):
                self._load(path, force)
            elif isinstance(force, SpringDamperSection):
                self._spring(path, force)
            else:
                self._torsion_spring(path, force)
        return self.errors

    def _enough(self) -> bool:
        """Whether a user has enough to do: very long lists of mistakes are cut."""
        return len(self.errors) >= MAX_MISTAKES

    def _error(self, path: str, message: str, remedy: str = "") -> None:
        self.errors.append(ModelError(message, path=path, remedy=remedy))

    # bodies

    def _body(self, path: str, body: AnyBody) -> None:
        if isinstance(body, ElasticBodySection):
            if isinstance(body.material, str) and body.material not in self.document.materials:
                self._error(
                    f"{path}.material",
                    f"unknown material {shown(body.material)}",
                    suggestion(body.material, self.document.materials, "known materials"),
                )
            self._node_sets(path, body)
        if body.frame is not None:
            for place, name in enumerate(body.frame.held):
                if name not in body.attachments:
                    self._error(
                        f"{path}.frame.held.{place}",
                        f"unknown attachment {shown(name)}",
                        suggestion(name, body.attachments, "attachments"),
                    )
            if isinstance(body.frame, GivenFrameSection):
                for place, component in enumerate(body.frame.origin or ()):
                    self._finite(f"{path}.frame.origin.{place}", component)
                if body.frame.angle is not None:
                    self._finite(f"{path}.frame.angle", body.frame.angle)

    def _node_sets(self, path: str, body: ElasticBodySection) -> None:
        """Sets of parametric meshes are known here; those of files when the mesh is read."""
        known = {BoxMeshSection: BOX_SETS, BeamMeshSection: BEAM_SETS}.get(type(body.mesh))
        if isinstance(body.mesh, BeamMeshSection | BoxMeshSection) and body.material is None:
            self._error(f"{path}.material", "missing key 'material'", "name a material, or give its keys")
        for name, attachment in body.attachments.items():
            if known and isinstance(attachment.nodes, str) and attachment.nodes not in known:
                self._error(
                    f"{path}.attachments.{name}.nodes",
                    f"unknown node set {shown(attachment.nodes)}",
                    suggestion(attachment.nodes, known, "sets of this mesh"),
                )

    # ends

    def _end(self, path: str, text: str, *, ground: bool = True) -> bool:
        """Check a text that names a body or an attachment; whether it is right."""
        name, dot, attachment = text.partition(".")
        if name == GROUND:
            if dot:
                self._error(path, "ground has no attachments", "write ground and give 'at'")
            elif not ground:
                self._error(path, "ground cannot stand here")
            return not dot and ground
        body = self.document.bodies.get(name)
        if body is None:
            known = [*self.document.bodies, GROUND] if ground else list(self.document.bodies)
            self._error(path, f"unknown body {shown(name)}", suggestion(name, known, "known bodies"))
            return False
        if dot and attachment not in body.attachments:
            self._error(
                path,
                f"body '{name}' has no attachment {shown(attachment)}",
                suggestion(attachment, body.attachments, f"attachments of {name}"),
            )
            return False
        if not dot and body.kind != "rigid":
            listed = ", ".join(f"{name}.{other}" for other in body.attachments) or "none so far"
            kind = "an elastic" if body.kind == "elastic" else "a Ritz"
            self._error(path, f"'{name}' is {kind} body and is held at attachments only", f"name one: {listed}")
            return False
        return True

    # joints

    def _joint(self, path: str, joint: JointSection) -> None:
        first, second = joint.between
        right = [self._end(f"{path}.between.{place}", text) for place, text in enumerate(joint.between)]
        if first.partition(".")[0] == second.partition(".")[0]:
            self._error(f"{path}.between", f"both ends are on '{first.partition('.')[0]}'", "join two different bodies")
            return
        named = first.count(".") + second.count(".")
        if named == 0 and joint.at is None and all(right):
            self._error(f"{path}.at", "missing key 'at'", "give the joint's point, or name an attachment in between")
        if named >= 2 and joint.at is not None:
            self._error(
                f"{path}.at",
                "two attachments are named and say where the joint is",
                "remove at, or name one attachment",
            )

    def _driver(self, name: str, driver: DriverSection, driven: dict[tuple[str, str], str]) -> None:
        path = f"joints.{name}"
        quantity, function = driver.quantity, driver.function
        self._finite(f"{path}.{quantity}", function)
        if quantity != "speed":
            start = value_at(function, [0.0])[0]
            if abs(start) > START:
                unit = "rad" if quantity == "angle" else "m"
                self._error(
                    f"{path}.{quantity}",
                    f"'{function.text}' is {start:.6g} {unit} at t = 0, but joints begin at zero",
                    f'subtract it: {quantity}: "{function.text} - ({start:.12g})"',
                )
        joint = self._joint_named(f"{path}.joint", driver.joint)
        if joint is None:
            return
        kind: str = joint.type  # type: ignore[attr-defined]  # every concrete joint has a type
        coordinates = COORDINATES[kind]
        known = [key for key in ("angle", "displacement") if getattr(coordinates, key)]
        if quantity == "speed" and len(known) == 1:
            coordinate = known[0]
            self._fits(
                f"{path}.speed", function, units.ANGULAR_VELOCITY if coordinate == "angle" else units.VELOCITY, kind
            )
        elif quantity == "speed" and known:
            self._error(
                f"{path}.speed",
                f"'{driver.joint}' is {kind}: speed of its angle or of its displacement?",
                "give the angle or the displacement as a function of t",
            )
            return
        elif quantity in known:
            coordinate = quantity
        else:
            can = f"drive its {' or '.join(known)}" if known else "drive a revolute, prismatic or cylindrical joint"
            self._error(f"{path}.{quantity}", f"'{driver.joint}' is {kind} and has no {quantity} to drive", can)
            return
        other = driven.setdefault((driver.joint, coordinate), name)
        if other != name:
            self._error(
                f"{path}.joint",
                f"the {coordinate} of '{driver.joint}' is driven twice, by '{other}' and '{name}'",
                "remove one of the drivers",
            )

    def _joint_named(self, path: str, name: str) -> JointSection | None:
        joint = self.document.joints.get(name)
        if isinstance(joint, JointSection):
            return joint
        joints = [key for key, value in self.document.joints.items() if isinstance(value, JointSection)]
        what = f"'{name}' is a driver, not a joint" if joint is not None else f"unknown joint {shown(name)}"
        self._error(path, what, suggestion(name, joints, "known joints"))
        return None

    # forces

    def _load(self, path: str, load: LoadSection) -> None:
        self._end(f"{path}.on", load.on, ground=False)
        wanted = units.FORCE if load.type == "force" else units.TORQUE
        for place, component in enumerate(load.value):
            at = f"{path}.value.{place}"
            self._fits(at, component, wanted, load.type)
            self._finite(at, component)

    def _spring(self, path: str, spring: SpringDamperSection) -> None:
        first, second = spring.between
        for place, end in enumerate(spring.between):
            if isinstance(end, str):
                if end == GROUND:
                    self._error(f"{path}.between.{place}", "ground has no point of its own", "write [x, y, z]")
                else:
                    self._end(f"{path}.between.{place}", end)
        if not isinstance(first, str) and not isinstance(second, str):
            self._error(f"{path}.between", "both ends are fixed points", "name a body's attachment at one end")
        elif first == second:
            self._error(f"{path}.between", f"both ends are {shown(first)}", "join two different points")
        self._acts(path, spring)

    def _torsion_spring(self, path: str, spring: TorsionSpringSection) -> None:
        joint = self._joint_named(f"{path}.joint", spring.joint)
        if joint is not None:
            kind: str = joint.type  # type: ignore[attr-defined]
            if not COORDINATES[kind].angle:
                self._error(
                    f"{path}.joint",
                    f"'{spring.joint}' is {kind} and has no angle",
                    "a torsion-spring acts on a revolute or cylindrical joint",
                )
        self._acts(path, spring)

    def _acts(self, path: str, spring: SpringDamperSection | TorsionSpringSection) -> None:
        if spring.stiffness == 0.0 and spring.damping == 0.0:
            self._error(path, "neither stiffness nor damping is given", "give one of them, or remove the spring")

    # functions of time

    def _fits(self, path: str, function: TimeFunction, wanted: Dimension, kind: str) -> None:
        """A number with a unit is checked once the kind of joint or load is known."""
        quantity = parse_quantity(function.text)
        if quantity and quantity.dimension is not None and not wanted.accepts(quantity.dimension):
            self._error(
                path,
                f"expected {wanted.article} ({kind}), got {quantity.dimension.article}: {function.text.strip()[:80]}",
            )

    def _finite(self, path: str, function: TimeFunction) -> None:
        duration = self.document.simulation.duration if self.document.simulation else 0.0
        times = [duration * k / (SAMPLES - 1) for k in range(SAMPLES)]
        for time, value in zip(times, value_at(function, times), strict=True):
            if not math.isfinite(value):
                self._error(
                    path,
                    f"'{function.text}' has no finite value at t = {time:.6g} s",
                    "keep the expression inside the domain of its functions over the whole run",
                )
                return

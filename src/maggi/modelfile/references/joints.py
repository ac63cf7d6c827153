"""What joints, drivers and couplers hold."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ...model import units
from ...model.errors import ModelError
from ...model.expression import value_at
from ...model.joint_kinds import Quantity, named_coordinates
from ...model.joints import GROUND, JointCoordinate
from ...model.linear import linear_parts
from ...model.operations import evaluate
from ..schema.ends import BetweenSection
from ..schema.joints import (
    AnyJoint,
    ContactSection,
    CouplerSection,
    DistanceSection,
    DriverSection,
    PfaffianSection,
    RelationCouplerSection,
    RollingSection,
)
from .findings import Findings

START = 1e-12
"""Largest value at t = 0 of an angle (rad), a displacement (m) or a relation between them that counts as zero."""


@dataclass
class JointChecks:
    """Checks of the section `joints`, one after the other: who drives what is remembered."""

    found: Findings
    driven: dict[tuple[str, str], str] = field(default_factory=dict)

    def check(self, name: str, joint: AnyJoint) -> None:
        """Ends, coordinates and functions of one of them."""
        path = f"joints.{name}"
        match joint:
            case DriverSection():
                self._driver(name, joint)
            case CouplerSection():
                self._coupler(path, joint)
            case DistanceSection():
                self.found.points(path, joint.between)
                if joint.length is not None:
                    self.found.finite(f"{path}.length", joint.length, positive=True)
            case PfaffianSection():
                self._pfaffian(path, joint)
            case BetweenSection():
                self._between(path, joint)

    def _between(self, path: str, joint: BetweenSection) -> None:
        first, second = joint.between
        right = [self.found.end(f"{path}.between.{place}", text) for place, text in enumerate(joint.between)]
        if first.partition(".")[0] == second.partition(".")[0]:
            self.found.error(
                f"{path}.between", f"both ends are on '{first.partition('.')[0]}'", "join two different bodies"
            )
            return
        if isinstance(joint, RollingSection):
            if second == GROUND:
                self.found.error(
                    f"{path}.between.1", "ground cannot roll or slide", "write between: [ground, body that moves]"
                )
        elif isinstance(joint, ContactSection):
            if "." not in second and joint.at is None and all(right):
                self.found.error(
                    f"{path}.at", "missing key 'at'", "give the follower's point, or name an attachment of the second"
                )
        elif "." not in first + second and joint.at is None and all(right):
            self.found.error(
                f"{path}.at", "missing key 'at'", "give the joint's point, or name an attachment in between"
            )
        if "." in first and "." in second and joint.at is not None:
            self.found.error(
                f"{path}.at",
                "two attachments are named and say where the joint is",
                "remove at, or name one attachment",
            )

    def _driver(self, name: str, driver: DriverSection) -> None:
        path, found = f"joints.{name}", self.found
        quantity, function = driver.quantity, driver.function
        found.finite(f"{path}.{quantity}", function)
        if quantity != "speed":
            start = value_at(function, [0.0])[0]
            if abs(start) > START:
                unit = "rad" if quantity == "angle" else "m"
                found.error(
                    f"{path}.{quantity}",
                    f"'{function.text}' is {start:.6g} {unit} at t = 0, but joints begin at zero",
                    f'subtract it: {quantity}: "{function.text} - ({start:.12g})"',
                )
        joint = found.joint(f"{path}.joint", driver.joint)
        if joint is None:
            return
        known = named_coordinates(joint.kind)
        if quantity == "speed" and len(known) == 1:
            coordinate: str = known[0]
            wanted = units.ANGULAR_VELOCITY if coordinate == "angle" else units.VELOCITY
            found.fits(f"{path}.speed", function, wanted, joint.kind)
        elif quantity == "speed" and known:
            found.error(
                f"{path}.speed",
                f"'{driver.joint}' is {joint.kind}: speed of its angle or of its displacement?",
                "give the angle or the displacement as a function of t",
            )
            return
        elif quantity in known:
            coordinate = quantity
        else:
            can = f"drive its {' or '.join(known)}" if known else "drive a revolute, prismatic or cylindrical joint"
            found.error(f"{path}.{quantity}", f"'{driver.joint}' is {joint.kind} and has no {quantity} to drive", can)
            return
        other = self.driven.setdefault((driver.joint, coordinate), name)
        if other != name:
            found.error(
                f"{path}.joint",
                f"the {coordinate} of '{driver.joint}' is driven twice, by '{other}' and '{name}'",
                "remove one of the drivers",
            )

    def _coupler(self, path: str, coupler: CouplerSection) -> None:
        met: dict[tuple[str, Quantity], str] = {}
        for keys, coordinate in coupler.coordinates.items():
            at = ".".join([path, *map(str, keys)])
            quantity = self._coordinate(at, coordinate)
            if quantity is None:
                continue
            if (coordinate.joint, quantity) in met:
                self.found.error(
                    at, f"the {quantity} of '{coordinate.joint}' stands here twice", "couple different coordinates"
                )
            met[coordinate.joint, quantity] = at
        if isinstance(coupler, RelationCouplerSection):
            self._relation(f"{path}.relation", coupler)

    def _coordinate(self, path: str, coordinate: JointCoordinate) -> Quantity | None:
        """Which coordinate of a joint is meant; a mistake where there is none, or more than one."""
        joint = self.found.joint(path, coordinate.joint)
        if joint is None:
            return None
        known, name = named_coordinates(joint.kind), coordinate.joint
        if coordinate.quantity in known:
            return coordinate.quantity
        if coordinate.quantity is None and len(known) == 1:
            return known[0]
        listed = " or ".join(f"{name}.{quantity}" for quantity in known)
        if coordinate.quantity is None and known:
            self.found.error(path, f"'{name}' is {joint.kind}: its angle or its displacement?", f"write {listed}")
        else:
            what = coordinate.quantity or "coordinate"
            remedy = f"write {listed}" if listed else "couple revolute, prismatic, cylindrical or screw joints"
            self.found.error(path, f"'{name}' is {joint.kind} and has no {what} to couple", remedy)
        return None

    def _relation(self, path: str, coupler: RelationCouplerSection) -> None:
        relation, names = coupler.relation, coupler.joints
        try:
            parts, constant = linear_parts(relation, names)
        except ModelError:
            pass  # of a relation that is not linear no part depends on time alone
        else:
            for part in (*parts.values(), *([constant] if constant else [])):
                self.found.finite_formula(path, part)
        if coupler.rates:
            return
        at_zero = [np.zeros(1) for _ in relation.variables]
        value = float(evaluate(relation.codes, relation.values, at_zero)[0])
        if not math.isfinite(value):
            self.found.error(
                path,
                f"'{relation.text}' has no finite value with all coordinates zero at t = 0, where joints begin",
                "write it without a division by what is zero there",
            )
        elif abs(value) > START:
            self.found.error(
                path,
                f"'{relation.text}' is {value:.6g} with all coordinates zero at t = 0, where joints begin",
                f'subtract it: relation: "{relation.text} - ({value:.12g})"',
            )

    def _pfaffian(self, path: str, rows: PfaffianSection) -> None:
        for name, end in rows.between.items():
            self.found.end(f"{path}.between.{name}", end)
        for place, row in enumerate(rows.rows):
            if all(rows.between[end] == GROUND for end, _ in row.coefficients):
                self.found.error(
                    f"{path}.rows.{place}", "the row holds only velocities of ground", "name a body that moves"
                )
            for formula in (*row.coefficients.values(), *([row.constant] if row.constant else [])):
                self.found.finite_formula(f"{path}.rows.{place}", formula)

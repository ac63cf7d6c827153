"""What cross-checks have in common: the document, the mistakes found so far, ends and functions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ...model.errors import ModelError
from ...model.expression import value_at
from ...model.functions import Formula, TimeFunction
from ...model.geometry import Vector
from ...model.joints import GROUND
from ...model.operations import Operation, evaluate
from ...model.units import Dimension, parse_quantity
from ..schema.document import Document
from ..schema.joints import JointSection
from ..schema.mistakes import MAX_MISTAKES, shown, suggestion

SAMPLES = 201
"""Times at which functions of time are tried before a run; between them the run itself looks."""


@dataclass
class Findings:
    """A document and its mistakes, to which the checks add."""

    document: Document
    errors: list[ModelError] = field(default_factory=list)

    @property
    def enough(self) -> bool:
        """Whether a user has enough to do."""
        return len(self.errors) >= MAX_MISTAKES

    def error(self, path: str, message: str, remedy: str = "") -> None:
        """Add a mistake."""
        self.errors.append(ModelError(message, path=path, remedy=remedy))

    def end(self, path: str, text: str, *, ground: bool = True) -> bool:
        """Check a text that names a body or an attachment; whether it is right."""
        name, dot, attachment = text.partition(".")
        if name == GROUND:
            if dot:
                self.error(path, "ground has no attachments", "write ground and give 'at'")
            elif not ground:
                self.error(path, "ground cannot stand here")
            return not dot and ground
        body = self.document.bodies.get(name)
        if body is None:
            known = [*self.document.bodies, GROUND] if ground else list(self.document.bodies)
            self.error(path, f"unknown body {shown(name)}", suggestion(name, known, "known bodies"))
            return False
        if dot and attachment not in body.attachments:
            self.error(
                path,
                f"body '{name}' has no attachment {shown(attachment)}",
                suggestion(attachment, body.attachments, f"attachments of {name}"),
            )
            return False
        if not dot and body.kind != "rigid":
            listed = ", ".join(f"{name}.{other}" for other in body.attachments) or "none so far"
            kind = "an elastic" if body.kind == "elastic" else "a Ritz"
            self.error(path, f"'{name}' is {kind} body and is held at attachments only", f"name one: {listed}")
            return False
        return True

    def points(self, path: str, between: Sequence[str | Vector]) -> None:
        """Check two points, of which bodies carry at least one."""
        first, second = between
        for place, end in enumerate(between):
            if end == GROUND:
                self.error(f"{path}.between.{place}", "ground has no point of its own", "write [x, y, z]")
            elif isinstance(end, str):
                self.end(f"{path}.between.{place}", end)
        if not isinstance(first, str) and not isinstance(second, str):
            self.error(f"{path}.between", "both ends are fixed points", "name a body's attachment at one end")
        elif first == second:
            self.error(f"{path}.between", f"both ends are {shown(first)}", "join two different points")

    def joint(self, path: str, name: str) -> JointSection | None:
        """The joint of a name, one that has coordinates; a mistake where there is none."""
        joint = self.document.joints.get(name)
        if isinstance(joint, JointSection):
            return joint
        joints = [key for key, value in self.document.joints.items() if isinstance(value, JointSection)]
        what = f"unknown joint {shown(name)}" if joint is None else f"'{name}' is a {joint.type}, not a joint"
        self.error(path, what, suggestion(name, joints, "known joints"))
        return None

    def fits(self, path: str, function: TimeFunction, wanted: Dimension, kind: str) -> None:
        """A number with a unit is checked once the kind of joint or load is known."""
        quantity = parse_quantity(function.text)
        if quantity and quantity.dimension is not None and not wanted.accepts(quantity.dimension):
            self.error(
                path,
                f"expected {wanted.article} ({kind}), got {quantity.dimension.article}: {function.text.strip()[:80]}",
            )

    def times(self) -> list[float]:
        """Times of the run (s) at which functions are tried; only 0 without a run."""
        duration = self.document.simulation.duration if self.document.simulation else 0.0
        return [duration * k / (SAMPLES - 1) for k in range(SAMPLES)]

    def finite(self, path: str, function: TimeFunction, *, positive: bool = False) -> None:
        """A function of time must have values over the whole run, `positive` ones where it is a size."""
        times = self.times()
        for time, value in zip(times, value_at(function, times), strict=True):
            if not math.isfinite(value):
                self.error(
                    path,
                    f"'{function.text}' has no finite value at t = {time:.6g} s",
                    "keep the expression inside the domain of its functions over the whole run",
                )
                return
            if positive and value <= 0.0:
                self.error(path, f"'{function.text}' is {value:.6g} at t = {time:.6g} s", "it must stay above 0")
                return

    def finite_formula(self, path: str, formula: Formula) -> None:
        """A formula in which of its variables only ``t`` occurs must have values over the whole run."""
        steps = zip(formula.codes, formula.values, strict=True)
        if any(code == Operation.VARIABLE and formula.variables[int(value)] != "t" for code, value in steps):
            return
        times = np.array(self.times())
        wrong = ~np.isfinite(evaluate(formula.codes, formula.values, [times]))
        if wrong.any():
            self.error(
                path,
                f"{formula.text} has no finite value at t = {times[int(np.argmax(wrong))]:.6g} s",
                "keep the expression inside the domain of its functions over the whole run",
            )

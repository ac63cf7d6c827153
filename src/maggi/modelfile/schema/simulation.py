"""What to compute and what to keep."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    StrictBool,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from ...model import units
from ...model.simulation import QUANTITIES, Outputs, Simulation
from .fields import Number, PositiveTime, Section, count_up_to
from .mistakes import mistake, shown, suggestion

MAX_STEPS = 1_000_000_000


ACCURACY = 1e-6
"""Local error of a step, relative to the mechanism's size, where `step: auto` does not say."""
LONGEST = 100
"""Over how many of them the duration goes where `step: auto` does not say how long steps may be."""

AUTO = 0.0
"""What `step: auto` becomes; no step that is given can be zero."""

Step = Annotated[float, Field(gt=0), Number(units.TIME)]


def _auto(value: Any, given: ValidatorFunctionWrapHandler) -> Any:
    return AUTO if value == "auto" else given(value)


class SimulationSection(Section):
    """A run in time."""

    duration: PositiveTime = Field(description="length of the run (s)")
    step: Annotated[Step, WrapValidator(_auto)] = Field(description="step (s), or auto: as long as `accuracy` allows")
    accuracy: Annotated[float, Field(gt=0, lt=1), Number(units.NUMBER)] = Field(
        ACCURACY,
        description="with step: auto, the error that a step may add to any position, relative to the mechanism's size "
        "(angles: rad)",
    )
    longest_step: Step | None = Field(
        None,
        description="with step: auto, the longest step (s), of which all are halves, quarters and so on, and at multiples of "
        f"which rows are written; the duration over {LONGEST} if not given",
    )
    method: Literal["generalized-alpha", "dop853", "radau"] = Field(
        "generalized-alpha",
        description="generalized-alpha in fixed steps, or an adaptive integrator of the true freedoms with rows at every "
        "step: dop853, explicit of order 8, or radau, implicit of order 5",
    )
    rho_inf: Annotated[float, Field(ge=0, le=1), Number(units.NUMBER)] = Field(
        0.9, description="spectral radius at infinite frequency: 1 keeps high modes, 0 removes them in one step"
    )
    tolerance: Annotated[float, Field(gt=0, lt=1), Number(units.NUMBER)] = Field(
        1e-8,
        description="relative error: left by the iteration of a step, or made by an adaptive integrator's own steps",
    )
    start: Literal["quasi-static", "undeformed"] = Field(
        "quasi-static",
        description="elastic bodies start in balance with the loads of the rigid motion, or undeformed",
    )
    assemble: StrictBool = Field(
        False, description="bodies move until joints close that do not meet in the given poses"
    )

    @model_validator(mode="after")
    def _countable(self) -> SimulationSection:
        for key in ("accuracy", "longest_step"):
            if self.step != AUTO and key in self.model_fields_set:
                raise mistake(f"steps of {self.step:g} s have no {key}", "leave it out, or use step: auto", (key,))
        if self.step == AUTO and self.method != "generalized-alpha":
            raise mistake(
                f"{self.method} chooses its own steps by `tolerance`",
                "give the time between two rows as step",
                ("step",),
            )
        step, key = self._nominal()
        steps = self.duration / step
        if steps < 0.5:
            raise mistake(
                f"the step {step:g} s is longer than the duration {self.duration:g} s",
                "shorten the step or lengthen the duration",
                (key,),
            )
        if steps > MAX_STEPS:
            raise mistake(f"{steps:.3g} steps are more than {MAX_STEPS:g}", "use a longer step", (key,))
        if self.method != "generalized-alpha" and "rho_inf" in self.model_fields_set:
            raise mistake(f"{self.method} has no rho_inf", "leave it out, or use generalized-alpha", ("rho_inf",))
        return self

    def build(self) -> Simulation:
        """The frozen description."""
        step, _ = self._nominal()
        return Simulation(
            self.duration,
            step,
            self.rho_inf,
            self.tolerance,
            self.start,
            self.method,
            self.assemble,
            self.accuracy if self.step == AUTO else None,
        )

    def _nominal(self) -> tuple[float, str]:
        """The nominal step (s) and the key that gives it."""
        if self.step != AUTO:
            return self.step, "step"
        return (self.duration / LONGEST if self.longest_step is None else self.longest_step), "longest_step"


def _quantities(value: Any) -> Any:
    if value == "all":
        return list(QUANTITIES)
    if not isinstance(value, list):
        raise mistake(
            f"expected a list of quantities or all, found {shown(value)}", f"they are {', '.join(QUANTITIES)}"
        )
    for place, name in enumerate(value):
        if not isinstance(name, str) or name not in QUANTITIES:
            what = suggestion(str(name), QUANTITIES, "known quantities")
            raise mistake(f"unknown quantity {shown(name)}", what, (place,))
    return value


def _unique(value: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(value))


class OutputsSection(Section):
    """What the result file keeps."""

    every: count_up_to(MAX_STEPS) = Field(1, description="a row at every this many steps")  # type: ignore[valid-type]
    quantities: Annotated[
        tuple[Literal["bodies", "attachments", "displacement", "joints", "energy", "residuals"], ...],
        AfterValidator(_unique),
        BeforeValidator(_quantities, json_schema_input_type=list[str] | Literal["all"]),
    ] = Field(QUANTITIES, description=f"all, or a list of {', '.join(QUANTITIES)}")  # type: ignore[arg-type]

    def build(self) -> Outputs:
        """The frozen description."""
        return Outputs(self.every, self.quantities)

"""Rows A(q, t) v + b(q, t) = 0 from texts."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from .errors import ModelError
from .expression import named_formula
from .joints import POSE, VELOCITIES, PfaffianRow
from .linear import linear_parts
from .suggest import nearest

CONSTANT = "constant"


def pfaffian_row(
    given: str | Mapping[str, str | float], ends: Collection[str], parameters: Mapping[str, float] | None = None
) -> PfaffianRow:
    """A row on the velocities of named ends.

    given : a text linear in the velocities, such as ``"blade.v.y*blade.r11 - blade.v.x*blade.r21 + 0.1*t"`` (= 0), or
        the coefficients by velocity, ``{"blade.v.y": "blade.r11", "constant": "0.1*t"}``.
    ends : their names; components are ``name.v.x`` … ``name.w.z``, poses ``name.x`` … ``name.r33``, all global.

    Raises ModelError for a text that is no expression in those names, ``t`` and the parameters, or not linear; its
    `path` is the wrong key of a mapping.
    """
    parameters = parameters or {}
    poses = ("t", *(f"{name}.{part}" for name in ends for part in POSE))
    velocities = {f"{name}.{component}": (name, component) for name in ends for component in VELOCITIES}
    if isinstance(given, str):
        whole = named_formula(given, (*poses, *velocities), parameters)
        parts, constant = linear_parts(whole, velocities)
        coefficients = {velocities[name]: formula for name, formula in parts.items()}
    else:
        constant, coefficients = None, {}
        for key, value in given.items():
            check_key(key, ends)
            try:
                formula = named_formula(value, poses, parameters)
            except ModelError as error:
                raise ModelError(error.message, path=key, remedy=error.remedy) from None
            if key == CONSTANT:
                constant = formula
            else:
                coefficients[velocities[key]] = formula
    if not coefficients:
        raise ModelError(
            "the row holds no velocity", remedy=f"write one, such as {next(iter(velocities), 'first.v.x')}"
        )
    return PfaffianRow(coefficients, constant)


def check_key(key: str, ends: Collection[str]) -> None:
    """Raise ModelError for a key of a row that names no velocity component of an end and is not ``constant``."""
    name, _, component = key.partition(".")
    if key == CONSTANT or (name in ends and component in VELOCITIES):
        return
    if name in ends:
        raise ModelError(
            f"'{key[:60]}' names no velocity component", path=key, remedy=f"components are {', '.join(VELOCITIES)}"
        )
    near = nearest(name, [*ends, CONSTANT])
    remedy = f"did you mean '{near}'?" if near else f"ends are {', '.join(ends)}"
    raise ModelError(f"no end is called '{name[:40]}'", path=key, remedy=remedy)

"""Gears, racks, belts and linear relations as couplers of joint coordinates."""

from __future__ import annotations

from collections.abc import Mapping

from .errors import ModelError
from .expression import check_variable_name, named_formula
from .functions import Formula
from .joints import Coupler, JointCoordinate


def gear(first: JointCoordinate, second: JointCoordinate, ratio: float) -> Coupler:
    """second = ratio · first (rad or m each)."""
    return _proportional("gear", first, second, ratio)


def rack(pinion: str, rack: str, radius: float) -> Coupler:
    """The displacement of joint `rack` is `radius` (m) times the angle of joint `pinion`."""
    return _proportional("rack", JointCoordinate(pinion, "angle"), JointCoordinate(rack, "displacement"), radius)


def belt(first: str, second: str, radii: tuple[float, float], crossed: bool = False) -> Coupler:
    """Angles of two joints whose pulleys (m) a belt holds together: radii[1] second = ± radii[0] first, − if crossed."""
    ratio = radii[0] / radii[1]
    a, b = (JointCoordinate(joint, "angle") for joint in (first, second))
    return _proportional("belt", a, b, -ratio if crossed else ratio)


def linear_coupler(terms: Mapping[JointCoordinate, float], rates: bool = False) -> Coupler:
    """Σ coefficient · coordinate = 0, or with `rates` of the speeds; named as their joints where such names will do."""
    names = [_plain(coordinate) for coordinate in terms]
    if None in names or len(set(names)) < len(names):
        names = [f"q{number}" for number in range(1, len(terms) + 1)]
    coordinates = {str(name): coordinate for name, coordinate in zip(names, terms, strict=True)}
    text = " + ".join(f"({factor!r})*{name}" for name, factor in zip(coordinates, terms.values(), strict=True))
    return Coupler("coupler", coordinates, relation(text, coordinates), rates)


def relation(text: str, names: Mapping[str, object], parameters: Mapping[str, float] | None = None) -> Formula:
    """The formula of a coupler: in ``t`` and the names of its coordinates. Raises ModelError as `formula` does."""
    return named_formula(text, ("t", *names), parameters or {})


def _proportional(kind: str, first: JointCoordinate, second: JointCoordinate, ratio: float) -> Coupler:
    coordinates = {"a": first, "b": second}
    return Coupler(kind, coordinates, relation(f"b - ({ratio!r})*a", coordinates))


def _plain(coordinate: JointCoordinate) -> str | None:
    name = coordinate.joint if coordinate.quantity is None else f"{coordinate.joint}_{coordinate.quantity}"
    try:
        check_variable_name(name)
    except ModelError:
        return None
    return name

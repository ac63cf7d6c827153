"""Physical quantities as text: ``"70 GPa"``, ``"1500 rpm"``, ``"12 kg m^2"``, converted to SI and known by dimension.

A unit is a product of unit names with integer exponents: ``N*m``, ``N m``, ``kg/m^3``, ``N/(m/s)``, ``m/s**2``,
``mm²``. A ``/`` divides by the one factor after it (``kg/m/s`` is kg/(m s)). Names are case-sensitive, with SI
prefixes on m, g, s, N, Pa, J, W, Hz, Nm. Angles are counted as a dimension of their own, so that revolutions per
minute and hertz are not mixed up.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import NamedTuple

from .errors import ModelError
from .suggest import nearest

MAX_EXPONENT = 9


class Dimension(NamedTuple):
    """Exponents of length (m), mass (kg), time (s) and angle (rad)."""

    length: int = 0
    mass: int = 0
    time: int = 0
    angle: int = 0

    def times(self, other: Dimension, exponent: int = 1) -> Dimension:
        """The dimension of a product ``self · other**exponent``."""
        return Dimension(*(a + exponent * b for a, b in zip(self, other, strict=True)))

    def accepts(self, given: Dimension) -> bool:
        """Whether a given quantity fits; "per radian" may be left out (N m for N m/rad)."""
        return given == self or (self.angle < 0 and given.angle == 0 and given[:3] == self[:3])

    def __str__(self) -> str:
        name = _NAMES.get(self)
        if name is not None:
            return name
        parts = [unit if n == 1 else f"{unit}^{n}" for unit, n in zip(("m", "kg", "s", "rad"), self, strict=True) if n]
        return "quantity in " + " ".join(parts)

    @property
    def article(self) -> str:
        """The name with its article: ``a pressure``, ``an angle``."""
        name = str(self)
        return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


NUMBER = Dimension()
LENGTH = Dimension(length=1)
AREA = Dimension(length=2)
SECOND_MOMENT_OF_AREA = Dimension(length=4)
MASS = Dimension(mass=1)
TIME = Dimension(time=1)
ANGLE = Dimension(angle=1)
PER_TIME = Dimension(time=-1)
VELOCITY = Dimension(length=1, time=-1)
ACCELERATION = Dimension(length=1, time=-2)
ANGULAR_VELOCITY = Dimension(time=-1, angle=1)
FORCE = Dimension(length=1, mass=1, time=-2)
TORQUE = Dimension(length=2, mass=1, time=-2)
PRESSURE = Dimension(length=-1, mass=1, time=-2)
DENSITY = Dimension(length=-3, mass=1)
INERTIA = Dimension(length=2, mass=1)
STIFFNESS = Dimension(mass=1, time=-2)
DAMPING = Dimension(mass=1, time=-1)
TORSION_STIFFNESS = Dimension(length=2, mass=1, time=-2, angle=-1)
TORSION_DAMPING = Dimension(length=2, mass=1, time=-1, angle=-1)

_NAMES = {
    NUMBER: "number without unit",
    LENGTH: "length",
    AREA: "area",
    Dimension(length=3): "volume",
    SECOND_MOMENT_OF_AREA: "second moment of area",
    MASS: "mass",
    TIME: "time",
    ANGLE: "angle",
    PER_TIME: "frequency",
    VELOCITY: "velocity",
    ACCELERATION: "acceleration",
    ANGULAR_VELOCITY: "angular velocity",
    Dimension(time=-2, angle=1): "angular acceleration",
    FORCE: "force",
    TORQUE: "torque",
    PRESSURE: "pressure",
    DENSITY: "density",
    INERTIA: "moment of inertia",
    STIFFNESS: "stiffness (force per length)",
    DAMPING: "damping (force per velocity)",
    TORSION_STIFFNESS: "torsional stiffness (torque per angle)",
    TORSION_DAMPING: "torsional damping (torque per angular velocity)",
    Dimension(length=2, mass=1, time=-3): "power",
}


class Unit(NamedTuple):
    """A unit: its size in SI units and its dimension."""

    size: float
    dimension: Dimension


@dataclass(frozen=True)
class Quantity:
    """A value in SI units and its dimension; None: a number without unit, which is taken as SI of any dimension."""

    value: float
    dimension: Dimension | None


_INCH = 0.0254
_POUND = 0.45359237
_STANDARD_GRAVITY = 9.80665
_POUND_FORCE = _POUND * _STANDARD_GRAVITY

_PREFIXABLE = {
    "m": Unit(1.0, LENGTH),
    "g": Unit(1e-3, MASS),
    "s": Unit(1.0, TIME),
    "N": Unit(1.0, FORCE),
    "Pa": Unit(1.0, PRESSURE),
    "J": Unit(1.0, TORQUE),
    "W": Unit(1.0, Dimension(length=2, mass=1, time=-3)),
    "Hz": Unit(1.0, PER_TIME),
    "Nm": Unit(1.0, TORQUE),
    "rad": Unit(1.0, ANGLE),
}
_PREFIXES = {
    "T": 1e12,
    "G": 1e9,
    "M": 1e6,
    "k": 1e3,
    "h": 1e2,
    "d": 1e-1,
    "c": 1e-2,
    "m": 1e-3,
    "u": 1e-6,
    "µ": 1e-6,  # micro sign
    "μ": 1e-6,  # Greek mu
    "n": 1e-9,
    "p": 1e-12,
}
_UNITS = {
    **_PREFIXABLE,
    "Nmm": Unit(1e-3, TORQUE),
    "t": Unit(1e3, MASS),
    "lb": Unit(_POUND, MASS),
    "in": Unit(_INCH, LENGTH),
    "ft": Unit(12.0 * _INCH, LENGTH),
    "min": Unit(60.0, TIME),
    "h": Unit(3600.0, TIME),
    "kgf": Unit(_STANDARD_GRAVITY, FORCE),
    "lbf": Unit(_POUND_FORCE, FORCE),
    "psi": Unit(_POUND_FORCE / _INCH**2, PRESSURE),
    "ksi": Unit(1e3 * _POUND_FORCE / _INCH**2, PRESSURE),
    "bar": Unit(1e5, PRESSURE),
    "deg": Unit(math.pi / 180.0, ANGLE),
    "°": Unit(math.pi / 180.0, ANGLE),
    "rev": Unit(2.0 * math.pi, ANGLE),
    "rpm": Unit(math.pi / 30.0, ANGULAR_VELOCITY),
    "%": Unit(1e-2, NUMBER),
}
# Possessive (++, ?+): without it 1e400*t would be read as the number 1 and a unit e400*t.
_NUMBER = r"[+-]?(?:\d++\.?+\d*+|\.\d++)(?:[eE][+-]?\d++)?+"
_LETTER = "[A-Za-zµμ]"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*((?:{_LETTER}|[°%]|(?<=\s)1\s*/).*)?", re.DOTALL)
_TOKEN = re.compile(rf"\s*(?:({_LETTER}+|[°%])|(\*\*|\^)\s*([+-]?\d)(?!\d)|([²³])|(\*|·)|(/)|(\()|(\))|(1)(?=\s*/))\s*")


def parse_quantity(text: str) -> Quantity | None:
    """A text as number and unit (or number alone); None if it is not of this form but may be an expression.

    Raises ModelError if a number is followed by something that is not a unit.
    """
    match = _QUANTITY.fullmatch(text.rstrip())
    if match is None or len(text) > 200:
        return None
    number, unit_text = match.groups()
    unit = parse_unit(unit_text, text) if unit_text else None
    value = float(number) * (unit.size if unit else 1.0)
    if not math.isfinite(value):
        raise ModelError(f"'{text.strip()}' is too large a number")
    return Quantity(value, unit.dimension if unit else None)


def parse_unit(text: str, whole: str = "") -> Unit:
    """A unit such as ``kg/m^3``; `whole` is the text it stands in, for the message.

    Raises ModelError for an unknown name (with the nearest known one) or a malformed product.
    """
    whole = (whole or text).strip()
    size, dimension = 1.0, NUMBER
    groups = [1]  # sign of the exponent inside each open parenthesis
    sign, fresh = 1, True  # of the next factor; fresh: a factor must come
    last: tuple[Unit, int] | None = None
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise _malformed(whole, text)
        position = match.end()
        name, power, exponent, raised, times, over, opened, closed, one = match.groups()
        if name or one:
            unit = _lookup(name, whole) if name else Unit(1.0, NUMBER)
            size *= unit.size ** (sign * groups[-1])
            dimension = dimension.times(unit.dimension, sign * groups[-1])
            last, sign, fresh = (unit, sign * groups[-1]), 1, False
        elif power or raised:
            n = {"²": 2, "³": 3}[raised] if raised else int(exponent)
            if last is None:
                raise _malformed(whole, text)
            unit, outer = last
            size *= unit.size ** (outer * (n - 1))
            dimension = dimension.times(unit.dimension, outer * (n - 1))
            last = None
        elif times or over:
            if fresh:
                raise _malformed(whole, text)
            sign, fresh, last = (-1 if over else 1), True, None
        elif opened:
            groups.append(groups[-1] * sign)
            sign, fresh, last = 1, True, None
        elif closed:
            if fresh or len(groups) == 1:
                raise _malformed(whole, text)
            groups.pop()
            last = None
    if fresh or len(groups) > 1 or max(map(abs, dimension)) > MAX_EXPONENT or not 0.0 < size < math.inf:
        raise _malformed(whole, text)
    return Unit(size, dimension)


def _lookup(name: str, whole: str) -> Unit:
    if name in _UNITS:
        return _UNITS[name]
    prefix, base = name[0], name[1:]
    if prefix in _PREFIXES and base in _PREFIXABLE:
        unit = _PREFIXABLE[base]
        return Unit(unit.size * _PREFIXES[prefix], unit.dimension)
    near = nearest(name, [*_UNITS, *(p + b for p in _PREFIXES for b in _PREFIXABLE)])
    raise ModelError(
        f"unknown unit '{name[:40]}' in '{whole[:80]}'",
        remedy=f"did you mean '{near}'?" if near else f"known units are {', '.join(_UNITS)} and SI prefixes",
    )


def _malformed(whole: str, unit: str) -> ModelError:
    return ModelError(
        f"cannot read the unit '{unit.strip()[:40]}' of '{whole[:80]}'",
        remedy="write units like N*m, kg/m^3 or N/(m/s); in an expression put * between a number and a name",
    )

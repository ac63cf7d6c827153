"""Quantities as text: values by definition of the units, dimensions, and what is refused."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from maggi.model import units
from maggi.model.errors import ModelError
from maggi.model.units import Dimension, parse_quantity, parse_unit

# Values by the SI brochure; inch, pound and standard gravity by their exact definitions (0.0254 m, 0.45359237 kg, 9.80665 m/s²).
KNOWN = [
    ("70 GPa", 70e9, units.PRESSURE),
    ("210000 MPa", 210e9, units.PRESSURE),
    ("1 psi", 0.45359237 * 9.80665 / 0.0254**2, units.PRESSURE),
    ("2 bar", 2e5, units.PRESSURE),
    ("5 N/mm^2", 5e6, units.PRESSURE),
    ("70 mm", 0.07, units.LENGTH),
    ("1 in", 0.0254, units.LENGTH),
    ("1 ft", 0.3048, units.LENGTH),
    ("3km", 3e3, units.LENGTH),
    ("5 µm", 5e-6, units.LENGTH),  # micro sign
    ("5 μm", 5e-6, units.LENGTH),  # Greek mu
    ("250 g", 0.25, units.MASS),
    ("2 t", 2000.0, units.MASS),
    ("1 lb", 0.45359237, units.MASS),
    ("10 us", 1e-5, units.TIME),
    ("2 min", 120.0, units.TIME),
    ("1 h", 3600.0, units.TIME),
    ("30 deg", math.pi / 6, units.ANGLE),
    ("90°", math.pi / 2, units.ANGLE),
    ("1500 rpm", 50 * math.pi, units.ANGULAR_VELOCITY),
    ("25 rev/s", 50 * math.pi, units.ANGULAR_VELOCITY),
    ("180 deg/s", math.pi, units.ANGULAR_VELOCITY),
    ("3 rad/s", 3.0, units.ANGULAR_VELOCITY),
    ("50 Hz", 50.0, units.PER_TIME),
    ("5 1/s", 5.0, units.PER_TIME),
    ("9.81 m/s^2", 9.81, units.ACCELERATION),
    ("9.81 m/s²", 9.81, units.ACCELERATION),
    ("9.81 m s^-2", 9.81, units.ACCELERATION),
    ("9.81 m/s/s", 9.81, units.ACCELERATION),
    ("3 kN", 3e3, units.FORCE),
    ("1 lbf", 0.45359237 * 9.80665, units.FORCE),
    ("10 N*m", 10.0, units.TORQUE),
    ("10 N m", 10.0, units.TORQUE),
    ("10 N·m", 10.0, units.TORQUE),
    ("10 Nm", 10.0, units.TORQUE),
    ("10 Nmm", 0.01, units.TORQUE),
    ("2 kNm", 2e3, units.TORQUE),
    ("7.85 g/cm^3", 7850.0, units.DENSITY),
    ("7850 kg/m**3", 7850.0, units.DENSITY),
    ("2 kg m^2", 2.0, units.INERTIA),
    ("5 N/mm", 5e3, units.STIFFNESS),
    ("5 N s/m", 5.0, units.DAMPING),
    ("5 N/(m/s)", 5.0, units.DAMPING),
    ("5 N/(mm/s)", 5e3, units.DAMPING),
    ("5 N m/rad", 5.0, units.TORSION_STIFFNESS),
    ("500 mm^4", 5e-10, units.SECOND_MOMENT_OF_AREA),
    ("12 %", 0.12, units.NUMBER),
    ("-1.5e-3 m", -1.5e-3, units.LENGTH),
    (" +.5 m ", 0.5, units.LENGTH),
]


@pytest.mark.parametrize(("text", "value", "dimension"), KNOWN)
def test_known_quantities(text: str, value: float, dimension: Dimension) -> None:
    quantity = parse_quantity(text)
    assert quantity is not None
    assert quantity.dimension == dimension
    assert quantity.value == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("text", ["3", "-2.5", "1e-3", ".5", "5."])
def test_a_number_alone_has_no_dimension(text: str) -> None:
    quantity = parse_quantity(text)
    assert quantity is not None
    assert (quantity.value, quantity.dimension) == (float(text), None)


@pytest.mark.parametrize("text", ["speed*t", "2*t", "sin(t)", "3 + 4", "3-4", "1e400*t", "", "mm", "3/(2)", "2**3"])
def test_what_may_be_an_expression_is_left_alone(text: str) -> None:
    assert parse_quantity(text) is None


@pytest.mark.parametrize(
    ("text", "message", "remedy"),
    [
        ("70 GPA", "unknown unit 'GPA'", "did you mean 'GPa'?"),
        ("3 mhz", "unknown unit 'mhz'", "did you mean"),
        ("3 rmp", "unknown unit 'rmp'", "did you mean 'rpm'?"),
        ("3 furlongs", "unknown unit 'furlongs'", "known units"),
        ("3 N/", "cannot read the unit 'N/'", "write units like"),
        ("3 N)", "cannot read the unit 'N)'", "write units like"),
        ("3 m/(s", "cannot read the unit", "write units like"),
        ("3 m^^2", "cannot read the unit", "write units like"),
        ("3 m^2^2", "cannot read the unit", "write units like"),
        ("3 m//s", "cannot read the unit", "write units like"),
        ("3 m^10", "cannot read the unit", "write units like"),
        ("3 m^9 m^9", "cannot read the unit", "write units like"),
        ("5 s - 1", "cannot read the unit", "put * between"),
        ("1e999 m", "too large", ""),
    ],
)
def test_refused(text: str, message: str, remedy: str) -> None:
    with pytest.raises(ModelError) as caught:
        parse_quantity(text)
    assert message in caught.value.message
    assert remedy in caught.value.remedy


def test_dimensions_have_names_with_articles() -> None:
    assert units.PRESSURE.article == "a pressure"
    assert units.ANGLE.article == "an angle"
    assert Dimension(1, 2, 3).article == "a quantity in m kg^2 s^3"


def test_per_radian_may_be_left_out_but_not_added() -> None:
    assert units.TORSION_STIFFNESS.accepts(units.TORQUE)
    assert not units.TORQUE.accepts(units.TORSION_STIFFNESS)
    assert not units.ANGULAR_VELOCITY.accepts(units.PER_TIME)


SIMPLE = ["m", "mm", "kg", "s", "N", "kPa", "rad", "min", "lbf", "Hz", "J"]


@given(st.lists(st.tuples(st.sampled_from(SIMPLE), st.integers(-2, 2)), min_size=1, max_size=3))
def test_products_are_the_products_of_their_factors(factors: list[tuple[str, int]]) -> None:
    size, dimension = 1.0, units.NUMBER
    for name, power in factors:
        unit = parse_unit(name)
        size *= unit.size**power
        dimension = dimension.times(unit.dimension, power)
    if max(map(abs, dimension)) <= units.MAX_EXPONENT:
        product = parse_unit("*".join(f"{name}^{power}" for name, power in factors))
        assert product.dimension == dimension
        assert product.size == pytest.approx(size, rel=1e-14)

"""Gears, racks, belts, linear relations: the relation's value at coordinates that fulfil it, and beside them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from maggi.model import Coupler, JointCoordinate
from maggi.model.couplers import belt, gear, linear_coupler, rack
from maggi.model.operations import evaluate


def defect(coupler: Coupler, *coordinates: float) -> float:
    f = coupler.relation
    assert f.variables == ("t", *coupler.coordinates)
    return float(evaluate(f.codes, f.values, [np.array([x]) for x in (0.3, *coordinates)])[0])


def test_gear() -> None:
    coupler = gear(JointCoordinate("one"), JointCoordinate("two", "angle"), -1 / 3)
    assert (coupler.kind, coupler.rates) == ("gear", False)
    assert coupler.coordinates == {"a": JointCoordinate("one"), "b": JointCoordinate("two", "angle")}
    assert defect(coupler, 0.9, -0.3) == pytest.approx(0.0, abs=1e-16)
    assert defect(coupler, 0.9, 0.3) == pytest.approx(0.6)


def test_rack() -> None:
    coupler = rack("pinion", "bar", 0.02)
    assert coupler.kind == "rack"
    assert list(coupler.coordinates.values()) == [
        JointCoordinate("pinion", "angle"),
        JointCoordinate("bar", "displacement"),
    ]
    assert defect(coupler, 2 * math.pi, 0.04 * math.pi) == pytest.approx(0.0, abs=1e-16)


@pytest.mark.parametrize(("crossed", "sign"), [(False, 1.0), (True, -1.0)])
def test_belt(crossed: bool, sign: float) -> None:
    """The belt runs at one speed: r_a q_a = ± r_b q_b."""
    coupler = belt("small", "large", (0.05, 0.2), crossed)
    assert coupler.kind == "belt"
    assert defect(coupler, 4.0, sign * 1.0) == pytest.approx(0.0, abs=1e-15)


def test_linear_coupler_is_named_as_its_joints() -> None:
    coupler = linear_coupler({JointCoordinate("crank"): 2.0, JointCoordinate("rocker", "angle"): -0.5}, rates=True)
    assert list(coupler.coordinates) == ["crank", "rocker_angle"]
    assert coupler.rates
    assert defect(coupler, 1.0, 4.0) == 0.0
    assert defect(coupler, 1.0, 0.0) == 2.0


@pytest.mark.parametrize("names", [("a-b", "c"), ("t", "c"), ("1", "2"), ("in", "c")])
def test_names_that_no_expression_can_hold_are_replaced(names: tuple[str, str]) -> None:
    coupler = linear_coupler({JointCoordinate(name): 1.0 for name in names})
    assert list(coupler.coordinates) == ["q1", "q2"]
    assert [one.joint for one in coupler.coordinates.values()] == list(names)


def test_names_that_would_fall_together_are_replaced() -> None:
    coupler = linear_coupler({JointCoordinate("a_angle"): 1.0, JointCoordinate("a", "angle"): 1.0})
    assert list(coupler.coordinates) == ["q1", "q2"]

"""Thinned series and readable units."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maggi.view.series import readable, thin


def test_thin_keeps_every_peak():
    time = np.linspace(0.0, 1.0, 100_003)
    values = np.sin(40.0 * time)
    values[[5, 77_777]] = 9.0, -9.0
    short_time, short = thin(time, values, 1000)
    assert len(short) <= 1004
    assert {9.0, -9.0} <= set(short)
    assert (np.diff(short_time) > 0.0).all()
    assert short_time[0] == 0.0 and short_time[-1] == 1.0


@given(st.integers(1, 60), st.integers(4, 20))
def test_thin_gives_points_of_the_series(n, most):
    time = np.arange(float(n))
    values = np.cos(time)
    short_time, short = thin(time, values, most)
    assert (short == np.cos(short_time)).all()
    assert short.max() == values.max() and short.min() == values.min()
    assert short_time[-1] == time[-1]


@pytest.mark.parametrize(
    ("unit", "value", "factor", "shown"),
    [
        ("N", 752.0, 1.0, "N"),
        ("N", 1000.0, 1e-3, "kN"),
        ("N m", -12e6, 1e-6, "MN m"),
        ("m", 4e-4, 1e6, "µm"),
        ("m", 5000.0, 1.0, "m"),
        ("s", 0.06, 1e3, "ms"),
        ("J", 1e-20, 1e12, "pJ"),
        ("J", 0.0, 1.0, "J"),
        ("1", 1e-9, 1.0, "1"),
    ],
)
def test_readable(unit, value, factor, shown):
    found, text = readable(unit, np.array([0.0, value]), np.zeros(0))
    assert found == pytest.approx(factor)
    assert text == shown

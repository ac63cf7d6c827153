"""Numbers from untrusted text."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maggi.mesh import text
from maggi.mesh.text import as_integers, parse_floats, shorten


@given(
    st.lists(st.floats(allow_nan=False, allow_infinity=False)),
    st.sampled_from([b" ", b"\n", b"\t \r\n"]),
    st.integers(1, 40),
)
def test_floats_come_back_whatever_the_chunk(values, separator, chunk):
    written = separator.join(repr(value).encode() for value in values)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(text, "_CHUNK", chunk)
        read = parse_floats(written)
    np.testing.assert_array_equal(read, np.array(values))


@pytest.mark.parametrize("wrong", [b"x", b"nan", b"inf", b"1e999", b"1_0", b"0x10", b"1,2", b"--1", b"\xd9\xa1"])
def test_what_is_no_finite_number(wrong):
    assert parse_floats(b"1 2 " + wrong + b" 3") is None


def test_integers():
    np.testing.assert_array_equal(as_integers(np.array([0.0, -3.0, 2.0**52])), [0, -3, 2**52])
    assert as_integers(np.array([1.5])) is None
    assert as_integers(np.array([2.0**53])) is None


def test_shorten_is_printable_and_short():
    assert shorten("a\x00\x1b[31mb") == "a??[31mb"
    assert len(shorten("x" * 1000)) == 40

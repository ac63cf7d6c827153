"""Labels to indices, against a dictionary."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from maggi.mesh.labels import LabelTable, sample

LABELS = st.lists(st.integers(1, 2**62), unique=True, max_size=30)


@given(LABELS, LABELS)
def test_find_as_a_dictionary_would(known, other):
    table = LabelTable(np.array(known, dtype=np.int64))
    sought = np.array(known[::2] + other, dtype=np.int64)
    indices, found = table.find(sought)
    place = {label: i for i, label in enumerate(known)}
    assert found.tolist() == [label in place for label in sought.tolist()]
    assert indices.tolist() == [place.get(label, 0) for label in sought.tolist()]


@given(
    st.lists(st.integers(1, 60), unique=True, max_size=30), st.integers(1, 60), st.integers(0, 60), st.integers(1, 7)
)
def test_within_as_a_range_would(known, first, length, step):
    table = LabelTable(np.array(known, dtype=np.int64))
    wanted = set(range(first, first + length + 1, step))
    assert sorted(known[i] for i in table.within(first, first + length, step)) == sorted(wanted & set(known))


def test_sample_is_short():
    assert sample(np.arange(3)) == "0, 1, 2"
    assert sample(np.arange(9)) == "0, 1, 2, 3, 4, …"

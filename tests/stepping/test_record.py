"""Instants kept on the way, and what is read from their memory."""

import numpy as np
import pytest
from linkages import four_bar

from maggi.stepping import allocate
from maggi.stepping.allocate import new_instant, new_record
from maggi.stepping.tables import LAST, NUMBER
from maggi.system.build import build_system


@pytest.fixture
def instant():
    return new_instant(build_system(four_bar()), 1.0, 1.0)


def arrays(table):
    for value in table:
        if isinstance(value, np.ndarray):
            yield value
        else:
            yield from arrays(value)


def test_an_instants_arrays_share_one_memory_without_overlap(instant):
    parts = [part for part in arrays(instant) if part is not instant.flat]
    instant.flat[:] = 0.0
    for number, part in enumerate(parts, 1):
        part[...] = number
    for number, part in enumerate(parts, 1):
        assert (part == number).all()
    assert sum(part.size for part in parts) == instant.flat.size


def test_values_are_those_of_the_instants_kept(instant):
    record = new_record(instant, 5)
    rng = np.random.default_rng(3)
    expected = []
    for step in range(4):
        instant.now.origin[:] = rng.normal(size=instant.now.origin.shape)
        instant.rows.coordinate[:] = rng.normal(size=instant.rows.coordinate.shape)
        instant.active[:] = rng.integers(-5, 5, size=instant.active.shape)
        expected.append((instant.now.origin.copy(), instant.rows.coordinate.copy(), instant.active.copy()))
        record.keep(instant, 10 * step)
    assert (record.kept, record.room, record.last_step()) == (4, 1, 30)
    for k, part in enumerate((instant.now.origin, instant.rows.coordinate, instant.active)):
        found = record.values(instant, part)
        assert found.dtype == part.dtype
        np.testing.assert_array_equal(found, [one[k] for one in expected])
    record.clear()
    assert (record.kept, record.last_step()) == (0, -1)
    assert record.values(instant, instant.now.e).shape == (0, *instant.now.e.shape)


def test_a_record_takes_no_more_memory_than_it_may(instant, monkeypatch):
    assert len(new_record(instant, 7).steps) == 7
    monkeypatch.setattr(allocate, "RECORD_BYTES", 3 * instant.flat.nbytes)
    assert len(new_record(instant, 7).steps) == 3
    monkeypatch.setattr(allocate, "RECORD_BYTES", 1)
    assert len(new_record(instant, 7).steps) == 1


@pytest.mark.parametrize("every", [0, 1, 3])
@pytest.mark.parametrize("number", [0, 2, 5])
def test_room_is_looked_at_before_kernels_write(instant, number, every):
    """As many instants as there are multiples of `every`, and the last step, among the steps."""
    last, capacity = 10, 3
    for steps in range(1, last - number + 1):
        record = new_record(instant, capacity)
        record.places[NUMBER : LAST + 1] = number, every, last
        due = sum(n % every == 0 or n == last for n in range(number + 1, number + steps + 1)) if every else 0
        if due > capacity:
            with pytest.raises(ValueError, match=f"{due} instants are to be kept"):
                record.check_room(steps)
        else:
            record.check_room(steps)

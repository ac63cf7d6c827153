"""Tables of a file that grow, against what the library's own interface reads."""

import h5py
import numpy as np
import pytest

from maggi.results.growing import GrowingTable


def table(file, shape, dtype="float64", chunk=4):
    return file.create_dataset(
        "t", shape=(0, *shape), maxshape=(None, *shape), chunks=(chunk, *(max(1, n) for n in shape)), dtype=dtype
    )


@pytest.mark.parametrize(
    ("shape", "dtype"), [((), "float64"), ((3,), "float64"), ((2, 3, 3), "float64"), ((), "int64")]
)
def test_rows_stand_behind_each_other(tmp_path, shape, dtype):
    rng = np.random.default_rng(4)
    parts = [(100 * rng.standard_normal((count, *shape))).astype(dtype) for count in (1, 6, 3)]
    with h5py.File(tmp_path / "a.h5", "w") as file:
        growing, rows = GrowingTable(table(file, shape, dtype)), 0
        for part in parts:
            growing.append(rows, part)
            rows += len(part)
    with h5py.File(tmp_path / "a.h5") as file:
        np.testing.assert_array_equal(file["t"][...], np.concatenate(parts))


def test_values_with_gaps_and_of_other_types(tmp_path):
    wide = np.arange(24.0).reshape(4, 6)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        GrowingTable(table(file, (2,), "int64")).append(0, wide[:, 1:5:3])
        np.testing.assert_array_equal(file["t"][...], wide[:, 1:5:3])


def test_rows_may_be_written_again(tmp_path):
    """As after an interrupt between writing and counting them."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        growing = GrowingTable(table(file, (2,)))
        growing.append(0, np.ones((3, 2)))
        growing.append(1, np.full((4, 2), 7.0))
        np.testing.assert_array_equal(file["t"][:, 0], [1.0, 7.0, 7.0, 7.0, 7.0])


@pytest.mark.parametrize(("rows", "until", "chunks"), [(0, 1, 1), (1, 4, 0), (4, 5, 1), (3, 13, 3), (0, 0, 0)])
def test_growth_is_that_of_the_chunks(tmp_path, rows, until, chunks):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        growing = GrowingTable(table(file, (3,)))
        assert growing.growth(rows, until) == chunks * (4 * 3 * 8 + 512)

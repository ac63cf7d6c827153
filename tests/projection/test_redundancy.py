"""Forces of least norm where joints repeat each other, against dense algebra on the same rows."""

import numpy as np
import pytest
from linkages import four_bar, random_mechanism
from motions import rows_at

from maggi.liaisons.tables import ROW_ANGULAR
from maggi.projection.redundancy import least_norm
from maggi.stepping.allocate import geometric_metric
from maggi.system.build import build_system
from maggi.system.dense import dense_rows

SYSTEMS = {
    "planar four-bar, 3 redundant rows": lambda: build_system(four_bar()),
    "spatial four-bar, none": lambda: build_system(four_bar(("revolute", "spherical", "spherical", "revolute"))),
    "more rows than velocities": lambda: build_system(random_mechanism(3, 3, 3, ["revolute", "weld"])),
    "loops": lambda: build_system(random_mechanism(5, 6, 3, ["revolute", "cylindrical", "weld"])),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_least_norm_is_that_of_least_squares(name):
    """The same Aᵀλ, the norm of the dense least-squares solution, and unique exactly where no null vector reaches."""
    system = SYSTEMS[name]()
    A = dense_rows(system, system.start, 0.0).A
    weight = np.where(system.liaisons.row[:, ROW_ANGULAR] == 1, 1.0 / system.size, 1.0)
    given = np.random.default_rng(1).normal(size=system.rows)
    flat = rows_at(system, system.start, 0.0).A
    # twice the same instant, with other forces the second time
    states, active = np.array([flat, flat]), np.ones((2, system.rows), dtype=np.int64)
    forces, metric = np.array([given, -2.0 * given]), geometric_metric(system)
    both, sure = least_norm(system.liaisons, system.bodies, states, metric, active, forces, system.size)
    found, unique = both[0], sure[0]
    np.testing.assert_allclose(both[1], -2.0 * found, atol=1e-13 * np.abs(found).max())
    assert (sure[1] == unique).all()
    assert forces[0] is not found and (forces[0] == given).all()
    np.testing.assert_allclose(A.T @ found, A.T @ given, atol=1e-11)
    expected = np.linalg.lstsq((A / weight[:, None]).T, A.T @ given, rcond=1e-10)[0] / weight
    np.testing.assert_allclose(found, expected, atol=1e-10 * np.abs(expected).max())
    left = np.linalg.svd(A / weight[:, None])[0][:, np.linalg.matrix_rank(A) :]
    np.testing.assert_array_equal(unique, np.linalg.norm(left, axis=1) < 1e-6)

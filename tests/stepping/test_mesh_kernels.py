"""What connects a mesh's passes with the small system, against numpy."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.spatial.transform import Rotation

from maggi.bodies.mean_axes import MeanAxes, RigidColumns
from maggi.bodies.tables import MotionState
from maggi.stepping.mesh_kernels import add_fields, distance, frame_drive, inner_product, respond, write_attachments
from maggi.stepping.nodal_kernels import Columns, NodalStep

SIZE, PLACES, ATTACHMENTS = 18, 20, 2


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture
def B(rng):
    return sp.random(SIZE, 6 * ATTACHMENTS, 0.3, format="csc", random_state=1)


def step(rng, B, implied=(0.0, 0.0)):
    fields = np.zeros((2, 4, PLACES))
    fields[:, :, :SIZE] = rng.normal(size=(2, 4, SIZE))
    solution = np.zeros(PLACES)
    solution[:SIZE] = rng.normal(size=SIZE)
    return NodalStep(
        linear=np.zeros(1),
        prediction=np.zeros((3, 4)),
        gain=np.zeros(4),
        now=fields[0],
        following=fields[1],
        solution=solution,
        implied=np.array(implied),
        columns=Columns.of(B),
        responses=np.zeros((ATTACHMENTS, PLACES // 4, 12, 4)),
        damping=np.zeros(2),
        forces=np.zeros((4, 6 * ATTACHMENTS)),
        loaded=np.zeros(ATTACHMENTS, np.int64),
        sizes=np.zeros((1, 2)),
    )


def test_drive_of_a_frame(rng):
    """a_O = v̇ + ω × v − Rᵀg, ω and ε, of the second of three bodies."""
    rotation = Rotation.random(3, random_state=2).as_matrix()
    motion = MotionState(np.zeros((3, 3)), rotation, np.zeros(20), *rng.normal(size=(2, 20)))
    gravity, out = rng.normal(size=3), np.empty((3, 3))
    frame_drive(motion, gravity, 1, 8, out)
    (v, w), (vd, eps) = motion.v[8:14].reshape(2, 3), motion.vd[8:14].reshape(2, 3)
    np.testing.assert_allclose(out[0], vd + np.cross(w, v) - rotation[1].T @ gravity, atol=1e-14)
    np.testing.assert_array_equal(out[1:], [w, eps])


@pytest.mark.parametrize("implied", [(0.0, 0.0), (3.0, -0.5)], ids=["K multiplied", "K by its factor"])
@pytest.mark.parametrize("floating", [0, 1])
def test_the_solution_is_completed(rng, B, floating, implied):
    of = step(rng, B, implied)
    Phi, C = rng.normal(size=(2, SIZE, 6))
    columns = [RigidColumns.of(part, np.zeros(0), np.zeros((0, 3))) for part in (Phi, C)]
    axes = MeanAxes.of(*columns, C.T @ Phi)
    expected = of.solution[:SIZE] + implied[0] * of.following[0, :SIZE] + implied[1] * of.following[1, :SIZE]
    if floating:
        expected = expected - Phi @ np.linalg.solve(C.T @ Phi, C.T @ expected)
    out = np.empty(6 * ATTACHMENTS)
    respond(of, axes, floating, out)
    np.testing.assert_allclose(of.solution[:SIZE], expected, atol=1e-12)
    np.testing.assert_allclose(out, -(B.T @ expected), atol=1e-12)
    assert not of.solution[SIZE:].any()


def test_what_attachments_have_of_the_present(rng, B):
    of = step(rng, B)
    e, nu, nud, a, difference = rng.normal(size=(5, 6 * ATTACHMENTS))
    before, sum_before = a.copy(), difference.copy()
    write_attachments(of, e, nu, nud, a, difference)
    for found, field in zip((e, nu, nud, a), of.now, strict=True):
        np.testing.assert_allclose(found, B.T @ field[:SIZE], atol=1e-14)
    np.testing.assert_allclose(difference, sum_before + a - before, atol=1e-14)


def test_sums_of_fields(rng):
    x, y, out = rng.normal(size=(3, 50))
    assert inner_product(x, y) == pytest.approx(x @ y, rel=1e-14)
    assert distance(x, y) == pytest.approx(np.linalg.norm(x - y), rel=1e-14)
    expected = out + 2.0 * x - 3.0 * y
    add_fields(2.0, x, -3.0, y, out)
    np.testing.assert_allclose(out, expected, atol=1e-14)

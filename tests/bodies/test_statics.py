"""Statics of a body that nothing supports, and of one whose attachments are held."""

import numpy as np
import pytest
from mesh_bodies import CELLS, COUPLINGS, mesh_body, outside

from maggi.bodies.craig_bampton import interface
from maggi.bodies.statics import FreeStatics, HeldStatics, determinate_support

CASES = [(cell, name) for cell in CELLS for name in ("none", "rigid")]
CASES += [(cell, name) for cell in ("hex8", "tet10") for name in COUPLINGS if name not in ("none", "rigid")]


@pytest.fixture(scope="module", params=CASES, ids=" ".join)
def body(request):
    cell, name = request.param
    return mesh_body(cell, COUPLINGS[name])


@pytest.fixture(scope="module", params=[case for case in CASES if case[1] != "none"], ids=" ".join)
def attached(request):
    cell, name = request.param
    return mesh_body(cell, COUPLINGS[name])


def forces(body, count=3):
    return np.random.default_rng(1).normal(size=(body.size, count))


def test_a_determinate_support_leaves_no_rigid_motion(body):
    support = determinate_support(body)
    assert len(set(support.tolist())) == 6
    assert np.linalg.cond(body.Phi[support]) < 1e4  # metres and radians side by side


def test_floating_body(body):
    """K u = Pᵀf, and mean axes."""
    f = forces(body)
    u = FreeStatics(body).floating(f)
    balanced = f - body.C @ np.linalg.solve(body.J6, body.Phi.T @ f)
    np.testing.assert_allclose(body.K.matrix() @ u, balanced, atol=1e-9 * np.abs(f).max())
    np.testing.assert_allclose(body.C.T @ u, 0.0, atol=1e-14 * body.inertia.mass * np.abs(u).max())


def test_held_body(attached):
    """Bᵀu = 0, and what K u lacks of the forces are forces at the attachments, Bλ."""
    body, B = attached, interface(attached.B)
    statics, f = FreeStatics(body), forces(body)
    u = HeldStatics(statics, B).displacements(f)
    # what is held at both ends moves up to 500 times less than what it is a difference of
    np.testing.assert_allclose(B.T @ u, 0.0, atol=1e-14 * np.abs(statics.on_support(f)).max())
    assert outside(body.K.matrix() @ u - f, B.toarray()) < 1e-9
    work = f.T @ u  # a symmetric, positive compliance
    np.testing.assert_allclose(work, work.T, atol=1e-11 * np.abs(work).max())
    assert np.linalg.eigvalsh(0.5 * (work + work.T))[0] > 0.0


def test_unit_displacements(attached):
    """Bᵀu = 1 with forces at the attachments alone; rigid motions of the attachments are those of the body."""
    body, B = attached, interface(attached.B)
    U = HeldStatics(FreeStatics(body), B).unit_displacements()
    np.testing.assert_allclose(B.T @ U, np.eye(B.shape[1]), atol=1e-11)
    elastic = U @ np.linalg.qr(B.T @ body.Phi, mode="complete")[0][:, 6:]
    if elastic.shape[1]:
        assert outside(body.K.matrix() @ elastic, B.toarray()) < 1e-9
    np.testing.assert_allclose(U @ (B.T @ body.Phi), body.Phi, atol=1e-10)


def test_a_body_held_everywhere():
    """A beam of one element: no freedom is left between its ends."""
    body = mesh_body("beam", cells=(1, 1, 1))
    held = HeldStatics(FreeStatics(body), interface(body.B))
    np.testing.assert_allclose(held.displacements(forces(body)), 0.0, atol=1e-20)
    np.testing.assert_allclose(body.B.T @ held.unit_displacements(), np.eye(12), atol=1e-12)

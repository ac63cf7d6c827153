"""Constants of reduced bodies: against integrals over their shapes, for every element."""

import numpy as np
import pytest
from mesh_bodies import ALLOY, CELLS, SIZE, mesh_body

from maggi.bodies.basis import Shapes
from maggi.bodies.complete import complete
from maggi.bodies.craig_bampton import craig_bampton
from maggi.bodies.reduced import reduce_body
from maggi.elements.ritz import box_quadrature, integrate_ritz
from maggi.model.errors import ModelError

CONSTANTS = ("mass", "S0", "J0", "m", "k", "D", "m_O", "G", "H", "s", "s2")


def polynomials(points, degree):
    """Displacement fields x_j e_i (degree 1), and x_j x_k e_i (degree 2) at points (p, 3): values (p, 3, n)."""
    x, y, z = points.T
    terms = [x, y, z] if degree == 1 else [x, y, z, x * x, y * y, z * z, x * y, y * z, z * x]
    return np.stack([np.outer(term, np.eye(3)[i]).reshape(-1, 3) for term in terms for i in range(3)], axis=-1)


def gradients(points, degree):
    """The same fields' derivatives (p, 3, 3, n), ∂u_i/∂x_j."""
    h = 1e-3  # exact for polynomials of degree 2, but for round-off
    steps = [(polynomials(points + h * e, degree) - polynomials(points - h * e, degree)) / (2 * h) for e in np.eye(3)]
    return np.stack(steps, axis=2)


# Every solid element reproduces linear fields, those with nodes on their edges quadratic ones.
@pytest.mark.parametrize(
    ("cell", "degree"), [(cell, 1) for cell in CELLS if cell != "beam"] + [("hex20", 2), ("tet10", 2)]
)
def test_polynomial_shapes(cell, degree):
    """A mesh that moves in polynomials has the constants of a Ritz body with these shape functions."""
    body = mesh_body(cell, ())
    basis = polynomials(body.mesh.nodes, degree).reshape(body.size, -1)
    found = reduce_body(body, Shapes("given", basis, 0, np.zeros(basis.shape[1]), np.empty(0), 0)).terms
    points, weights = box_quadrature(np.zeros(3), np.array(SIZE), 4)
    expected = integrate_ritz(
        lambda x: polynomials(x, degree),
        points,
        weights,
        ALLOY.density,
        material=ALLOY,
        gradients=lambda x: gradients(x, degree),
    )
    for name in CONSTANTS:
        a, b = getattr(found, name), getattr(expected, name)
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-10 * np.abs(b).max(), err_msg=name)


@pytest.mark.parametrize("cell", ["hex8", "beam"])
def test_attachments_and_nodes_follow_the_shapes(cell):
    body = mesh_body(cell, ("rigid", "rigid"))
    reduced = reduce_body(body, craig_bampton(body, 3, "path"))
    e = np.random.default_rng(1).normal(size=reduced.basis.shape[1])
    u = reduced.basis @ e
    assert reduced.psi.shape == (2, 6, e.size)
    np.testing.assert_allclose((reduced.psi @ e).ravel(), body.B.T @ u, atol=1e-14)
    np.testing.assert_allclose(reduced.nodal_displacement(e), body.nodal_displacement(u), atol=1e-15)
    np.testing.assert_allclose(reduced.nodal_basis() @ e, body.nodal_displacement(u), atol=1e-14)


def test_rigid_motions_of_a_prescribed_frame():
    body = mesh_body("hex8", ("rigid", "average"), held=("a",))
    reduced = reduce_body(body, craig_bampton(body, 3, "path"))
    e = reduced.rigid_motions()
    np.testing.assert_allclose(reduced.basis @ e, body.Phi, atol=1e-12)
    np.testing.assert_array_equal(reduced.terms.k @ e, 0.0)
    elastic = reduced.static_compliance() @ reduced.terms.k
    np.testing.assert_allclose(elastic[6:, 6:], np.eye(len(e) - 6), atol=1e-9)
    floating = mesh_body("hex8", ("rigid", "average"))
    assert reduce_body(floating, craig_bampton(floating, 3, "path")).rigid_motions().shape == (9, 0)


@pytest.mark.parametrize(("held", "missing"), [(None, 6), (("a",), 0)])
@pytest.mark.parametrize("cell", ["hex8", "tet10", "beam"])
def test_complete_shapes(cell, held, missing):
    """As many coordinates as motions; a nodal force bends the dense body as it bends the mesh."""
    body = mesh_body(cell, ("rigid", "rigid"), cells=(2, 1, 1), held=held)
    reduced = reduce_body(body, complete(body, "bodies.bar"))
    n = body.size - missing
    assert reduced.basis.shape == (body.size, n)
    assert np.linalg.matrix_rank(reduced.basis / np.linalg.norm(reduced.basis, axis=0)) == n
    f = np.random.default_rng(2).normal(size=body.size)
    f -= body.C @ np.linalg.solve(body.J6, body.Phi.T @ f)
    u = reduced.basis @ (reduced.static_compliance() @ (reduced.basis.T @ f))
    np.testing.assert_allclose(body.K.matrix() @ u, f, atol=1e-7 * np.abs(f).max())


def test_too_many_complete_shapes():
    with pytest.raises(ModelError, match="1,641 elastic coordinates are more than the 1,500") as error:
        complete(mesh_body("hex8", (), cells=(60, 2, 2)), "bodies.bar")
    assert error.value.path == "bodies.bar" and "reduction" in error.value.remedy

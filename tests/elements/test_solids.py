"""Properties that every registered solid element has."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from maggi.elements import quadrature
from maggi.elements.assembly import assemble_solids, element_masses, element_stiffnesses
from maggi.elements.materials import CellMaterials
from maggi.elements.moving_frame import (
    FrameMotion,
    inertia_constants,
    isotropic_shapes,
    maggi_vector,
    nodal_acceleration,
)
from maggi.elements.solids import SOLIDS
from maggi.model.materials import Material

STEEL = Material(density=7850.0, young=2.1e11, poisson=0.3)
HIGH = {
    "tet4": quadrature.tetrahedron(6),
    "tet10": quadrature.tetrahedron(8),
    "hex8": quadrature.hexahedron(6),
    "hex20": quadrature.hexahedron(8),
    "wedge6": quadrature.wedge(6, 6),
}


@pytest.fixture(params=list(SOLIDS.values()), ids=list(SOLIDS))
def element(request):
    return request.param


def geometry(element, rule, X):
    """Values (p, k), spatial gradients (p, k, 3) and w det J (p,) of one cell with nodes X, by numpy alone."""
    reference = element.gradients(rule.points)
    J = np.einsum("ai,paj->pij", X, reference)
    spatial = np.einsum("paj,pji->pai", reference, np.linalg.inv(J))
    return element.values(rule.points), spatial, rule.weights * np.linalg.det(J)


def stiffness(element, rule, X, material):
    """∫ BᵀDB dV with the 6×3k strain matrix of the textbooks."""
    _, g, volume = geometry(element, rule, X)
    k = element.node_count
    B = np.zeros((len(g), 6, k, 3))
    for i in range(3):
        B[:, i, :, i] = g[:, :, i]
    for row, (i, j) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
        B[:, row, :, i], B[:, row, :, j] = g[:, :, j], g[:, :, i]
    B = B.reshape(len(g), 6, 3 * k)
    E, nu = material.young, material.poisson
    D = np.diag([1 - 2 * nu] * 3 + [(1 - 2 * nu) / 2] * 3)
    D[:3, :3] += nu
    D *= E / ((1 + nu) * (1 - 2 * nu))
    return np.einsum("p,pra,rs,psb->ab", volume, B, D, B, optimize=True)


def close(actual, expected, tolerance):
    __tracebackhide__ = True
    assert np.abs(actual - expected).max() <= tolerance * np.abs(expected).max()


def test_moving_frame_constants_agree_with_the_nodal_acceleration_field(element, box):
    """T2–T3 (constants G, H, s of the cell) against T4 (μ times one nodal field), on curved cells."""
    X, cells = box(element.name, jitter=0.2, curve=0.1, origin=(0.3, -0.2, 0.5))
    rng = np.random.default_rng(3)
    N = isotropic_shapes(element.values(element.mass_rule.points))
    masses = element_masses(element.name, X, cells, np.full(len(cells), STEEL.density))
    for row, cell in enumerate(cells):
        values, _, volume = geometry(element, element.mass_rule, X[cell])
        terms = inertia_constants(N, values @ X[cell], STEEL.density * volume)
        motion = FrameMotion(*rng.normal(size=(3, 3)))
        u, rate, acceleration = rng.normal(size=(3, element.node_count, 3))
        field = nodal_acceleration(X[cell], u, rate, acceleration, motion)
        vector = maggi_vector(terms, motion, u.ravel(), rate.ravel(), acceleration.ravel())
        close(vector, (masses[row] @ field).ravel(), 2e-14)


def test_mass_is_exact_on_curved_cells(element, box):
    X, cells = box(element.name, jitter=0.2, curve=0.15)
    masses = element_masses(element.name, X, cells, np.full(len(cells), STEEL.density))
    for row, cell in enumerate(cells):
        N, _, volume = geometry(element, HIGH[element.name], X[cell])
        close(masses[row], STEEL.density * np.einsum("p,pa,pb->ab", volume, N, N), 1e-13)


def test_stiffness_is_exact_on_affine_cells(element, box):
    shear = np.array([[1.0, 0.3, -0.2], [0.1, 0.8, 0.25], [-0.15, 0.05, 1.2]])
    X, cells = box(element.name)
    X = X @ shear.T
    matrices = element_stiffnesses(element.name, X, cells, CellMaterials.uniform(STEEL, len(cells)))
    for row, cell in enumerate(cells):
        close(matrices[row], stiffness(element, HIGH[element.name], X[cell], STEEL), 1e-12)


def test_stiffness_of_curved_cells(element, box):
    """The same rule gives the same matrix; the rule's own error on a curved cell vanishes with the curvature."""
    errors = []
    for curve in (0.1, 0.05):
        X, cells = box(element.name, curve=curve)
        matrices = element_stiffnesses(element.name, X, cells, CellMaterials.uniform(STEEL, len(cells)))
        worst = 0.0
        for row, cell in enumerate(cells):
            close(matrices[row], stiffness(element, element.stiffness_rule, X[cell], STEEL), 1e-12)
            high = stiffness(element, HIGH[element.name], X[cell], STEEL)
            worst = max(worst, np.abs(matrices[row] - high).max() / np.abs(high).max())
        errors.append(worst)
    assert errors[0] < 0.03
    assert errors[1] < 0.7 * errors[0] or errors[0] < 1e-12


def test_rigid_motions_are_free_of_stress_and_nothing_else_is(element, box):
    X, cells = box(element.name, jitter=0.2, curve=0.1)
    matrices = element_stiffnesses(element.name, X, cells, CellMaterials.uniform(STEEL, len(cells)))
    for row, cell in enumerate(cells):
        rotations = [np.cross(axis, X[cell]) for axis in np.eye(3)]
        rigid = np.array([np.tile(axis, element.node_count) for axis in np.eye(3)] + [r.ravel() for r in rotations])
        assert np.abs(matrices[row] @ rigid.T).max() < 1e-13 * np.abs(matrices[row]).max() * element.node_count
        values = np.linalg.eigvalsh(matrices[row])
        assert np.abs(values[:6]).max() < 1e-12 * values[-1]
        assert values[6] > 1e-5 * values[-1]


def test_patch_test(element, box):
    """A linear displacement on the boundary of a distorted patch is reproduced inside it."""
    X, cells = box(element.name, count=(3, 3, 3), jitter=0.2)
    on_hull = _hull(X, cells)
    K = assemble_solids(X, {element.name: cells}, STEEL).stiffness.tocsc()
    gradient = np.array([[1.0, 0.4, -0.2], [0.3, -0.7, 0.1], [0.25, 0.6, 0.5]]) * 1e-3
    exact = (X @ gradient.T + 2e-3).ravel()
    fixed = np.repeat(on_hull, 3)
    assert (~fixed).sum() >= 24
    inner = K[~fixed]
    u = spsolve(inner[:, ~fixed].tocsc(), -inner[:, fixed] @ exact[fixed])
    np.testing.assert_allclose(u, exact[~fixed], atol=1e-13)


def _hull(X, cells):
    """Nodes of the hull of `box`: those that jitter of a fifth of a cell leaves nearest to its faces."""
    scale = (X.min(axis=0) + X.max(axis=0)) / 2.0
    return (np.abs(X - scale) > 0.5 - 0.5 / 6.0).any(axis=1)


def test_mass_gives_total_mass_centre_and_inertia(element, box):
    X, cells = box(element.name, count=(2, 1, 1), size=(2.0, 0.5, 0.3))
    mu = assemble_solids(X, {element.name: cells}, STEEL).mass
    mass = STEEL.density * 0.3
    assert mu.sum() == pytest.approx(mass, rel=1e-14)
    np.testing.assert_allclose((mu @ X).sum(axis=0) / mass, [1.0, 0.25, 0.15], rtol=1e-13)
    second = X.T @ (mu @ X)
    np.testing.assert_allclose(np.diag(second), mass / 3.0 * np.array([4.0, 0.25, 0.09]), rtol=1e-13)

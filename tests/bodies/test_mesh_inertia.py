"""Inertia of meshed bodies, solid (T4) and beams (T2, T3, T5a), against dense constants with and without ties."""

import numpy as np
import pytest
import scipy.sparse as sp

from maggi.bodies.beam_inertia import BeamInertia
from maggi.bodies.freedoms import Freedoms
from maggi.bodies.isotropic_inertia import IsotropicInertia
from maggi.elements.assembly import assemble_solids
from maggi.elements.beam import assemble_beam
from maggi.elements.moving_frame import (
    SKEW,
    SKEW2,
    FrameMotion,
    InertiaConstants,
    frame_resultants,
    maggi_vector,
)
from maggi.mesh.parametric import beam, box
from maggi.model.materials import Material
from maggi.model.meshes import Section

STEEL = Material(density=7800.0, young=2e11, poisson=0.3)


def solid(tied):
    """A box of two hexahedra, its last face made rigid where `tied`; constants by N = Σ N_a I₃ and the tie T."""
    mesh = box((0.4, 0.2, 0.1), (2, 1, 1))
    mu = assemble_solids(mesh.nodes, mesh.cells, STEEL).mass
    face = mesh.node_sets["x_max"]
    freedoms = Freedoms.of(mesh.nodes, [(face, mesh.nodes[face].mean(axis=0))] if tied else [])
    T = freedoms.matrix().toarray()
    dense, X = mu.toarray(), mesh.nodes
    second = X.T @ dense @ X
    s = np.einsum("ab,kij,bj->kai", dense, SKEW, X).reshape(3, -1)
    s2 = np.einsum("ab,klij,bj->klai", dense, SKEW2, X).reshape(3, 3, -1)
    terms = InertiaConstants(
        mass=dense.sum(),
        S0=dense.sum(axis=0) @ X,
        J0=np.trace(second) * np.eye(3) - second,
        m=T.T @ np.kron(dense, np.eye(3)) @ T,
        m_O=T.T @ np.kron(dense.sum(axis=1)[:, None], np.eye(3)),
        G=np.array([T.T @ np.kron(dense, SKEW[k]) @ T for k in range(3)]),
        H=np.array([[T.T @ np.kron(dense, SKEW2[k, l]) @ T for l in range(3)] for k in range(3)]),
        s=s @ T,
        s2=s2 @ T,
    )
    return IsotropicInertia(mesh.nodes, mu, freedoms), terms


def beams():
    """A bent frame of three beams, in no plane."""
    nodes = np.array([[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [0.7, 0.5, 0.2], [0.7, 0.5, 0.8]])
    cells = np.array([[0, 1], [1, 2], [2, 3]])
    t = assemble_beam(nodes, cells, Section.rectangle(0.05, 0.1), STEEL)
    dense = InertiaConstants(
        np.array(t.mass),
        t.S0,
        t.J0,
        t.M.toarray(),
        t.m_O,
        np.array([G.toarray() for G in t.G]),
        np.array([[H.toarray() for H in row] for row in t.H]),
        t.s,
        t.s2,
    )
    return BeamInertia(t), dense


CASES = {"solid": lambda: solid(False), "solid with a rigid set": lambda: solid(True), "beams": beams}


@pytest.fixture(scope="module", params=CASES, ids=str)
def case(request):
    return CASES[request.param]()


def random_state(size, seed):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(3, 3)), 0.2 * rng.normal(size=(3, size))


def close(actual, expected):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=2e-13 * np.abs(expected).max())


@pytest.mark.parametrize("seed", range(2))
def test_residual(case, seed):
    inertia, terms = case
    (a_O, w, eps), (u, ud, udd) = random_state(len(terms.m), seed)
    nodal, frame = np.empty(len(u)), np.empty(6)
    inertia.forces(u, ud, udd, nodal).residual(np.array([a_O, w, eps]), frame)
    motion = FrameMotion(w, eps, a_O)
    close(nodal, maggi_vector(terms, motion, u, ud, udd))
    force, moment = frame_resultants(terms, motion, u, ud, udd)
    close(frame[:3], force)
    close(frame[3:], moment)


def test_relative_accelerations_are_for_the_freedoms_alone(case):
    """M (p u + q u̇) more on the freedoms, the same on the frame."""
    inertia, terms = case
    drive, (u, ud, udd) = random_state(len(terms.m), 6)
    relative, (p, q) = np.zeros(2), (-3.0, 0.7)
    nodal, frame, without = np.empty(len(u)), np.empty(6), np.empty(6)
    forces = inertia.forces(u, ud, udd, nodal, relative)
    S, J = forces.residual(drive, without)
    expected = nodal + terms.m @ (p * u + q * ud)
    relative[:] = p, q
    of_deformed = forces.residual(drive, frame)
    close(nodal, expected)
    np.testing.assert_array_equal(frame, without)
    np.testing.assert_array_equal(np.vstack(of_deformed), np.vstack((S, J)))


@pytest.mark.parametrize("columns", [1, 5, 11])
def test_product(case, columns):
    inertia, terms = case
    x = np.random.default_rng(8).normal(size=(len(terms.m), columns))
    close(inertia.product(x), terms.m @ x)
    close(inertia.product(np.asfortranarray(x)), terms.m @ x)


def test_squares(case):
    inertia, terms = case
    fields = np.random.default_rng(7).normal(size=(len(terms.m), 4))
    expected = np.einsum("nk,nk->k", fields, terms.m @ fields)
    np.testing.assert_allclose(inertia.squares(fields.reshape(-1, 3, 4)), expected, rtol=1e-12)


@pytest.mark.parametrize("seed", range(2))
def test_residual_on_mean_axes(case, seed):
    """With mean axes, Pᵀ of the forces on the freedoms, P = I − Φ (ΦᵀMΦ)⁻¹ ΦᵀM; the frame's are the same."""
    inertia, terms = case
    (a_O, w, eps), (u, ud, udd) = random_state(len(terms.m), seed)
    C = np.hstack([terms.m_O, terms.s.T])  # forces of unit accelerations of the frame
    Phi = np.linalg.solve(terms.m, C)
    axes = inertia.mean_axes(Phi, C, Phi.T @ C)
    nodal, frame, free, of_free = (np.empty(len(u)), np.empty(6), np.empty(len(u)), np.empty(6))
    inertia.forces(u, ud, udd, free).residual(np.array([a_O, w, eps]), of_free)
    inertia.forces(u, ud, udd, nodal, axes=axes).residual(np.array([a_O, w, eps]), frame)
    expected = free - C @ np.linalg.solve(Phi.T @ C, Phi.T @ free)
    np.testing.assert_allclose(nodal, expected, rtol=0, atol=1e-12 * np.abs(free).max())
    close(frame, of_free)


def test_constants(case):
    inertia, terms = case
    close(inertia.mass, terms.mass)
    close(inertia.S0, terms.S0)
    close(inertia.J0, terms.J0)
    close(inertia.matrix.toarray(), terms.m)


def test_constants_on_a_basis(case):
    """Those of u = Ψ e are the full ones between Ψ (a full Ψ, so that no symmetry of shapes hides a transposition)."""
    inertia, terms = case
    basis = np.random.default_rng(5).normal(size=(len(terms.m), 4))
    found = inertia.constants(basis)
    for name in ("mass", "S0", "J0"):
        close(getattr(found, name), getattr(terms, name))
    for name in ("m", "G", "H"):
        close(getattr(found, name), basis.T @ getattr(terms, name) @ basis)
    for name in ("s", "s2"):
        close(getattr(found, name), getattr(terms, name) @ basis)
    close(found.m_O, basis.T @ terms.m_O)


def mass_of_everything(terms, u):
    """The (6 + n)² mass matrix, column by column from accelerations alone."""
    n = len(u)
    columns, rest = [], np.zeros(n)
    for i in range(6 + n):
        a = np.eye(6 + n)[i]
        motion = FrameMotion(np.zeros(3), a[3:6], a[:3])
        columns.append(
            np.concatenate(
                [*frame_resultants(terms, motion, u, rest, a[6:]), maggi_vector(terms, motion, u, rest, a[6:])]
            )
        )
    return np.array(columns).T


def test_kinetic_energy(case):
    inertia, terms = case
    (v, w, _), (u, ud, _) = random_state(len(terms.m), 3)
    M = mass_of_everything(terms, u)
    velocity = np.concatenate([v, w, ud])
    assert inertia.kinetic_energy(v, w, u, ud) == pytest.approx(0.5 * velocity @ M @ velocity, rel=1e-12)


def test_inertia_of_the_deformed_frame(case):
    """S is exact; J in its part of first order in u, and wholly where the deformation is a mere shift."""
    inertia, terms = case
    _, (u, _, _) = random_state(len(terms.m), 4)
    plus, minus = (mass_of_everything(terms, x) for x in (u, -u))
    at_rest = np.zeros_like(u)

    def deformed(x):
        S, J = inertia.forces(x, at_rest, at_rest, np.empty_like(u)).residual(np.zeros((3, 3)), np.empty(6))
        return S.copy(), J.copy()

    (S, J), (_, J_minus) = (deformed(x) for x in (u, -u))
    close(S, [plus[5, 1], plus[3, 2], plus[4, 0]])
    close(J - J_minus, (plus - minus)[3:6, 3:6])
    shift = np.linalg.solve(terms.m, terms.m_O) @ [0.3, -0.2, 0.5]
    _, J = deformed(shift)
    np.testing.assert_allclose(J, mass_of_everything(terms, shift)[3:6, 3:6], rtol=0, atol=1e-10 * J.max())


def test_beams_on_different_graphs_are_refused():
    terms = assemble_beam(*(lambda m: (m.nodes, m.cells["beam2"]))(beam(1.0, 2)), Section.circle(0.1), STEEL)
    broken = type(terms)(**{**vars(terms), "G": (sp.bsr_matrix(terms.M.shape, blocksize=(3, 3)), *terms.G[1:])})
    with pytest.raises(ValueError, match="one graph"):
        BeamInertia(broken)

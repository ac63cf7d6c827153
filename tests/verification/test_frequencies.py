"""Natural frequencies of beams and plates against exact beam theory and converged plate theory (CASES C12)."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.linalg import eigh, expm
from scipy.optimize import brentq
from scipy.sparse.linalg import eigsh

from maggi.elements.assembly import assemble_solids
from maggi.elements.beam import assemble_beam
from maggi.mesh.parametric import beam, box
from maggi.model.materials import Material
from maggi.model.meshes import Section

# NAFEMS R0015: E, ν, ρ of all its cases.
NAFEMS = Material(density=8000.0, young=200e9, poisson=0.3)
# Roots of cos βL cosh βL = −1 (CASES C12).
CLAMPED_FREE = np.array([1.875104068712, 4.694091132974, 7.854757438238, 10.99554073488, 14.13716839105])


def bernoulli(material, length, area, inertia, count):
    """Exact clamped-free frequencies (Hz) of the Euler–Bernoulli beam."""
    return (
        CLAMPED_FREE[:count] ** 2
        / (2 * np.pi * length**2)
        * np.sqrt(material.young * inertia / (material.density * area))
    )


def timoshenko(material, length, area, inertia, factor, count):
    """Exact clamped-free frequencies (Hz) of the Timoshenko beam: roots of the transfer matrix's free-end determinant.

    State (w/L, ψ, M L/EI, Q L²/EI) along x/L with w' = ψ + Q/kGA, ψ' = M/EI, M' = −Q − ρIω²ψ, Q' = −ρAω²w.
    """
    E, G = material.young, material.young / (2 * (1 + material.poisson))
    shear = E * inertia / (factor * G * area * length**2)
    slimness = inertia / (area * length**2)

    def free_end(frequency):
        square = material.density * area * length**4 / (E * inertia) * (2 * np.pi * frequency) ** 2
        A = np.array([[0, 1, 0, shear], [0, 0, 1, 0], [0, -slimness * square, 0, -1], [-square, 0, 0, 0]])
        return np.linalg.det(expm(A)[2:, 2:])

    roots = []
    upper = bernoulli(material, length, area, inertia, count)
    # Below the Euler–Bernoulli frequency of the same number, above that of the one before.
    for low, high in zip(np.concatenate([[0.0], upper[:-1]]), upper, strict=True):
        grid = np.linspace(low, high, 40)[1:]
        values = [free_end(f) for f in grid]
        last = max(i for i in range(len(grid) - 1) if values[i] * values[i + 1] <= 0.0)
        roots.append(brentq(free_end, grid[last], grid[last + 1], xtol=1e-12, rtol=1e-14))
    return np.array(roots)


def clamped_beam(section, length, elements, material):
    """All frequencies (Hz) of a clamped-free beam along x."""
    mesh = beam(length, elements)
    terms = assemble_beam(mesh.nodes, mesh.cells["beam2"], section, material)
    squares = eigh(terms.K.toarray()[6:, 6:], terms.M.toarray()[6:, 6:], eigvals_only=True)
    return np.sqrt(squares) / (2 * np.pi)


def solid_frequencies(mesh, material, free, count, shift):
    """The `count` lowest frequencies (Hz) of a solid mesh with the nodes `free`; shift in (rad/s)²."""
    matrices = assemble_solids(mesh.nodes, mesh.cells, material)
    dofs = (3 * np.flatnonzero(free)[:, None] + np.arange(3)).ravel()
    K = matrices.stiffness.tocsr()[dofs][:, dofs].tocsc()
    M = sp.kron(matrices.mass, sp.eye(3), format="csr")[dofs][:, dofs].tocsc()
    squares = eigsh(K, count, M, sigma=shift, return_eigenvectors=False)
    return np.sort(np.sqrt(np.abs(squares)) / (2 * np.pi))


def test_slender_beam_has_the_frequencies_of_euler_and_bernoulli():
    """Length 1000 heights. Remaining: the elements' (βh)⁴/720 = 2e-5 in mode 5, rotary inertia (βL r/L)²/2 = 1e-5."""
    section = Section(area=1e-6, Iy=1e-12 / 12, Iz=4e-12 / 12, J=2e-13)
    frequencies = clamped_beam(section, 1.0, 40, NAFEMS)
    for inertia in (section.Iy, section.Iz):
        for expected in bernoulli(NAFEMS, 1.0, section.area, inertia, 5):
            assert np.abs(frequencies / expected - 1.0).min() < 5e-5


def test_beam_converges_with_fourth_order():
    section = Section(area=1e-6, Iy=1e-12 / 12, Iz=4e-12 / 12, J=2e-13)
    third = bernoulli(NAFEMS, 1.0, section.area, section.Iy, 3)[2]
    errors = [np.abs(clamped_beam(section, 1.0, n, NAFEMS) / third - 1.0).min() for n in (4, 8)]
    assert 3.5 < np.log2(errors[0] / errors[1]) < 4.5


def test_thick_beam_has_all_frequencies_of_timoshenko_and_rod_theory():
    """Length 12 heights: bending in both planes with shear and rotary inertia, axial and torsional, in one spectrum.

    50 elements; the rod's linear interpolation errs most, (βh)²/24 = 4e-4 in its second mode.
    """
    length, section = 1.2, Section.rectangle(0.06, 0.1)
    E, G, rho = NAFEMS.young, NAFEMS.young / 2.6, NAFEMS.density
    odd = np.array([1.0, 3.0]) / (4 * length)
    along_z = timoshenko(NAFEMS, length, section.area, section.Iy, section.kz, 5)
    assert along_z[2] < 0.97 * bernoulli(NAFEMS, length, section.area, section.Iy, 3)[2]
    expected = np.concatenate(
        [
            along_z,
            timoshenko(NAFEMS, length, section.area, section.Iz, section.ky, 5),
            odd * np.sqrt(E / rho),
            odd * np.sqrt(G * section.J / (rho * (section.Iy + section.Iz))),
        ]
    )
    complete = min(along_z[-1], 5 * odd[0] * np.sqrt(G * section.J / (rho * (section.Iy + section.Iz))))
    expected = np.sort(expected[expected < 0.99 * complete])
    assert len(expected) >= 9
    frequencies = clamped_beam(section, length, 50, NAFEMS)[: len(expected)]
    np.testing.assert_allclose(frequencies, expected, rtol=5e-4)


@pytest.mark.parametrize(("cell", "count"), [("hex20", (20, 2, 2)), ("tet10", (24, 2, 2))])
def test_solid_cantilever_has_timoshenkos_frequencies(cell, count):
    """Two modes in each plane of a cantilever of 12 and 20 heights, with ν = 0.

    With ν = 0 the clamp hinders no lateral contraction and Timoshenko's theory with k = 5/6 is the limit of the
    solid up to terms of (h/λ)⁴. What the meshes leave is 4e-4 (hex20) and 7e-4 (tet10) in the fourth mode; with half the
    cell length and width both are below 2e-4 of Timoshenko's.
    """
    length, width, height = 1.2, 0.06, 0.1
    material = Material(NAFEMS.density, NAFEMS.young, 0.0)
    mesh = box((length, width, height), count, cell)
    free = np.ones(len(mesh.nodes), dtype=bool)
    free[mesh.node_sets["x_min"]] = False
    section = Section.rectangle(width, height)
    expected = np.sort(
        np.concatenate(
            [timoshenko(material, length, section.area, inertia, 5 / 6, 2) for inertia in (section.Iy, section.Iz)]
        )
    )
    frequencies = solid_frequencies(mesh, material, free, 4, 0.0)
    np.testing.assert_allclose(frequencies, expected, rtol=1e-3)
    # A displacement method with exact mass converges from above.
    assert (frequencies > expected * (1 - 2e-4)).all()


def test_fv12_free_thin_plate():
    """NAFEMS FV12: 10 m × 10 m × 0.05 m, free; modes 7–14 against converged Kirchhoff theory, 1 %.

    Kirchhoff Ritz, 12 to 16 functions (CASES C12). Full integration: the cells are 12.5 times as wide as thick.
    """
    kirchhoff = np.array([1.621654, 2.359496, 2.922282, 4.190243, 4.190243, 7.356004, 7.356004, 7.668206])
    mesh = box((10.0, 10.0, 0.05), (16, 16, 1), "hex20")
    free = np.ones(len(mesh.nodes), dtype=bool)
    frequencies = solid_frequencies(mesh, NAFEMS, free, 14, -10.0)
    assert (frequencies[:6] < 1e-2).all()
    np.testing.assert_allclose(frequencies[6:], kirchhoff, rtol=0.01)

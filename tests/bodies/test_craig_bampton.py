"""Craig–Bampton's shapes: what they span, for every element and attachment, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from mesh_bodies import CELLS, COUPLINGS, description, mesh_body, outside

from maggi.analyses.modal import mesh_modes
from maggi.bodies.craig_bampton import craig_bampton, interface
from maggi.bodies.mesh_body import build_mesh_body
from maggi.bodies.reduced import reduce_body
from maggi.bodies.statics import FreeStatics
from maggi.model import BoxMesh
from maggi.model.errors import ModelError

CASES = [(cell, name) for cell in CELLS for name in ("none", "rigid")]
CASES += [(cell, name) for cell in ("hex8", "tet10") for name in COUPLINGS if name not in ("none", "rigid")]
HELD = [case for case in CASES if case[1] != "none"]
LOADED = [
    case for case in HELD if not case[1].startswith("one")
]  # a single attachment carries no forces in equilibrium


def over(cases):
    return pytest.mark.parametrize("case", cases, ids=" ".join)


def built(case, **keys):
    return mesh_body(case[0], COUPLINGS[case[1]], **keys)


@pytest.mark.parametrize(
    ("case", "held"),
    [(case, None) for case in CASES] + [(case, ("a",)) for case in HELD],
    ids=lambda part: " ".join(part) if isinstance(part, tuple) else "floating",
)
def test_shapes_are_orthogonal_and_apart_from_rigid_motions(case, held):
    body = built(case, held=held)
    shapes = craig_bampton(body, 5, "path")
    mass, basis = body.inertia.mass, shapes.basis
    np.testing.assert_allclose(
        basis.T @ (body.inertia.matrix @ basis), mass * np.eye(basis.shape[1]), atol=1e-11 * mass
    )
    stiffness = basis.T @ (body.K.matrix() @ basis)
    expected = np.diag(mass * (2 * np.pi * shapes.frequencies) ** 2)
    np.testing.assert_allclose(stiffness, expected, atol=1e-10 * expected.max())
    assert shapes.rigid == (6 if held else 0)
    np.testing.assert_allclose(body.C.T @ basis[:, shapes.rigid :], 0.0, atol=1e-13 * mass)
    if held:
        assert outside(basis[:, :6], body.Phi) < 1e-12


@over(CASES)
def test_modes_and_interface_are_those_of_the_body(case):
    """Frequencies with the attachments held, by another way: K + sM, clamps by projection; without, the elastic ones."""
    body = built(case)
    shapes = craig_bampton(body, 4, "path")
    clamped = [coupling.name for coupling in body.couplings]
    rigid = 0 if clamped else 6
    other = mesh_modes(body, 4 + rigid, clamped).frequencies[rigid:]
    np.testing.assert_allclose(shapes.held, other, rtol=1e-9)
    independent = {"none": 0, "one rigid": 6, "one average": 6}.get(case[1], 12)
    assert shapes.interface == independent
    assert shapes.basis.shape[1] == 4 + max(independent - 6, 0)


@over(LOADED)
def test_statics_of_loaded_attachments_is_exact_without_modes(case):
    """Forces in equilibrium at the attachments deform the reduced body as they do the full mesh."""
    body = built(case)
    reduced = reduce_body(body, craig_bampton(body, 0, "path"))
    B = body.B.toarray()
    balanced = scipy.linalg.null_space(body.Phi.T @ B)
    exact = FreeStatics(body).floating(B @ balanced)
    e = reduced.static_compliance() @ np.einsum("kin,kij->nj", reduced.psi, balanced.reshape(len(reduced.psi), 6, -1))
    np.testing.assert_allclose(reduced.basis @ e, exact, atol=1e-9 * np.abs(exact).max())


@over([("hex8", "rigid"), ("hex8", "average"), ("beam", "rigid"), ("tet4", "none")])
def test_all_modes_span_all_motions(case):
    body = built(case, cells=(2, 1, 1))
    free = body.size - (interface(body.B).shape[1] or 6)
    shapes = craig_bampton(body, free, "path")
    assert shapes.basis.shape[1] == body.size - 6
    everything = np.random.default_rng(3).normal(size=(body.size, 4))
    assert outside(everything, np.hstack([shapes.basis, body.Phi])) < 1e-9


def test_more_modes_come_closer_from_above():
    """Frequencies of the free body fall towards those of the mesh as modes are added (Rayleigh–Ritz)."""
    body = mesh_body("hex8", cells=(8, 2, 2))
    exact = mesh_modes(body, 12).frequencies[6:]
    found = [craig_bampton(body, count, "path").frequencies[:6] for count in (0, 2, 6, 12, 24)]
    errors = [float((one / exact - 1.0).max()) for one in found]
    assert (np.array(found) >= exact * (1 - 1e-9)).all()
    assert (np.diff(errors) < 1e-9).all()
    assert errors[-1] < 1e-3 and errors[0] > 0.1


def test_a_square_bar_has_its_bending_modes_twice():
    square = replace(description(), mesh=BoxMesh((0.4, 0.05, 0.05), (10, 2, 2), "hex8"))
    held = craig_bampton(build_mesh_body("bar", square, "."), 8, "path").held
    assert held[0] == pytest.approx(held[1], rel=1e-10)
    assert held[2] > 1.5 * held[1]


@pytest.mark.parametrize(
    ("couplings", "held", "count", "said"),
    [
        (("rigid", "rigid"), None, 1000, "1000 modes are asked for; with its attachments held the body has"),
        ((), None, 0, "cannot deform"),
        (("rigid",), None, 0, "cannot deform"),
        ((), (), 3, "no attachment that could hold it on its prescribed frame"),
    ],
)
def test_refused(couplings, held, count, said):
    with pytest.raises(ModelError, match=said) as error:
        craig_bampton(mesh_body("hex8", couplings, held=held), count, "bodies.bar.reduction")
    assert error.value.path.startswith("bodies.bar.reduction") and error.value.remedy

"""Assembly of solid meshes: against scikit-fem, against Maggi's projection (28), and its messages."""

import numba
import numpy as np
import pytest
import scipy.sparse as sp
import skfem
from skfem.helpers import ddot, dot, eye, sym_grad, trace

from maggi.elements.assembly import CHUNK, assemble_solids, element_masses, element_stiffnesses
from maggi.elements.materials import CellMaterials
from maggi.elements.solids import SOLIDS
from maggi.mesh import parametric
from maggi.model.errors import MeshError, ModelError
from maggi.model.materials import Material

STEEL = Material(density=7850.0, young=2.1e11, poisson=0.3)
ORACLE = {
    "tet4": (skfem.MeshTet, skfem.ElementTetP1),
    "tet10": (skfem.MeshTet, skfem.ElementTetP2),
    "hex8": (skfem.MeshHex, skfem.ElementHex1),
    "hex20": (skfem.MeshHex, skfem.ElementHexS2),
    "wedge6": (skfem.MeshWedge1, skfem.ElementWedge1),
}


def scikit_fem(name, X, cells, kind):
    """Mass or stiffness of a straight-edged mesh by scikit-fem, with the element's own rule, in our numbering."""
    element = SOLIDS[name]
    mesh_type, element_type = ORACLE[name]
    rule = element.mass_rule if kind == "mass" else element.stiffness_rule
    # Reference cells of scikit-fem: [0, 1] where ours are [-1, 1].
    low = np.array({"tet": [0, 0, 0], "hex": [-1, -1, -1], "wed": [0, 0, -1]}[name[:3]])
    to_unit = lambda x: np.where(low < 0, (x + 1.0) / 2.0, x)  # noqa: E731
    corners = mesh_type.init_refdom().p.T
    order = [int(np.abs(to_unit(element.nodes) - corner).sum(axis=1).argmin()) for corner in corners]
    used, local = np.unique(cells[:, order], return_inverse=True)
    mesh = mesh_type(X[used].T, local.reshape(-1, len(order)).T)
    quadrature = (to_unit(rule.points).T, rule.weights / 2.0 ** (low < 0).sum())
    basis = skfem.Basis(mesh, skfem.ElementVector(element_type()), quadrature=quadrature)
    lame = STEEL.young * STEEL.poisson / ((1 + STEEL.poisson) * (1 - 2 * STEEL.poisson))
    shear = STEEL.young / (2 * (1 + STEEL.poisson))

    @skfem.BilinearForm
    def mass(u, v, w):
        return STEEL.density * dot(u, v)

    @skfem.BilinearForm
    def elasticity(u, v, w):
        strain = sym_grad(u)
        return ddot(lame * eye(trace(strain), 3) + 2.0 * shear * strain, sym_grad(v))

    matrix = (mass if kind == "mass" else elasticity).assemble(basis)
    component = np.empty(basis.N, dtype=int)
    for dofs in (basis.nodal_dofs, basis.edge_dofs):
        for i, row in enumerate(dofs):
            component[row] = i % 3
    nearest = np.array([np.abs(X - place).sum(axis=1).argmin() for place in basis.doflocs.T])
    ours = np.empty(basis.N, dtype=int)
    ours[3 * nearest + component] = np.arange(basis.N)
    return matrix[ours][:, ours]


@pytest.mark.parametrize("kind", ["mass", "stiffness"])
@pytest.mark.parametrize("name", SOLIDS)
def test_distorted_straight_edged_mesh_agrees_with_scikit_fem(name, kind, box):
    X, cells = box(name, count=(2, 2, 2), size=(1.0, 0.7, 0.4), jitter=0.25)
    matrices = assemble_solids(X, {name: cells}, STEEL)
    ours = matrices.stiffness.tocsr() if kind == "stiffness" else sp.kron(matrices.mass, sp.eye(3))
    oracle = scikit_fem(name, X, cells, kind)
    assert abs(ours - oracle).max() <= 1e-12 * abs(oracle).max()


def mixed_mesh(box):
    """Two hex8 and four wedges that share the nodes between them, a curved tet10 patch and a hex20 beside them."""
    parts = {
        "hex8": box("hex8", count=(1, 2, 1)),
        "wedge6": box("wedge6", count=(1, 2, 1), origin=(1.0, 0.0, 0.0)),
        "tet10": box("tet10", count=(1, 1, 1), curve=0.1, origin=(0.0, 2.0, 0.0)),
        "hex20": box("hex20", count=(1, 1, 1), curve=0.1, origin=(3.0, 0.0, 0.0)),
    }
    places = np.vstack([X for X, _ in parts.values()])
    nodes, index = np.unique(places.round(9), axis=0, return_inverse=True)
    cells, start = {}, 0
    for name, (X, connectivity) in parts.items():
        cells[name] = index[start + connectivity]
        start += len(X)
    assert len(nodes) < len(places)
    return nodes, cells


def test_assembly_is_maggis_projection(box):
    """``Aᵀ [blockdiag] A`` of paper (28), with A the 0/1 matrix of Δ = A q written out."""
    nodes, cells = mixed_mesh(box)
    rng = np.random.default_rng(2)
    laws = {
        name: CellMaterials(rng.uniform(1, 2, len(c)), rng.uniform(1, 2, len(c)), rng.uniform(0.0, 0.4, len(c)))
        for name, c in cells.items()
    }
    matrices = assemble_solids(nodes, cells, laws)
    masses, stiffnesses, members = [], [], []
    for name, connectivity in cells.items():
        masses += list(element_masses(name, nodes, connectivity, laws[name].density))
        stiffnesses += list(element_stiffnesses(name, nodes, connectivity, laws[name]))
        members.append(connectivity.ravel())
    element_nodes = np.concatenate(members)
    A = sp.csr_matrix((np.ones(element_nodes.size), (range(element_nodes.size), element_nodes)))
    A3 = sp.kron(A, sp.eye(3))
    for ours, blocks, projection in ((matrices.mass, masses, A), (matrices.stiffness, stiffnesses, A3)):
        expected = (projection.T @ sp.block_diag(blocks) @ projection).toarray()
        assert np.abs(ours.toarray() - expected).max() <= 1e-15 * np.abs(expected).max()


def test_same_bits_for_any_number_of_threads(box):
    X, cells = box("tet10", count=(4, 4, 4), jitter=0.2)
    results = []
    before = numba.get_num_threads()
    for threads in {1, before}:
        numba.set_num_threads(threads)
        results.append(assemble_solids(X, {"tet10": cells}, STEEL))
    numba.set_num_threads(before)
    for one in results:
        assert np.array_equal(one.mass.data, results[0].mass.data)
        assert np.array_equal(one.stiffness.data, results[0].stiffness.data)
        assert np.array_equal(one.graph.indices, results[0].graph.indices)


def test_matrices_are_exactly_symmetric_and_share_int32_indices(box):
    nodes, cells = mixed_mesh(box)
    matrices = assemble_solids(nodes, cells, STEEL)
    for matrix in (matrices.mass, matrices.stiffness):
        assert abs(matrix - matrix.T).max() == 0.0
        assert matrix.indices.dtype == matrix.indptr.dtype == np.int32
    assert matrices.mass.has_canonical_format


def test_more_cells_than_a_chunk():
    """Chunks of cells only order the work: a block stretched evenly (E ε A at its ends, nothing inside)."""
    mesh = parametric.box((2.0, 3.0, 4.0), (18, 18, 17), "hex20")
    assert mesh.n_cells > CHUNK // 20**2
    matrices = assemble_solids(mesh.nodes, mesh.cells, STEEL)
    assert matrices.mass.sum() == pytest.approx(24.0 * STEEL.density, rel=1e-13)
    extension = matrices.stiffness @ (mesh.nodes * [1.0, -0.3, -0.3]).ravel()
    inner = np.setdiff1d(np.arange(mesh.n_nodes), np.concatenate([mesh.node_sets["x_min"], mesh.node_sets["x_max"]]))
    nodal = extension.reshape(-1, 3)
    assert nodal[mesh.node_sets["x_max"], 0].sum() == pytest.approx(STEEL.young * 12.0, rel=1e-11)
    assert np.abs(nodal[inner]).max() < 1e-11 * STEEL.young * 12.0


@pytest.mark.parametrize("name", SOLIDS)
def test_an_inverted_cell_is_named_with_its_determinant(name, box):
    X, cells = box(name, count=(3, 1, 1))
    X = X * [1.0, 1.0, -1.0]
    labels = {name: np.arange(1001, 1001 + len(cells))}
    with pytest.raises(MeshError, match=rf"{name} cell 1001 is inverted: least Jacobian determinant -\d.*more {name}"):
        assemble_solids(X, {name: cells}, STEEL, labels)


def test_one_bad_cell_among_many(box):
    X, cells = box("tet4", count=(2, 2, 2))
    cells = cells.copy()
    cells[7, :2] = cells[7, [1, 0]]
    with pytest.raises(MeshError, match=r"tet4 cell at row 7 is inverted: least Jacobian determinant -0.125 m³ "):
        assemble_solids(X, {"tet4": cells}, STEEL)


def test_flat_cells_are_refused_and_small_or_thin_ones_are_not(box):
    X, cells = box("hex8", count=(2, 1, 1))
    with pytest.raises(MeshError, match="hex8 cell at row 0 has no volume"):
        assemble_solids(X * [1.0, 1.0, 0.0], {"hex8": cells}, STEEL)
    assert assemble_solids(X * [1e-7, 1e-7, 1e-9], {"hex8": cells}, STEEL).mass.sum() > 0.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"density": 0.0}, "hex8 cell 11 has density 0"),
        ({"young": -1.0}, "hex8 cell 11 has young -1"),
        ({"young": float("inf")}, "has young inf"),
        ({"poisson": 0.5}, "has poisson 0.5"),
        ({"poisson": -1.0}, "has poisson -1"),
        ({"poisson": float("nan")}, "has poisson nan"),
    ],
)
def test_impossible_materials_are_refused(change, message, box):
    X, cells = box("hex8", count=(2, 1, 1))
    material = Material(**({"density": 1.0, "young": 1.0, "poisson": 0.3} | change))
    with pytest.raises(ModelError, match=message):
        assemble_solids(X, {"hex8": cells}, material, {"hex8": [11, 12]})


def test_unusable_meshes_are_refused(box):
    X, cells = box("hex8", count=(2, 1, 1))
    beyond = cells.copy()
    beyond[1, 3] = len(X)
    hole = X.copy()
    hole[4, 1] = np.nan
    for nodes, mesh, message in (
        (X, {"hex8": beyond}, f"row 1 names node index {len(X)}; the mesh has {len(X)} nodes"),
        (X, {"pyramid5": cells[:, :5]}, "'pyramid5' are not solid elements"),
        (X, {"hex20": cells}, r"hex20 cells have shape \(2, 8\)"),
        (X, {}, "no solid cells"),
        (hole, {"hex8": cells}, "node at row 4 has coordinates"),
        (X * 1e200, {"hex8": cells}, "coordinates .*e\\+200"),
        (X[:, :2], {"hex8": cells}, "nodes have shape"),
    ):
        with pytest.raises(MeshError, match=message):
            assemble_solids(nodes, mesh, STEEL)
    with pytest.raises(MeshError, match="no material is given for the hex8 cells"):
        assemble_solids(X, {"hex8": cells}, {})

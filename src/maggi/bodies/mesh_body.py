"""An elastic body with its full mesh: matrices, rigid motions and attachments on its freedoms."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from maggi.elements.assembly import assemble_solids
from maggi.elements.beam import assemble_beam
from maggi.elements.materials import CellMaterials
from maggi.elements.products import SymmetricBlocks
from maggi.mesh import Mesh, load_mesh, select
from maggi.mesh.load import in_the_model
from maggi.model.attachments import Attachment
from maggi.model.bodies import ElasticBody
from maggi.model.errors import MeshError, ModelError
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BeamMesh

from .beam_inertia import BeamInertia
from .couplings import Coupling, averaging_weights, make_coupling, refuse_overlap
from .freedoms import Freedoms
from .isotropic_inertia import IsotropicInertia
from .mean_axes import MeanAxes
from .mesh_inertia import MeshInertia

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MeshBody:
    """An elastic body in its own frame; nd freedoms in blocks of three, k attachments.

    K (nd, nd), one triangle; inertia; damping ``D = mass·PᵀMP + stiffness·K`` (relative to the frame).
    B (nd, 6k) sparse: the attachments' (d, θ) are Bᵀu. Phi (nd, 6): rigid motions about the origin;
    C (nd, 6) = M Φ: mean axes are Cᵀu = 0; J6 (6, 6) = ΦᵀMΦ; axes: the projections by them.
    floating: False where the frame is prescribed; then nothing is projected out.
    likeness: the same for bodies that are the same but for their names and their mesh's; those built together share
    everything else.
    """

    name: str
    mesh: Mesh
    inertia: MeshInertia
    K: SymmetricBlocks
    damping: Damping
    freedoms: Freedoms | None
    couplings: tuple[Coupling, ...]
    B: sp.csc_matrix
    J6: Array
    axes: MeanAxes
    floating: bool
    likeness: str

    @property
    def size(self) -> int:
        """Number of freedoms."""
        return self.K.order

    @property
    def Phi(self) -> Array:
        """Φ (nd, 6), made anew with every call."""
        return self.axes.Phi.dense()

    @property
    def C(self) -> Array:
        """C (nd, 6), made anew with every call."""
        return self.axes.C.dense()

    def set_aside(self) -> None:
        """Lets the system take back the memory of M and K until they are next read."""
        self.K.set_aside()
        self.inertia.set_aside()

    def nodal_displacement(self, u: Array) -> Array:
        """Displacements (n_nodes, 3) of the mesh's nodes, body frame."""
        if self.freedoms is None:
            return u.reshape(-1, 6)[:, :3].copy()
        return self.freedoms.expand(u, np.empty((self.mesh.n_nodes, 3))).copy()

    def nodal_displacements(self, columns: Array) -> Array:
        """Displacements (n_nodes, 3, k) of the mesh's nodes for k columns of freedoms (nd, k), body frame."""
        if self.freedoms is None:
            return np.ascontiguousarray(columns.reshape(-1, 6, columns.shape[1])[:, :3])
        return self.freedoms.expand_many(columns)

    def without_rigid_motion(self, columns: Array) -> Array:
        """Fields (nd, k) less the rigid motion that mean axes put into the frame: P of Eq. T6."""
        return np.asarray(columns - self.Phi @ np.linalg.solve(self.J6, self.C.T @ columns))


def build_mesh_body(name: str, body: ElasticBody, folder: str, others: Iterable[MeshBody] = ()) -> MeshBody:
    """Read or make the mesh, assemble it and attach its attachments.

    others : bodies built before; one that is the same gives its matrices.

    Raises ModelError or MeshError for a mesh, a set, a material or an attachment that cannot be used.
    """
    path = f"bodies.{name}"
    mesh = load_mesh(body.mesh, folder, f"{path}.mesh")
    if isinstance(body.mesh, BeamMesh):
        return _beam_body(name, body, body.mesh, mesh, others)
    if "beam2" in mesh.cells:
        raise ModelError(
            "the mesh file has beam cells, whose section it does not give",
            path=f"{path}.mesh",
            remedy="use `beam:` for a beam, or leave the beam cells out of the file",
        )
    couplings = [
        make_coupling(
            key,
            mesh.nodes,
            select(mesh, _selection(attachment, f"{path}.attachments.{key}"), f"{path}.attachments.{key}.nodes"),
            attachment.coupling == "rigid",
            f"{path}.attachments.{key}",
        )
        for key, attachment in body.attachments.items()
    ]
    refuse_overlap(couplings, path)
    materials, damping = _materials(body.material, mesh, path)
    likeness = _likeness(mesh, materials, damping, couplings, body.motion is None)
    twin = _twin(name, mesh, couplings, likeness, others)
    if twin is not None:
        return twin
    try:
        matrices = assemble_solids(mesh.nodes, mesh.cells, materials, mesh.cell_labels)
    except MeshError as error:
        raise in_the_model(error, body.mesh, f"{path}.mesh") from None
    freedoms = Freedoms.of(mesh.nodes, [(c.nodes, c.point) for c in couplings if c.rigid])
    inertia = IsotropicInertia(mesh.nodes, matrices.mass, freedoms)
    columns = []
    first = freedoms.blocks - 2 * sum(c.rigid for c in couplings)
    for coupling in couplings:
        if coupling.rigid:
            columns.append(_unit_columns(freedoms.size, 3 * first))
            first += 2
        else:
            columns.append(_averaging_columns(mesh.nodes, coupling, freedoms))
    Phi = _rigid_motions(mesh.nodes, freedoms, [c.point for c in couplings if c.rigid])
    return _finish(
        name,
        body,
        mesh,
        inertia,
        freedoms.reduce_matrix(matrices.stiffness),
        damping,
        freedoms,
        couplings,
        columns,
        Phi,
        likeness,
    )


def _beam_body(name: str, body: ElasticBody, source: BeamMesh, mesh: Mesh, others: Iterable[MeshBody]) -> MeshBody:
    path = f"bodies.{name}"
    if body.material is None:
        raise ModelError("a beam needs a material", path=path, remedy="add `material:` with the name of one")
    couplings = []
    for key, attachment in body.attachments.items():
        where = f"{path}.attachments.{key}"
        members = select(mesh, _selection(attachment, where), f"{where}.nodes")
        if len(members) != 1:
            raise ModelError(
                f"the attachment selects {len(members)} nodes of a beam",
                path=where,
                remedy="select one node, such as the sets `start` and `end`",
            )
        couplings.append(Coupling(key, members, mesh.nodes[members[0]], True))
    likeness = _likeness(mesh, (body.material, source.section), body.material.damping, couplings, body.motion is None)
    twin = _twin(name, mesh, couplings, likeness, others)
    if twin is not None:
        return twin
    terms = assemble_beam(mesh.nodes, mesh.cells["beam2"], source.section, body.material, mesh.cell_labels)
    columns = [_unit_columns(terms.K.shape[0], 6 * int(coupling.nodes[0])) for coupling in couplings]
    Phi = np.zeros((mesh.n_nodes, 6, 6))
    Phi[:, :3, :3] = np.eye(3)
    Phi[:, 3:, 3:] = np.eye(3)
    Phi[:, :3, 3:] = -_skew(mesh.nodes)
    return _finish(
        name,
        body,
        mesh,
        BeamInertia(terms),
        terms.K,
        body.material.damping,
        None,
        couplings,
        columns,
        Phi.reshape(-1, 6),
        likeness,
    )


def _finish(
    name: str,
    body: ElasticBody,
    mesh: Mesh,
    inertia: MeshInertia,
    K: sp.bsr_matrix,
    damping: Damping,
    freedoms: Freedoms | None,
    couplings: list[Coupling],
    columns: list[sp.csc_matrix],
    Phi: Array,
    likeness: str,
) -> MeshBody:
    B = sp.hstack(columns).tocsc() if columns else sp.csc_matrix((K.shape[0], 0))
    C = np.ascontiguousarray(inertia.matrix @ Phi)
    J6 = np.einsum("ni,nj->ij", Phi, C)  # in one thread, and one order
    J6 = 0.5 * (J6 + J6.T)
    return MeshBody(
        name,
        mesh,
        inertia,
        SymmetricBlocks.of(K),
        damping,
        freedoms,
        tuple(couplings),
        B,
        J6,
        inertia.mean_axes(Phi, C, J6),
        body.motion is None,
        likeness,
    )


def _likeness(mesh: Mesh, materials: object, damping: Damping, couplings: list[Coupling], floating: bool) -> str:
    """A digest of all that the matrices of a body follow from, by value."""
    digest = hashlib.sha256()

    def add(*parts: object) -> None:
        for part in parts:
            if isinstance(part, np.ndarray):
                digest.update(f"{part.dtype} {part.shape} ".encode() + np.ascontiguousarray(part).tobytes())
            else:
                digest.update(f"{part!r} ".encode())

    add(floating, damping, mesh.nodes)
    for kind, cells in sorted(mesh.cells.items()):
        add(kind, cells)
    if isinstance(materials, Mapping):
        for kind, table in sorted(materials.items()):
            add(kind, table.density, table.young, table.poisson)
    else:
        add(materials)
    for coupling in couplings:
        add(coupling.rigid, coupling.point, coupling.nodes)
    return digest.hexdigest()


def _twin(
    name: str, mesh: Mesh, couplings: list[Coupling], likeness: str, others: Iterable[MeshBody]
) -> MeshBody | None:
    """A body that shares the matrices of one of the others, if it is the same."""
    for other in others:
        if other.likeness == likeness:
            return replace(other, name=name, mesh=mesh, couplings=tuple(couplings))
    return None


def _selection(attachment: Attachment, path: str):  # type: ignore[no-untyped-def]
    if attachment.nodes is None:
        raise ModelError(
            "an attachment of an elastic body needs nodes",
            path=path,
            remedy="give `nodes:` a named set, or a box or a plane of nodes",
        )
    return attachment.nodes


def _materials(
    material: Material | None, mesh: Mesh, path: str
) -> tuple[Material | Mapping[str, CellMaterials], Damping]:
    """The body's material, or the mesh file's own where the body gives none."""
    if material is not None:
        return material, material.damping
    if not mesh.materials:
        raise ModelError(
            "the body has no material, and neither has its mesh file",
            path=path,
            remedy="add `material:` with the name of one",
        )
    table = list(mesh.materials.values())
    result = {}
    for kind, cells in mesh.cells.items():
        index = mesh.cell_materials.get(kind, np.full(len(cells), -1))
        missing = np.flatnonzero(index < 0)
        if missing.size:
            raise ModelError(
                f"{missing.size} {kind} cells have no material in the mesh file, the first is cell "
                f"{mesh.cell_labels[kind][missing[0]]}",
                path=path,
                remedy="add `material:` to the body, or *SOLID SECTION for these cells",
            )
        result[kind] = CellMaterials(
            np.array([m.density for m in table])[index],
            np.array([m.young for m in table])[index],
            np.array([m.poisson for m in table])[index],
        )
    return result, Damping()


def _unit_columns(size: int, first: int) -> sp.csc_matrix:
    return sp.csc_matrix((np.ones(6), (first + np.arange(6), np.arange(6))), shape=(size, 6))


def _averaging_columns(nodes: Array, coupling: Coupling, freedoms: Freedoms) -> sp.csc_matrix:
    weights = averaging_weights(nodes, coupling)
    rows = (3 * coupling.nodes[:, None] + np.arange(3)).ravel()
    columns = sp.coo_matrix(
        (weights.ravel(), (np.tile(rows, 6), np.repeat(np.arange(6), rows.size))), shape=(3 * len(nodes), 6)
    )
    if freedoms.tied.size == 0:
        return columns.tocsc()
    return (freedoms.matrix().T @ columns.tocsr()).tocsc()


def _skew(points: Array) -> Array:
    result = np.zeros((len(points), 3, 3))
    result[:, 0, 1], result[:, 0, 2] = -points[:, 2], points[:, 1]
    result[:, 1, 0], result[:, 1, 2] = points[:, 2], -points[:, 0]
    result[:, 2, 0], result[:, 2, 1] = -points[:, 1], points[:, 0]
    return result


def _rigid_motions(nodes: Array, freedoms: Freedoms, points: list[Array]) -> Array:
    """Φ on the freedoms: [I, −X̃] at free nodes; (d, θ) of a rigid motion at rigid attachments."""
    Phi = np.zeros((freedoms.blocks, 3, 6))
    free = freedoms.node_block >= 0
    Phi[freedoms.node_block[free], :, :3] = np.eye(3)
    Phi[freedoms.node_block[free], :, 3:] = -_skew(nodes[free])
    first = freedoms.blocks - 2 * len(points)
    for k, point in enumerate(points):
        Phi[first + 2 * k, :, :3] = np.eye(3)
        Phi[first + 2 * k, :, 3:] = -_skew(point[None])[0]
        Phi[first + 2 * k + 1, :, 3:] = np.eye(3)
    return Phi.reshape(-1, 6)

"""Small meshed bodies of every kind of element and attachment, built."""

import numpy as np

from maggi.bodies.mesh_body import build_mesh_body
from maggi.model import Attachment, BeamMesh, BoxMesh, Damping, ElasticBody, GivenMotion, Material, NamedSet, Section

ALLOY = Material(2700.0, 70e9, 0.33, Damping(3.0, 1e-5))
SIZE = (0.4, 0.06, 0.05)
CELLS = ("hex8", "hex20", "tet4", "tet10", "wedge6", "beam")
# coupling of each of the ends that have an attachment
COUPLINGS = {
    "none": (),
    "rigid": ("rigid", "rigid"),
    "average": ("average", "average"),
    "rigid and average": ("rigid", "average"),
    "average and rigid": ("average", "rigid"),
    "one rigid": ("rigid",),
    "one average": ("average",),
    "average twice": ("average", "average", "again"),
}


def description(cell="hex8", couplings=("rigid", "rigid"), cells=(4, 1, 1), *, held=None, material=ALLOY, **keys):
    """A bar along x; attachments ``a`` at its start, ``b`` at its end, ``c`` at its end again. held: prescribed frame."""
    if cell == "beam":
        mesh = BeamMesh(SIZE[0], Section.rectangle(*SIZE[1:]), cells[0])
    else:
        mesh = BoxMesh(SIZE, cells, cell)
    sets = ("start", "end", "end") if cell == "beam" else ("x_min", "x_max", "x_max")
    attachments = {
        name: Attachment(nodes=NamedSet(chosen), coupling="average" if coupling == "again" else coupling)
        for name, chosen, coupling in zip("abc", sets, couplings, strict=False)
    }
    motion = None if held is None else GivenMotion(held=held)
    return ElasticBody(mesh, material, attachments=attachments, motion=motion, **keys)


def mesh_body(cell="hex8", couplings=("rigid", "rigid"), cells=(4, 1, 1), **keys):
    """The same, built."""
    return build_mesh_body("bar", description(cell, couplings, cells, **keys), ".")


def outside(vectors, space):
    """The part of vectors (n, k) that is not in the span of space (n, r), relative to the vectors."""
    q = np.linalg.qr(space / np.linalg.norm(space, axis=0))[0]
    rest = vectors - q @ (q.T @ vectors)
    return np.linalg.norm(rest - q @ (q.T @ rest)) / np.linalg.norm(vectors)

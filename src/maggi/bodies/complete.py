"""Shapes that span all motions of a small mesh: the full mesh as a dense body, for linearisation and cross-checks."""

from __future__ import annotations

import numpy as np

from .basis import Shapes, modes_where, orthogonal_shapes, refuse_many
from .mesh_body import MeshBody


def complete(body: MeshBody, path: str) -> Shapes:
    """All free modes of a body, and on a prescribed frame its rigid motions: as many shapes as the motions span.

    Raises ModelError where they are too many for dense constants.
    """
    refuse_many(body.size - 6 * body.floating, path, "give the body a `reduction:`, or a coarser mesh")
    _, modes = modes_where(body, body.C, body.size - 6)
    basis, frequencies, rigid = orthogonal_shapes(body, modes, with_rigid=False)
    return Shapes("complete", basis, rigid, frequencies, np.empty(0), 0)

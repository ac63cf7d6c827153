"""Craig–Bampton's shapes: the lowest modes with all attachments held, and the statics of the attachments' motions."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator

from maggi.linalg.lanczos import ModesNotFoundError, lowest_modes
from maggi.model.errors import ModelError

from .basis import Shapes, modes_where, orthogonal_shapes, refuse_many
from .mesh_body import MeshBody
from .statics import FreeStatics, HeldStatics

Array = NDArray[np.float64]

SMALL = 1500  # freedoms up to which modes are found with dense matrices where a sixth of them or more are asked for
MOST = 20  # vectors of Lanczos's for a mode, and 1000 more, before modes are given up
SAME = 1e-12  # an interface motion whose squared length is below this part of the longest repeats others


def craig_bampton(body: MeshBody, count: int, path: str) -> Shapes:
    """Shapes of `count` held modes and all independent motions of the attachments, rigid (RBE2) or averaged (RBE3).

    A body without attachments gets its free modes. On a floating frame the rigid motions are taken out; on a prescribed
    one they stay, and held attachments are clamped by their liaison rows. path : of the reduction, for messages.

    Raises ModelError for more modes than the body has, where no shape is left, and for a prescribed frame that no
    attachment can hold.
    """
    B = interface(body.B)
    r = B.shape[1]
    _refuse(body, count, r, path)
    if body.size <= SMALL and 6 * count >= body.size:
        squares, modes = modes_where(body, B.toarray() if r else body.C, count)
        static = HeldStatics(FreeStatics(body), B).unit_displacements() if r else np.empty((body.size, 0))
    else:
        squares, modes, static = _sparse(body, B, count, path)
    basis, frequencies, rigid = orthogonal_shapes(body, np.hstack([modes, static]), with_rigid=r > 0)
    return Shapes("craig-bampton", basis, rigid, frequencies, np.sqrt(squares) / (2.0 * np.pi), r)


def interface(B: sp.csc_matrix) -> sp.csc_matrix:
    """Independent combinations of the attachments' motions Bᵀu: columns (nd, r) that span what B's do.

    Attachments repeat each other where, say, two average the same nodes.
    """
    if B.shape[1] == 0:
        return B
    length = np.sqrt(np.asarray(B.multiply(B).sum(axis=0)).ravel())
    unit = sp.csc_matrix(B @ sp.diags(1.0 / length))
    squares, turn = np.linalg.eigh((unit.T @ unit).toarray())
    kept = squares > SAME * squares.max()
    if kept.all():
        return unit
    return sp.csc_matrix(unit @ sp.csc_matrix(turn[:, kept] / np.sqrt(squares[kept])))


def _sparse(body: MeshBody, B: sp.csc_matrix, count: int, path: str) -> tuple[Array, Array, Array]:
    """λ, held modes and constraint modes with one factorisation."""
    statics = FreeStatics(body)
    held = HeldStatics(statics, B) if B.shape[1] else None
    static = held.unit_displacements() if held else np.empty((body.size, 0))
    if count == 0:
        return np.empty(0), np.empty((body.size, 0)), static
    product, shape = body.inertia.product, (body.size, body.size)
    M = LinearOperator(shape, matvec=lambda x: product(x.reshape(-1, 1)), matmat=product, dtype=np.float64)
    try:
        squares, modes = lowest_modes(held.displacements if held else statics.floating, M, count, MOST * count + 1000)
    except ModesNotFoundError as error:
        raise ModelError(str(error), path=f"{path}.modes", remedy="ask for fewer modes") from None
    return squares, modes, static


def _refuse(body: MeshBody, count: int, r: int, path: str) -> None:
    available = body.size - (r or 6)
    if count > available:
        raise ModelError(
            f"{count} modes are asked for; with its attachments held the body has {available}",
            path=f"{path}.modes",
            remedy="ask for fewer, or leave the reduction out",
        )
    if count + max(r - 6, 0) == 0:
        raise ModelError(
            "without modes and with fewer than two attachments the body cannot deform",
            path=f"{path}.modes",
            remedy="ask for modes, or make the body rigid",
        )
    if r == 0 and not body.floating:
        raise ModelError(
            "the body has no attachment that could hold it on its prescribed frame",
            path=path,
            remedy="add an attachment and name it in `held:`",
        )
    refuse_many(count + r, f"{path}.modes", "ask for fewer modes")

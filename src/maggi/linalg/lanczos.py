"""Lowest eigenpairs of K x = λ M x by block Lanczos on the inverse, with full reorthogonalisation.

Blocks, because bodies are symmetric: a square bar has every bending mode twice, which a single sequence of vectors finds
only by its round-off; and because eight right sides cost hardly more than one. Grimes, Lewis, Simon: A shifted block
Lanczos algorithm for solving sparse symmetric generalized eigenproblems, SIAM J. Matrix Anal. Appl. 15 (1994) 228–272.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BLOCK = 8
TOLERANCE = 1e-11  # of a residual, relative to its eigenvalue of the inverse
CONFIRMED = 2  # steps with fresh directions, after which nothing more must have been found
# A column that falls below the first of these parts of its length when what is known is taken out, and a direction of
# unit columns whose squared length falls below the second, is round-off.
EXHAUSTED, DEPENDENT = 1e-11, 1e-13
# Products with M are made again where what has changed since is more than the first, or has been magnified by more than
# the second allows.
NEGLIGIBLE, DIGITS_LOST = 1e-14, 1e-2


class ModesNotFoundError(RuntimeError):
    """The eigenpairs asked for were not found."""


def lowest_modes(inverse: Callable[[Array], Array], M: Any, count: int, most: int) -> tuple[Array, Array]:
    """The `count` lowest λ (count,), rising, and their x (n, count), M-orthonormal.

    Parameters
    ----------
    inverse : forces (n, k) to displacements (n, k), symmetric: K⁻¹, or the inverse of K on a subspace, which it keeps to.
    M : (n, n), anything that multiplies; positive definite.
    most : how many vectors are kept at most.

    Blocks find an eigenvalue as often as they are wide. So that none is missed that comes more often, as those of many equal
    blades on one hub, some fresh directions are followed at the end. Raises ModesNotFoundError if `most` do not do.
    """
    n = int(M.shape[0])
    rng = np.random.default_rng(0)

    def fresh() -> Array:
        return inverse(M @ rng.standard_normal((n, BLOCK)))

    Q = np.empty((n, most), order="F")  # memory is taken as columns are written
    T = np.zeros((0, 0))  # Qᵀ M inverse M Q
    used = 0
    found, confirmed = np.empty(0), 0
    block, image, _ = _orthonormal(fresh(), Q[:, :0], M)
    while block.shape[1] and used + block.shape[1] <= most:
        width, used = used, used + block.shape[1]
        Q[:, width:used] = block
        following, image, part = _orthonormal(inverse(image), Q[:, :used], M)
        inside, outside = part[:used], part[used:]
        corner = inside[width:]
        T = np.block([[T, inside[:width]], [inside[:width].T, 0.5 * (corner + corner.T)]])
        block = following
        if block.shape[1] and used < count:
            continue
        theta, y = np.linalg.eigh(T)
        theta, y = theta[::-1][:count], y[:, ::-1][:, :count]
        residual = np.linalg.norm(outside @ y[width:], axis=0)
        if used >= count and (residual <= TOLERANCE * theta).all():
            if found.size == 0 or np.abs(theta / found - 1.0).max() > 1e-8:
                found, confirmed = theta, 0
                block, image, _ = _orthonormal(np.hstack([following, fresh()]), Q[:, :used], M)
            else:
                confirmed += 1
            if confirmed == CONFIRMED or block.shape[1] == 0:
                return 1.0 / theta, Q[:, :used] @ y
        elif block.shape[1] == 0:  # the space that the first block leads to is exhausted
            block, image, _ = _orthonormal(fresh(), Q[:, :used], M)
    raise ModesNotFoundError(f"{count} modes were not found among {used} vectors")


def _orthonormal(X: Array, Q: Array, M: Any) -> tuple[Array, Array, Array]:
    """M-orthonormal columns Y of what X has outside Q, M Y, and the coefficients of X in [Q, Y]."""
    inside, outside = np.zeros((Q.shape[1], X.shape[1])), np.eye(X.shape[1])
    image = M @ X
    for repeated in (False, True):  # the second time for the digits that short columns have lost
        before = np.einsum("ij,ij->j", X, image)
        share = Q.T @ image
        X = X - Q @ share
        inside += share @ outside
        if not repeated or np.abs(share).max(initial=0.0) > NEGLIGIBLE:
            image = M @ X
        square = np.einsum("ij,ij->j", X, image)
        kept = square > EXHAUSTED**2 * before
        length = np.sqrt(square[kept])
        unit, image = X[:, kept] / length, image[:, kept] / length
        squares, turn = np.linalg.eigh(unit.T @ image)
        independent = squares > DEPENDENT
        scale = np.sqrt(squares[independent])
        turn = turn[:, independent]
        X, image = unit @ (turn / scale), image @ (turn / scale)
        outside = (scale[:, None] * turn.T * length) @ outside[kept]
        if scale.min(initial=1.0) < DIGITS_LOST:
            image = M @ X
    return X, image, np.vstack([inside, outside])

"""Lowest eigenpairs of K x = λ M x by block Lanczos on the inverse, with full reorthogonalisation and thick restarts.

Blocks, because bodies are symmetric: a square bar has every bending mode twice, which a single sequence of vectors finds
only by its round-off; and because eight right sides cost hardly more than one. Grimes, Lewis, Simon: A shifted block
Lanczos algorithm for solving sparse symmetric generalized eigenproblems, SIAM J. Matrix Anal. Appl. 15 (1994) 228–272.
Where there is no more room the best approximations so far go on in the place of all vectors. Wu, Simon: Thick-restart Lanczos
method for large symmetric eigenvalue problems, SIAM J. Matrix Anal. Appl. 22 (2000) 602–616.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BLOCK = 8
TOLERANCE = 1e-11  # of a residual, relative to its eigenvalue of the inverse
ROOM = 8  # blocks that there is room for beside as many vectors as are asked for
ROWS = 4096  # that are combined at a time
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
    M : (n, n), anything that multiplies, ``M @ X`` a new array; positive definite.
    most : how many vectors are made at most. Fewer are kept, `count` and some blocks.

    Blocks find an eigenvalue as often as they are wide. So that none is missed that comes more often, as those of many equal
    blades on one hub, some fresh directions are followed at the end. Raises ModesNotFoundError if `most` do not do.
    """
    n = int(M.shape[0])
    rng = np.random.default_rng(0)

    def fresh() -> Array:
        return inverse(M @ rng.standard_normal((n, BLOCK)))

    room = min(count + ROOM * BLOCK, most)
    Q = np.empty((n, room), order="F")  # memory is taken as columns are written
    T = np.zeros((0, 0))  # Qᵀ M inverse M Q
    used = made = 0
    found, confirmed = np.empty(0), 0
    block, image, _ = _orthonormal(fresh(), Q[:, :0], M)
    while block.shape[1] and made + block.shape[1] <= most:
        if used + block.shape[1] > room:
            used = count + BLOCK
            theta, y = _largest(T, used)
            _combine(Q, y)
            T = np.diag(theta)
        width, used, made = used, used + block.shape[1], made + block.shape[1]
        Q[:, width:used] = block
        following, image, part = _orthonormal(inverse(image), Q[:, :used], M)
        inside, outside = part[:used], part[used:]
        corner = inside[width:]
        T = np.block([[T, inside[:width]], [inside[:width].T, 0.5 * (corner + corner.T)]])
        block = following
        if block.shape[1] and used < count:
            continue
        theta, y = _largest(T, count)
        residual = np.linalg.norm(outside @ y[width:], axis=0)
        if used >= count and (residual <= TOLERANCE * theta).all():
            if found.size == 0 or np.abs(theta / found - 1.0).max() > 1e-8:
                found, confirmed = theta, 0
                block, image, _ = _orthonormal(np.hstack([following, fresh()]), Q[:, :used], M)
            else:
                confirmed += 1
            if confirmed == CONFIRMED or block.shape[1] == 0:
                _combine(Q, y)
                return 1.0 / theta, Q[:, :count]
        elif block.shape[1] == 0:  # the space that the first block leads to is exhausted
            block, image, _ = _orthonormal(fresh(), Q[:, :used], M)
    raise ModesNotFoundError(f"{count} modes were not found among {made} vectors")


def _largest(T: Array, count: int) -> tuple[Array, Array]:
    """The largest eigenvalues of a symmetric matrix, falling, and their vectors."""
    theta, y = np.linalg.eigh(T)
    return theta[::-1][:count], y[:, ::-1][:, :count]


def _combine(Q: Array, y: Array) -> Array:
    """Combinations y (m, k) of the first m columns in place of the first k; returns those."""
    m, k = y.shape
    for first in range(0, len(Q), ROWS):
        rows = slice(first, first + ROWS)
        Q[rows, :k] = Q[rows, :m] @ y
    return Q[:, :k]


def _orthonormal(X: Array, Q: Array, M: Any) -> tuple[Array, Array, Array]:
    """M-orthonormal columns Y of what X has outside Q, M Y, and the coefficients of X in [Q, Y]. X is overwritten."""
    inside, outside = np.zeros((Q.shape[1], X.shape[1])), np.eye(X.shape[1])
    image = M @ X
    for repeated in (False, True):  # the second time for the digits that short columns have lost
        before = np.einsum("ij,ij->j", X, image)
        share = Q.T @ image
        for first in range(0, len(X), ROWS):
            rows = slice(first, first + ROWS)
            X[rows] -= Q[rows] @ share
        inside += share @ outside
        if not repeated or np.abs(share).max(initial=0.0) > NEGLIGIBLE:
            image = M @ X
        square = np.einsum("ij,ij->j", X, image)
        kept = square > EXHAUSTED**2 * before
        length = np.sqrt(square[kept])
        if not kept.all():
            X, image = X[:, kept], image[:, kept]
        X /= length
        image /= length
        squares, turn = np.linalg.eigh(X.T @ image)
        independent = squares > DEPENDENT
        scale = np.sqrt(squares[independent])
        turn = turn[:, independent]
        X, image = _combine(X, turn / scale), _combine(image, turn / scale)
        outside = (scale[:, None] * turn.T * length) @ outside[kept]
        if scale.min(initial=1.0) < DIGITS_LOST:
            image = M @ X
    return X, image, np.vstack([inside, outside])

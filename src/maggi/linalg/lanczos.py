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
DEPENDENT = 1e-20  # a direction whose squared length falls below this part of the longest is round-off


class ModesNotFoundError(RuntimeError):
    """The eigenpairs asked for were not found."""


def lowest_modes(inverse: Callable[[Array], Array], M: Any, count: int, most: int) -> tuple[Array, Array]:
    """The `count` lowest λ (count,), rising, and their x (n, count), M-orthonormal.

    Parameters
    ----------
    inverse : forces (n, k) to displacements (n, k), symmetric: K⁻¹, or the inverse of K on a subspace, which it keeps to.
    M : (n, n), anything that multiplies; positive definite.
    most : how many vectors are kept at most.

    Raises ModesNotFoundError if so many vectors do not do.
    """
    n = int(M.shape[0])
    rng = np.random.default_rng(0)
    Q = np.empty((n, most), order="F")  # memory is taken as columns are written
    T = np.zeros((0, 0))  # Qᵀ M inverse M Q
    used = 0
    block, image, _ = _orthonormal(inverse(M @ rng.standard_normal((n, BLOCK))), Q[:, :0], M)
    while block.shape[1] and used + block.shape[1] <= most:
        width, used = used, used + block.shape[1]
        Q[:, width:used] = block
        block, image, part = _orthonormal(inverse(image), Q[:, :used], M)
        inside, outside = part[:used], part[used:]
        corner = inside[width:]
        T = np.block([[T, inside[:width]], [inside[:width].T, 0.5 * (corner + corner.T)]])
        theta, y = np.linalg.eigh(T)
        theta, y = theta[::-1][:count], y[:, ::-1][:, :count]
        if used >= count:
            residual = np.linalg.norm(outside @ y[width:], axis=0)
            if (residual <= TOLERANCE * theta).all():
                return 1.0 / theta, Q[:, :used] @ y
        if block.shape[1] == 0:  # the space that the first block leads to is exhausted
            block, image, _ = _orthonormal(inverse(M @ rng.standard_normal((n, BLOCK))), Q[:, :used], M)
    raise ModesNotFoundError(f"{count} modes were not found among {used} vectors")


def _orthonormal(X: Array, Q: Array, M: Any) -> tuple[Array, Array, Array]:
    """M-orthonormal columns Y of what X has outside Q, M Y, and the coefficients of X in [Q, Y]."""
    image = M @ X
    largest = float(np.abs(np.einsum("ij,ij->j", X, image)).max(initial=0.0))
    inside = Q.T @ image
    X = X - Q @ inside
    image = M @ X
    rest = Q.T @ image
    X -= Q @ rest
    squares, turn = np.linalg.eigh(X.T @ image)
    kept = squares > DEPENDENT * largest
    length = np.sqrt(squares[kept])
    X = (X @ turn[:, kept]) / length
    # once more: the first Gram matrix has the square of the columns' condition number
    image = M @ X
    squares, again = np.linalg.eigh(X.T @ image)
    scaled = again / np.sqrt(squares)
    outside = (np.sqrt(squares)[:, None] * again.T) @ (length[:, None] * turn[:, kept].T)
    return X @ scaled, image @ scaled, np.vstack([inside + rest, outside])

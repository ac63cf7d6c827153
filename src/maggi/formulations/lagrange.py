"""Lagrange's formulation: multipliers beside the accelerations, ``[M Aᵀ; A 0] (v̇, λ) = (f, −γ)``.

It takes the program's own matrices: it checks the projection, not what is projected.
"""

from __future__ import annotations

import numpy as np

from .linear import least_squares
from .question import Answer, Question


def lagrange(question: Question) -> Answer:
    """Accelerations and joint forces with multipliers, of least norm where rows are redundant."""
    terms = question.terms
    k, rows = len(terms.f), len(terms.A)
    matrix = np.block([[terms.M, terms.A.T], [terms.A, np.zeros((rows, rows))]])
    solution = least_squares(matrix, np.concatenate([terms.f, -terms.gamma]))
    accelerations, multipliers = solution[:k], solution[k:]
    liaisons = {name: -terms.A[owned].T @ multipliers[owned] for name, owned in terms.owner.items()}
    return Answer(accelerations, -terms.A.T @ multipliers, liaisons)

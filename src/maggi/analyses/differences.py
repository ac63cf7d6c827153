"""Derivatives of smooth functions by central differences of high order."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Order: weights of f(x + k h) − f(x − k h), k = 1, 2, …, and the step, relative to a typical change, at which the
# formula's error and round-off are alike.
CENTRAL = {
    2: ((1 / 2,), 1e-5),
    4: ((2 / 3, -1 / 12), 5e-4),
    6: ((3 / 4, -3 / 20, 1 / 60), 3e-3),
}


def central_differences(f: Callable[[Array], Array], x: Array, typical: Array, order: int) -> Array:
    """∂f/∂x (m, n) at x (n,); typical (n,): changes over which f is smooth. Order 2, 4 or 6."""
    weights, relative = CENTRAL[order]
    columns = []
    for j in range(len(x)):
        step = np.zeros(len(x))
        step[j] = relative * typical[j]
        terms = [w * (f(x + k * step) - f(x - k * step)) for k, w in enumerate(weights, 1)]
        columns.append(sum(terms[1:], terms[0]) / step[j])
    return np.array(columns).T if columns else np.empty((len(f(x)), 0))

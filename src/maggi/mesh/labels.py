"""From the labels of a file to indices of arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .mesh import IntArray


class LabelTable:
    """Finds the index of each label; memory in proportion to the number of labels, however large they are.

    labels : (n,), in any order; where one is repeated the first place is found.
    """

    def __init__(self, labels: IntArray) -> None:
        self._order = np.argsort(labels, kind="stable")
        self._sorted = labels[self._order]

    def find(self, labels: IntArray) -> tuple[IntArray, NDArray[np.bool_]]:
        """Indices of `labels` and which of them exist, both of the same shape as `labels`; index 0 where missing."""
        if len(self._sorted) == 0:
            return np.zeros_like(labels), np.zeros(labels.shape, dtype=np.bool_)
        place = np.minimum(np.searchsorted(self._sorted, labels), len(self._sorted) - 1)
        found = self._sorted[place] == labels
        return np.where(found, self._order[place], 0), found

    def within(self, first: int, last: int, step: int) -> IntArray:
        """Indices of the labels first, first + step, … up to last that exist."""
        low, high = np.searchsorted(self._sorted, [first, last + 1])
        chosen = (self._sorted[low:high] - first) % step == 0
        indices: IntArray = self._order[low:high][chosen]
        return indices


def sample(labels: IntArray, count: int = 5) -> str:
    """A few labels, for a message."""
    text = ", ".join(str(label) for label in labels[:count])
    return text if len(labels) <= count else f"{text}, …"

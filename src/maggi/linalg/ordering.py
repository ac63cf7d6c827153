"""Orders of rows in which a skyline matrix is narrow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

FEW = 8  # members, whose order has little to gain: scipy, slow to load, is left out


def skyline_order(count: int, pairs: Sequence[tuple[int, int]]) -> list[int]:
    """0 … count − 1 by reverse Cuthill–McKee on these pairs, each of which is taken both ways; as they are where few."""
    if count <= FEW:
        return list(range(count))
    import scipy.sparse as sp
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    rows, columns = np.concatenate([first, second]), np.concatenate([second, first])
    graph = sp.coo_matrix((np.ones(rows.size), (rows, columns)), shape=(count, count))
    return [int(i) for i in reverse_cuthill_mckee(graph.tocsr(), symmetric_mode=True)]

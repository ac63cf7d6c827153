"""Mass and stiffness of a tet10 mesh, against writing the same arrays once (the memory limit)."""

from __future__ import annotations

import statistics
import time

import numpy as np

from maggi.elements.assembly import assemble_solids
from maggi.mesh import box
from maggi.model.materials import Material

CELLS = (18, 18, 18)
REPEATS = 5


def main() -> None:
    mesh = box((1.0, 1.0, 1.0), CELLS, "tet10")
    steel = Material(7850.0, 2.1e11, 0.3)
    matrices = assemble_solids(mesh.nodes, mesh.cells, steel)
    assembled, written = [], []
    for _ in range(REPEATS):
        began = time.perf_counter()
        assemble_solids(mesh.nodes, mesh.cells, steel)
        assembled.append(time.perf_counter() - began)
        began = time.perf_counter()
        copies = [matrices.stiffness.data.copy(), matrices.mass.data.copy(), matrices.stiffness.indices.copy()]
        written.append(time.perf_counter() - began)
        del copies
    freedoms = 3 * mesh.n_nodes
    print(f"mass and stiffness, tet10, {freedoms:,} freedoms, {mesh.n_cells:,} cells (medians of {REPEATS})")
    print(f"  graph, mass, stiffness           {1e3 * statistics.median(assembled):8.1f} ms")
    print(f"  one copy of the finished arrays  {1e3 * statistics.median(written):8.1f} ms")
    print(f"  ratio                            {np.median(np.array(assembled) / np.array(written)):8.1f}")


if __name__ == "__main__":
    main()

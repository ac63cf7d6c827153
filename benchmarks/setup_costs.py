"""What is paid once: mass and stiffness, their factor, Craig–Bampton modes, and the memory that all of it takes.

Limits: of assembly, one copy of the finished arrays; of the factor, the library alone on the same matrix; of memory, the
factor as the library reports it and the matrices M and K themselves. Memory is that of a process of its own that gets
ready to run and makes two steps, less what the program takes for the smallest of meshes. Beside it stand what the library
says it needs at the peak of one factorisation, with the matrices beside it, and the memory of a reduction.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys

import scipy.sparse as sp

from common.bars import BAR_STEP, cells_for, hinged_bars
from common.ours import Ours
from common.tables import MISSING, Table, figure, times
from common.targets import Target
from common.timing import in_turn, median, ratio, wall_seconds
from maggi.bodies.craig_bampton import craig_bampton
from maggi.bodies.mesh_body import MeshBody, build_mesh_body
from maggi.bodies.reduced import reduce_body
from maggi.elements.assembly import assemble_solids
from maggi.integrators.generalized_alpha import generalized_alpha
from maggi.linalg.factor import factorise, rslab, settings  # which sets the library's allocator before it is loaded
from maggi.mesh import box
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody
from maggi.model.materials import Material
from maggi.model.meshes import BoxMesh

STEEL = Material(7850.0, 2.1e11, 0.3)
ASSEMBLY = Target(0.6, " s", at_most=True)
MODES = Target(15.0, " s", at_most=True)
MEMORY = Target(1.3, at_most=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="nine rounds, memory of 300,000 freedoms too")
    parser.add_argument("--child", choices=CHILDREN, help=argparse.SUPPRESS)
    parser.add_argument("--freedoms", type=int, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.child:
        print(json.dumps(CHILDREN[given.child](given.freedoms)))
        return
    table = Table("Paid once", "what", "freedoms", "ours", "limit", "ratio", "target", "reached")
    assembly(table, 9 if given.long else 5)
    body = two_ended(cells_for(95_000, "tet10"))
    factor(table, body)
    modes(table, body)
    memory(table, 95_000, MEMORY)
    if given.long:
        memory(table, 300_000)
    table.note("Seconds, tet10; for memory, MB.")
    table.show()


def assembly(table: Table, rounds: int) -> None:
    """Mass and stiffness of 152,000 freedoms."""
    mesh = box((1.0, 1.0, 1.0), (18, 18, 18), "tet10")
    matrices = assemble_solids(mesh.nodes, mesh.cells, STEEL)
    arrays = (matrices.stiffness.data, matrices.mass.data, matrices.stiffness.indices)
    taken = in_turn(
        {
            "ours": lambda: wall_seconds(lambda: assemble_solids(mesh.nodes, mesh.cells, STEEL)),
            "limit": lambda: wall_seconds(lambda: [array.copy() for array in arrays]),
        },
        rounds,
    )
    seconds = median(taken["ours"])
    _line(
        table, "mass and stiffness", 3 * mesh.n_nodes, seconds, median(taken["limit"]), ratio(*taken.values()), ASSEMBLY
    )


def two_ended(cells: tuple[int, int, int]) -> MeshBody:
    """The bar with a rigid interface at either end."""
    ends = {name: Attachment(nodes=NamedSet(name), coupling="rigid") for name in ("x_min", "x_max")}
    return build_mesh_body("bar", ElasticBody(BoxMesh((1.0, 0.05, 0.05), cells, "tet10"), STEEL, attachments=ends), "")


def step_matrix(body: MeshBody) -> sp.csc_array:
    """What a step factorises."""
    c = generalized_alpha(BAR_STEP, 0.9)
    return sp.csc_array(c.sigma * body.inertia.matrix + c.beta * c.h**2 * body.K.matrix())


def factor(table: Table, body: MeshBody) -> None:
    """The factor of a step's matrix, beside the library alone."""
    matrix = step_matrix(body)
    taken = in_turn(
        {
            "ours": lambda: wall_seconds(lambda: factorise(matrix)),
            "limit": lambda: wall_seconds(lambda: rslab.ldlt(matrix, ordering="metis")),
        },
        2,
    )
    _line(
        table,
        "factor of a step",
        body.size,
        median(taken["ours"]),
        median(taken["limit"]),
        ratio(*taken.values()),
        None,
    )


def modes(table: Table, body: MeshBody) -> None:
    """Thirty Craig–Bampton modes with two interfaces, and the constants of the reduced body."""
    shapes = []
    seconds = wall_seconds(lambda: shapes.append(craig_bampton(body, 30, "bar")))
    _line(table, "30 Craig–Bampton modes, 2 interfaces", body.size, seconds, None, None, MODES)
    seconds = wall_seconds(lambda: reduce_body(body, shapes[0]))
    _line(table, "constants of the reduced body", body.size, seconds, None, None, None)


def memory(table: Table, freedoms: int, target: Target | None = None) -> None:
    """Peak memory of getting ready, in a process of its own."""
    _in_a_process("start", freedoms)  # may have to compile, which takes memory too
    found = _in_a_process("start", freedoms) | _in_a_process("reduction", freedoms)
    quotient = found["peak"] / found["least"]
    none = (MISSING, MISSING)
    reached = target.cells("peak memory over factor and matrices", quotient) if target else none
    for what, key, cells in (
        ("peak memory", "peak", reached),
        ("the library's own peak and the matrices", "library", none),
        ("peak memory of 30 Craig–Bampton modes", "reduction", none),
    ):
        sizes = figure(found[key] / 2**20), figure(found["least"] / 2**20)
        table.row(what, f"{found['freedoms']:,}", *sizes, times(found[key] / found["least"]), *cells)


def _in_a_process(child: str, freedoms: int) -> dict[str, float]:
    command = [sys.executable, __file__, "--child", child, "--freedoms", str(freedoms)]
    found: dict[str, float] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return found


def _resident() -> int:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _peak() -> int:
    """Not `ru_maxrss`, which begins with that of the process that started this one."""
    with open("/proc/self/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmHWM:")) * 1024


def memory_of_reduction(freedoms: int) -> dict[str, float]:
    """Bytes: the peak of 30 Craig–Bampton modes, the body itself included, above that of a tiny one."""
    craig_bampton(two_ended((2, 1, 1)), 3, "bar")
    before = _resident()
    craig_bampton(two_ended(cells_for(freedoms, "tet10")), 30, "bar")
    return {"reduction": _peak() - before}


def memory_of_start(freedoms: int) -> dict[str, float]:
    """Bytes: the peak of a start and two steps above that of a tiny mesh; the library's and the matrices; factor and matrices."""
    Ours(hinged_bars((2, 1, 1), "tet10"), BAR_STEP).advance(2)  # compiled kernels, libraries
    before = _resident()
    ours = Ours(hinged_bars(cells_for(freedoms, "tet10"), "tet10"), BAR_STEP)
    ours.advance(2)
    peak = _peak() - before
    mesh = ours.stepper.meshes[0]
    body, held = mesh.body, mesh.constants.factor
    assert held is not None
    K, M = body.K.matrix(), sp.csr_matrix(body.inertia.matrix)
    M.eliminate_zeros()
    matrices = K.data.nbytes + K.indices.nbytes + M[::3, ::3].nnz * 12
    analysis = rslab.analyze(sp.tril(step_matrix(body)).tocsc(), path="ldlt", **settings(body.size))
    return {
        "freedoms": body.size,
        "peak": peak,
        "library": analysis.memory_plan()["peak_bytes"] + matrices,
        "least": held.nbytes + matrices,
    }


CHILDREN = {"start": memory_of_start, "reduction": memory_of_reduction}


def _line(
    table: Table,
    what: str,
    freedoms: int,
    seconds: float,
    limit: float | None,
    quotient: float | None,
    target: Target | None,
) -> None:
    cells = target.cells(f"{what}, {freedoms:,} freedoms", seconds) if target else (MISSING, MISSING)
    table.row(what, f"{freedoms:,}", figure(seconds), figure(limit), times(quotient), *cells)


if __name__ == "__main__":
    main()
